#include "sim/case/soft_landmarks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

namespace condyle {
namespace {

constexpr double bin_mm = 0.5;

constexpr double face_depth_mm = 50;  // largest depth of the profile behind its foremost point

/// The most anterior crossing of a surface with the plane x = x0, by height: z bin -> y.
std::map<int, double> profile(const TriMesh& mesh, double x0) {
  std::map<int, double> front;
  const auto keep = [&](int bin, double y) {
    const auto [it, fresh] = front.try_emplace(bin, y);
    if (!fresh) it->second = std::min(it->second, y);
  };
  double foremost = 1e9;
  for (const auto& t : mesh.triangles) {
    std::vector<Eigen::Vector3d> ends;
    for (int e = 0; e < 3; ++e) {
      const Eigen::Vector3d& a = mesh.vertices[static_cast<std::size_t>(t[e])];
      const Eigen::Vector3d& b = mesh.vertices[static_cast<std::size_t>(t[(e + 1) % 3])];
      if ((a.x() < x0) != (b.x() < x0))
        ends.push_back(a + (x0 - a.x()) / (b.x() - a.x()) * (b - a));
    }
    if (ends.size() != 2) continue;
    if (ends[0].z() > ends[1].z()) std::swap(ends[0], ends[1]);
    foremost = std::min({foremost, ends[0].y(), ends[1].y()});
    const double low = ends[0].z(), height = ends[1].z() - low;
    const auto bin_of = [](double z) { return static_cast<int>(std::floor(z / bin_mm)); };
    keep(bin_of(low), ends[0].y());
    keep(bin_of(low + height), ends[1].y());
    for (int bin = bin_of(low) + 1; bin < bin_of(low + height); ++bin)
      keep(bin, ends[0].y() + ((bin + 0.5) * bin_mm - low) / height * (ends[1].y() - ends[0].y()));
  }
  std::erase_if(front, [&](const auto& at) { return at.second > foremost + face_depth_mm; });
  return front;
}

double height(int bin) { return (bin + 0.5) * bin_mm; }

using Found = std::optional<Eigen::Vector3d>;

Found most_anterior(const std::map<int, double>& front, double x0, double low, double high) {
  Found best;
  for (const auto& [bin, y] : front) {
    const double z = height(bin);
    if (z < low || z > high) continue;
    if (!best || y < best->y()) best = Eigen::Vector3d(x0, y, z);
  }
  return best;
}

/// Depth of a point behind the prominences above and below it, the lesser of the two.
double hollow(const std::map<int, double>& front, int bin, double y) {
  constexpr int reach = static_cast<int>(8 / bin_mm);  // height of a lip
  double above = y, below = y;
  for (int step = 1; step <= reach; ++step) {
    if (const auto at = front.find(bin + step); at != front.end())
      above = std::min(above, at->second);
    if (const auto at = front.find(bin - step); at != front.end())
      below = std::min(below, at->second);
  }
  return y - std::max(above, below);
}

/// Between the lips: the widest gap of the profile, its deepest concavity, or its most posterior
/// point.
Found mouth(const std::map<int, double>& front, double x0, double low, double high) {
  Found gap, valley;
  double widest = 3 * bin_mm, deepest = 0.2;
  std::optional<std::pair<double, double>> above;  // z, y of the previous sample, upward
  for (const auto& [bin, y] : front) {
    const double z = height(bin);
    if (z < low || z > high) continue;
    if (above && z - above->first > widest) {
      widest = z - above->first;
      gap = Eigen::Vector3d(x0, std::max(y, above->second), 0.5 * (z + above->first));
    }
    const double depth = hollow(front, bin, y);
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
        most_anterior(profile(mandible->mesh, x0), x0, lower->z() - 60, lower->z() - 18);
    add("pogonion", chin);
    if (const auto found = patient.landmarks.find("pogonion")) chin_z = found->z();
  }
  if (const Part* face = patient.find(Role::face)) {
    const auto front = profile(face->mesh, x0);
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
