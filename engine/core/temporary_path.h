#pragma once

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <string>

namespace condyle {

/// A unique path in the system's temporary folder; its contents are deleted with the object.
class TemporaryPath {
 public:
  explicit TemporaryPath(const std::string& what) {
    static std::atomic<int> made = 0;  // several threads may create one at the same time
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
