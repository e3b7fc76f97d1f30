#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "render/displacement_drawing.h"
#include "render/gl_context.h"
#include "render/recorder.h"
#include "render/shown_overlays.h"
#include "sim/case/muscle.h"
#include "tools/camera_options.h"
#include "tools/distance_drawing.h"
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

/// Draws the frames of one recording, seen by one camera or several, and keeps them.
class PictureTaker {
 public:
  PictureTaker(const RecordOptions& options, const RecordingSubject& subject);

  /// Whether any camera still wants the frame.
  bool wanted(int frame) const;
  /// Pictures that were there already.
  int kept() const { return kept_; }

  /// All frames, in their order, are to be shown to it, wanted or not: paths grow with them.
  void take(int frame, FrameState& state);
  void finish();
  const std::string& driver() const { return context_.description(); }

 private:
  struct View {
    RecordingCamera camera;
    PictureSettings settings;
    std::unique_ptr<Recorder> recorder;
  };
  Image picture(const View& view, const Camera& camera, const FrameState& state);
  Image before_after(const View& view, const Camera& camera, const FrameState& state);
  Image drawn(const View& view, const Camera& camera, const FrameState& state, bool with_paths,
              bool with_map);
  Overlays overlays_of(const FrameState& state, bool with_paths) const;

  OffscreenContext context_;
  const RecordingSubject subject_;
  std::string caption_;
  PicturePlan plan_;
  SceneRenderer renderer_;
  FrameState rest_;  // for wipes
  MotionPaths paths_;
  std::vector<Muscle> muscles_;  // that are drawn
  OverlaySender overlays_;
  Lettering words_;
  std::optional<DistanceDrawing> distances_;
  std::optional<DisplacementDrawing> displacement_;
  std::vector<View> views_;
  int kept_ = 0;
};

}  // namespace condyle
