#pragma once

#include <Eigen/Core>
#include <map>
#include <set>
#include <string>

#include "render/overlays.h"

namespace condyle {

class SceneRenderer;

/// Lines and sheets in space that are shown beside the parts, by name.
struct Overlays {
  std::map<std::string, LineSet> lines = {};
  std::map<std::string, GlassSheet> sheets = {};
};

/// The patient's directions left, back and up, as arrows from the middle of a box.
LineSet patient_axes(const Eigen::Vector3d& low, const Eigen::Vector3d& high);

/// Keeps the overlays of one renderer as they are wanted.
class OverlaySender {
 public:
  /// What was sent before and is not among these is taken away.
  void send(SceneRenderer& renderer, const Overlays& wanted);

 private:
  std::set<std::string> lines_, sheets_;
};

}  // namespace condyle
