#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace condyle {

/// A set of output files: written to a temporary folder beside those of an earlier run, which stay
/// intact until all new ones are complete.
class AtomicOutput {
 public:
  /// Creates `folder` if it does not exist. throws: MachineError.
  explicit AtomicOutput(const std::filesystem::path& folder);
  ~AtomicOutput();
  AtomicOutput(const AtomicOutput&) = delete;
  AtomicOutput& operator=(const AtomicOutput&) = delete;

  /// Path to which the file of this name is written.
  std::filesystem::path path(const std::string& name);
  void write(const std::string& name, std::string_view content);

  /// Moves all files to their final paths, in the order in which they were written.
  void finish();

 private:
  std::filesystem::path folder_, stage_;
  std::vector<std::string> names_;
};

}  // namespace condyle
