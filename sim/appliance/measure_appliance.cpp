#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/appliance/appliance.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr std::size_t run_length = 256;
constexpr double longest_path_mm = 15;  // out of undercuts
constexpr double chord_step_mm = 0.1;
constexpr double thickest_mm = 30;   // of measured walls
constexpr double facing_cos = -0.7;  // of the normals of two sides of a wall
constexpr double far_mm = 2;         // nor is a point beyond this beside the print
constexpr double near_mm = 0.6;      // an appliance farther away than this leaves a point uncovered

template <class Body>
void for_runs(std::size_t count, int threads, const Body& body) {
  parallel_for((count + run_length - 1) / run_length, threads, [&](std::size_t run) {
    const std::size_t end = std::min(count, (run + 1) * run_length);
    for (std::size_t i = run * run_length; i < end; ++i) body(i);
  });
}

struct Face {
  Vector3d center, normal;  // unit
  double area = 0;          // 0: degenerate
};

Face face_of(const TriMesh& mesh, std::size_t t) {
  const auto& v = mesh.triangles[t];
  const Vector3d &a = mesh.vertices[static_cast<std::size_t>(v[0])],
                 &b = mesh.vertices[static_cast<std::size_t>(v[1])],
                 &c = mesh.vertices[static_cast<std::size_t>(v[2])];
  const Vector3d n = (b - a).cross(c - a);
  const double length = n.norm();
  return {(a + b + c) / 3, length > 0 ? Vector3d(n / length) : Vector3d::Zero(), 0.5 * length};
}

/// The least distance of the support from p on its path along `out`, mm; `enough` where it is more.
double clearance_on_path(const TriangleTree& support, const Vector3d& p, const Vector3d& out,
                         double enough) {
  double least = enough;
  for (double at = 0; at < longest_path_mm;) {
    const double distance = support.signed_distance(p + at * out);
    least = std::min(least, distance);
    at += std::max(chord_step_mm, distance - enough);
  }
  return least;
}

/// The deepest point within the support on the path of p along `out`, mm; 0 where the path is free.
double depth_along_path(const TriangleTree& support, const Vector3d& p, const Vector3d& out) {
  double deepest = 0, from = 0;
  while (from < longest_path_mm) {
    const auto entry = support.ray_cast(p + from * out, out, longest_path_mm - from);
    if (!entry) break;
    const double in = from + entry->distance + 1e-4;
    const auto exit = support.ray_cast(p + in * out, out, longest_path_mm);
    const double end = exit ? in + exit->distance : in;
    for (double at = in; at < end; at += chord_step_mm)
      deepest = std::max(deepest, -support.signed_distance(p + at * out));
    from = end + 1e-4;
  }
  return deepest;
}

double quantile(std::vector<double> values, double fraction) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

/// The wall at a corner: from it along its normal to a facing side at most `reach_mm` away.
struct CornerWall {
  double mm = -1;  // none
  Vector3d middle = Vector3d::Zero();
};
std::vector<CornerWall> corner_walls(const TriMesh& mesh, const TriangleTree& tree, double reach_mm,
                                     int threads) {
  // Normals of corners: those of single triangles, some of which are slivers, are not reliable.
  const std::vector<Vector3d> normals = vertex_normals(mesh);
  std::vector<CornerWall> walls(mesh.vertices.size());
  for_runs(mesh.vertices.size(), threads, [&](std::size_t v) {
    const auto hit = tree.ray_cast(mesh.vertices[v] - 1e-3 * normals[v], -normals[v], reach_mm);
    if (!hit) return;
    Vector3d other = Vector3d::Zero();
    for (int c = 0; c < 3; ++c)
      other += hit->barycentric[c] * normals[mesh.triangles[hit->triangle][c]];
    if (other.dot(normals[v]) < facing_cos)
      walls[v] = {hit->distance + 1e-3, 0.5 * (mesh.vertices[v] + hit->point)};
  });
  return walls;
}

