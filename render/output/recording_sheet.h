#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace condyle {

/// Identity of a recording, by name: size, frames, camera, hashes of case and motion. Two
/// recordings with the same sheet have the same pictures.
using RecordingSheet = std::map<std::string, std::string>;

/// Absent when the folder has none or it is unreadable: then nothing in the folder can be trusted.
std::optional<RecordingSheet> read_recording_sheet(const std::filesystem::path& file);
/// throws: MachineError.
void write_recording_sheet(const std::filesystem::path& file, const RecordingSheet& sheet);

/// Names of the entries in which they differ.
std::vector<std::string> differing(const RecordingSheet& before, const RecordingSheet& now);
/// "frames was 60, is 90; …", or empty when they are the same.
std::string difference(const RecordingSheet& before, const RecordingSheet& now);

/// Whether the file is a PNG of that size with all its chunks intact.
bool is_whole_png(const std::filesystem::path& file, int width, int height);

}  // namespace condyle
