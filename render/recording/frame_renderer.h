#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "render/output/parallel_renderers.h"
#include "render/output/recorder.h"
#include "render/recording/distance_drawing.h"
#include "render/recording/muscle_bellies.h"
#include "render/recording/picture_plan.h"
#include "render/recording/recording_camera.h"
#include "render/recording/render_metadata.h"
#include "render/scene/displacement_drawing.h"
#include "render/scene/shown_overlays.h"
#include "sim/simulator/simulator.h"

namespace condyle {

/// What is recorded, for its sheet and its cameras.
struct RecordingSubject {
  const Scene& scene;
  const Motion& motion;
  const SimulatorSettings& settings;
  int frames = 1;
  double frames_per_second = 30;
  RecordingSheet identity;  // of case, motion and tissue
};

/// The same motion, drawn with other parts or opacities.
struct OtherLook {
  std::filesystem::path out;
  PictureSettings settings;
  RecordingSheet words = {};  // as PicturePlan::words
};

/// Output of the pictures.
struct RecordingFiles {
  std::filesystem::path out;  // with several cameras: one subfolder each
  bool film = false;
  bool resume = false;
  std::vector<OtherLook> others = {};  // drawn of the same frames
};

/// Existing content at the output of a recording, of all its cameras together.
RecordingThere recording_there(const PicturePlan& plan, const RecordingFiles& files,
                               const RecordingSubject& subject);

/// Draws and stores the frames of one recording, for one or several cameras.
class FrameRenderer {
 public:
  FrameRenderer(const PicturePlan& plan, const RecordingFiles& files,
                const RecordingSubject& subject);

  /// Pictures that existed already.
  int kept() const { return kept_; }
  RenderMetadata facts() const;

  /// Called for a frame once its pictures are drawn: in order, one at a time, on the drawing
  /// threads.
  using Done = std::function<void(int frame, const FrameState& state)>;
  /// Must be called with all frames in order, drawn or not, since paths accumulate. Returns when it
  /// is ready for the next. throws: MachineError of this frame or an earlier one.
  void take(int frame, FrameState state, const Done& done);
  /// Waits until all frames are drawn and delivered.
  void wait();
  /// Waits for the files and makes the films.
  void finish();

 private:
  struct View {
    RecordingCamera camera;
    PictureSettings settings;
    std::unique_ptr<Recorder> recorder;
  };
  /// Data of one drawing thread.
  struct Desk {
    OverlaySender overlays;
    Glyphs words;
    std::optional<DistanceDrawing> distances;
    std::optional<DisplacementDrawing> displacement;
  };
  /// A frame with its overlays.
  struct Shot {
    SceneRenderer& renderer;
    Desk& desk;
    const FrameState& state;
    const Overlays& overlays;
  };
  void prepare(SceneRenderer& renderer, Desk& desk) const;
  /// With key and legend; returns the space that they leave for the notes.
  Image picture(const View& view, const Camera& camera, const Shot& shot, Annotations& notes) const;
  Image before_after(const View& view, const Camera& camera, const Shot& shot) const;
  Image drawn(const PictureSettings& settings, const Camera& camera, const Shot& shot,
              bool with_map) const;
  Image finished(const View& view, int frame, const Shot& shot) const;
  /// Whether any camera still needs the frame.
  bool is_drawn(int frame) const;
  /// Overlays of the window or of the command, with a key to all of them.
  Overlays overlays_of(const FrameState& state, bool with_paths) const;
  Overlays chosen_overlays(const FrameState& state, bool with_paths) const;

  const RecordingSubject subject_;
  PicturePlan plan_;
  FrameState rest_;  // left of a wipe
  MotionPaths paths_;
  std::optional<MuscleBellies> muscles_;  // if they are drawn
  std::vector<View> views_;
  int kept_ = 0;
  std::deque<Desk> desks_;
  std::optional<ParallelRenderers> drawers_;  // destroyed first
};

}  // namespace condyle
