#include "render/window/picture_files.h"

#include <ctime>
#include <string>

namespace condyle {

std::filesystem::path next_picture_file(const std::filesystem::path& folder) {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char stamp[32] = "";
  std::strftime(stamp, sizeof stamp, "%Y%m%d-%H%M%S", &local);
  const std::string name = std::string("condyle-") + stamp;
  std::filesystem::path file = folder / (name + ".png");
  std::error_code ignored;
  for (int n = 2; std::filesystem::exists(file, ignored); ++n)
    file = folder / (name + "-" + std::to_string(n) + ".png");
  return file;
}

}  // namespace condyle
