#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace condyle {

/// Folder of the user's state: $XDG_STATE_HOME/condyle, else ~/.local/state/condyle; empty without
/// a home.
std::filesystem::path state_folder();

/// The folder of autosaved sessions. Each process has a file of its own there, which no other one
/// writes, and holds a lock for as long as it lives: a file whose lock is free was left by a
/// process that ended without removing it.
class AutosaveFolder {
 public:
  /// `ending`: of the files. A folder that is empty or cannot be written: nothing is autosaved.
  explicit AutosaveFolder(std::string ending, std::filesystem::path folder = state_folder());
  ~AutosaveFolder();  // frees the locks; the files stay
  AutosaveFolder(const AutosaveFolder&) = delete;
  AutosaveFolder& operator=(const AutosaveFolder&) = delete;

  /// File of this process; empty: nothing can be autosaved.
  const std::filesystem::path& file() const { return file_; }
  /// Why nothing can be autosaved, as a sentence; empty where it can.
  const std::string& trouble() const { return trouble_; }

  /// Files of processes that no longer live, the newest first. They are locked for this process
  /// until it ends, so that two windows do not open the same one.
  std::vector<std::filesystem::path> take_orphans();
  /// Makes an orphan the file of this process.
  void adopt(const std::filesystem::path& orphan);
  void discard(const std::filesystem::path& orphan);
  /// Sets aside an orphan that could be opened only in part; returns its new name.
  std::filesystem::path set_aside(const std::filesystem::path& orphan);
  /// Removes the file of this process: it ends as the user asked.
  void end();

 private:
  struct Lock {
    std::filesystem::path file;  // that it protects
    int descriptor = -1;
  };
  void free_lock(const std::filesystem::path& file);
  bool take_lock(const std::filesystem::path& file);

  std::string ending_;
  std::filesystem::path folder_, file_;
  std::string trouble_;
  std::vector<Lock> locks_;
};

}  // namespace condyle
