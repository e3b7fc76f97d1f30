#pragma once

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <string>

namespace condyle {

/// A place for a file or folder among the machine's passing ones; what was put there goes with the
/// object.
class TemporaryPath {
 public:
  explicit TemporaryPath(const std::string& what) {
    static std::atomic<int> made = 0;  // several threads may want one at a time
    path_ = std::filesystem::temp_directory_path() /
            ("condyle-" + what + "-" + std::to_string(::getpid()) + "-" + std::to_string(made++));
  }
  ~TemporaryPath() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryPath(const TemporaryPath&) = delete;
  TemporaryPath& operator=(const TemporaryPath&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace condyle
