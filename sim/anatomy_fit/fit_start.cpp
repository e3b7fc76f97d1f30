#include "sim/anatomy_fit/fit_start.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/parallel.h"
#include "engine/core/units.h"

namespace condyle {
namespace {

using Eigen::AngleAxisd, Eigen::Matrix3d, Eigen::Vector3d;

/// Box of the samples without the outermost hundredth on each side.
Box inner_box(const std::vector<SurfaceSample>& samples, const Matrix3d& turn) {
  Box box;
  if (samples.empty()) return box;
  for (int a = 0; a < 3; ++a) {
    std::vector<double> along;
    for (const auto& sample : samples) along.push_back(turn.row(a).dot(sample.point));
    std::sort(along.begin(), along.end());
    const std::size_t cut = along.size() / 100;
    box.low[a] = along[cut];
    box.high[a] = along[along.size() - 1 - cut];
  }
  return box;
}

std::vector<SurfaceSample> thinned(const std::vector<SurfaceSample>& samples, std::size_t count) {
  if (samples.size() <= count) return samples;
  std::vector<SurfaceSample> some;
  for (std::size_t i = 0; i < count; ++i) some.push_back(samples[i * samples.size() / count]);
  return some;
}

/// Trimmed iterative closest points of scan samples to the template, which stays.
AffineMap settle(const FitSurface& moving, const std::vector<SurfaceSample>& scan, AffineMap map,
                 int rounds, const ScaleRange& scale, double kept) {
  AffineMap back = map.inverse();
  const TriangleTree& tree = moving.pairs.tree();
  for (int k = 0; k < rounds; ++k) {
    std::vector<PointPair> pairs;
    std::vector<double> distances;
    const double size = std::cbrt(back.matrix.determinant());
    for (const auto& sample : scan) {
      const Vector3d p = back * sample.point;
      const SurfacePoint found = tree.nearest(p);
      if (found.triangle < 0) continue;
      const auto& c = tree.corners(found.triangle);
      const Vector3d normal = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
      if (normal.dot(back.matrix * sample.normal) < 0.3 * size) continue;
      pairs.push_back({sample.point, found.point, 1, normal});
      distances.push_back(found.distance);
    }
    if (pairs.size() < 10) break;
    auto sorted = distances;
    std::sort(sorted.begin(), sorted.end());
    const double limit =
        sorted[static_cast<std::size_t>(kept * static_cast<double>(sorted.size() - 1))];
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const double far = distances[i] / 8;
      pairs[i].weight = distances[i] > limit ? 0 : 1 / (1 + far * far);
    }
    const auto next = similarity_fit(pairs, scale);
    if (!next) break;
    back = *next;
  }
  return back.inverse();
}

struct Candidate {
  AffineMap map;
  ScanFrame frame = ScanFrame::lps;
  double score = 0;
};

double share_near(const FitSurface& moving, const std::vector<SurfaceSample>& scan,
                  const AffineMap& map, double near_mm) {
  const AffineMap back = map.inverse();
  const double scale = std::cbrt(back.matrix.determinant());
  const TriangleTree& tree = moving.pairs.tree();
  double sum = 0;
  for (const auto& sample : scan) {
    const SurfacePoint found = tree.nearest(back * sample.point, near_mm * scale);
    if (found.triangle < 0) continue;
    const auto& c = tree.corners(found.triangle);
    const Vector3d normal = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
    if (normal.dot(back.matrix * sample.normal) > 0.5 * scale) sum += 1;
  }
  return scan.empty() ? 0 : sum / static_cast<double>(scan.size());
}

/// Offsets that shift [low, high] over [low_scan, high_scan] from end to end.
std::vector<double> offsets(double low, double high, double low_scan, double high_scan) {
  constexpr double step_mm = 30, alike_mm = 8;
  const double bottom = low_scan - low, top = high_scan - high, range = std::abs(top - bottom);
  if (range < alike_mm) return {0.5 * (bottom + top)};
  const int steps = std::max(2, static_cast<int>(std::ceil(range / step_mm)));
  std::vector<double> all;
  for (int k = 0; k <= steps; ++k) all.push_back(bottom + (top - bottom) * k / steps);
  return all;
}

std::vector<Candidate> candidates(const FitSurface& moving, const FitSurface& target) {
  struct Turn {
    ScanFrame frame;
    Matrix3d matrix;
  };
  const auto about = [](double deg, const Vector3d& axis) {
    return AngleAxisd(deg * degree, axis).toRotationMatrix();
  };
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  const std::array<Turn, 4> frames = {
      Turn{ScanFrame::lps, Matrix3d::Identity()}, Turn{ScanFrame::face_behind, about(180, z)},
      Turn{ScanFrame::upside_down, about(180, x)}, Turn{ScanFrame::turned_over, about(180, y)}};
  const std::array<Matrix3d, 9> tilts = {about(0, x),   about(-15, x), about(15, x),
                                         about(-30, x), about(30, x),  about(-15, y),
                                         about(15, y),  about(-20, z), about(20, z)};
  const Box scan = inner_box(target.samples, Matrix3d::Identity());
  std::vector<Candidate> all;
  for (const Turn& frame : frames)
    for (std::size_t k = 0; k < tilts.size(); ++k) {
      if (frame.frame != ScanFrame::lps && k > 2) continue;
      const Matrix3d turn = frame.matrix * tilts[k];
      const Box box = inner_box(moving.samples, turn);
      const double across = (scan.center() - box.center()).x();
      const bool forward = (turn * y).y() > 0;  // the template's face points to the scan's low y
      const double front = forward ? scan.low.y() - box.low.y() : scan.high.y() - box.high.y();
      std::vector<double> depths = {(scan.center() - box.center()).y()};
      if (std::abs(front - depths[0]) > 8) depths.push_back(front);
      for (const double depth : depths)
        for (const double height : offsets(box.low.z(), box.high.z(), scan.low.z(), scan.high.z()))
          all.push_back({{turn, {across, depth, height}}, frame.frame, 0});
    }
  return all;
}

}  // namespace

FitStart find_start(const FitSurface& moving, const FitSurface& target, int threads) {
  constexpr double near_mm = 5, rough_mm = 10;
  constexpr std::size_t finalists = 10;
  const auto few = thinned(target.samples, 200), many = thinned(target.samples, 700);
  std::vector<Candidate> all = candidates(moving, target);
  parallel_for(all.size(), threads, [&](std::size_t i) {
    all[i].map = settle(moving, few, all[i].map, 8, {1, 1}, 0.9);
    all[i].score = share_near(moving, few, all[i].map, rough_mm);
  });
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  if (all.size() > finalists) all.resize(finalists);
  parallel_for(all.size(), threads, [&](std::size_t i) {
    all[i].map = settle(moving, many, all[i].map, 25, {0.8, 1.25}, 0.9);
    all[i].score = share_near(moving, many, all[i].map, near_mm);
  });
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  FitStart start;
  if (all.empty()) return start;
  start.map = all.front().map;
  start.frame = all.front().frame;
  start.explained = all.front().score;
  return start;
}

}  // namespace condyle