void measure_walls(const TriMesh& mesh, const TriangleTree& tree, int threads,
                   ApplianceMeasure& measure) {
  const std::vector<CornerWall> corners = corner_walls(mesh, tree, thickest_mm, threads);
  std::vector<double> walls;
  measure.wall_min_mm = 1e9;
  for (std::size_t v = 0; v < corners.size(); ++v) {
    if (corners[v].mm < 0) continue;
    walls.push_back(corners[v].mm);
    if (corners[v].mm < measure.wall_min_mm) {
      measure.wall_min_mm = corners[v].mm;
      measure.wall_at = mesh.vertices[v];
    }
  }
  if (walls.empty()) measure.wall_min_mm = 0;
  measure.wall_p5_mm = quantile(std::move(walls), 0.05);
}

}  // namespace

ApplianceMeasure measure_appliance(const TriMesh& mesh, const TriangleTree& tree, int threads) {
  ApplianceMeasure measure;
  const Topology topology = inspect(mesh);
  measure.closed = topology.closed();
  measure.pieces = topology.components;
  measure.triangles = static_cast<int>(mesh.triangles.size());
  measure.volume_mm3 = topology.volume_mm3;
  const Vector3d size = bounding_box(mesh).size();
  for (int i = 0; i < 3; ++i) measure.size_mm[i] = size[i];
  measure_walls(mesh, tree, threads, measure);
  return measure;
}

PrintMeasure measure_print(const TriMesh& appliance, const TriangleTree& printed,
                           const TriMesh& support, const PrintSettings& settings, int threads) {
  PrintMeasure measure;
  measure.on = settings.on;
  measure.seat = settings.seat;
  const TriangleTree on(support);
  const Box box = bounding_box(appliance);
  const Vector3d out = -settings.seat;
  // A ball as thick as the least wall, against the face: where it does not fit between teeth or
  // bone, or cannot leave them with what the print holds, the print was widened.
  const double radius = 0.5 * settings.thin_mm, ball = settings.gap_mm + radius;
  const double leaves = radius - settings.held_mm;
  const auto is_relieved = [&](const Face& face) {
    const Vector3d center = face.center + ball * face.normal;
    return on.nearest(center).distance < ball - 0.02 ||
           clearance_on_path(on, center, out, leaves) < leaves;
  };
  struct Sample {
    double fit = -1, area = 0;
    bool relieved = false, beyond = false;
  };
  std::vector<Sample> samples(support.triangles.size());
  for_runs(support.triangles.size(), threads, [&](std::size_t t) {
    const Face face = face_of(support, t);
    if (face.area == 0 || !box.contains(face.center)) return;
    // Not within other teeth.
    if (on.signed_distance(face.center + 0.5 * settings.gap_mm * face.normal) < 0) return;
    // Covered: the appliance lies in front of it.
    const auto front = printed.ray_cast(face.center, face.normal, far_mm);
    if (!front ||
        face_of(appliance, static_cast<std::size_t>(front->triangle)).normal.dot(face.normal) > 0)
      return;
    samples[t] = {printed.nearest(face.center).distance, face.area, is_relieved(face),
                  front->distance > near_mm};
  });
  // The rims of the print are rounded, as walls there are.
  TriMesh uncovered{support.vertices, {}, {}};
  for (std::size_t t = 0; t < samples.size(); ++t)
    if (samples[t].fit < 0 || (samples[t].beyond && !samples[t].relieved))
      uncovered.triangles.push_back(support.triangles[t]);
  const TriangleTree bare(uncovered);
  std::vector<char> at_rim(samples.size(), 0);
  for_runs(samples.size(), threads, [&](std::size_t t) {
    if (samples[t].fit < 0 || samples[t].beyond) return;
    const Face face = face_of(support, t);
    at_rim[t] = settings.body ? settings.body(face.center + ball * face.normal) > -radius
                              : bare.nearest(face.center, ball).triangle >= 0;
  });
  std::vector<double> fits;
  double sum = 0, area = 0;
  for (std::size_t t = 0; t < samples.size(); ++t) {
    const Sample& sample = samples[t];
    if (sample.fit < 0) continue;
    if (sample.relieved || sample.beyond || at_rim[t]) {
      (sample.relieved ? measure.relieved_mm2
       : sample.beyond ? measure.not_reached_mm2
                       : measure.rim_mm2) += sample.area;
      continue;
    }
    fits.push_back(sample.fit);
    area += sample.area;
    sum += sample.area * sample.fit;
    measure.fit_max_mm = std::max(measure.fit_max_mm, sample.fit);
  }
  measure.area_mm2 = area;
  measure.fit_mean_mm = area > 0 ? sum / area : 0;
  measure.fit_p95_mm = quantile(std::move(fits), 0.95);

  struct Passage {
    double overlap = 0, undercut = 0;
  };
  std::vector<Passage> passages(appliance.vertices.size());
  for_runs(appliance.vertices.size(), threads, [&](std::size_t v) {
    const Vector3d& p = appliance.vertices[v];
    const SurfacePoint near = on.signed_nearest(p, near_mm);
    const double overlap = near.triangle < 0 ? 0 : std::max(0.0, -near.distance);
    passages[v] = {overlap, depth_along_path(on, p, out)};
  });
  for (const Passage& passage : passages) {
    measure.overlap_mm = std::max(measure.overlap_mm, passage.overlap);
    measure.undercut_mm = std::max(measure.undercut_mm, passage.undercut);
  }
  return measure;
}

