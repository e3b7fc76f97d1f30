#pragma once

#include <filesystem>
#include <memory>

#include "render/image/image.h"

namespace condyle {

/// An MP4 (x264, yuv420p) encoded by the `ffmpeg` program while pictures are still being drawn. It
/// is written to a temporary file and renamed when complete. Reproducible: the same pictures give
/// the same bytes. Odd sides gain one black row or column, as the format requires.
class Film {
 public:
  /// throws: MachineError when ffmpeg cannot be started.
  Film(const std::filesystem::path& file, int width, int height, double frames_per_second);
  /// Without `finish` nothing is left of it.
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// The next picture, of that size. throws: MachineError with ffmpeg's last message.
  void add(const Image& picture);

  /// Waits for ffmpeg and moves the film into place. throws: MachineError; then the old film
  /// remains.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
