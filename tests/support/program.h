#pragma once

#include <csignal>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace condyle::test {

struct Outcome {
  int code = -1;  // exit code; 128 + signal when killed
  std::string out, err;
};

struct Limits {
  long memory_mb = 0;                    // of address space; 0 = none
  long file_mb = -1;                     // largest file that may be written; -1 = none
  std::function<bool()> kill_when = {};  // polled; the program is killed when it returns true
  int kill_signal = SIGKILL;
};

/// Runs the built program with the arguments and waits for it.
Outcome condyle(const std::vector<std::string>& arguments, const Limits& limits = {});

/// A folder of this test's own, removed with the object.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

void write_text(const std::filesystem::path& file, const std::string& text);
std::string read_text(const std::filesystem::path& file);

/// A mandible and a maxilla made of boxes, 1 mm apart, as ASCII STL, with landmarks; 100 mm wide.
void write_box_patient(const std::filesystem::path& folder);
/// The same imported into a case folder; returns it.
std::string box_case(const Folder& folder);

}  // namespace condyle::test
