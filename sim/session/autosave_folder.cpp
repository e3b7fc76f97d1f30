#include "sim/session/autosave_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "engine/core/files.h"

namespace condyle {
namespace fs = std::filesystem;
namespace {

constexpr const char* lock_ending = ".lock";

fs::path lock_of(fs::path file) { return file.replace_extension(lock_ending); }

/// Opens a file for a lock, which no child process inherits, and takes it. Returns a descriptor, or
/// -1 where another process has the lock.
int locked(const fs::path& file, int flags) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CLOEXEC | flags, 0600);
  if (descriptor < 0 || ::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
  ::close(descriptor);
  return -1;
}

}  // namespace

fs::path state_folder() {
  const char* state = std::getenv("XDG_STATE_HOME");
  const char* home = std::getenv("HOME");
  // By the XDG specification a relative path is ignored.
  if (state && fs::path(state).is_absolute()) return fs::path(state) / "condyle";
  if (home && *home) return fs::path(home) / ".local" / "state" / "condyle";
  return {};
}

AutosaveFolder::AutosaveFolder(std::string ending, fs::path folder)
    : ending_(std::move(ending)), folder_(std::move(folder)) {
  if (folder_.empty()) {
    trouble_ = "the user has no home folder";
    return;
  }
  try {
    make_folder(folder_);
  } catch (const std::exception& error) {
    trouble_ = error.what();
    return;
  }
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const std::string name =
      "window-" + std::to_string(::getpid()) + "-" +
      std::to_string(std::chrono::duration_cast<std::chrono::microseconds>(now).count());
  const fs::path file = folder_ / (name + ending_);
  // Other processes see the lock only once it is taken.
  const fs::path hidden = folder_ / ("." + name + lock_ending);
  const int descriptor = locked(hidden, O_CREAT | O_EXCL);
  if (descriptor < 0 || ::rename(hidden.c_str(), lock_of(file).c_str()) != 0) {
    trouble_ = folder_.string() + ": cannot be written: " + std::strerror(errno);
    if (descriptor >= 0) ::close(descriptor);
    return;
  }
  locks_.push_back({file, descriptor});
  file_ = file;
}

AutosaveFolder::~AutosaveFolder() {
  std::error_code ignored;
  for (const Lock& lock : locks_) {
    // The lock of a file that is gone protects nothing.
    if (!fs::exists(lock.file, ignored)) fs::remove(lock_of(lock.file), ignored);
    ::close(lock.descriptor);
  }
}

bool AutosaveFolder::take_lock(const fs::path& file) {
  const int descriptor = locked(lock_of(file), O_CREAT);
  if (descriptor < 0) return false;
  locks_.push_back({file, descriptor});
  return true;
}

void AutosaveFolder::free_lock(const fs::path& file) {
  const auto lock =
      std::find_if(locks_.begin(), locks_.end(), [&](const Lock& one) { return one.file == file; });
  if (lock == locks_.end()) return;
  std::error_code ignored;
  fs::remove(lock_of(file), ignored);
  ::close(lock->descriptor);
  locks_.erase(lock);
}

std::vector<fs::path> AutosaveFolder::take_orphans() {
  std::vector<std::pair<fs::file_time_type, fs::path>> orphans;
  std::error_code error;
  std::vector<fs::path> there;
  if (!folder_.empty())
    for (fs::directory_iterator one(folder_, error), end; !error && one != end;
         one.increment(error))
      there.push_back(one->path());
  for (const fs::path& path : there) {
    std::error_code ignored;
    if (!path.filename().string().starts_with("window-") || path == file_) continue;
    if (path.extension() == lock_ending) {  // of a process that had written nothing yet
      fs::path file = path;
      file.replace_extension(ending_);
      if (!fs::exists(file, ignored) && file != file_ && take_lock(file)) free_lock(file);
    } else if (path.extension() == ending_ && take_lock(path)) {
      // Another process may have discarded it before the lock was taken.
      const auto time = fs::last_write_time(path, ignored);
      if (ignored)
        free_lock(path);
      else
        orphans.emplace_back(time, path);
    }
  }
  std::sort(orphans.begin(), orphans.end(), std::greater<>());
  std::vector<fs::path> files;
  for (auto& [time, path] : orphans) files.push_back(std::move(path));
  return files;
}

void AutosaveFolder::adopt(const fs::path& orphan) {
  std::error_code error;
  if (!file_.empty()) fs::rename(orphan, file_, error);
  if (!error) free_lock(orphan);
}

void AutosaveFolder::discard(const fs::path& orphan) {
  std::error_code ignored;
  fs::remove(orphan, ignored);
  free_lock(orphan);
}

fs::path AutosaveFolder::set_aside(const fs::path& orphan) {
  fs::path aside = orphan;
  aside += ".kept";
  std::error_code ignored;
  fs::rename(orphan, aside, ignored);
  free_lock(orphan);
  return aside;
}

void AutosaveFolder::end() {
  if (file_.empty()) return;
  std::error_code ignored;
  fs::remove(file_, ignored);
  free_lock(file_);
  file_.clear();
}

}  // namespace condyle
