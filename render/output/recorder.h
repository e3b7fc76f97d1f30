#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "render/image/image.h"
#include "render/output/recording_sheet.h"

namespace condyle {

struct RecorderSettings {
  std::filesystem::path folder;
  int width = 1280, height = 720;
  int frames = 0;                 // of the whole recording
  double frames_per_second = 30;  // of the film
  bool film = false;
  bool resume = false;  // keep the complete frames of the same recording
  // other data that determines the pictures: camera, case and motion hashes …
  RecordingSheet identity;
};

/// Existing content of a recording's folder.
struct RecordingThere {
  int pictures = 0;  // complete ones of this recording, or those of another
  // entries in which the other recording differs; empty: it is this one
  std::vector<std::string> differs;
};
RecordingThere recording_there(const RecorderSettings& settings);

/// Writes frames/000000.png …, hashes.csv (of each picture's file) and film.mp4 into a folder. A
/// frame is written to a temporary file and renamed, so that an interruption at any time leaves
/// complete frames; `recording.json` identifies them. Pictures are compressed, written and passed
/// to the film on a separate thread, a few behind the drawing.
class Recorder {
 public:
  /// Changes nothing except leftovers of a killed run. An earlier recording is set aside when the
  /// first new frame is ready; it is removed when the new one is complete, and restored when a
  /// frame cannot be written. throws: MachineError when the folder cannot be created or written;
  /// InputError when `resume` finds another recording, listing the differences.
  explicit Recorder(const RecorderSettings& settings);
  /// Waits for pending frames; makes no film.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Whether the frame exists already and need not be drawn again.
  bool has(int frame) const;
  int kept_frames() const;

  /// Driver of the frames that are added from now on.
  void set_driver(const std::string& driver);
  /// Drivers of the existing frames, including those of a resumed run: each driver once, in their
  /// order, separated by "; ".
  std::string drivers() const;

  /// Adds a picture of the configured size; frames in any order.
  /// throws: MachineError of this or an earlier frame that could not be written.
  void add(int frame, Image picture);

  /// Waits for the last frame and makes the film.
  /// throws: MachineError; the frames remain complete when only the film fails.
  void finish();

  std::filesystem::path frame_file(int frame) const;
  std::filesystem::path film_file() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
