#include "sim/scanner/laser_scan.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "engine/core/parallel.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/scanner/scanner_noise.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double scanner_mm = 400;         // distance of the scanner from its axis
constexpr std::uint64_t numbers_each = 4;  // random, for each sample

/// Face and eyes in the scanner's frame, as one surface.
TriMesh visible_surface(const Case& patient, const Pose& X_SC) {
  TriMesh all;
  for (const Part& part : patient.parts) {
    if (part.role != Role::face && part.role != Role::eyes) continue;
    const int offset = static_cast<int>(all.vertices.size());
    for (const auto& v : part.mesh.vertices) all.vertices.push_back(X_SC * v);
    for (const auto& t : part.mesh.triangles)
      all.triangles.push_back(t + Eigen::Vector3i::Constant(offset));
    if (part.mesh.colors.empty())
      all.colors.resize(all.vertices.size(), Eigen::Vector3f(.8f, .62f, .52f));
    else
      all.colors.insert(all.colors.end(), part.mesh.colors.begin(), part.mesh.colors.end());
  }
  return all;
}

/// Position of a head on the scanner's axis, a little turned and moved.
Pose placed_in_scanner(const Case& patient, std::uint64_t seed) {
  constexpr double turn_deg = 5, shift_mm = 10, axis_behind_nose_mm = 100;
  const auto between = [&](std::uint64_t place, double most) {
    return most * (2 * uniform_number(seed ^ 0x5ca1ab1eULL, place) - 1);
  };
  Box box;
  for (const Part& part : patient.parts)
    if (part.role == Role::face) box.add(bounding_box(part.mesh));
  const Vector3d nose(box.center().x(), box.low.y(), 0);
  const Vector3d axis = Vector3d(between(0, 1), between(1, 1), between(2, 1)).normalized();
  Pose pose;
  pose.R =
      Eigen::Quaterniond(Eigen::AngleAxisd(between(3, turn_deg) * std::numbers::pi / 180, axis));
  pose.t = pose.R * -(nose + Vector3d(0, axis_behind_nose_mm, -10)) +
           Vector3d(between(4, shift_mm), between(5, shift_mm), between(6, shift_mm));
  return pose;
}

/// One ray of the scanner.
struct Sample {
  float depth = std::numeric_limits<float>::quiet_NaN();
  Eigen::Vector3f colour = Eigen::Vector3f::Zero();
};

class LaserScanner {
 public:
  LaserScanner(TriMesh surface, const LaserSettings& settings, const FaceDepthMap& map)
      : surface_(std::move(surface)),
        tree_(surface_),
        normals_(vertex_normals(surface_)),
        settings_(settings),
        map_(map) {}

  Sample sample(int column, int row) const {
    constexpr double dark = 0.35, grazing_cosine = 0.2;  // 78 degrees
    const Vector3d outward = map_.towards_scanner(column);
    const Vector3d from = map_.place(column, row, scanner_mm);
    Sample sample;
    const auto hit = tree_.ray_cast(from, -outward, scanner_mm - 5);
    if (!hit) return sample;
    const auto& t = surface_.triangles[static_cast<std::size_t>(hit->triangle)];
    Vector3d normal = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(t[k]);
      normal += hit->barycentric[k] * normals_[v];
      sample.colour += static_cast<float>(hit->barycentric[k]) * surface_.colors[v];
    }
    const auto number = numbers_each * static_cast<std::uint64_t>(row * map_.width + column);
    const double brightness = sample.colour.mean();
    if (normal.normalized().dot(outward) < grazing_cosine) return sample;
    if (brightness < dark && uniform_number(settings_.seed, number) > brightness / dark)
      return sample;
    double depth = scanner_mm - hit->distance +
                   settings_.noise_mm * normal_number(settings_.seed, number / numbers_each);
    if (uniform_number(settings_.seed, number + 1) < settings_.spikes)
      depth += 30 * (uniform_number(settings_.seed, number + 2) - 0.5);
    sample.depth = static_cast<float>(depth);
    return sample;
  }

 private:
  TriMesh surface_;
  TriangleTree tree_;
  std::vector<Vector3d> normals_;
  const LaserSettings& settings_;
  const FaceDepthMap& map_;
};

}  // namespace

LaserScan scan_laser(const Case& patient, const LaserSettings& settings) {
  LaserScan scan;
  scan.X_SC = placed_in_scanner(patient, settings.seed);
  FaceDepthMap& map = scan.map;
  map.width = map.colour_width = settings.columns;
  map.height = map.colour_height = settings.rows;
  map.height_mm = settings.height_mm;
  map.angle_from_deg = settings.angle_from_deg;
  map.angle_to_deg = settings.angle_to_deg;
  const auto count = static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height);
  map.depth_mm.resize(count);
  map.rgb.resize(3 * count);
  const LaserScanner scanner(visible_surface(patient, scan.X_SC), settings, map);
  parallel_for(static_cast<std::size_t>(map.height), settings.threads, [&](std::size_t row) {
    for (int column = 0; column < map.width; ++column) {
      const Sample sample = scanner.sample(column, static_cast<int>(row));
      const std::size_t at =
          row * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(column);
      map.depth_mm[at] = sample.depth;
      for (int k = 0; k < 3; ++k)
        map.rgb[3 * at + static_cast<std::size_t>(k)] =
            static_cast<std::uint8_t>(std::lround(255 * std::clamp(sample.colour[k], 0.f, 1.f)));
    }
  });
  return scan;
}

}  // namespace condyle
