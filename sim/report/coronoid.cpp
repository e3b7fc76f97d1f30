#include "sim/report/coronoid.h"

#include <algorithm>
#include <cmath>

#include "sim/contact/anatomical_regions.h"

namespace condyle {
namespace {

constexpr double process_mm = 8;  // from the tip

TriMesh triangles_where(const TriMesh& mesh, const auto& selects) {
  TriMesh kept{mesh.vertices, {}, {}};
  for (const auto& t : mesh.triangles)
    if (selects((mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3))
      kept.triangles.push_back(t);
  return kept;
}

void append(TriMesh& mesh, const TriMesh& other) {
  const int first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& t : other.triangles)
    mesh.triangles.push_back(t + Eigen::Vector3i::Constant(first));
}

}  // namespace

int CoronoidSide::min_frame() const {
  return static_cast<int>(std::min_element(mm.begin(), mm.end()) - mm.begin());
}

CoronoidClearance::CoronoidClearance(const Case& patient) {
  for (const std::string side : {"left", "right"}) {
    const auto found = coronoid_tip(patient, side);
    const auto condyle = patient.landmarks.find(side + "_condyle");
    const auto miss = [&](const std::string& what) {
      missing_ += (missing_.empty() ? "" : "; ") + side + ": " + what;
    };
    if (!found || !condyle) {
      miss(found || !condyle ? "the landmark " + side + "_condyle is missing"
                             : "the landmark " + side +
                                   "_coronoid_tip is missing and no coronoid process was found "
                                   "on the mandible");
      continue;
    }
    const Eigen::Vector3d& tip = found->point;
    const double outward = side == "left" ? 1 : -1;  // x runs to the left
    const double back = 0.5 * (tip.y() + condyle->y());
    const BodyId body = side == "left" ? patient.jaw.left_condyle : patient.jaw.right_condyle;
    TriMesh coronoid, zygoma;
    for (const auto& part : patient.parts) {
      if (!collides(part.role) || is_teeth(part.role)) continue;
      if (part.body == body)
        append(coronoid, triangles_where(part.mesh, [&](const Eigen::Vector3d& p) {
                 return (p - tip).norm() < process_mm;
               }));
      if (part.body == cranium_body)
        append(zygoma, triangles_where(part.mesh, [&](const Eigen::Vector3d& p) {
                 return outward * (p.x() - tip.x()) > 0 && p.y() < back;
               }));
    }
    if (coronoid.empty() || zygoma.empty()) {
      miss(coronoid.empty() ? "there is no mandibular bone at the coronoid tip"
                            : "the case has no zygomatic bone lateral of the coronoid process");
      continue;
    }
    sides_.push_back({side, found->estimated, tip, {}});
    surfaces_.push_back({CollisionMesh(coronoid), CollisionMesh(zygoma), body});
  }
}

double CoronoidClearance::distance_mm(std::size_t side, const BodyPoses& at,
                                      TrianglePair& start) const {
  const auto& [coronoid, zygoma, body] = surfaces_[side];
  const auto found = distance(zygoma, Pose{}, coronoid, at[body], start);
  start = found.triangles;
  return found.distance_mm;
}

}  // namespace condyle
