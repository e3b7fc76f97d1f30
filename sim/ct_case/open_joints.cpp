#include "sim/ct_case/open_joints.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "engine/mesh/triangle_tree.h"
#include "sim/motion/joint_surfaces.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double near_condyle_mm = 20;  // vertices that may move
constexpr double margin_step_mm = 0.05;
constexpr int rounds = 10;

using Shifts = std::vector<std::pair<int, Vector3d>>;  // of vertices

/// Half the way to `margin_mm` from the other surface for vertices near the condyle.
Shifts shifts_from(const TriMesh& mesh, const TriangleTree& other, const Vector3d& condyle,
                   double margin_mm) {
  Shifts shifts;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vector3d& p = mesh.vertices[v];
    if ((p - condyle).squaredNorm() > near_condyle_mm * near_condyle_mm) continue;
    const SurfacePoint found = other.signed_nearest(p, near_condyle_mm);
    if (found.triangle < 0 || found.distance >= margin_mm) continue;
    shifts.emplace_back(static_cast<int>(v),
                        0.5 * (margin_mm - found.distance) * other.pseudonormal(found));
  }
  return shifts;
}

void apply(const Shifts& shifts, TriMesh& mesh, std::vector<Vector3d>& total) {
  for (const auto& [v, shift] : shifts) {
    mesh.vertices[static_cast<std::size_t>(v)] += shift;
    total[static_cast<std::size_t>(v)] += shift;
  }
}

Part* part_of(Case& patient, Role role) {
  const auto found = std::find_if(patient.parts.begin(), patient.parts.end(),
                                  [&](const Part& part) { return part.role == role; });
  return found == patient.parts.end() ? nullptr : &*found;
}

}  // namespace

double open_joints(Case& patient) {
  Part *const skull = part_of(patient, Role::skull), *const jaw = part_of(patient, Role::mandible);
  if (!skull || !jaw) return 0;
  const auto left = patient.landmarks.find("left_condyle"),
             right = patient.landmarks.find("right_condyle");
  if (!left || !right) return 0;
  std::vector<Vector3d> skull_total(skull->mesh.vertices.size(), Vector3d::Zero()),
      jaw_total(jaw->mesh.vertices.size(), Vector3d::Zero());
  for (int round = 1; round <= rounds && !JointSurfaces::find(patient); ++round) {
    const TriangleTree skull_tree(skull->mesh), jaw_tree(jaw->mesh);
    bool touches = false;
    for (const Vector3d& condyle : {*left, *right}) {
      const double margin_mm = round * margin_step_mm;
      const Shifts of_jaw = shifts_from(jaw->mesh, skull_tree, condyle, margin_mm),
                   of_skull = shifts_from(skull->mesh, jaw_tree, condyle, margin_mm);
      touches |= !of_jaw.empty() || !of_skull.empty();
      apply(of_jaw, jaw->mesh, jaw_total);
      apply(of_skull, skull->mesh, skull_total);
    }
    if (!touches) break;
  }
  double most = 0;
  for (const auto* total : {&skull_total, &jaw_total})
    for (const Vector3d& shift : *total) most = std::max(most, shift.norm());
  return most;
}

}  // namespace condyle
