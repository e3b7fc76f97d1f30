#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>

#include "engine/collide/collision_mesh.h"
#include "sim/motion/jaw_joints.h"

namespace condyle {

/// Distance between the teeth, or the surfaces in their place, in the rest pose of the case, mm; 0
/// also where they or the landmarks of the jaw are missing. Bones carry crowns where the
/// upper_incisal_point is marked.
double teeth_apart_at_rest_mm(const Case& patient);

/// Tooth guidance: for given condylar positions, the rotation at which the teeth (or the occluding
/// surfaces in their place) first touch as the jaw closes. Where the crowns overlap at rest, that
/// overlap is the baseline, faded out over the first 3 mm. An incisal table, if present, also
/// limits closing.
class BiteGuide {
 public:
  BiteGuide(const Case& patient, const JawJoints& joints, const MotionParameters& parameters);

  /// Minimum rotation, rad, for the condylar positions and shift of `at`. Caches results; not
  /// thread-safe.
  double theta(const JawInputs& at);

  /// Rotation from the rest pose of the case to its bite, rad; 0 where the case is in its bite.
  double bite_theta() const { return bite_theta_; }

  /// Whether teeth, or surfaces in their place, guide, rather than the table alone.
  bool on_teeth() const { return lower_.has_value(); }
  /// Description of the guidance.
  const std::string& notes() const { return notes_; }

 private:
  double contact_theta(const JawInputs& at);
  double table_theta(const JawInputs& at) const;

  const JawJoints& joints_;
  std::optional<CollisionMesh> upper_, lower_;
  double lever_mm_ = 0;  // largest distance of the lower surface from the intercondylar axis
  double baseline_ = 0, bite_theta_ = 0;
  std::optional<double> table_slope_;
  TrianglePair near_;
  double last_ = 0;
  std::map<std::tuple<long, long, long>, double> known_;
  std::string notes_;
};

}  // namespace condyle
