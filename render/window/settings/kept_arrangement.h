#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "engine/core/settings_file.h"
#include "render/window/settings/arrangement.h"

namespace condyle {

/// The arrangement of the window in a file of the user's settings. Only changes made in the window
/// are stored: options of a command line apply to its own run.
class KeptArrangement {
 public:
  /// A missing file means the defaults.
  explicit KeptArrangement(std::filesystem::path file = settings_file("window.json"));

  const Arrangement& arrangement() const { return kept_; }
  /// A sentence if the file could not be read; the defaults then apply.
  const std::string& trouble() const { return trouble_; }

  /// The window as it opened.
  void begin(const Arrangement& opened) { before_ = opened; }
  /// Takes the present state of the window: changes are written atomically once nothing has changed
  /// for a moment, or `at_once`. A file that cannot be written is no error: the arrangement then
  /// lasts only as long as the window.
  void update(const Arrangement& now, bool at_once = false);

 private:
  std::filesystem::path file_;
  std::string trouble_;
  Arrangement kept_, before_;
  bool due_ = false;  // kept_ has not been written yet
  std::chrono::steady_clock::time_point changed_{};
};

}  // namespace condyle
