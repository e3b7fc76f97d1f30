#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>

#include "engine/collide/collision_mesh.h"
#include "sim/motion/jaw_joints.h"

namespace condyle {

/// How far the teeth (or what bites in their place) let the jaw close while its condyles are
/// anywhere: the rotation at which the first of them touch when the jaw closes from above. Where
/// the case's crowns overlap at rest, that overlap is the baseline, given up over the first 3 mm.
/// An incisal table, where there is one, stops the closing jaw too.
class BiteGuide {
 public:
  BiteGuide(const Case& patient, const JawJoints& joints, const MotionParameters& parameters);

  /// Least rotation, rad, with the condyles and shift of `at`. Remembers what it was asked; not for
  /// several threads at once.
  double theta(const JawInputs& at);

  /// Rotation that closes the case's own pose into its bite: 0 where the case is in its bite.
  double bite_theta() const { return bite_theta_; }

  /// Teeth, or surfaces in their place, guide; not the table alone.
  bool on_teeth() const { return lower_.has_value(); }
  /// What guides, for people.
  const std::string& notes() const { return notes_; }

 private:
  double touch_theta(const JawInputs& at);
  double table_theta(const JawInputs& at) const;

  const JawJoints& joints_;
  std::optional<CollisionMesh> upper_, lower_;
  double lever_mm_ = 0;  // farthest of the lower surface from the condyles' line
  double baseline_ = 0, bite_theta_ = 0;
  std::optional<double> table_slope_;
  TrianglePair near_;
  double last_ = 0;
  std::map<std::tuple<long, long, long>, double> known_;
  std::string notes_;
};

}  // namespace condyle
