#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace condyle {

/// Files that belong together: written into a folder of their own beside those of an earlier run,
/// which stay whole until all new ones are there.
class AtomicOutput {
 public:
  /// Makes `folder` when it is not there. throws: MachineError.
  explicit AtomicOutput(const std::filesystem::path& folder);
  ~AtomicOutput();
  AtomicOutput(const AtomicOutput&) = delete;
  AtomicOutput& operator=(const AtomicOutput&) = delete;

  /// Where to write the file of this name.
  std::filesystem::path path(const std::string& name);
  void write(const std::string& name, std::string_view content);

  /// Puts all files in place, in the order in which they were written.
  void finish();

 private:
  std::filesystem::path folder_, stage_;
  std::vector<std::string> names_;
};

}  // namespace condyle
