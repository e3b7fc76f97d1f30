#include "sim/report/coronoid.h"

#include <cmath>

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

CoronoidClearance::CoronoidClearance(const Case& patient) {
  for (const std::string side : {"left", "right"}) {
    const auto tip = patient.landmarks.find(side + "_coronoid_tip");
    const auto condyle = patient.landmarks.find(side + "_condyle");
    const auto miss = [&](const std::string& what) {
      missing_ += (missing_.empty() ? "" : "; ") + side + ": " + what;
    };
    if (!tip || !condyle) {
      miss("the landmark " + side + (tip ? "_condyle" : "_coronoid_tip") + " is not given");
      continue;
    }
    const double outward = side == "left" ? 1 : -1;  // x runs to the left
    const double back = 0.5 * (tip->y() + condyle->y());
    TriMesh coronoid, zygoma;
    for (const auto& part : patient.parts) {
      if (part.role == Role::mandible)
        append(coronoid, triangles_where(part.mesh, [&](const Eigen::Vector3d& p) {
                 return (p - *tip).norm() < process_mm;
               }));
      if (part.role == Role::skull || part.role == Role::maxilla)
        append(zygoma, triangles_where(part.mesh, [&](const Eigen::Vector3d& p) {
                 return outward * (p.x() - tip->x()) > 0 && p.y() < back;
               }));
    }
    if (coronoid.empty() || zygoma.empty()) {
      miss(coronoid.empty() ? "no bone of the mandible lies at its coronoid tip"
                            : "the case has no zygomatic bone beside the coronoid process");
      continue;
    }
    sides_.push_back({side, {}, 0});
    surfaces_.push_back({CollisionMesh(coronoid), CollisionMesh(zygoma), {}});
  }
}

void CoronoidClearance::add(const Pose& X_CM) {
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    auto& [coronoid, zygoma, start] = surfaces_[i];
    const auto found = distance(zygoma, Pose{}, coronoid, X_CM, start);
    start = found.triangles;
    auto& side = sides_[i];
    side.mm.push_back(found.distance_mm);
    if (found.distance_mm < side.least_mm())
      side.least_frame = static_cast<int>(side.mm.size()) - 1;
  }
}

}  // namespace condyle
