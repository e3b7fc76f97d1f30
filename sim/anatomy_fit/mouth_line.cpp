#include "sim/anatomy_fit/mouth_line.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "sim/case/front_profile.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double reach_mm = 9, least_depth_mm = 0.5, about_as_deep_mm = 0.7;
constexpr double shifted_mm = 2.5, doubtful_mm = 8;
constexpr double widest_mm = 35, side_step_mm = 1, climb_mm = 1.5;
constexpr double alone_mm = 2;       // a hollow is the deepest one within this height
constexpr double ends_early_mm = 6;  // of the line before a carried corner

struct Hollow {
  double y = 0, z = 0;
};

/// The hollow of a profile that is nearest to a height, of those about as deep as the deepest
/// within `reach`. Each is the deepest of its surroundings: the side of a hollow is none.
std::optional<Hollow> hollow_near(const FrontProfile& front, double height, double reach) {
  std::map<int, double> depths;
  for (const auto& [bin, y] : front)
    if (std::abs(profile_height(bin) - height) <= reach + alone_mm)
      depths[bin] = hollow_depth(front, bin, y);
  const auto is_deepest = [&](int bin, double depth) {
    return std::none_of(depths.begin(), depths.end(), [&](const auto& other) {
      return std::abs(profile_height(other.first) - profile_height(bin)) <= alone_mm &&
             other.second > depth;
    });
  };
  std::map<int, double> hollows;
  double most = least_depth_mm;
  for (const auto& [bin, depth] : depths) {
    if (std::abs(profile_height(bin) - height) > reach || depth < least_depth_mm) continue;
    if (!is_deepest(bin, depth)) continue;
    hollows[bin] = depth;
    most = std::max(most, depth);
  }
  std::optional<Hollow> best;
  for (const auto& [bin, depth] : hollows) {
    const double z = profile_height(bin);
    if (depth < most - about_as_deep_mm) continue;
    if (!best || std::abs(z - height) < std::abs(best->z - height)) best = Hollow{front.at(bin), z};
  }
  return best;
}

/// The line between the lips in the frame of the head.
class MouthLine {
 public:
  MouthLine(TriMesh skin, double x0) : skin_(std::move(skin)), x0_(x0) {}

  /// The height at which most of the profiles beside the midline have their deepest hollow.
  std::optional<Vector3d> middle(double expected_z) const {
    std::vector<Hollow> found;
    for (const double beside : {-5.0, -2.5, 0.0, 2.5, 5.0})
      if (const auto hollow = hollow_near(front_profile(skin_, x0_ + beside), expected_z, reach_mm))
        found.push_back(*hollow);
    if (found.size() < 3) return std::nullopt;
    std::sort(found.begin(), found.end(),
              [](const Hollow& a, const Hollow& b) { return a.z < b.z; });
    const Hollow& median = found[found.size() / 2];
    return Vector3d(x0_, median.y, median.z);
  }

  /// Follows the line from its middle to a side, up to x. Nothing where it ends much earlier.
  std::optional<Vector3d> corner(const Vector3d& middle, double x) const {
    const double sign = x > middle.x() ? 1 : -1;
    const double width = std::min(std::abs(x - middle.x()), widest_mm);
    Vector3d at = middle;
    for (double beside = side_step_mm; beside <= width; beside += side_step_mm) {
      const double next = middle.x() + sign * beside;
      const auto hollow = hollow_near(front_profile(skin_, next), at.z(), climb_mm);
      if (hollow) at = {next, hollow->y, hollow->z};
    }
    if (std::abs(at.x() - middle.x()) < width - ends_early_mm) return std::nullopt;
    return at;
  }

  /// The front of the skin at a height.
  Vector3d on_skin(const Vector3d& near) const {
    Vector3d best = near;
    double least = 1e9;
    for (const auto& [bin, y] : front_profile(skin_, near.x()))
      if (const double off = std::abs(profile_height(bin) - near.z()); off < least) {
        least = off;
        best.y() = y;
      }
    return best;
  }

  /// The foremost point of a lip, between two heights.
  Vector3d foremost(double low, double high) const {
    Vector3d best(x0_, 1e9, 0.5 * (low + high));
    for (const auto& [bin, y] : front_profile(skin_, x0_))
      if (profile_height(bin) >= low && profile_height(bin) <= high && y < best.y())
        best = {x0_, y, profile_height(bin)};
    return best;
  }

 private:
  TriMesh skin_;
  double x0_;
};

/// The part of the skin that can hold the mouth, in the frame of the head.
TriMesh mouth_region(const TriMesh& skin, const Eigen::Matrix3d& axes, const Vector3d& stomion) {
  const Vector3d half(widest_mm + 10, 45, 40);
  TriMesh region;
  region.vertices.reserve(skin.vertices.size());
  std::vector<char> near;
  for (const auto& v : skin.vertices) {
    region.vertices.push_back(axes.transpose() * v);
    near.push_back(((region.vertices.back() - stomion).array().abs() < half.array()).all());
  }
  for (const auto& t : skin.triangles)
    if (near[t[0]] && near[t[1]] && near[t[2]]) region.triangles.push_back(t);
  return region;
}

}  // namespace

void find_mouth_line(std::map<std::string, ProposedLandmark>& marks, const TriMesh& skin,
                     const Eigen::Matrix3d& axes) {
  const auto find = [&](const char* name) -> ProposedLandmark* {
    const auto at = marks.find(name);
    return at == marks.end() || at->second.outside_scan ? nullptr : &at->second;
  };
  ProposedLandmark* stomion = find("stomion");
  const ProposedLandmark* incisor = find("upper_incisal_point");
  if (!stomion || !incisor || incisor->doubtful || skin.empty()) return;
  const auto in_head = [&](const Vector3d& p) -> Vector3d { return axes.transpose() * p; };
  const Vector3d carried = in_head(stomion->point);
  const double expected_z = in_head(incisor->point).z();
  const MouthLine line(mouth_region(skin, axes, carried), carried.x());
  const auto middle = line.middle(expected_z);
  if (!middle) {
    if (std::abs(carried.z() - expected_z) < doubtful_mm) return;
    stomion->doubtful = true;
    stomion->reason = "no line between the lips was found near the incisors";
    return;
  }
  const double shift = middle->z() - carried.z();
  if (std::abs(shift) < shifted_mm) return;
  const auto place = [&](const char* name, const Vector3d& p) {
    ProposedLandmark* mark = find(name);
    if (!mark) return;
    mark->uncertainty_mm += 0.25 * std::abs(shift);
    mark->point = axes * p;
  };
  for (const char* name : {"left_cheilion", "right_cheilion"})
    if (ProposedLandmark* mark = find(name)) {
      const Vector3d at = in_head(mark->point);
      const auto corner = line.corner(*middle, at.x());
      place(name, corner.value_or(line.on_skin(at + Vector3d(0, 0, shift))));
      if (corner) continue;
      mark->doubtful = true;
      mark->reason = "the line between the lips was not found up to the corner";
    }
  constexpr double nearest_mm = 1, farthest_mm = 9;  // of a lip's foremost point from the line
  place("labrale_superius", line.foremost(middle->z() + nearest_mm, middle->z() + farthest_mm));
  place("labrale_inferius", line.foremost(middle->z() - farthest_mm, middle->z() - nearest_mm));
  place("stomion", *middle);
}

}  // namespace condyle
