#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "render/window/settings/arrangement.h"
#include "engine/core/settings_file.h"

namespace condyle {

/// The arrangement of the window in a small file of the person's settings. Only what the person
/// changes in the window goes there: what a command line asks for holds for its own run.
class KeptArrangement {
 public:
  /// A missing file is no trouble: all is as at first.
  explicit KeptArrangement(std::filesystem::path file = settings_file("window.json"));

  const Arrangement& arrangement() const { return kept_; }
  /// A sentence when the file could not be understood; then all is as at first.
  const std::string& trouble() const { return trouble_; }

  /// The window as it opened.
  void begin(const Arrangement& opened) { before_ = opened; }
  /// The window as it is now: what has changed is written, beside and renamed, when nothing has
  /// changed for a moment or `at_once`. A file that cannot be written is no error: the arrangement
  /// lasts as long as the window then.
  void update(const Arrangement& now, bool at_once = false);

 private:
  std::filesystem::path file_;
  std::string trouble_;
  Arrangement kept_, before_;
  bool due_ = false;  // kept_ is not in the file yet
  std::chrono::steady_clock::time_point changed_{};
};

}  // namespace condyle
