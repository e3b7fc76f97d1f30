#include "sim/motion/bite_guide.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "sim/motion/condylar_kinematics.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double contact_mm = 0.01;
constexpr double closed_limit = -20 * degree, open_limit = 25 * degree;
constexpr double same_bite_mm = 0.4;  // teeth closer than this are in their bite
constexpr double fade_mm = 3;
constexpr double default_table_deg = 20;

/// Triangles of a body's bones and teeth (or of its teeth alone) with a vertex that `selects`
/// accepts.
TriMesh gathered(const Case& patient, BodyId body, bool teeth_alone,
                 const std::function<bool(const Vector3d&)>& selects) {
  TriMesh out;
  for (const auto& part : patient.parts) {
    if (!collides(part.role) || part.body != body) continue;
    if (teeth_alone && !is_teeth(part.role)) continue;
    std::vector<int> index(part.mesh.vertices.size(), -1);
    for (const auto& t : part.mesh.triangles) {
      const auto& v = part.mesh.vertices;
      if (!selects(v[t[0]]) && !selects(v[t[1]]) && !selects(v[t[2]])) continue;
      Eigen::Vector3i copy;
      for (int k = 0; k < 3; ++k) {
        int& copied = index[t[k]];
        if (copied < 0) {
          copied = static_cast<int>(out.vertices.size());
          out.vertices.push_back(v[t[k]]);
        }
        copy[k] = copied;
      }
      out.triangles.push_back(copy);
    }
  }
  return out;
}

bool has_teeth(const Case& patient) { return patient.has_both_arches(); }

struct OccludingSurfaces {
  TriMesh upper, lower;
};

/// The teeth. Where they are no parts of their own, the surfaces in front of the rami within 20 mm
/// of the height of the incisal points.
OccludingSurfaces occluding_surfaces(const Case& patient, const Vector3d& hinge,
                                     const Vector3d& incisor) {
  const Vector3d upper_incisor = patient.landmarks.find("upper_incisal_point").value_or(incisor);
  const double behind = hinge.y() + 0.4 * (incisor.y() - hinge.y());
  constexpr double beside_mm = 20;
  return {gathered(patient, patient.jaw.upper_arch, has_teeth(patient),
                   [&](const Vector3d& p) {
                     return p.y() < behind && p.z() < upper_incisor.z() + beside_mm;
                   }),
          gathered(patient, patient.jaw.lower_arch, has_teeth(patient), [&](const Vector3d& p) {
            return p.y() < behind && p.z() > incisor.z() - beside_mm;
          })};
}

}  // namespace

double teeth_apart_at_rest_mm(const Case& patient) {
  const auto left = patient.landmarks.find("left_condyle");
  const auto right = patient.landmarks.find("right_condyle");
  const auto incisor = patient.landmarks.find("lower_incisal_point");
  const bool has_crowns = has_teeth(patient) || patient.landmarks.find("upper_incisal_point");
  if (!left || !right || !incisor || !has_crowns) return 0;
  const auto teeth = occluding_surfaces(patient, 0.5 * (*left + *right), *incisor);
  if (teeth.upper.empty() || teeth.lower.empty()) return 0;
  TrianglePair start;
  const auto cache = box_tree_folder(patient);
  return distance(CollisionMesh(teeth.upper, cache), {}, CollisionMesh(teeth.lower, cache), {},
                  start)
      .distance_mm;
}

