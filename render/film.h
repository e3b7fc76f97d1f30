#pragma once

#include <filesystem>

namespace condyle {

/// Makes an MP4 (x264, yuv420p) of folder/frames/000000.png … through the `ffmpeg` program, beside
/// the target, and renames it. The same frames give the same bytes. Odd sides gain one black row or
/// column, which the format demands.
/// throws: MachineError with ffmpeg's last line, or how to install it; the old film stays whole.
void make_film(const std::filesystem::path& folder, const std::filesystem::path& film, int frames,
               double frames_per_second);

}  // namespace condyle
