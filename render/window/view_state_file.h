#pragma once

#include <filesystem>
#include <string>

#include "render/window/window.h"

namespace condyle {

/// Keeps a JSON file up to date with what a window shows: the targets, the current state, and where
/// each thing that can be used stands. So that programs can use the window as people do.
class ViewStateFile {
 public:
  /// Empty: none is kept.
  explicit ViewStateFile(std::filesystem::path file) : file_(std::move(file)) {}
  /// Called once a turn of the window's loop.
  void update(const Window& window, const FrameState* frame, const std::string& busy_with);

 private:
  std::filesystem::path file_;
  std::string written_;
};

}  // namespace condyle
