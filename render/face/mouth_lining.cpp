#include "render/face/mouth_lining.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "engine/math/smooth_step.h"
#include "engine/mesh/rims.h"
#include "engine/mesh/slit_seam.h"
#include "render/face/mouth_space.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int rings = 24;
constexpr double throat_narrower = 0.5;  // relative to the width
constexpr double palate_fraction = 0.8;  // of half the width of the mouth

std::vector<Vector3d> vertices_of(std::span<const Part> parts, Role role) {
  std::vector<Vector3d> all;
  for (const auto& part : parts)
    if (part.role == role)
      all.insert(all.end(), part.mesh.vertices.begin(), part.mesh.vertices.end());
  return all;
}

Eigen::AlignedBox3d box_of(std::span<const Vector3d> places) {
  Eigen::AlignedBox3d box;
  for (const auto& p : places) box.extend(p);
  return box;
}

/// The rim between the lips: it lies around the front of the teeth.
std::vector<int> mouth_rim(const TriMesh& face, const Eigen::AlignedBox3d& teeth) {
  constexpr double near_mm = 15, narrowest_mm = 20;
  for (auto& rim : rims_of(face)) {
    if (rim.size() <= 8) continue;
    Eigen::AlignedBox3d box;
    for (const int v : rim) box.extend(face.vertices[static_cast<std::size_t>(v)]);
    const Vector3d middle = box.center();
    if (std::abs(middle.x() - teeth.center().x()) < near_mm && box.sizes().x() > narrowest_mm &&
        middle.z() > teeth.min().z() && middle.z() < teeth.max().z() &&
        std::abs(middle.y() - teeth.min().y()) < near_mm)
      return std::move(rim);
  }
  return {};
}

/// The bone of a jaw at the position of its teeth: anterior, near the level of the lips.
std::vector<Vector3d> front_of(std::vector<Vector3d> bone, double lips_z, double middle_x) {
  constexpr double near_lips_mm = 12, beside_mm = 36, arch_mm = 45;
  std::erase_if(bone, [&](const Vector3d& v) {
    return std::abs(v.z() - lips_z) > near_lips_mm || std::abs(v.x() - middle_x) > beside_mm;
  });
  const double back = box_of(bone).min().y() + arch_mm;
  std::erase_if(bone, [&](const Vector3d& v) { return v.y() > back; });
  return bone;
}

/// Vertices of both dental arches, or of the jaws' fronts where teeth are not separate parts; empty
/// if either is missing.
std::vector<Vector3d> find_arches(std::span<const Part> parts, const TriMesh& face) {
  auto upper = vertices_of(parts, Role::upper_teeth), lower = vertices_of(parts, Role::lower_teeth);
  if (upper.empty() || lower.empty()) {
    const auto mandible = vertices_of(parts, Role::mandible);
    if (mandible.empty()) return {};
    const auto jaw = box_of(mandible);
    const auto rim = mouth_rim(face, jaw);
    if (rim.empty()) return {};
    Eigen::AlignedBox3d lips;
    for (const int v : rim) lips.extend(face.vertices[static_cast<std::size_t>(v)]);
    const auto front = [&](std::vector<Vector3d> bone) {
      return front_of(std::move(bone), lips.center().z(), jaw.center().x());
    };
    if (upper.empty()) upper = front(vertices_of(parts, Role::maxilla));
    if (upper.empty()) upper = front(vertices_of(parts, Role::skull));
    if (lower.empty()) lower = front(mandible);
    if (upper.empty() || lower.empty()) return {};
  }
  upper.insert(upper.end(), lower.begin(), lower.end());
  return upper;
}

/// Position of a rim vertex: -1 at one corner of the mouth, 1 at the other; and which lip it is on.
struct RimPoint {
  double across;
  bool upper;
};

/// Of each vertex of a rim: how far the triangles beside it lie above it, mm.
std::vector<double> heights_beside(const TriMesh& face, const std::vector<int>& rim) {
  std::unordered_map<int, std::size_t> place;
  for (std::size_t i = 0; i < rim.size(); ++i) place.emplace(rim[i], i);
  std::vector<double> above(rim.size(), 0);
  for (const auto& t : face.triangles)
    for (const int v : t)
      if (const auto at = place.find(v); at != place.end())
        for (const int other : t)
          above[at->second] += face.vertices[static_cast<std::size_t>(other)].z() -
                               face.vertices[static_cast<std::size_t>(v)].z();
  return above;
}

