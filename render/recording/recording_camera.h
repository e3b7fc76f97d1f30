#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/camera/arch_view.h"
#include "render/camera/camera_path.h"
#include "sim/case/case.h"

namespace condyle {

/// Splits "front,left,path.json" at commas. throws: as check_cameras.
std::vector<std::string> split_cameras(const std::string& list);

/// Includes those of a window. throws: InputError for a repeated name, an unknown view, and a file
/// that cannot be read.
void check_cameras(const std::vector<std::string>& cameras);

/// One camera of a recording, as specified.
class RecordingCamera {
 public:
  enum class Turning { no, once };
  /// `text`: a standard view, spin, an arch, or a JSON file with {view, target, direction, up,
  /// distance_mm, field_of_view_deg} or a list "path" of such with "at" from 0 to 1. [low, high]:
  /// the box to be in view.
  RecordingCamera(const std::string& text, const Case& patient, const Eigen::Vector3d& low,
                  const Eigen::Vector3d& high, double aspect);
  /// The current view of a window; turning: one turn about the upright axis over the recording.
  RecordingCamera(const std::string& name, const Camera& camera, Turning turning,
                  const Eigen::Vector3d& upright);

  /// `fraction`: of the recording, 0 to 1.
  Camera at(double fraction, const FrameState& frame) const;

  /// Folder of its pictures where there are several cameras.
  const std::string& name() const { return name_; }
  /// Describes everything that determines its pictures.
  std::string description() const;
  const ArchView* arch() const { return arch_ ? &*arch_ : nullptr; }

 private:
  std::string name_;
  Turning turning_ = Turning::no;
  Eigen::Vector3d upright_ = {0, 0, 1};
  CameraPath path_;
  std::optional<ArchView> arch_;
};

}  // namespace condyle
