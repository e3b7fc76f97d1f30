#include "sim/face_scan/depth_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/mesh/repair.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double spike_mm = 3, widest_hole_mm = 15, longest_pixels = 4, steepest_deg = 80;

/// Neighbours in a map: columns wrap round a full turn.
class Neighbours {
 public:
  explicit Neighbours(const FaceDepthMap& map)
      : width_(map.width), height_(map.height), turns_(map.is_full_turn()) {}
  /// Index of the sample beside another; -1 beyond the border.
  int at(int column, int row) const {
    if (turns_) column = (column % width_ + width_) % width_;
    return column < 0 || column >= width_ || row < 0 || row >= height_ ? -1 : row * width_ + column;
  }
  int column(int index) const { return index % width_; }
  int row(int index) const { return index / width_; }
  std::array<int, 4> around(int index) const {
    const int c = column(index), r = row(index);
    return {at(c - 1, r), at(c + 1, r), at(c, r - 1), at(c, r + 1)};
  }

 private:
  int width_, height_;
  bool turns_;
};

int drop_spikes(FaceDepthMap& map) {
  const Neighbours beside(map);
  const std::vector<float> before = map.depth_mm;
  int dropped = 0;
  std::vector<float> near;
  for (int row = 0; row < map.height; ++row)
    for (int column = 0; column < map.width; ++column) {
      const auto here = static_cast<std::size_t>(beside.at(column, row));
      if (std::isnan(before[here])) continue;
      near.clear();
      for (int j = -2; j <= 2; ++j)
        for (int i = -2; i <= 2; ++i)
          if (const int at = beside.at(column + i, row + j);
              at >= 0 && !std::isnan(before[static_cast<std::size_t>(at)]))
            near.push_back(before[static_cast<std::size_t>(at)]);
      const auto middle = near.begin() + static_cast<std::ptrdiff_t>(near.size() / 2);
      std::nth_element(near.begin(), middle, near.end());
      if (std::abs(before[here] - *middle) <= spike_mm) continue;
      map.depth_mm[here] = std::nanf("");
      ++dropped;
    }
  return dropped;
}

/// A connected set of samples without a depth.
struct Gap {
  std::vector<int> samples;
  bool at_border = false;
};

/// Adds to a gap all missing samples that are connected with its first one.
void grow(const FaceDepthMap& map, const Neighbours& beside, std::vector<bool>& seen, Gap& gap) {
  for (std::size_t n = 0; n < gap.samples.size(); ++n)
    for (const int next : beside.around(gap.samples[n])) {
      if (next < 0) {
        gap.at_border = true;
        continue;
      }
      const auto at = static_cast<std::size_t>(next);
      if (seen[at] || !std::isnan(map.depth_mm[at])) continue;
      seen[at] = true;
      gap.samples.push_back(next);
    }
}

std::vector<Gap> gaps_of(const FaceDepthMap& map) {
  const Neighbours beside(map);
  std::vector<bool> seen(map.depth_mm.size(), false);
  std::vector<Gap> gaps;
  for (std::size_t first = 0; first < map.depth_mm.size(); ++first) {
    if (seen[first] || !std::isnan(map.depth_mm[first])) continue;
    seen[first] = true;
    Gap& gap = gaps.emplace_back();
    gap.samples.push_back(static_cast<int>(first));
    grow(map, beside, seen, gap);
  }
  return gaps;
}

/// Size of a pixel at a depth, mm: the larger of its sides.
double pixel_size(const FaceDepthMap& map, double depth) {
  if (map.kind == FaceDepthMap::Kind::plane) return map.pixel_mm;
  return std::max(std::abs(map.angle(1) - map.angle(0)) * depth, map.height_mm / map.height);
}