ApplianceMeasure measure_in_axes(const TriMesh& mesh, const TriangleTree& tree,
                                 const Eigen::Matrix3d& R, const std::vector<PrintedOn>& prints,
                                 int threads) {
  ApplianceMeasure measure = measure_appliance(mesh, tree, threads);
  measure.wall_at = R.transpose() * measure.wall_at;
  for (const PrintedOn& each : prints) {
    measure.prints.push_back(measure_print(mesh, tree, each.support, each.settings, threads));
    measure.prints.back().seat = R.transpose() * each.settings.seat;
  }
  return measure;
}

void check_withdrawal(const ApplianceMeasure& measure, double grip_mm, const std::string& name) {
  constexpr double elastic_mm = 0.5;
  for (const PrintMeasure& print : measure.prints)
    if (print.undercut_mm > grip_mm + elastic_mm)
      throw InputError(fmt::format(
          "the {} cannot be withdrawn from {}: it would pass {:.2f} mm deep through it, and its "
          "grip "
          "is {:g} mm; less depth, and crowns that are a part of their own, leave fewer undercuts",
          name, print.on, print.undercut_mm, grip_mm));
}

std::vector<ThinWall> find_thin_walls(const TriMesh& mesh, const TriangleTree& tree,
                                      double least_mm, int threads) {
  std::vector<ThinWall> thin;
  for (const CornerWall& wall : corner_walls(mesh, tree, least_mm, threads))
    if (wall.mm >= 0 && wall.mm < least_mm) thin.push_back({wall.middle, wall.mm});
  std::stable_sort(thin.begin(), thin.end(), [](const ThinWall& a, const ThinWall& b) {
    return a.thickness_mm < b.thickness_mm;
  });
  return thin;
}

double keep_one_piece(TriMesh& mesh) {
  const Components components = find_components(mesh);
  if (components.count <= 1) return 0;
  std::vector<double> volume(static_cast<std::size_t>(components.count), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    volume[static_cast<std::size_t>(components.of_triangle[t])] +=
        mesh.vertices[static_cast<std::size_t>(v[0])].dot(
            mesh.vertices[static_cast<std::size_t>(v[1])].cross(
                mesh.vertices[static_cast<std::size_t>(v[2])]));
  }
  const auto largest = std::max_element(volume.begin(), volume.end()) - volume.begin();
  double next = 0;
  for (std::size_t i = 0; i < volume.size(); ++i)
    if (static_cast<std::ptrdiff_t>(i) != largest) next = std::max(next, volume[i] / 6);
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (components.of_triangle[t] == largest) mesh.triangles[kept++] = mesh.triangles[t];
  mesh.triangles.resize(kept);
  drop_unreferenced(mesh);
  return next;
}

}  // namespace condyle
