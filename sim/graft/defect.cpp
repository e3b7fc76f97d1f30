#include "sim/graft/defect.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "engine/core/error.h"
#include "sim/graft/section.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Triangles of one plane.
struct PlaneFaces {
  Vector3d normal;
  double offset = 0;
  int step = 0;
  double area = 0;
  Vector3d moment = Vector3d::Zero();
};

std::vector<PlaneFaces> plane_faces(const TriMesh& bone, const std::vector<int>& made_by) {
  constexpr double same_cosine = 0.9998, same_plane_mm = 0.05, least_area = 1e-9;
  std::vector<PlaneFaces> faces;
  for (std::size_t t = 0; t < bone.triangles.size(); ++t) {
    if (made_by[t] <= 0) continue;
    const auto& corner = bone.triangles[t];
    const Vector3d a = bone.vertices[corner[0]], b = bone.vertices[corner[1]],
                   c = bone.vertices[corner[2]];
    const Vector3d twice = (b - a).cross(c - a);
    if (twice.norm() < least_area) continue;
    const Vector3d normal = twice.normalized();
    auto at = std::find_if(faces.begin(), faces.end(), [&](const PlaneFaces& face) {
      return face.step == made_by[t] && face.normal.dot(normal) > same_cosine &&
             std::abs(face.normal.dot(a) - face.offset) < same_plane_mm;
    });
    if (at == faces.end())
      at = faces.insert(at,
                        PlaneFaces{.normal = normal, .offset = normal.dot(a), .step = made_by[t]});
    at->area += 0.5 * twice.norm();
    at->moment += 0.5 * twice.norm() * (a + b + c) / 3;
  }
  std::stable_sort(faces.begin(), faces.end(),
                   [](const auto& a, const auto& b) { return a.area > b.area; });
  return faces;
}

/// A path from the first face to the second whose direction turns evenly.
struct DefectPath {
  Vector3d from, to, start, end;  // ends and their directions
  double length;
  Vector3d point(double u) const {
    const double v = 1 - u;
    return (1 + 2 * u) * v * v * from + u * v * v * length * start + u * u * (3 - 2 * u) * to -
           u * u * v * length * end;
  }
  /// Turns evenly; between faces that look almost the same way, that of the path itself.
  Vector3d direction(double u) const {
    constexpr double least = 0.3, step = 0.01;
    const Vector3d even = (1 - u) * start + u * end;
    return even.norm() > least ? even.normalized()
                               : (point(u + step) - point(u - step)).normalized();
  }
};

/// Of a section's lines those that are connected with the one nearest to a point: a plane through
/// one limb of the jaw may meet the other.
std::vector<SectionLine> nearest_outline(const std::vector<SectionLine>& lines,
                                         const Vector3d& point) {
  constexpr double same_mm = 1e-4;
  const auto key = [](const Vector3d& p) {
    return std::array{std::llround(p.x() / same_mm), std::llround(p.y() / same_mm),
                      std::llround(p.z() / same_mm)};
  };
  std::map<std::array<long long, 3>, std::vector<std::size_t>> at;
  std::size_t nearest = 0;
  double least = 1e9;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (const Vector3d& p : lines[i]) at[key(p)].push_back(i);
    const double distance = (0.5 * (lines[i][0] + lines[i][1]) - point).norm();
    if (distance < least) {
      least = distance;
      nearest = i;
    }
  }
  std::vector<SectionLine> outline;
  std::vector<char> taken(lines.size(), 0);
  std::vector<std::size_t> open;
  if (!lines.empty()) {
    open = {nearest};
    taken[nearest] = 1;
  }
  while (!open.empty()) {
    const std::size_t i = open.back();
    open.pop_back();
    outline.push_back(lines[i]);
    for (const Vector3d& p : lines[i])
      for (const std::size_t next : at[key(p)])
        if (!std::exchange(taken[next], 1)) open.push_back(next);
  }
  return outline;
}

/// The point above the lower border of a section, in the middle of its width there; absent where
/// the plane misses the bone.
std::optional<Vector3d> point_in_section(const std::vector<SectionLine>& lines,
                                         const Vector3d& across, const Vector3d& up,
                                         double height_mm) {
  if (lines.empty()) return std::nullopt;
  double low = 1e9, high = -1e9;
  for (const auto& line : lines)
    for (const Vector3d& p : line) {
      low = std::min(low, up.dot(p));
      high = std::max(high, up.dot(p));
    }
  const double level = std::min(low + height_mm, 0.5 * (low + high));
  double left = 1e9, right = -1e9;
  Vector3d there = Vector3d::Zero();
  for (const auto& [a, b] : lines) {
    const double za = up.dot(a) - level, zb = up.dot(b) - level;
    if ((za > 0) == (zb > 0)) continue;
    const Vector3d p = a + (b - a) * (za / (za - zb));
    left = std::min(left, across.dot(p));
    right = std::max(right, across.dot(p));
    there = p;
  }
  if (left > right) return std::nullopt;
  return there + (0.5 * (left + right) - across.dot(there)) * across +
         (low + height_mm - level) * up;
}

}  // namespace

