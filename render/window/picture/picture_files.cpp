#include "render/window/picture/picture_files.h"

#include <ctime>
#include <string>

namespace condyle {
namespace {

std::filesystem::path next_free(const std::filesystem::path& folder, const std::string& ending) {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char stamp[32] = "";
  std::strftime(stamp, sizeof stamp, "%Y%m%d-%H%M%S", &local);
  const std::string name = std::string("condyle-") + stamp;
  std::filesystem::path file = folder / (name + ending);
  std::error_code ignored;
  for (int n = 2; std::filesystem::exists(file, ignored); ++n)
    file = folder / (name + "-" + std::to_string(n) + ending);
  return file;
}

}  // namespace

std::filesystem::path next_picture_file(const std::filesystem::path& folder) {
  return next_free(folder, ".png");
}

std::filesystem::path next_recording_folder(const std::filesystem::path& folder) {
  return next_free(folder, "");
}

}  // namespace condyle