BiteGuide::BiteGuide(const Case& patient, const JawJoints& joints,
                     const MotionParameters& parameters)
    : joints_(joints) {
  const Vector3d hinge = 0.5 * (joints.condyle(JawSide::left) + joints.condyle(JawSide::right));
  const auto [upper, lower] = occluding_surfaces(patient, hinge, joints.incisor());
  if (parameters.incisal_guidance_deg || lower.empty() || upper.empty() || !has_teeth(patient))
    table_slope_ = std::tan(parameters.incisal_guidance_deg.value_or(default_table_deg) * degree);
  bite_theta_ = joints.closed_theta();
  if (lower.empty() || upper.empty()) {
    known_[{0, 0, 0}] = bite_theta_;
    notes_ = "without teeth, an incisal table guides protrusion and laterotrusion";
    return;
  }
  const auto cache = box_tree_folder(patient);
  lower_.emplace(lower, cache);
  upper_.emplace(upper, cache);
  for (const auto& v : lower.vertices)
    lever_mm_ = std::max(lever_mm_, std::hypot(v.y() - hinge.y(), v.z() - hinge.z()));
  lever_mm_ *= 1.1;  // allowance for the inferior translation of the condyles
  const double at_rest = contact_theta({});
  TrianglePair start;
  const double apart = distance(*upper_, {}, *lower_, {}, start).distance_mm;
  if (patient.scan_opening_mm) {
    baseline_ = at_rest - bite_theta_;
    notes_ = fmt::format(
        "scan_opening_mm declares the patient scanned {:.1f} mm open: the jaw is closed at {:.1f} "
        "deg, from where openings and rotations count",
        *patient.scan_opening_mm, bite_theta_ / degree);
  } else if (at_rest <= closed_limit) {
    notes_ =
        "the teeth of the case do not meet when the jaw closes: its rest pose is taken as the bite";
  } else if (apart > same_bite_mm) {
    bite_theta_ = at_rest;
    notes_ = fmt::format(
        "the teeth of the case are {:.1f} mm apart at rest; they meet when the jaw closes by "
        "{:.1f} deg{}",
        apart, -at_rest / degree,
        joints.closed_theta() == 0
            ? ""
            : ", the closed position, from where openings and rotations count");
  } else {
    baseline_ = at_rest;
    if (at_rest > 0.1 * degree)
      notes_ = fmt::format(
          "crowns overlap at rest and separate at {:.1f} deg of opening; guidance takes the rest "
          "pose "
          "as closed",
          at_rest / degree);
  }
  known_[{0, 0, 0}] = bite_theta_;
}

/// Closes from an open pose in steps that the distance allows, until the surfaces touch.
double BiteGuide::contact_theta(const JawInputs& at) {
  constexpr double raise = 2 * degree;
  JawInputs in = at;
  const auto apart = [&](double theta) {
    in.theta = theta;
    const MeshDistance now = distance(*upper_, {}, *lower_, joints_.pose(in), near_);
    near_ = now.triangles;
    return now.distance_mm;
  };
  double theta = std::clamp(last_ + 0.5 * raise, 0.0, open_limit);
  double gap = apart(theta);
  while (gap <= contact_mm && theta < open_limit) gap = apart(theta += raise);
  for (int i = 0; i < 200 && gap > contact_mm && theta > closed_limit; ++i)
    gap = apart(theta -= std::max(gap / lever_mm_, 1e-5));
  last_ = theta;
  return std::max(theta, closed_limit);
}

/// Rotation at which the incisal point is on the table, which it lowers by the table's slope times
/// its forward or lateral displacement.
double BiteGuide::table_theta(const JawInputs& at) const {
  JawInputs in = at;
  double low = closed_limit, high = open_limit;
  for (int i = 0; i < 50; ++i) {
    in.theta = 0.5 * (low + high);
    const Vector3d d = joints_.incisor(in) - joints_.incisor();
    const double aside = std::hypot(d.x(), std::max(0.0, -d.y()));
    (-d.z() < *table_slope_ * aside ? low : high) = in.theta;
  }
  return high;
}

double BiteGuide::theta(const JawInputs& at) {
  const auto rounded = [](double value) { return std::lround(value * 1e5); };
  const std::tuple key{rounded(at.left_mm), rounded(at.right_mm), rounded(at.shift_mm)};
  if (const auto found = known_.find(key); found != known_.end()) return found->second;
  double least = closed_limit;
  if (lower_) {
    const double displacement =
        std::max({std::abs(at.left_mm), std::abs(at.right_mm), std::abs(at.shift_mm)});
    const double u = std::clamp(displacement / fade_mm, 0.0, 1.0);
    // The overlap of the crowns at rest does not apply where other teeth meet.
    least = contact_theta(at) - baseline_ * (1 - u * u * (3 - 2 * u));
  }
  if (table_slope_ && bite_theta_ == 0) least = std::max(least, table_theta(at));
  return known_[key] = least;
}

}  // namespace condyle
