#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/arch_view.h"
#include "render/camera_path.h"

namespace condyle {

/// "front,left,path.json" by commas. throws: as check_cameras.
std::vector<std::string> split_cameras(const std::string& list);

/// Those of a window, too. throws: InputError for the same name twice, for an unknown view, and for
/// a file that cannot be read.
void check_cameras(const std::vector<std::string>& cameras);

/// One camera of a recording as it was asked for.
class RecordingCamera {
 public:
  enum class Turning { no, once };
  /// `text`: a standard view, spin, an arch, or a JSON file with {view, target, direction, up,
  /// distance_mm, field_of_view_deg} or a list "path" of such with "at" from 0 to 1. [low, high]:
  /// the box to be seen.
  RecordingCamera(const std::string& text, std::span<const Part> parts, const Eigen::Vector3d& low,
                  const Eigen::Vector3d& high, double aspect);
  /// Of a window as it looks now; turning: once about the upright axis over the recording.
  RecordingCamera(const std::string& name, const Camera& camera, Turning turning,
                  const Eigen::Vector3d& upright);

  /// `share`: of the recording, 0 to 1.
  Camera at(double share, const FrameState& frame) const;

  /// Folder of its pictures where there are several cameras.
  const std::string& name() const { return name_; }
  /// Says all that decides its pictures.
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