std::vector<RimPoint> rim_points(const TriMesh& face, const std::vector<int>& rim) {
  constexpr double apart_mm =
      0.5;  // lips that are nearer are distinguished by the skin beside them
  const std::vector<double> beside = heights_beside(face, rim);
  const auto n = rim.size();
  const auto place = [&](std::size_t i) -> const Vector3d& {
    return face.vertices[static_cast<std::size_t>(rim[i % n])];
  };
  std::size_t right = 0, left = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (place(i).x() < place(right).x()) right = i;
    if (place(i).x() > place(left).x()) left = i;
  }
  std::vector<RimPoint> places(n);
  struct Lip {
    double height, beside;  // mean, mm; sum over its triangles
  };
  const auto walk = [&](std::size_t from, std::size_t to, double start) {
    const std::size_t count = (to + n - from) % n;
    double length = 0;
    Lip lip{};
    for (std::size_t k = 0; k < count; ++k) {
      length += (place(from + k + 1) - place(from + k)).norm();
      lip.height += place(from + k).z() / static_cast<double>(count);
      lip.beside += beside[(from + k) % n];
    }
    double gone = 0;
    for (std::size_t k = 0; k < count; ++k) {
      places[(from + k) % n] = {start - 2 * start * gone / length, false};
      gone += (place(from + k + 1) - place(from + k)).norm();
    }
    return lip;
  };
  const Lip there = walk(right, left, -1), back = walk(left, right, 1);
  const bool there_is_upper = std::abs(there.height - back.height) > apart_mm
                                  ? there.height > back.height
                                  : there.beside > back.beside;
  for (std::size_t k = 0; k < n; ++k)
    places[k].upper = ((k + n - right) % n < (left + n - right) % n) == there_is_upper;
  return places;
}

void add_triangles(MouthLining& lining) {
  const int n = static_cast<int>(lining.rim.size());
  const auto at = [&](int ring, int i) { return ring * n + i % n; };
  for (int i = 0; i < n; ++i) {
    for (int ring = 0; ring < rings; ++ring) {
      lining.triangles.emplace_back(at(ring, i), at(ring, i + 1), at(ring + 1, i + 1));
      lining.triangles.emplace_back(at(ring, i), at(ring + 1, i + 1), at(ring + 1, i));
    }
    lining.triangles.emplace_back(at(rings, i), at(rings, i + 1), (rings + 1) * n);
  }
}

/// Smooths heights of neighbouring rings and columns, except at the lips and the throat: mucosa
/// leaves the crowns along an even line.
void even_out(std::vector<Vector3f>& places, std::size_t around) {
  constexpr int rounds = 6;
  constexpr std::size_t from = 3;  // first ring, counted from the lips
  for (int round = 0; round < rounds; ++round) {
    const auto before = places;
    for (std::size_t ring = from; ring < rings; ++ring)
      for (std::size_t i = 0; i < around; ++i) {
        const auto z = [&](std::size_t r, std::size_t k) {
          return before[r * around + k % around].z();
        };
        places[ring * around + i].z() =
            0.5f * z(ring, i) +
            0.125f * (z(ring - 1, i) + z(ring + 1, i) + z(ring, i + 1) + z(ring, i + around - 1));
      }
  }
}

/// Smooths neighbours around a rim.
void draw_together(std::vector<Vector3f>& places) {
  constexpr int rounds = 12;
  const std::size_t n = places.size();
  for (int round = 0; round < rounds; ++round) {
    const auto before = places;
    for (std::size_t i = 0; i < n; ++i)
      places[i] = 0.5f * before[i] + 0.25f * (before[(i + 1) % n] + before[(i + n - 1) % n]);
  }
}

/// Rim, whether it is a cut, and the displayed triangles of the face; no rim if there is none.
MouthLining lining_at_rim(const TriMesh& face, const Eigen::AlignedBox3d& teeth) {
  constexpr double beside_mm = 45;  // from the centre of the teeth
  MouthLining lining;
  lining.rim = mouth_rim(face, teeth);
  if (lining.rim.empty()) return lining;
  TriMesh shown{
      face.vertices, without_deep_inside(face, lining.rim, teeth.center(), beside_mm), {}};
  auto rim = mouth_rim(shown, teeth);
  lining.cut = !rim.empty() && shown.triangles.size() < face.triangles.size();
  if (lining.cut) {
    lining.rim = std::move(rim);
    lining.face = std::move(shown.triangles);
  } else {
    lining.face = face.triangles;
  }
  return lining;
}

/// Height of the closed lips at the corners of the mouth; without corners, `otherwise`.
double lips_height(const TriMesh& face, std::span<const int> rim, std::span<const RimPoint> places,
                   double otherwise) {
  constexpr double corner = 0.7;
  double sum = 0, found = 0;
  for (std::size_t i = 0; i < rim.size(); ++i)
    if (std::abs(places[i].across) > corner) {
      sum += face.vertices[static_cast<std::size_t>(rim[i])].z();
      ++found;
    }
  return found > 0 ? sum / found : otherwise;
}

