#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "render/displacement_drawing.h"
#include "render/drawers.h"
#include "render/recorder.h"
#include "render/shown_overlays.h"
#include "sim/case/muscle.h"
#include "tools/camera_options.h"
#include "tools/distance_drawing.h"
#include "tools/picture_facts.h"
#include "tools/picture_options.h"

namespace condyle {

/// What a recording is of, for its sheet and its cameras.
struct RecordingSubject {
  const Scene& scene;
  const Motion& motion;
  const SimulatorSettings& settings;
  int frames = 1;
  double frames_per_second = 30;
  RecordingSheet identity;  // of case, motion and tissue
};

/// Where the pictures go.
struct RecordingFiles {
  std::filesystem::path out;  // several cameras: a folder each in it
  bool film = false;
  bool resume = false;
};

/// What lies where a recording is to go, of all its cameras together.
RecordingThere recording_there(const PicturePlan& plan, const RecordingFiles& files,
                               const RecordingSubject& subject);

/// Draws the frames of one recording, seen by one camera or several, and keeps them.
class PictureTaker {
 public:
  PictureTaker(const PicturePlan& plan, const RecordingFiles& files,
               const RecordingSubject& subject);

  /// Pictures that were there already.
  int kept() const { return kept_; }
  PictureFacts facts() const;

  /// What is done with a frame once its pictures are drawn: in order, one at a time, on threads of
  /// the drawing.
  using Done = std::function<void(int frame, const FrameState& state)>;
  /// All frames, in their order, are to be shown to it, wanted or not: paths grow with them.
  /// Returns when it is ready for the next. throws: MachineError of this frame or an earlier one.
  void take(int frame, FrameState state, const Done& done);
  /// Until all taken are drawn and done.
  void wait();
  /// Waits for the files and makes the films.
  void finish();

 private:
  struct View {
    RecordingCamera camera;
    PictureSettings settings;
    std::unique_ptr<Recorder> recorder;
  };
  /// What one drawing thread draws with.
  struct Desk {
    OverlaySender overlays;
    Lettering words;
    std::optional<DistanceDrawing> distances;
    std::optional<DisplacementDrawing> displacement;
  };
  /// A frame with what is drawn around it.
  struct Shot {
    SceneRenderer& renderer;
    Desk& desk;
    const FrameState& state;
    const Overlays& overlays;
  };
  void prepare(SceneRenderer& renderer, Desk& desk) const;
  /// With key and legend; tells the notes what room they leave.
  Image picture(const View& view, const Camera& camera, const Shot& shot, Annotations& notes) const;
  Image before_after(const View& view, const Camera& camera, const Shot& shot) const;
  Image drawn(const View& view, const Camera& camera, const Shot& shot, bool with_map) const;
  Image finished(const View& view, int frame, const Shot& shot) const;
  /// Whether any camera still wants the frame.
  bool wanted(int frame) const;
  /// Of the window or of the command, with a key to all of it.
  Overlays overlays_of(const FrameState& state, bool with_paths) const;
  Overlays chosen_overlays(const FrameState& state, bool with_paths) const;

  const RecordingSubject subject_;
  PicturePlan plan_;
  FrameState rest_;  // left of a wipe
  MotionPaths paths_;
  std::vector<Muscle> muscles_;  // that are drawn
  std::vector<View> views_;
  int kept_ = 0;
  std::deque<Desk> desks_;
  std::optional<Drawers> drawers_;  // ends first
};

}  // namespace condyle
