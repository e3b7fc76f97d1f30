#include "sim/motion/joint_surfaces.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "engine/core/user_cache.h"
#include "engine/mesh/shape_key.h"

namespace condyle {
namespace {

constexpr double condyle_radius_mm = 15;  // part of the mandible about the landmark
constexpr double fossa_radius_mm = 45;    // part of the cranium; the condyle travels about 20 mm
constexpr double largest_gap_mm = 6;      // a surface farther away is not a fossa
constexpr double min_gap_mm = 0.02;       // a closer surface counts as touching

/// Appends the triangles of `mesh` that have a corner within `radius` of `center`.
void append_near(const TriMesh& mesh, const Eigen::Vector3d& center, double radius, TriMesh& out) {
  std::vector<int> index(mesh.vertices.size(), -1);
  for (const auto& t : mesh.triangles) {
    const auto close = [&](int v) {
      return (mesh.vertices[v] - center).squaredNorm() <= radius * radius;
    };
    if (!close(t[0]) && !close(t[1]) && !close(t[2])) continue;
    Eigen::Vector3i copy;
    for (int k = 0; k < 3; ++k) {
      int& v = index[t[k]];
      if (v < 0) {
        v = static_cast<int>(out.vertices.size());
        out.vertices.push_back(mesh.vertices[t[k]]);
      }
      copy[k] = v;
    }
    out.triangles.push_back(copy);
  }
}

}  // namespace

std::filesystem::path box_tree_folder(const Case& patient) {
  const bool divided = std::any_of(patient.parts.begin(), patient.parts.end(),
                                   [](const Part& part) { return is_piece(part.role); });
  return divided ? std::filesystem::path() : user_cache_folder();
}

std::optional<JointSurfaces> JointSurfaces::find(const Case& patient) {
  JointSurfaces joint;
  for (const auto& [name, body] : {std::pair{"left_condyle", patient.jaw.left_condyle},
                                   std::pair{"right_condyle", patient.jaw.right_condyle}}) {
    const auto center = patient.landmarks.find(name);
    if (!center) return std::nullopt;
    TriMesh condyle, fossa;
    for (const auto& part : patient.parts) {
      if (!collides(part.role) || is_teeth(part.role)) continue;
      if (part.body == body) append_near(part.mesh, *center, condyle_radius_mm, condyle);
      if (part.body == cranium_body) append_near(part.mesh, *center, fossa_radius_mm, fossa);
    }
    if (condyle.empty() || fossa.empty()) return std::nullopt;
    const auto cache = box_tree_folder(patient);
    Side side{CollisionMesh(condyle, cache), CollisionMesh(fossa, cache), 0, 0, {}};
    side.hash = shape_key(fossa, shape_key(condyle));
    const MeshDistance rest = distance(side.fossa, {}, side.condyle, {});
    if (rest.distance_mm < min_gap_mm || rest.distance_mm > largest_gap_mm) return std::nullopt;
    side.rest_gap_mm = rest.distance_mm;
    side.last = rest.triangles;
    joint.sides_.push_back(std::move(side));
  }
  return joint;
}

double JointSurfaces::rest_gap_mm() const {
  return std::min(sides_[0].rest_gap_mm, sides_[1].rest_gap_mm);
}

double JointSurfaces::slack_mm(const Pose& X_CM) {
  double least = std::numeric_limits<double>::infinity();
  for (auto& side : sides_) {
    const MeshDistance now = distance(side.fossa, {}, side.condyle, X_CM, side.last);
    side.last = now.triangles;
    least = std::min(least, now.distance_mm - side.rest_gap_mm);
  }
  return least;
}

double JointSurfaces::gap_mm(JawSide side, const Pose& X_CM, TrianglePair& start) const {
  const Side& joint = at(side);
  const MeshDistance now = distance(joint.fossa, {}, joint.condyle, X_CM, start);
  start = now.triangles;
  return now.distance_mm;
}

bool JointSurfaces::nearer_than(double limit_mm, JawSide side, const Pose& X_CM) const {
  const Side& joint = at(side);
  return distance_within(limit_mm, joint.fossa, {}, joint.condyle, X_CM).has_value();
}

}  // namespace condyle