/// Largest extent of a gap, by the depths at its rim.
double width_of(const FaceDepthMap& map, const Gap& gap) {
  const Neighbours beside(map);
  Eigen::AlignedBox3d box;
  for (const int sample : gap.samples)
    for (const int next : beside.around(sample)) {
      if (next < 0) continue;
      const float depth = map.depth_mm[static_cast<std::size_t>(next)];
      if (!std::isnan(depth)) box.extend(map.place(beside.column(next), beside.row(next), depth));
    }
  return box.isEmpty() ? 0 : box.diagonal().maxCoeff();
}

/// Depths that continue those around the gap smoothly: each is the mean of its neighbours.
void fill(FaceDepthMap& map, const Gap& gap) {
  constexpr int rounds = 300;
  constexpr double settled_mm = 1e-4;
  const Neighbours beside(map);
  double sum = 0;
  int known = 0;
  for (const int sample : gap.samples)
    for (const int next : beside.around(sample))
      if (next >= 0 && !std::isnan(map.depth_mm[static_cast<std::size_t>(next)])) {
        sum += map.depth_mm[static_cast<std::size_t>(next)];
        ++known;
      }
  for (const int sample : gap.samples)
    map.depth_mm[static_cast<std::size_t>(sample)] = static_cast<float>(sum / known);
  for (int round = 0; round < rounds; ++round) {
    double most = 0;
    for (const int sample : gap.samples) {
      double mean = 0;
      for (const int next : beside.around(sample))
        mean += 0.25 * map.depth_mm[static_cast<std::size_t>(next)];
      float& depth = map.depth_mm[static_cast<std::size_t>(sample)];
      most = std::max(most, std::abs(mean - depth));
      depth = static_cast<float>(mean);
    }
    if (most < settled_mm) break;
  }
}

void fill_holes(FaceDepthMap& map, DepthMapRepair& repair) {
  for (const Gap& gap : gaps_of(map)) {
    if (gap.at_border || width_of(map, gap) > widest_hole_mm) continue;
    fill(map, gap);
    ++repair.holes;
    repair.filled_samples += static_cast<int>(gap.samples.size());
  }
}

/// Bilinear, at a place of the depth map.
Eigen::Vector3f colour_at(const FaceDepthMap& map, int column, int row) {
  const double x = (column + 0.5) * map.colour_width / map.width - 0.5;
  const double y = (row + 0.5) * map.colour_height / map.height - 0.5;
  const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
  const bool turns = map.is_full_turn();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int j : {0, 1})
    for (const int i : {0, 1}) {
      const int c = turns ? (left + i + map.colour_width) % map.colour_width
                          : std::clamp(left + i, 0, map.colour_width - 1);
      const int r = std::clamp(top + j, 0, map.colour_height - 1);
      const std::size_t at =
          3 * (static_cast<std::size_t>(r) * static_cast<std::size_t>(map.colour_width) +
               static_cast<std::size_t>(c));
      const double weight = (i ? x - left : 1 - x + left) * (j ? y - top : 1 - y + top);
      sum += weight * Vector3d(map.rgb[at], map.rgb[at + 1], map.rgb[at + 2]) / 255;
    }
  return sum.cast<float>().cwiseMax(0).cwiseMin(1);
}

/// Triangles between the samples that have a depth.
class Triangulation {
 public:
  Triangulation(const FaceDepthMap& map, const std::vector<Vector3d>& places,
                DepthMapRepair& repair)
      : map_(map), places_(places), repair_(repair) {}

  std::vector<Eigen::Vector3i> take() {
    const Neighbours beside(map_);
    const int columns = map_.is_full_turn() ? map_.width : map_.width - 1;
    for (int row = 0; row + 1 < map_.height; ++row)
      for (int column = 0; column < columns; ++column)
        quad({beside.at(column, row), beside.at(column + 1, row), beside.at(column + 1, row + 1),
              beside.at(column, row + 1)},
             column);
    return std::move(triangles_);
  }

