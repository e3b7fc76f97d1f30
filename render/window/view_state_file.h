#pragma once

#include <filesystem>
#include <string>

#include "render/window/window.h"

namespace condyle {

/// Keeps a JSON file up to date with the state of a window: the targets, the current state, and the
/// position of each control, so that programs can use the window as people do.
class ViewStateFile {
 public:
  /// An empty path: no file.
  explicit ViewStateFile(std::filesystem::path file) : file_(std::move(file)) {}
  /// Called once per turn of the window's loop.
  void update(const Window& window, const FrameState* frame, const std::string& busy_with);

 private:
  std::filesystem::path file_;
  std::string written_;
};

}  // namespace condyle
