#include "sim/motion/bite_guide.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "sim/motion/condylar_path.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double touch_mm = 0.01;
constexpr double most_closed = -10 * radian_per_degree, most_open = 25 * radian_per_degree;
constexpr double same_bite_mm = 0.4;  // teeth this near are in their bite
constexpr double fade_mm = 3;
constexpr double usual_table_deg = 20;

/// Triangles of a body's bones and teeth (of its teeth alone) with a corner that `wanted` takes.
TriMesh gathered(const Case& patient, Body body, bool teeth_alone,
                 const std::function<bool(const Vector3d&)>& wanted) {
  TriMesh out;
  for (const auto& part : patient.parts) {
    if (!collides(part.role) || body_of(part.role) != body) continue;
    if (teeth_alone && !is_teeth(part.role)) continue;
    std::vector<int> index(part.mesh.vertices.size(), -1);
    for (const auto& t : part.mesh.triangles) {
      const auto& v = part.mesh.vertices;
      if (!wanted(v[t[0]]) && !wanted(v[t[1]]) && !wanted(v[t[2]])) continue;
      Eigen::Vector3i copy;
      for (int k = 0; k < 3; ++k) {
        int& place = index[t[k]];
        if (place < 0) {
          place = static_cast<int>(out.vertices.size());
          out.vertices.push_back(v[t[k]]);
        }
        copy[k] = place;
      }
      out.triangles.push_back(copy);
    }
  }
  return out;
}

bool has_teeth(const Case& patient) {
  return patient.find(Role::upper_teeth) && patient.find(Role::lower_teeth);
}

}  // namespace

BiteGuide::BiteGuide(const Case& patient, const JawJoints& joints,
                     const MotionParameters& parameters)
    : joints_(joints) {
  // Without teeth of their own, the biting surfaces lie in front of the rami, within some 20 mm of
  // the incisal points' height.
  const Vector3d hinge = 0.5 * (joints.condyle(JawSide::left) + joints.condyle(JawSide::right));
  const Vector3d& incisor = joints.incisor();
  const Vector3d upper_incisor = patient.landmarks.find("upper_incisal_point").value_or(incisor);
  const double behind = hinge.y() + 0.4 * (incisor.y() - hinge.y());
  constexpr double beside_mm = 20;
  const TriMesh lower = gathered(
      patient, Body::mandible, has_teeth(patient),
      [&](const Vector3d& p) { return p.y() < behind && p.z() > incisor.z() - beside_mm; });
  const TriMesh upper = gathered(
      patient, Body::cranium, has_teeth(patient),
      [&](const Vector3d& p) { return p.y() < behind && p.z() < upper_incisor.z() + beside_mm; });
  if (parameters.incisal_guidance_deg || lower.empty() || upper.empty() || !has_teeth(patient))
    table_slope_ =
        std::tan(parameters.incisal_guidance_deg.value_or(usual_table_deg) * radian_per_degree);
  if (lower.empty() || upper.empty()) {
    notes_ = "no teeth to guide: an incisal table guides protrusion and laterotrusion";
    return;
  }
  lower_.emplace(lower);
  upper_.emplace(upper);
  for (const auto& v : lower.vertices)
    lever_mm_ = std::max(lever_mm_, std::hypot(v.y() - hinge.y(), v.z() - hinge.z()));
  lever_mm_ *= 1.1;  // a path that falls adds to what the rotation does
  const double at_rest = touch_theta({});
  TrianglePair start;
  const double apart = distance(*upper_, {}, *lower_, {}, start).distance_mm;
  if (at_rest <= most_closed) {
    notes_ = "the case's teeth do not meet when the jaw closes: its pose at rest is its bite";
  } else if (apart > same_bite_mm) {
    bite_theta_ = at_rest;
    notes_ = fmt::format(
        "the case's teeth are {:.1f} mm apart at rest; they meet when the jaw closes by {:.1f} deg",
        apart, -at_rest / radian_per_degree);
  } else {
    baseline_ = at_rest;
    if (at_rest > 0.1 * radian_per_degree)
      notes_ = fmt::format(
          "crowns overlap at rest: free from {:.1f} deg of opening on; guidance takes the bite at "
          "rest for closed",
          at_rest / radian_per_degree);
  }
  known_[{0, 0, 0}] = bite_theta_;
}

/// Closes from where nothing touches, by what the distance allows, until something does.
double BiteGuide::touch_theta(const JawInputs& at) {
  constexpr double raise = 2 * radian_per_degree;
  JawInputs in = at;
  const auto apart = [&](double theta) {
    in.theta = theta;
    const MeshDistance now = distance(*upper_, {}, *lower_, joints_.pose(in), near_);
    near_ = now.triangles;
    return now.distance_mm;
  };
  double theta = std::clamp(last_ + 0.5 * raise, 0.0, most_open);
  double gap = apart(theta);
  while (gap <= touch_mm && theta < most_open) gap = apart(theta += raise);
  for (int i = 0; i < 200 && gap > touch_mm && theta > most_closed; ++i)
    gap = apart(theta -= std::max(gap / lever_mm_, 1e-5));
  last_ = theta;
  return std::max(theta, most_closed);
}

/// Rotation at which the incisal point stands on the table: it drops by the table's slope times its
/// way forward or aside.
double BiteGuide::table_theta(const JawInputs& at) const {
  JawInputs in = at;
  double low = most_closed, high = most_open;
  for (int i = 0; i < 50; ++i) {
    in.theta = 0.5 * (low + high);
    const Vector3d way = joints_.incisor(in) - joints_.incisor();
    const double aside = std::hypot(way.x(), std::max(0.0, -way.y()));
    (-way.z() < *table_slope_ * aside ? low : high) = in.theta;
  }
  return high;
}

double BiteGuide::theta(const JawInputs& at) {
  const auto rounded = [](double value) { return std::lround(value * 1e5); };
  const std::tuple key{rounded(at.left_mm), rounded(at.right_mm), rounded(at.shift_mm)};
  if (const auto found = known_.find(key); found != known_.end()) return found->second;
  double least = most_closed;
  if (lower_) {
    const double way =
        std::max({std::abs(at.left_mm), std::abs(at.right_mm), std::abs(at.shift_mm)});
    const double u = std::clamp(way / fade_mm, 0.0, 1.0);
    // What the crowns overlap by at rest is not kept up where others meet.
    least = touch_theta(at) - baseline_ * (1 - u * u * (3 - 2 * u));
  }
  if (table_slope_ && bite_theta_ == 0) least = std::max(least, table_theta(at));
  return known_[key] = least;
}

}  // namespace condyle