/// Start of the lining at each vertex of the rim.
std::vector<Vector3f> starts_of(const TriMesh& face, const MouthLining& lining) {
  std::vector<Vector3f> starts;
  starts.reserve(lining.rim.size());
  for (const int v : lining.rim)
    starts.push_back(face.vertices[static_cast<std::size_t>(v)].cast<float>());
  if (lining.cut) draw_together(starts);
  return starts;
}

/// Distance from the rim over which the lining rises to where the cheek meets the jaw, mm, and over
/// which it follows the lip: it rises in front of the first crown, however near, and leaves the lip
/// there. Below the corners it descends over twice the distance: a smile thins the cheek there, and
/// the lining would pierce it.
struct Rise {
  double rises_mm, leaves_mm;
};

Rise rise_from(const Vector3d& start, const RimPoint& place, double fornix,
               const MouthSpace& space) {
  const double to_throat = space.throat_y - start.y();
  constexpr double corner_from = 0.5, corner_to = 0.9;  // of half the width of the mouth
  double fraction = 0.1;
  if (!place.upper)
    fraction *= 1 + smooth_step((std::abs(place.across) - corner_from) / (corner_to - corner_from));
  Rise rise = {fraction * to_throat, 0.35 * to_throat};
  for (double up = 0; place.upper && up < rise.rises_mm; up += 0.5)
    if (space.bone.at(start.x(), start.y() + up) < fornix) {
      rise.rises_mm = std::max(1.0, up - MouthSpace::within_mm);
      rise.leaves_mm = 2 * rise.rises_mm;
    }
  return rise;
}

/// Height of the lining's roof along the path back from an upper lip: up to the fornix, within gums
/// and crowns, under the palate, down the soft palate. Queried from front to back.
class Roof {
 public:
  Roof(const MouthSpace& space, double across) : space_(space), across_(across) {}
  double at(double x, double y, double fornix) {
    const double hit = space_.bone.at(x, y);
    if (hit < fornix) behind_teeth_ = true;
    if (!behind_teeth_ || std::abs(across_) >= palate_fraction)
      return std::min(fornix, hit + space_.above.at(y, hit));
    if (hit < space_.mid_z + MouthSpace::highest_palate_mm &&
        (y < space_.soft.begin_y || hit < bone_z_ + 4)) {
      bone_z_ = hit + space_.above.at(y, hit);
      bone_y_ = y;
    }
    return bone_z_ + smooth_step((y - bone_y_) / 6) * (space_.soft.at(y) - bone_z_);
  }

 private:
  const MouthSpace& space_;
  double across_;
  bool behind_teeth_ = false;
  double bone_z_ = 0, bone_y_ = 0;  // position of the last bone above
};

/// How far a place is the back of a resting tongue, 0 to 1: between the lower crowns, from behind
/// the incisors to the throat.
double tongue_at(double x, double y, const MouthSpace& space) {
  constexpr double behind_edges_mm = 9, tip_mm = 14, root_mm = 20, beside_mm = 10;
  const double half = space.width.at(y) - beside_mm;
  const double aside = (x - space.teeth.center().x()) / half;
  if (half <= 0 || std::abs(aside) >= 1) return 0;
  const double from_tip = y - space.teeth.min().y() - behind_edges_mm;
  return std::sqrt(1 - aside * aside) * std::sqrt(smooth_step(from_tip / tip_mm)) *
         smooth_step((space.throat_y - y) / root_mm);
}

/// The vertices of each ring behind the i-th vertex of the rim.
void lay_column(MouthLining& lining, std::size_t i, const Vector3d& start, const RimPoint& place,
                const MouthSpace& space) {
  const auto [across, is_upper] = place;
  const auto& teeth = space.teeth;
  // A lip that ends at its edge is thin: the lining leaves it backward before it turns aside.
  const double turned = lining.cut ? 0.35 : 0;
  // Round at the sides, except where the rim is.
  const double turn = std::sqrt(std::max(0.0, 1 - std::pow(across, 20)));
  const double fornix =
      space.mid_z + (is_upper ? MouthSpace::fornix_up_mm : -MouthSpace::fornix_down_mm);
  const auto [rises_mm, leaves_mm] = rise_from(start, place, fornix, space);
  Roof roof(space, across);
  for (int ring = 0; ring <= rings; ++ring) {
    const std::size_t v = static_cast<std::size_t>(ring) * lining.rim.size() + i;
    const double t = std::pow(static_cast<double>(ring) / rings, 1.4);
    const double y = start.y() + t * (space.throat_y - start.y());
    const double half =
        space.width.at(y) * (1 - throat_narrower * smooth_step((y - teeth.max().y() + 3) / 12));
    const double x =
        start.x() + smooth_step(4 * t) * (teeth.center().x() + across * half - start.x());
    double z = is_upper ? roof.at(x, y, fornix) : fornix;
    if (!is_upper && space.tongueless) {
      const double tongue = turn * tongue_at(x, y, space);
      z += tongue * (MouthSpace::fornix_down_mm - MouthSpace::tongue_down_mm);
      lining.tongue[v] = static_cast<float>(tongue);
    }
    z = space.mid_z + turn * (z - space.mid_z);
    const double in = ring == 0 ? 0 : smooth_step(turned + (y - start.y()) / rises_mm);
    lining.rest[v] = Vector3d(x, y, start.z() + in * (z - start.z())).cast<float>();
    lining.jaw[v] = static_cast<float>(is_upper ? 0.5 - 0.5 * turn : 0.5 + 0.5 * turn);
    lining.lip[v] = static_cast<float>(1 - smooth_step((y - start.y()) / leaves_mm));
  }
}

