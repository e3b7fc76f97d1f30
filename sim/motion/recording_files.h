#pragma once

#include <filesystem>
#include <string_view>

#include "sim/motion/pose_series.h"

namespace condyle {

/// A recording's file taken apart: poses of the mandible and, where it moves too, the cranium, in
/// the file's own axes.
struct RecordingFile {
  std::string format;  // as people call it
  RecordingMap map;    // what the format takes for granted, and the sidecar's changes
  PoseSeries mandible;
  std::optional<PoseSeries> cranium = {};
};

/// Knows by the content: a table of named columns (CSV; tab or semicolon too), OpenSim .mot and
/// .sto, .trc (all markers on the mandible unless a sidecar tells more), ArtiSynth probe text with
/// 12 or 16 columns, and rows of 16 numbers (4x4) or 17 (time first). throws: InputError.
RecordingFile read_recording_file(const std::filesystem::path& file);

}  // namespace condyle
