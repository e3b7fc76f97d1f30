#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "render/image.h"
#include "render/recording_sheet.h"

namespace condyle {

struct RecorderSettings {
  std::filesystem::path folder;
  int width = 1280, height = 720;
  int frames = 0;                 // of the whole recording
  double frames_per_second = 30;  // of the film
  bool film = false;
  bool resume = false;      // keep the whole frames of the same recording
  RecordingSheet identity;  // what else decides the pictures: camera, case and motion hashes …
};

/// What lies where a recording is to go.
struct RecordingThere {
  int pictures = 0;                  // whole ones of this recording, or those of another
  std::vector<std::string> differs;  // in what the other is another; empty: it is this one
};
RecordingThere recording_there(const RecorderSettings& settings);

/// Writes frames/000000.png …, hashes.csv (of each picture's file) and film.mp4 into a folder. A
/// frame is written beside and renamed, so that whatever kills the program leaves whole frames;
/// `recording.json` says what they are of. Pictures are packed, written and given to the film on a
/// thread of their own, a few behind the drawing.
class Recorder {
 public:
  /// Touches nothing but leftovers of a killed run. An earlier recording is set aside when the
  /// first new frame is ready; it goes when the new one is whole, and comes back when a frame
  /// cannot be written. throws: MachineError when the folder cannot be made or written; InputError
  /// when `resume` meets another recording, saying what differs.
  explicit Recorder(const RecorderSettings& settings);
  /// Waits for the frames in hand; makes no film.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Whether the frame is there already and need not be drawn again.
  bool has(int frame) const;
  int kept_frames() const;

  /// What draws the frames that are added from now on.
  void set_driver(const std::string& driver);
  /// What has drawn the frames that are there, also those of the run that is resumed: each driver
  /// once, in their order, parted by "; ".
  std::string drivers() const;

  /// Takes a picture of the wanted size; frames in any order.
  /// throws: MachineError of this or an earlier frame that could not be written.
  void add(int frame, Image picture);

  /// Waits for the last frame and makes the film.
  /// throws: MachineError; the frames stay whole when only the film fails.
  void finish();

  std::filesystem::path frame_file(int frame) const;
  std::filesystem::path film_file() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
