#include "sim/report/smile_measures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include "sim/tissue/body_weights.h"

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double lip_mm = 8;
constexpr int margin_samples = 121;
constexpr double highest_crown_mm = 16, gum_step_mm = 0.05;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Distance of each vertex from a chain along edges of the mesh, up to lip_mm; else infinite.
std::vector<double> distances_from(const std::vector<int>& chain, const TriMesh& mesh,
                                   const std::vector<std::vector<int>>& neighbours) {
  std::vector<double> distance(mesh.vertices.size(), infinity);
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const int vertex : chain) {
    distance[static_cast<std::size_t>(vertex)] = 0;
    queue.push({0, vertex});
  }
  while (!queue.empty()) {
    const auto [so_far, vertex] = queue.top();
    queue.pop();
    const auto v = static_cast<std::size_t>(vertex);
    if (so_far > distance[v]) continue;
    for (const int next : neighbours[v]) {
      const auto n = static_cast<std::size_t>(next);
      const double there = so_far + (mesh.vertices[n] - mesh.vertices[v]).norm();
      if (there >= distance[n] || there > lip_mm) continue;
      distance[n] = there;
      queue.push({there, next});
    }
  }
  return distance;
}

double between(const std::vector<double>& values, double fraction) {
  const double at = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), values.size() - 2);
  const double part = at - static_cast<double>(i);
  return values[i] + part * (values[i + 1] - values[i]);
}

/// Greatest `sign` z of the triangles at each x; where they have no point, as at the nearest that
/// has.
std::vector<double> envelope(const std::vector<Eigen::Vector3i>& triangles,
                             std::span<const Eigen::Vector3f> face, double low_x, double high_x,
                             double sign) {
  std::vector<double> height(margin_samples, -infinity);
  const double step = (high_x - low_x) / (margin_samples - 1);
  for (const Eigen::Vector3i& triangle : triangles)
    for (int k = 0; k < 3; ++k) {
      Vector3d a = face[static_cast<std::size_t>(triangle[k])].cast<double>(),
               b = face[static_cast<std::size_t>(triangle[(k + 1) % 3])].cast<double>();
      if (a.x() > b.x()) std::swap(a, b);
      if (!(b.x() > a.x())) continue;
      const int first = std::max(0, static_cast<int>(std::ceil((a.x() - low_x) / step))),
                last = std::min(margin_samples - 1,
                                static_cast<int>(std::floor((b.x() - low_x) / step)));
      for (int i = first; i <= last; ++i) {
        const double t = (low_x + i * step - a.x()) / (b.x() - a.x());
        double& highest = height[static_cast<std::size_t>(i)];
        highest = std::max(highest, sign * (a.z() + t * (b.z() - a.z())));
      }
    }
  std::vector<double> filled = height;
  for (int i = 0; i < margin_samples; ++i)
    for (int away = 0; away < margin_samples && !std::isfinite(filled[static_cast<std::size_t>(i)]);
         ++away)
      for (const int from : {i - away, i + away})
        if (from >= 0 && from < margin_samples &&
            std::isfinite(height[static_cast<std::size_t>(from)]))
          filled[static_cast<std::size_t>(i)] = height[static_cast<std::size_t>(from)];
  for (double& value : filled) value *= sign;
  return filled;
}

/// Section of triangles with the sagittal plane at x: segments of (y, z).
std::vector<std::pair<Vector2d, Vector2d>> section(const std::vector<Vector3d>& vertices,
                                                   std::span<const Eigen::Vector3i> triangles,
                                                   double x) {
  std::vector<std::pair<Vector2d, Vector2d>> segments;
  for (const Eigen::Vector3i& triangle : triangles) {
    std::vector<Vector2d> ends;
    for (int k = 0; k < 3; ++k) {
      const Vector3d& a = vertices[static_cast<std::size_t>(triangle[k])];
      const Vector3d& b = vertices[static_cast<std::size_t>(triangle[(k + 1) % 3])];
      if ((a.x() < x) == (b.x() < x)) continue;
      const Vector3d at = a + (x - a.x()) / (b.x() - a.x()) * (b - a);
      ends.emplace_back(at.y(), at.z());
    }
    if (ends.size() == 2) segments.emplace_back(ends[0], ends[1]);
  }
  return segments;
}

