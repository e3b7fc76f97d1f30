#pragma once

#include <filesystem>
#include <vector>

#include "engine/core/settings_file.h"

namespace condyle {

/// What was opened before, the last one first; kept in a file of the person's settings.
class RecentFiles {
 public:
  /// `file`: a path a line. A missing or unreadable one is an empty list.
  explicit RecentFiles(std::filesystem::path file = settings_file("recent"));

  const std::vector<std::filesystem::path>& list() const { return list_; }
  /// Puts it first and writes the list beside and renamed; ten are kept. A list that cannot be
  /// written is no error: it lasts as long as the window.
  void add(const std::filesystem::path& opened);
  /// What is not there any more.
  void forget(const std::filesystem::path& gone);

 private:
  void write() const;
  std::filesystem::path file_;
  std::vector<std::filesystem::path> list_;
};

}  // namespace condyle