Defect find_defect(const TriMesh& resected, const std::vector<int>& made_by,
                   const std::function<double(int step)>& kerf_mm, const Vector3d& up,
                   const Vector3d& jaw_middle) {
  const auto faces = plane_faces(resected, made_by);
  constexpr double least_mm2 = 20;
  if (faces.size() < 2 || faces[1].area < least_mm2)
    throw InputError(
        fmt::format("the resected segment has {} plane cut face{}; a graft needs two "
                    "between which it lies",
                    faces.empty() ? "no" : "only one", faces.empty() ? "s" : ""));
  Defect defect;
  defect.up = up.normalized();
  for (const int i : {0, 1}) {
    const PlaneFaces& face = faces[i];
    const double kerf = kerf_mm(face.step);
    defect.faces[i] = {face.moment / face.area + kerf * face.normal, -face.normal, face.area, kerf};
  }
  const Vector3d along = defect.faces[1].point - defect.faces[0].point,
                 middle = 0.5 * (defect.faces[0].point + defect.faces[1].point);
  if (defect.up.cross(along).dot(middle - jaw_middle) < 0)
    std::swap(defect.faces[0], defect.faces[1]);
  return defect;
}

std::vector<Vector3d> border_curve(const TriMesh& resected, const Defect& defect,
                                   double height_mm) {
  constexpr int stations = 48, passes = 4;
  constexpr double inside = 0.004;  // the ends themselves lie in cut faces
  const DefectFace &first = defect.faces[0], &second = defect.faces[1];
  const auto in_segment = [](const DefectFace& face) {
    return Vector3d(face.point + face.kerf_mm * face.normal);
  };
  const DefectPath path{in_segment(first), in_segment(second), first.normal, -second.normal,
                        (second.point - first.point).norm()};
  std::vector<Vector3d> curve;
  for (int i = 0; i <= stations; ++i) {
    const double u = inside + (1 - 2 * inside) * i / stations;
    const Vector3d m = path.direction(u);
    const Vector3d up = (defect.up - defect.up.dot(m) * m).normalized();
    const auto lines =
        nearest_outline(plane_section(resected, plane_through(path.point(u), m)), path.point(u));
    if (const auto p = point_in_section(lines, m.cross(up), up, height_mm)) curve.push_back(*p);
  }
  if (curve.size() < 2)
    throw InputError("the lower border of the resected segment cannot be followed; give a curve");
  for (int pass = 0; pass < passes; ++pass) {
    const auto rough = curve;
    for (std::size_t i = 1; i + 1 < curve.size(); ++i)
      curve[i] = 0.25 * rough[i - 1] + 0.5 * rough[i] + 0.25 * rough[i + 1];
  }
  return curve_between(curve, defect);
}

std::vector<Vector3d> curve_between(std::vector<Vector3d> curve, const Defect& defect) {
  const DefectFace &first = defect.faces[0], &second = defect.faces[1];
  if ((curve.front() - first.point).norm() + (curve.back() - second.point).norm() >
      (curve.back() - first.point).norm() + (curve.front() - second.point).norm())
    std::reverse(curve.begin(), curve.end());
  const auto end_in = [&](const DefectFace& face, const char* which) {
    const auto depth = [&](const Vector3d& p) { return face.normal.dot(p - face.point); };
    // Points behind the face are dropped; the first line is cut or extended to it.
    while (curve.size() > 2 && depth(curve[1]) < 0) curve.erase(curve.begin());
    const double a = depth(curve[0]), b = depth(curve[1]);
    if (constexpr double at_face_mm = 1; std::abs(a) < at_face_mm) {
      curve[0] -= a * face.normal;
      return;
    }
    constexpr double least_slope = 0.2;
    if (!(b - a > least_slope * (curve[1] - curve[0]).norm()))
      throw InputError(
          fmt::format("the curve runs beside the {} face of the defect, not into it", which));
    curve[0] += (curve[1] - curve[0]) * (-a / (b - a));
  };
  end_in(first, "first");
  std::reverse(curve.begin(), curve.end());
  end_in(second, "second");
  std::reverse(curve.begin(), curve.end());
  return curve;
}

}  // namespace condyle
