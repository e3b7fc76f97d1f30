#include "sim/session/recent_files.h"

#include <algorithm>
#include <sstream>

#include "engine/core/error.h"
#include "engine/core/files.h"

namespace condyle {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t most = 10;
constexpr std::size_t largest_recent_list = std::size_t{1} << 16;

}  // namespace

RecentFiles::RecentFiles(fs::path file) : file_(std::move(file)) {
  if (file_.empty()) return;
  try {
    std::istringstream lines(read_file(file_, largest_recent_list));
    for (std::string line; std::getline(lines, line) && list_.size() < most;)
      if (!line.empty()) list_.emplace_back(line);
  } catch (const std::exception&) {
    list_.clear();  // none yet
  }
}

void RecentFiles::add(const fs::path& opened) {
  std::error_code ignored;
  fs::path whole = fs::weakly_canonical(opened, ignored);
  if (whole.empty()) whole = opened;
  if (whole.string().find('\n') != std::string::npos) return;  // the list has one path per line
  std::erase(list_, whole);
  list_.insert(list_.begin(), whole);
  if (list_.size() > most) list_.resize(most);
  write();
}

void RecentFiles::forget(const fs::path& gone) {
  std::error_code ignored;
  if (std::erase(list_, fs::weakly_canonical(gone, ignored)) + std::erase(list_, gone) > 0) write();
}

void RecentFiles::write() const {
  if (file_.empty()) return;
  std::string text;
  for (const fs::path& path : list_) text += path.string() + "\n";
  try {
    make_folder(file_.parent_path());
    write_file(file_, text);
  } catch (const MachineError&) {
    // The list then lasts only as long as the window.
  }
}

}  // namespace condyle
