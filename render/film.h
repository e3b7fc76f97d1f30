#pragma once

#include <filesystem>
#include <memory>

#include "render/image.h"

namespace condyle {

/// An MP4 (x264, yuv420p) made by the `ffmpeg` program while pictures are still being drawn. It is
/// written beside its place and renamed when it is whole. The same pictures give the same bytes.
/// Odd sides gain one black row or column, which the format demands.
class Film {
 public:
  /// throws: MachineError when ffmpeg cannot be started.
  Film(const std::filesystem::path& file, int width, int height, double frames_per_second);
  /// Without `finish` nothing is left of it.
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// The next picture, of that size. throws: MachineError with ffmpeg's last words.
  void add(const Image& picture);

  /// Waits for ffmpeg and puts the film in its place. throws: MachineError; the old film stays.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