/// The centre of the last ring, which closes the throat.
void add_throat(MouthLining& lining) {
  const auto n = lining.rim.size();
  Vector3d middle = Vector3d::Zero();
  for (std::size_t i = 0; i < n; ++i)
    middle += lining.rest[static_cast<std::size_t>(rings) * n + i].cast<double>() /
              static_cast<double>(n);
  lining.rest.back() = middle.cast<float>();
  lining.jaw.back() = 0.5f;
}

}  // namespace

std::optional<MouthLining> line_mouth(std::span<const Part> parts, const TriMesh* drawn) {
  const auto part =
      std::find_if(parts.begin(), parts.end(), [](const Part& p) { return p.role == Role::face; });
  if (part == parts.end()) return std::nullopt;
  const TriMesh& face = drawn ? *drawn : part->mesh;
  const auto arches = find_arches(parts, face);
  if (arches.empty()) return std::nullopt;
  const auto teeth = box_of(arches);
  constexpr double widest_mouth_mm = 300;  // larger extents are due to stray vertices
  if (teeth.sizes().maxCoeff() > widest_mouth_mm) return std::nullopt;
  MouthLining lining = lining_at_rim(face, teeth);
  if (lining.rim.empty()) return std::nullopt;
  const auto places = rim_points(face, lining.rim);
  const double mid = lips_height(face, lining.rim, places, teeth.center().z());
  lining.mid_z = static_cast<float>(mid);
  const MouthSpace space(parts, arches, mid);

  const auto n = lining.rim.size();
  lining.rest.resize((rings + 1) * n + 1);
  lining.jaw.resize(lining.rest.size());
  lining.lip.resize(lining.rest.size());
  lining.tongue.assign(lining.rest.size(), 0);
  const auto starts = starts_of(face, lining);
  for (std::size_t i = 0; i < n; ++i)
    lay_column(lining, i, starts[i].cast<double>(), places[i], space);
  add_throat(lining);
  if (space.above.bare()) even_out(lining.rest, n);
  add_triangles(lining);
  return lining;
}

void even_rim(std::vector<Vector3f>& places, std::span<const int> rim) {
  std::vector<Vector3f> own;
  own.reserve(rim.size());
  for (const int v : rim) own.push_back(places[static_cast<std::size_t>(v)]);
  draw_together(own);
  for (std::size_t i = 0; i < rim.size(); ++i) places[static_cast<std::size_t>(rim[i])] = own[i];
}

std::vector<Vector3f> places_now(const MouthLining& lining, std::span<const Vector3f> rim,
                                 const Pose& X_CM) {
  const std::size_t n = lining.rim.size();
  std::vector<Vector3f> now(lining.rest.size()), rim_shift(n);
  for (std::size_t v = 0; v < now.size(); ++v) {
    const Vector3f with_jaw = (X_CM * lining.rest[v].cast<double>()).cast<float>();
    now[v] = lining.rest[v] + lining.jaw[v] * (with_jaw - lining.rest[v]);
    if (v < n) {
      rim_shift[v] = rim[v] - now[v];
      now[v] = rim[v];
      continue;
    }
    // Lips that come forward leave the lining behind them on the arches; it would pierce the skin.
    Vector3f shift = rim_shift[v % n];
    shift.y() = std::max(0.0f, shift.y());
    now[v] += lining.lip[v] * shift;
  }
  return now;
}

std::vector<Eigen::Vector3i> rim_fan(const MouthLining& lining) {
  std::vector<Eigen::Vector3i> fan;
  for (std::size_t i = 1; i + 1 < lining.rim.size(); ++i)
    fan.emplace_back(lining.rim[0], lining.rim[i], lining.rim[i + 1]);
  return fan;
}

}  // namespace condyle
