#include "sim/frame/face_openings.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>

#include "engine/core/infinity.h"
#include "engine/mesh/rims.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Kind = FaceOpening::Kind;

struct Rim {
  std::vector<int> walk;
  Vector3d middle = Vector3d::Zero(), outward = Vector3d::Zero(), size;
  double length = 0;
};

/// By rim length and centre, relative to the tip of the nose: lateral, posterior, superior; mm.
bool is_eye(const Rim& rim, const Vector3d& offset) {
  const double beside = std::abs(offset.x());
  return rim.length > 45 && rim.length < 160 && beside > 15 && beside < 55 && offset.y() > 0 &&
         offset.y() < 75 && offset.z() > 5 && offset.z() < 60 && -rim.outward.y() > 0.5;
}

bool may_be_nostril(const Rim& rim, const Vector3d& offset) {
  return rim.length > 12 && rim.length < 80 && std::abs(offset.x()) < 22 && offset.y() > 0 &&
         offset.y() < 35 && offset.z() > -25 && offset.z() < 8 && -rim.outward.z() > 0.25;
}

/// Two nostrils side by side.
bool are_pair(const Rim& a, const Rim& b, const Vector3d& tip) {
  constexpr double off_mm = 10;  // lateral deviation of a crooked nose
  const Vector3d between = b.middle - a.middle;
  return std::abs(between.x()) > 4 && std::abs(between.y()) < off_mm &&
         std::abs(between.z()) < off_mm && a.length < 2 * b.length && b.length < 2 * a.length &&
         std::abs((a.middle.x() + b.middle.x()) / 2 - tip.x()) < off_mm;
}

/// Both nostrils in one opening; a mouth is wider than high.
bool is_double(const Rim& rim, const Vector3d& offset) {
  return std::abs(offset.x()) < rim.size.x() / 2 &&
         rim.size.x() < std::hypot(rim.size.y(), rim.size.z());
}

std::vector<Rim> measured_rims(const TriMesh& face) {
  std::vector<Rim> rims;
  for (auto& walk : rims_of(face)) {
    Rim rim;
    Eigen::AlignedBox3d box;
    const auto place = [&](std::size_t i) -> const Vector3d& {
      return face.vertices[static_cast<std::size_t>(walk[i % walk.size()])];
    };
    for (std::size_t i = 0; i < walk.size(); ++i) {
      rim.middle += place(i) / static_cast<double>(walk.size());
      rim.outward += (place(i) - place(0)).cross(place(i + 1) - place(0));
      rim.length += (place(i + 1) - place(i)).norm();
      box.extend(place(i));
    }
    if (!(rim.outward.norm() > 0)) continue;
    rim.outward.normalize();
    rim.size = box.sizes();
    rim.walk = std::move(walk);
    rims.push_back(std::move(rim));
  }
  return rims;
}

/// Candidates for the tip of the nose: the most anterior vertex of each height band that protrudes
/// beyond the bands just above and below; most anterior first. A chin or a tube may protrude
/// further.
std::vector<Vector3d> possible_tips(const TriMesh& face) {
  constexpr double band_mm = 4, spike_mm = 6;
  constexpr int beside = 3;  // bands
  // distance in front of all neighbours
  std::vector<double> before(face.vertices.size(), -infinity);
  double low = infinity, high = -infinity;
  for (const auto& t : face.triangles)
    for (int k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(t[k]);
      const Vector3d& p = face.vertices[v];
      double& front = before[v];
      for (const int other : {t[(k + 1) % 3], t[(k + 2) % 3]})
        front = std::max(front, p.y() - face.vertices[static_cast<std::size_t>(other)].y());
      low = std::min(low, p.z());
      high = std::max(high, p.z());
    }
  if (!(high - low < 10000)) return {};
  std::vector<Vector3d> fronts(static_cast<std::size_t>((high - low) / band_mm) + 1,
                               Vector3d::Constant(infinity));
  for (std::size_t v = 0; v < before.size(); ++v) {
    const Vector3d& p = face.vertices[v];
    if (before[v] < -spike_mm || !p.allFinite()) continue;  // noise, or without triangles
    auto& front = fronts[static_cast<std::size_t>((p.z() - low) / band_mm)];
    if (p.y() < front.y()) front = p;
  }
  std::vector<Vector3d> tips;
  for (int i = 0; i < static_cast<int>(fronts.size()); ++i) {
    const auto here = fronts.begin() + i;
    const auto first = fronts.begin() + std::max(0, i - beside);
    const auto last = fronts.begin() + std::min(static_cast<int>(fronts.size()), i + beside + 1);
    const auto front_most = std::min_element(
        first, last, [](const Vector3d& a, const Vector3d& b) { return a.y() < b.y(); });
    if (front_most == here && here->y() < infinity) tips.push_back(*here);
  }
  std::stable_sort(tips.begin(), tips.end(),
                   [](const Vector3d& a, const Vector3d& b) { return a.y() < b.y(); });
  return tips;
}

/// Indices of rims that are openings, given the tip of the nose.
std::vector<std::pair<std::size_t, Kind>> openings_about(const Vector3d& tip,
                                                         std::span<const Rim> rims) {
  std::vector<std::pair<std::size_t, Kind>> found;
  const auto may = [&](const Rim& rim) { return may_be_nostril(rim, rim.middle - tip); };
  for (std::size_t i = 0; i < rims.size(); ++i) {
    const Vector3d offset = rims[i].middle - tip;
    if (is_eye(rims[i], offset)) {
      found.emplace_back(i, Kind::eye);
    } else if (may(rims[i])) {
      const bool paired = std::any_of(rims.begin(), rims.end(), [&](const Rim& other) {
        return may(other) && are_pair(rims[i], other, tip);
      });
      if (paired || is_double(rims[i], offset)) found.emplace_back(i, Kind::nostril);
    }
  }
  return found;
}

}  // namespace

std::vector<FaceOpening> find_openings(const TriMesh& face) {
  auto rims = measured_rims(face);
  if (rims.empty()) return {};
  std::vector<std::pair<std::size_t, Kind>> most;
  for (const auto& tip : possible_tips(face))
    if (auto about = openings_about(tip, rims); about.size() > most.size()) most = std::move(about);
  std::vector<FaceOpening> found;
  for (const auto& [i, kind] : most)
    found.push_back({kind, std::move(rims[i].walk), rims[i].middle, rims[i].outward});
  return found;
}

}  // namespace condyle