/// The foremost y of a section at a height; infinite where it has none.
double front_y(const std::vector<std::pair<Vector2d, Vector2d>>& section, double z) {
  double front = infinity;
  for (const auto& [a, b] : section) {
    if ((a.y() < z) == (b.y() < z)) continue;
    front = std::min(front, a.x() + (z - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
  }
  return front;
}

/// A part at its pose.
struct PosedPart {
  std::vector<Vector3d> vertices;
  std::span<const Eigen::Vector3i> triangles;

  PosedPart(const Part& part, std::span<const Pose> X_CB) : triangles(part.mesh.triangles) {
    const Pose X = pose_in(X_CB, part.body);
    for (const Vector3d& vertex : part.mesh.vertices) vertices.push_back(X * vertex);
  }
};

ToothShow tooth_show(const Tooth& tooth, const PosedPart& arch, const PosedPart* gums,
                     const LipMargins& lips) {
  constexpr double edge_mm = 1.5;  // height of the part of a crown that counts as its edge
  const auto triangles = arch.triangles.subspan(static_cast<std::size_t>(tooth.first_triangle),
                                                static_cast<std::size_t>(tooth.triangle_count));
  double edge_z = infinity;
  for (const auto& triangle : triangles)
    for (const int v : triangle)
      edge_z = std::min(edge_z, arch.vertices[static_cast<std::size_t>(v)].z());
  double low_x = infinity, high_x = -infinity;
  for (const auto& triangle : triangles)
    for (const int v : triangle)
      if (const Vector3d& at = arch.vertices[static_cast<std::size_t>(v)];
          at.z() < edge_z + edge_mm) {
        low_x = std::min(low_x, at.x());
        high_x = std::max(high_x, at.x());
      }
  const double x = 0.5 * (low_x + high_x);
  ToothShow show{.fdi = tooth.fdi, .show_mm = lips.upper_at(x) - edge_z};
  if (!gums) return show;
  const auto crown = section(arch.vertices, triangles, x),
             gum = section(gums->vertices, gums->triangles, x);
  for (double up = 1; up < highest_crown_mm && !show.crown_mm; up += gum_step_mm)
    if (front_y(gum, edge_z + up) < front_y(crown, edge_z + up)) show.crown_mm = up;
  return show;
}

/// The gums of a body, or the cranium's before its upper arch was cut free.
const Part* gums_of(const Case& patient) {
  if (const Part* own = patient.find(Role::upper_gums, patient.jaw.upper_arch)) return own;
  return patient.find(Role::upper_gums);
}

std::optional<double> corridor(const PosedPart& arch, const LipMargins& lips) {
  double right = infinity, left = -infinity;
  for (const Vector3d& at : arch.vertices)
    if (lips.spans(at.x()) && at.z() < lips.upper_at(at.x()) && at.z() > lips.lower_at(at.x())) {
      right = std::min(right, at.x());
      left = std::max(left, at.x());
    }
  if (right > left) return std::nullopt;
  return 1 - (left - right) / (lips.left_x - lips.right_x);
}

/// Means of the central incisors.
void sum_up(SmileMeasures& measures) {
  int incisors = 0, crowns = 0;
  double show = 0, gum = 0, fraction = 0;
  for (const ToothShow& tooth : measures.teeth) {
    if (tooth.fdi != 11 && tooth.fdi != 21) continue;
    ++incisors;
    show += tooth.show_mm;
    if (!tooth.crown_mm) continue;
    ++crowns;
    gum += *tooth.gum_mm();
    fraction += *tooth.crown_fraction();
  }
  if (incisors > 0) measures.incisor_show_mm = show / incisors;
  if (crowns == 0) return;
  measures.gum_show_mm = gum / crowns;
  measures.crown_fraction = fraction / crowns;
  measures.line = *measures.gum_show_mm > 0         ? SmileLine::high
                  : *measures.crown_fraction < 0.75 ? SmileLine::low
                                                    : SmileLine::average;
}

}  // namespace

LipSurfaces lip_surfaces(const TriMesh& face, const MouthOutline& mouth) {
  std::vector<std::vector<int>> neighbours(face.vertices.size());
  for (const Eigen::Vector3i& triangle : face.triangles)
    for (int k = 0; k < 3; ++k) {
      neighbours[static_cast<std::size_t>(triangle[k])].push_back(triangle[(k + 1) % 3]);
      neighbours[static_cast<std::size_t>(triangle[(k + 1) % 3])].push_back(triangle[k]);
    }
  const auto from_upper = distances_from(mouth.upper, face, neighbours),
             from_lower = distances_from(mouth.lower, face, neighbours);
  LipSurfaces lips{.right_corner = mouth.right_corner, .left_corner = mouth.left_corner};
  for (const Eigen::Vector3i& triangle : face.triangles) {
    bool upper = true, lower = true;
    for (const int vertex : triangle) {
      const auto v = static_cast<std::size_t>(vertex);
      upper &= from_upper[v] < from_lower[v];
      lower &= from_lower[v] < from_upper[v];
    }
    if (upper) lips.upper.push_back(triangle);
    if (lower) lips.lower.push_back(triangle);
  }
  return lips;
}

double LipMargins::upper_at(double x) const {
  return between(upper_z, (x - right_x) / (left_x - right_x));
}
double LipMargins::lower_at(double x) const {
  return between(lower_z, (x - right_x) / (left_x - right_x));
}

LipMargins lip_margins(const LipSurfaces& lips, std::span<const Eigen::Vector3f> face) {
  LipMargins margins{.right_x = face[static_cast<std::size_t>(lips.right_corner)].x(),
                     .left_x = face[static_cast<std::size_t>(lips.left_corner)].x(),
                     .upper_z = {},
                     .lower_z = {}};
  margins.upper_z = envelope(lips.upper, face, margins.right_x, margins.left_x, -1);
  margins.lower_z = envelope(lips.lower, face, margins.right_x, margins.left_x, 1);
  return margins;
}

std::optional<double> ToothShow::gum_mm() const {
  if (!crown_mm) return std::nullopt;
  return std::max(0.0, show_mm - *crown_mm);
}

std::optional<double> ToothShow::crown_fraction() const {
  if (!crown_mm) return std::nullopt;
  return std::clamp(show_mm / *crown_mm, 0.0, 1.0);
}

std::string name_of(SmileLine line) {
  return line == SmileLine::low ? "low" : line == SmileLine::average ? "average" : "high";
}

SmileMeasures smile_measures(const Case& patient, const LipMargins& lips,
                             std::span<const Pose> X_CB) {
  SmileMeasures measures;
  const Part* teeth = patient.teeth_of(patient.jaw.upper_arch);
  if (!teeth) return measures;
  const PosedPart arch(*teeth, X_CB);
  std::optional<PosedPart> gums;
  if (const Part* part = gums_of(patient)) gums.emplace(*part, X_CB);
  for (const int fdi : {15, 14, 13, 12, 11, 21, 22, 23, 24, 25})
    for (const Tooth& tooth : teeth->teeth)
      if (tooth.fdi == fdi && tooth.triangle_count > 0)
        measures.teeth.push_back(tooth_show(tooth, arch, gums ? &*gums : nullptr, lips));
  sum_up(measures);
  if (const auto edge = patient.landmarks.find("upper_incisal_point");
      edge && !measures.incisor_show_mm) {
    const Vector3d at = pose_in(X_CB, patient.jaw.upper_arch) * *edge;
    measures.incisor_show_mm = lips.upper_at(at.x()) - at.z();
  }
  measures.buccal_corridor = corridor(arch, lips);
  return measures;
}

}  // namespace condyle
