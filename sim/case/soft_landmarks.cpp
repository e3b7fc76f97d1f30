#include "sim/case/soft_landmarks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

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
    }
    add("soft_pogonion", most_anterior(front, x0, chin_z - 8, chin_z + 8));
  }
  if (!added.empty()) patient.notes.push_back("landmarks estimated from the surfaces: " + added);
}

}  // namespace condyle
