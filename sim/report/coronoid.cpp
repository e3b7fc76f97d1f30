#include "sim/report/coronoid.h"

#include <algorithm>
#include <cmath>

#include "sim/contact/places.h"

namespace condyle {
namespace {

constexpr double process_mm = 8;  // from the tip

TriMesh triangles_where(const TriMesh& mesh, const auto& wanted) {
  TriMesh kept{mesh.vertices, {}, {}};
  for (const auto& t : mesh.triangles)
    if (wanted((mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3))
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

int CoronoidSide::least_frame() const {
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
      miss(found || !condyle ? "the landmark " + side + "_condyle is not given"
                             : "the landmark " + side +
                                   "_coronoid_tip is not given and the mandible shows no such "
                                   "process");
      continue;
    }
    const Eigen::Vector3d& tip = found->point;
    const double outward = side == "left" ? 1 : -1;  // x runs to the left
    const double back = 0.5 * (tip.y() + condyle->y());
    TriMesh coronoid, zygoma;
    for (const auto& part : patient.parts) {
      if (part.role == Role::mandible)
        append(coronoid, triangles_where(part.mesh, [&](const Eigen::Vector3d& p) {
                 return (p - tip).norm() < process_mm;
               }));
      if (part.role == Role::skull || part.role == Role::maxilla)
        append(zygoma, triangles_where(part.mesh, [&](const Eigen::Vector3d& p) {
                 return outward * (p.x() - tip.x()) > 0 && p.y() < back;
               }));
    }
    if (coronoid.empty() || zygoma.empty()) {
      miss(coronoid.empty() ? "no bone of the mandible lies at its coronoid tip"
                            : "the case has no zygomatic bone beside the coronoid process");
      continue;
    }
    sides_.push_back({side, found->estimated, tip, {}});
    surfaces_.push_back({CollisionMesh(coronoid), CollisionMesh(zygoma)});
  }
}

double CoronoidClearance::distance_mm(std::size_t side, const Pose& X_CM,
                                      TrianglePair& start) const {
  const auto& [coronoid, zygoma] = surfaces_[side];
  const auto found = distance(zygoma, Pose{}, coronoid, X_CM, start);
  start = found.triangles;
  return found.distance_mm;
}

}  // namespace condyle
