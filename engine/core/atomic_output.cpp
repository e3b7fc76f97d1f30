#include "engine/core/atomic_output.h"

#include "engine/core/error.h"
#include "engine/core/files.h"

namespace condyle {
namespace fs = std::filesystem;

AtomicOutput::AtomicOutput(const fs::path& folder) : folder_(folder), stage_(folder / ".new.part") {
  make_folder(folder);
  std::error_code none;
  fs::remove_all(stage_, none);  // left by an interrupted run
  make_folder(stage_);
}

AtomicOutput::~AtomicOutput() {
  std::error_code none;
  fs::remove_all(stage_, none);
}

fs::path AtomicOutput::path(const std::string& name) {
  names_.push_back(name);
  return stage_ / name;
}

void AtomicOutput::write(const std::string& name, std::string_view content) {
  write_file(path(name), content);
}

void AtomicOutput::finish() {
  for (const auto& name : names_) {
    std::error_code error;
    fs::rename(stage_ / name, folder_ / name, error);
    if (error)
      throw MachineError((folder_ / name).string() +
                         ": cannot be moved into place: " + error.message());
  }
}

}  // namespace condyle
