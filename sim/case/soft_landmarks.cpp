#include "sim/case/soft_landmarks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "engine/mesh/rims.h"
#include "sim/case/front_profile.h"

namespace condyle {
namespace {

using Found = std::optional<Eigen::Vector3d>;

Found most_anterior(const FrontProfile& front, double x0, double low, double high) {
  Found best;
  for (const auto& [bin, y] : front) {
    const double z = profile_height(bin);
    if (z < low || z > high) continue;
    if (!best || y < best->y()) best = Eigen::Vector3d(x0, y, z);
  }
  return best;
}

/// Between the lips: the widest gap of the profile, its deepest concavity, or its most posterior
/// point.
Found mouth(const FrontProfile& front, double x0, double low, double high) {
  Found gap, valley;
  double widest = 3 * profile_bin_mm, deepest = 0.2;
  std::optional<std::pair<double, double>> above;  // z, y of the previous sample, upward
  for (const auto& [bin, y] : front) {
    const double z = profile_height(bin);
    if (z < low || z > high) continue;
    if (above && z - above->first > widest) {
      widest = z - above->first;
      gap = Eigen::Vector3d(x0, std::max(y, above->second), 0.5 * (z + above->first));
    }
    const double depth = hollow_depth(front, bin, y);
    if (!valley || depth > deepest || (deepest == 0.2 && y > valley->y()))
      valley = Eigen::Vector3d(x0, y, z);
    deepest = std::max(deepest, depth);
    above = {z, y};
  }
  return gap ? gap : valley;
}

/// Where the upper lip meets the nose: the deepest hollow between them.
Found below_nose(const FrontProfile& front, double x0, double low, double high) {
  Found best;
  double deepest = 0;
  for (const auto& [bin, y] : front) {
    const double z = profile_height(bin);
    if (z < low || z > high) continue;
    if (const double depth = hollow_depth(front, bin, y); depth > deepest) {
      deepest = depth;
      best = Eigen::Vector3d(x0, y, z);
    }
  }
  return best;
}

/// Both ends of the opening between the lips, right and left, where the face has one.
std::optional<std::pair<Eigen::Vector3d, Eigen::Vector3d>> mouth_corners(
    const TriMesh& face, const Eigen::Vector3d& stomion) {
  constexpr double narrowest = 30, widest = 80, off_middle = 12;  // mm
  const auto by_x = [&](int a, int b) { return face.vertices[a].x() < face.vertices[b].x(); };
  for (const auto& rim : rims_of(face)) {
    const auto [right, left] = std::minmax_element(rim.begin(), rim.end(), by_x);
    const Eigen::Vector3d &a = face.vertices[*right], &b = face.vertices[*left];
    const Eigen::Vector3d middle = 0.5 * (a + b) - stomion;
    if (b.x() - a.x() > narrowest && b.x() - a.x() < widest &&
        std::hypot(middle.x(), middle.z()) < off_middle)
      return std::pair(a, b);
  }
  return std::nullopt;
}

}  // namespace

void estimate_profile_landmarks(Case& patient) {
  auto& marks = patient.landmarks.points;
  const auto upper = patient.landmarks.find("upper_incisal_point");
  const auto lower = patient.landmarks.find("lower_incisal_point");
  if (!upper || !lower) return;
  const double x0 = 0.5 * (upper->x() + lower->x());
  std::string added;
  const auto add = [&](const char* name, const Found& point) {
    if (!point || marks.contains(name)) return;
    marks[name] = *point;
    added += (added.empty() ? "" : ", ") + std::string(name);
  };

  double chin_z = lower->z() - 30;
  if (const Part* mandible = patient.find(Role::mandible)) {
    const auto chin =
        most_anterior(front_profile(mandible->mesh, x0), x0, lower->z() - 60, lower->z() - 18);
    add("pogonion", chin);
    if (const auto found = patient.landmarks.find("pogonion")) chin_z = found->z();
  }
  if (const Part* face = patient.find(Role::face)) {
    const auto front = front_profile(face->mesh, x0);
    const double middle = 0.5 * (upper->z() + lower->z());
    add("pronasale", most_anterior(front, x0, upper->z() + 15, upper->z() + 80));
    add("stomion", mouth(front, x0, middle - 9, middle + 9));
    if (const auto stomion = patient.landmarks.find("stomion")) {
      add("labrale_superius", most_anterior(front, x0, stomion->z() + 0.5, stomion->z() + 9));
      add("labrale_inferius", most_anterior(front, x0, stomion->z() - 9, stomion->z() - 0.5));
      if (const auto corners = mouth_corners(face->mesh, *stomion)) {
        add("right_cheilion", corners->first);
        add("left_cheilion", corners->second);
      }
    }
    const auto nose = patient.landmarks.find("pronasale"),
               red = patient.landmarks.find("labrale_superius");
    if (nose && red) add("subnasale", below_nose(front, x0, red->z() + 3, nose->z() - 3));
    add("soft_pogonion", most_anterior(front, x0, chin_z - 8, chin_z + 8));
  }
  if (!added.empty()) patient.notes.push_back("landmarks estimated from the surfaces: " + added);
}

}  // namespace condyle
