#pragma once

#include <filesystem>
#include <string_view>

#include "sim/motion/pose_series.h"

namespace condyle {

/// Content of a recording: poses of the mandible and, if recorded, of the cranium, in the axes of
/// the file.
struct RecordingFile {
  std::string format;  // name of the format
  RecordingMap map;    // defaults of the format, with the changes of the sidecar
  PoseSeries mandible;
  std::optional<PoseSeries> cranium = {};
};

/// Detects the format by content: a table of named columns (separated by comma, tab or semicolon),
/// OpenSim .mot and .sto, .trc (all markers on the mandible unless a sidecar assigns them),
/// ArtiSynth probe text with 12 or 16 columns, and rows of 16 numbers (4x4) or 17 (time first).
/// throws: InputError.
RecordingFile read_recording_file(const std::filesystem::path& file);

}  // namespace condyle
