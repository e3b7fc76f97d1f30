#include "sim/comparison/face_comparison.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/core/error.h"
#include "engine/core/infinity.h"
#include "engine/core/parallel.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/registration/rigid_fit.h"
#include "engine/registration/surface_fit.h"

namespace condyle {
namespace {

/// Refuses surfaces of other sizes: the units of one of them are wrong.
void check_sizes(const TriMesh& predicted, const TriMesh& after) {
  const double first = bounding_box(predicted).size().norm(),
               second = bounding_box(after).size().norm();
  if (!(first > 0)) throw InputError("the predicted face has no extent");
  if (second > 0.3 * first && second < 4 * first) return;
  std::string units;
  for (const auto& [name, mm] : {std::pair{"m", 1000.0}, {"cm", 10.0}, {"in", 25.4}})
    if (mm * second > 0.3 * first && mm * second < 4 * first)
      units = fmt::format("; in {} it would fit: --units {}", name, name);
  throw InputError(
      fmt::format("the face after the operation is {:.4g} mm across, the predicted one {:.4g} mm{}",
                  second, first, units));
}

/// Points of the predicted face that are registered: those of the upper face, at most about
/// `most` of them.
struct FitPoints {
  std::vector<Eigen::Vector3d> points, normals;
};
FitPoints upper_points(const TriMesh& face, const std::vector<FaceRegion>& regions) {
  constexpr std::size_t most = 6000;
  const auto normals = vertex_normals(face);
  const auto count =
      static_cast<std::size_t>(std::count(regions.begin(), regions.end(), FaceRegion::upper));
  const std::size_t step = std::max<std::size_t>(1, count / most);
  FitPoints points;
  std::size_t at = 0;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (regions[i] != FaceRegion::upper || at++ % step != 0) continue;
    points.points.push_back(face.vertices[i]);
    points.normals.push_back(normals[i]);
  }
  return points;
}

/// X_OP by the landmarks of the upper face that both have.
Pose landmark_fit(const MarkedFace& predicted, const MarkedFace& after, FaceComparison& result) {
  std::vector<Eigen::Vector3d> p_P, p_O;
  for (const auto& name : stable_soft_landmarks()) {
    const auto p = predicted.landmarks.find(name), o = after.landmarks.find(name);
    if (!p || !o) continue;
    p_P.push_back(*p);
    p_O.push_back(*o);
  }
  const auto fit = rigid_fit(p_P, p_O);
  if (!fit)
    throw InputError(fmt::format(
        "registration by landmarks needs three of these, not on a line, on both faces: {}; {} "
        "{} in common",
        fmt::join(stable_soft_landmarks(), ", "), p_P.size(), p_P.size() == 1 ? "is" : "are"));
  double squares = 0;
  for (std::size_t i = 0; i < p_P.size(); ++i) squares += (*fit * p_P[i] - p_O[i]).squaredNorm();
  result.registration_rms_mm = std::sqrt(squares / static_cast<double>(p_P.size()));
  result.registration_points = static_cast<int>(p_P.size());
  return *fit;
}

/// The surface turned to face outward as the predicted one does, which an open scan cannot show by
/// itself.
TriMesh oriented(const TriMesh& after, const TriMesh& predicted, const Pose& X_OP,
                 std::vector<std::string>& notes) {
  TriMesh mesh = after;
  weld(mesh);
  orient_outward(mesh);
  const TriangleTree tree(mesh);
  if (tree.empty()) throw InputError("the face after the operation has no triangle with an area");
  const auto normals = vertex_normals(predicted);
  const std::size_t step = std::max<std::size_t>(1, normals.size() / 2000);
  double agreement = 0;
  for (std::size_t i = 0; i < normals.size(); i += step)
    agreement +=
        (X_OP.R * normals[i]).dot(tree.pseudonormal(tree.nearest(X_OP * predicted.vertices[i])));
  if (agreement < 0) {
    flip(mesh);
    notes.push_back("the face after the operation faced inward and was turned");
  }
  return mesh;
}

double median_distance(const TriangleTree& tree, const std::vector<Eigen::Vector3d>& points,
                       const Pose& X_OP) {
  const std::size_t step = std::max<std::size_t>(1, points.size() / 500);
  std::vector<double> distances;
  for (std::size_t i = 0; i < points.size(); i += step)
    distances.push_back(tree.nearest(X_OP * points[i]).distance);
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

/// Area of a third of the triangles at each vertex, mm^2.
std::vector<double> vertex_areas(const TriMesh& mesh) {
  std::vector<double> areas(mesh.vertices.size(), 0);
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const Eigen::Vector3d &a = mesh.vertices[static_cast<std::size_t>(t[0])],
                          &b = mesh.vertices[static_cast<std::size_t>(t[1])],
                          &c = mesh.vertices[static_cast<std::size_t>(t[2])];
    const double third = (b - a).cross(c - a).norm() / 6;
    for (int k = 0; k < 3; ++k) areas[static_cast<std::size_t>(t[k])] += third;
  }
  return areas;
}

struct Weighted {
  double value, weight;
};
/// The value below which this share of the weight lies. Sorts the values.
double quantile(std::vector<Weighted>& values, double share) {
  std::stable_sort(values.begin(), values.end(),
                   [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  double total = 0, sum = 0;
  for (const Weighted& each : values) total += each.weight;
  for (const Weighted& each : values)
    if ((sum += each.weight) >= share * total) return each.value;
  return values.empty() ? 0 : values.back().value;
}

template <class Belongs>
RegionDistances distances_in(const std::string& name, const std::vector<double>& distance_mm,
                             const std::vector<double>& areas, const Belongs& belongs) {
  RegionDistances row;
  row.region = name;
  std::vector<Weighted> with_sign, absolute;
  double measured = 0, below = 0;
  for (std::size_t i = 0; i < distance_mm.size(); ++i) {
    if (!belongs(i)) continue;
    row.area_mm2 += areas[i];
    if (!std::isfinite(distance_mm[i])) continue;
    const double size = std::abs(distance_mm[i]);
    with_sign.push_back({distance_mm[i], areas[i]});
    absolute.push_back({size, areas[i]});
    measured += areas[i];
    row.signed_mean_mm += areas[i] * distance_mm[i];
    row.mean_mm += areas[i] * size;
    if (size < 2) below += areas[i];
    row.max_mm = std::max(row.max_mm, size);
  }
  row.points = static_cast<int>(absolute.size());
  if (!(measured > 0)) return row;
  row.measured_share = measured / row.area_mm2;
  row.signed_mean_mm /= measured;
  row.mean_mm /= measured;
  row.share_below_2_mm = below / measured;
  row.signed_median_mm = quantile(with_sign, 0.5);
  row.median_mm = quantile(absolute, 0.5);
  row.p90_mm = quantile(absolute, 0.9);
  row.p95_mm = quantile(absolute, 0.95);
  return row;
}

std::vector<RegionDistances> region_rows(const FaceComparison& result, const TriMesh& face) {
  const auto areas = vertex_areas(face);
  const auto row = [&](const std::string& name, const auto& belongs) {
    return distances_in(name, result.distance_mm, areas, belongs);
  };
  const auto& regions = result.regions;
  if (regions.empty()) return {row("whole", [](std::size_t) { return true; })};
  std::vector<RegionDistances> rows;
  for (const FaceRegion region : face_regions)
    rows.push_back(row(region_name(region), [&](std::size_t i) { return regions[i] == region; }));
  rows.push_back(row("whole", [&](std::size_t i) {
    return regions[i] != FaceRegion::none && regions[i] != FaceRegion::upper;
  }));
  return rows;
}

/// Pose of the predicted face on the surface after the operation, X_OP.
Pose registered(const MarkedFace& predicted, const MarkedFace& after,
                const FaceComparisonSettings& settings, FaceComparison& result) {
  const bool by_surface = settings.alignment == FaceAlignment::surface;
  Pose X_OP;
  if (settings.alignment == FaceAlignment::landmarks ||
      (by_surface && !after.landmarks.points.empty()))
    X_OP = landmark_fit(predicted, after, result);
  result.after = oriented(after.mesh, predicted.mesh, X_OP, result.notes);
  const SurfacePairs pairs(result.after);
  constexpr double too_far_mm = 30;
  if (const double apart = median_distance(pairs.tree(), predicted.mesh.vertices, X_OP);
      apart > too_far_mm)
    throw InputError(fmt::format(
        "the face after the operation lies {:.0f} mm from the predicted one: check its units and "
        "axes (--units, --frame), or register by landmarks (--after-landmarks FILE)",
        apart));
  if (!by_surface) return X_OP;
  const FitPoints points = upper_points(predicted.mesh, result.regions);
  const SurfaceFit fit =
      fit_to_surface(points.points, points.normals, pairs, X_OP, {.threads = settings.threads});
  if (!fit.converged)
    throw InputError(fmt::format(
        "the upper face could not be registered by its surface: {} of {} points have a partner; "
        "use landmarks (--align landmarks) or register both before",
        fit.pairs, points.points.size()));
  result.registration_rms_mm = fit.rms_mm;
  result.registration_points = fit.pairs;
  return fit.X_BA;
}

}  // namespace

FaceComparison compare_faces(const MarkedFace& predicted, const MarkedFace& after,
                             const FaceComparisonSettings& settings) {
  check_sizes(predicted.mesh, after.mesh);
  FaceComparison result;
  try {
    result.regions = regions_of_face(predicted.mesh, predicted.landmarks, settings.threads);
  } catch (const InputError& error) {
    if (settings.alignment == FaceAlignment::surface)
      throw InputError(
          fmt::format("registration by the surface of the upper face: {}; give "
                      "--landmarks or --case, or use --align none",
                      error.what()));
    result.notes.push_back(fmt::format("no regions: {}", error.what()));
  }
  result.X_PO = registered(predicted, after, settings, result).inverse();
  for (Eigen::Vector3d& p : result.after.vertices) p = result.X_PO * p;
  const SurfacePairs pairs(result.after);
  const auto normals = vertex_normals(predicted.mesh);
  result.distance_mm.assign(normals.size(), infinity);
  parallel_for(normals.size(), settings.threads, [&](std::size_t i) {
    if (const auto pair = pairs.find(predicted.mesh.vertices[i], normals[i]))
      result.distance_mm[i] = pair->distance;
  });
  result.rows = region_rows(result, predicted.mesh);
  if (result.rows.back().points == 0)
    throw InputError(
        "no point of the predicted face has a partner on the face after the operation");
  return result;
}

}  // namespace condyle
