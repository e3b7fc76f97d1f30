#pragma once

#include <filesystem>
#include <vector>

#include "engine/core/settings_file.h"

namespace condyle {

/// The files opened before, the last one first; stored in a file of the user's settings.
class RecentFiles {
 public:
  /// `file`: one path per line. A missing or unreadable one is an empty list.
  explicit RecentFiles(std::filesystem::path file = settings_file("recent"));

  const std::vector<std::filesystem::path>& list() const { return list_; }
  /// Puts the path first and writes the list atomically; ten are kept. A list that cannot be
  /// written is no error: it lasts only as long as the window.
  void add(const std::filesystem::path& opened);
  /// Removes a path that no longer exists.
  void forget(const std::filesystem::path& gone);

 private:
  void write() const;
  std::filesystem::path file_;
  std::vector<std::filesystem::path> list_;
};

}  // namespace condyle