 private:
  const Vector3d& at(int sample) const { return places_[static_cast<std::size_t>(sample)]; }
  bool known(int sample) const {
    return !std::isnan(map_.depth_mm[static_cast<std::size_t>(sample)]);
  }
  /// Corners from the upper left one, clockwise as the scanner sees them.
  void quad(const std::array<int, 4>& q, int column) {
    const bool all = known(q[0]) && known(q[1]) && known(q[2]) && known(q[3]);
    const bool other = all ? (at(q[0]) - at(q[2])).norm() > (at(q[1]) - at(q[3])).norm()
                           : !(known(q[0]) && known(q[2]));
    if (other) {
      triangle({q[0], q[3], q[1]}, column);
      triangle({q[1], q[3], q[2]}, column);
    } else {
      triangle({q[0], q[2], q[1]}, column);
      triangle({q[0], q[3], q[2]}, column);
    }
  }
  void triangle(Eigen::Vector3i t, int column) {
    if (map_.kind == FaceDepthMap::Kind::cylinder && map_.angle_to_deg < map_.angle_from_deg)
      std::swap(t[1], t[2]);
    if (!known(t[0]) || !known(t[1]) || !known(t[2])) return;
    static const double least_cosine = std::cos(steepest_deg * std::numbers::pi / 180);
    const double longest =
        longest_pixels * pixel_size(map_, map_.depth_mm[static_cast<std::size_t>(t[0])]);
    double longest_edge = 0;
    for (int k = 0; k < 3; ++k)
      longest_edge = std::max(longest_edge, (at(t[k]) - at(t[(k + 1) % 3])).norm());
    const Vector3d normal = (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
    const double cosine = normal.normalized().dot(map_.towards_scanner(column + 0.5));
    if (longest_edge > longest || cosine < least_cosine)
      ++repair_.steep_triangles;
    else
      triangles_.push_back(t);
  }

  const FaceDepthMap& map_;
  const std::vector<Vector3d>& places_;
  DepthMapRepair& repair_;
  std::vector<Eigen::Vector3i> triangles_;
};

}  // namespace

bool FaceDepthMap::is_full_turn() const {
  return kind == Kind::cylinder && std::abs(angle_to_deg - angle_from_deg) > 360 - 1e-6;
}

double FaceDepthMap::angle(double column) const {
  return (angle_from_deg + (column + 0.5) * (angle_to_deg - angle_from_deg) / width) *
         std::numbers::pi / 180;
}

double FaceDepthMap::row_height(double row) const {
  const double step = kind == Kind::plane ? pixel_mm : height_mm / height;
  return (0.5 * height - row - 0.5) * step;
}

Vector3d FaceDepthMap::place(double column, double row, double depth) const {
  if (kind == Kind::plane)
    return {(column + 0.5 - 0.5 * width) * pixel_mm, -depth, row_height(row)};
  const double a = angle(column);
  return {depth * std::sin(a), -depth * std::cos(a), row_height(row)};
}

Vector3d FaceDepthMap::towards_scanner(double column) const {
  if (kind == Kind::plane) return -Vector3d::UnitY();
  const double a = angle(column);
  return {std::sin(a), -std::cos(a), 0};
}

TriMesh surface_of(FaceDepthMap map, DepthMapRepair& repair) {
  repair.spikes += drop_spikes(map);
  fill_holes(map, repair);
  TriMesh mesh;
  mesh.vertices.assign(map.depth_mm.size(), Vector3d::Zero());
  const bool coloured = !map.rgb.empty();
  if (coloured) mesh.colors.assign(map.depth_mm.size(), Eigen::Vector3f::Zero());
  for (int row = 0, at = 0; row < map.height; ++row)
    for (int column = 0; column < map.width; ++column, ++at) {
      const auto i = static_cast<std::size_t>(at);
      if (std::isnan(map.depth_mm[i])) continue;
      mesh.vertices[i] = map.place(column, row, map.depth_mm[i]);
      if (coloured) mesh.colors[i] = colour_at(map, column, row);
    }
  mesh.triangles = Triangulation(map, mesh.vertices, repair).take();
  drop_unreferenced(mesh);
  return mesh;
}

}  // namespace condyle
