#include "engine/cut/cap_rims.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "engine/cut/fill_loops.h"
#include "engine/cut/region.h"
#include "engine/mesh/rims.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

struct MeasuredRim {
  std::vector<int> vertices;
  double length_mm = 0;
};

/// The plane through a rim that best spans it; its normal points out of the cap.
Plane plane_of(const TriMesh& mesh, const std::vector<int>& rim) {
  Vector3d middle = Vector3d::Zero(), area = Vector3d::Zero();
  for (const int v : rim) middle += mesh.vertices[v] / static_cast<double>(rim.size());
  for (std::size_t i = 0; i < rim.size(); ++i)
    area +=
        (mesh.vertices[rim[i]] - middle).cross(mesh.vertices[rim[(i + 1) % rim.size()]] - middle);
  return area.norm() > 0 ? plane_through(middle, area) : Plane{Vector3d::Zero(), 0};
}

bool lies_in(const TriMesh& mesh, const std::vector<int>& rim, const Plane& plane, double off_mm) {
  return plane.normal.squaredNorm() > 0 && std::all_of(rim.begin(), rim.end(), [&](int v) {
           return std::abs(plane.distance(mesh.vertices[v])) <= off_mm;
         });
}

void append_cap(TriMesh& mesh, const std::vector<MeasuredRim>& rims, const Plane& plane) {
  const Vector3d right = plane.normal.unitOrthogonal(), up = plane.normal.cross(right);
  std::vector<Eigen::Vector2d> points;
  std::vector<int> vertices;
  std::vector<std::vector<int>> loops;
  for (const MeasuredRim& rim : rims) {
    loops.emplace_back();
    for (const int v : rim.vertices) {
      loops.back().push_back(static_cast<int>(points.size()));
      points.push_back({right.dot(mesh.vertices[v]), up.dot(mesh.vertices[v])});
      vertices.push_back(v);
    }
  }
  for (const auto& t : fill_loops(points, loops).triangles) {
    const Eigen::Vector3i cap(vertices[t[0]], vertices[t[1]], vertices[t[2]]);
    if (cap[0] != cap[1] && cap[1] != cap[2] && cap[2] != cap[0]) mesh.triangles.push_back(cap);
  }
}

}  // namespace

CappedRims cap_flat_rims(TriMesh& mesh, const FlatRim& flat) {
  std::vector<MeasuredRim> open;
  for (auto& rim : rims_of(mesh)) {
    MeasuredRim measured{std::move(rim)};
    const auto& v = measured.vertices;
    for (std::size_t i = 0; i < v.size(); ++i)
      measured.length_mm += (mesh.vertices[v[i]] - mesh.vertices[v[(i + 1) % v.size()]]).norm();
    open.push_back(std::move(measured));
  }
  std::stable_sort(open.begin(), open.end(), [](const MeasuredRim& a, const MeasuredRim& b) {
    return a.length_mm > b.length_mm;
  });
  CappedRims capped;
  while (!open.empty() && open.front().length_mm >= flat.least_mm) {
    const Plane plane = plane_of(mesh, open.front().vertices);
    if (!lies_in(mesh, open.front().vertices, plane, flat.off_plane_mm)) {
      open.erase(open.begin());
      continue;
    }
    capped.longest_rim_mm = std::max(capped.longest_rim_mm, open.front().length_mm);
    const auto others = std::stable_partition(open.begin(), open.end(), [&](const auto& rim) {
      return lies_in(mesh, rim.vertices, plane, flat.off_plane_mm);
    });
    const std::vector<MeasuredRim> group(open.begin(), others);
    open.erase(open.begin(), others);
    capped.rims += static_cast<int>(group.size());
    append_cap(mesh, group, plane);
  }
  return capped;
}

}  // namespace condyle
