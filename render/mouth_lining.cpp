#include "render/mouth_lining.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/mesh/rims.h"
#include "engine/mesh/slit_seam.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int rings = 24;
// From the line of the lips to where the cheek turns to the jaws.
constexpr double fornix_up_mm = 11.5, fornix_down_mm = 13;
constexpr double behind_teeth_mm = 1.6;     // from teeth to the cheek
constexpr double throat_mm = 18;            // from the last tooth on
constexpr double throat_narrower = 0.5;     // by this share of the width
constexpr double within_mm = 1.5;           // what is seen stands before the lining by so much
constexpr double within_crowns_mm = 5;      // of a bone that has them, with their cusps and pits
constexpr double gum_mm = 1;                // of a palate without gums of its own
constexpr double palate_mm = 32;            // above the line of the lips, at most
constexpr double palate_share = 0.8;        // of the mouth's half width
constexpr double soft_palate_slope = 0.85;  // down over back, behind the bone

double smooth(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

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

/// The rim between the lips: it stands about the front of the teeth.
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

/// Of a jaw's bone what stands where its teeth would: in front, near the level of the lips.
std::vector<Vector3d> front_of(std::vector<Vector3d> bone, double lips_z, double middle_x) {
  constexpr double near_lips_mm = 12, beside_mm = 36, arch_mm = 45;
  std::erase_if(bone, [&](const Vector3d& v) {
    return std::abs(v.z() - lips_z) > near_lips_mm || std::abs(v.x() - middle_x) > beside_mm;
  });
  const double back = box_of(bone).min().y() + arch_mm;
  std::erase_if(bone, [&](const Vector3d& v) { return v.y() > back; });
  return bone;
}

/// Vertices of both dental arches, or of the jaws' fronts where teeth are no parts of their own;
/// none if either is missing.
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

/// Height of the lowest surface above a level, seen from below, on a grid in plan.
class Ceiling {
 public:
  Ceiling(std::span<const Part> parts, const Eigen::AlignedBox3d& region, double above)
      : low_(region.min().head<2>()), above_(above) {
    const Eigen::Vector2d size = region.sizes().head<2>();
    columns_ = static_cast<int>(size.x() / cell_mm) + 2;
    rows_ = static_cast<int>(size.y() / cell_mm) + 2;
    heights_.assign(static_cast<std::size_t>(columns_ * rows_), none);
    for (const auto& part : parts)
      if (part.role == Role::skull || part.role == Role::maxilla || part.role == Role::upper_gums)
        for (const auto& t : part.mesh.triangles)
          add(part.mesh.vertices[static_cast<std::size_t>(t[0])],
              part.mesh.vertices[static_cast<std::size_t>(t[1])],
              part.mesh.vertices[static_cast<std::size_t>(t[2])]);
  }

  static constexpr double none = std::numeric_limits<double>::infinity();
  double at(double x, double y) const {
    const int c = static_cast<int>(std::lround((x - low_.x()) / cell_mm)),
              r = static_cast<int>(std::lround((y - low_.y()) / cell_mm));
    if (c < 0 || r < 0 || c >= columns_ || r >= rows_) return none;
    return heights_[static_cast<std::size_t>(r * columns_ + c)];
  }

 private:
  static constexpr double cell_mm = 0.5;

  void add(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    if (std::max({a.z(), b.z(), c.z()}) < above_) return;
    const Eigen::Matrix2d sides =
        (Eigen::Matrix2d() << (b - a).head<2>(), (c - a).head<2>()).finished();
    if (std::abs(sides.determinant()) < 1e-9) return;
    const Eigen::Matrix2d to_shares = sides.inverse();
    const auto within = [&](double cell, int k) {
      return static_cast<int>(
          std::clamp(cell, -1.0, static_cast<double>(k == 0 ? columns_ : rows_)));
    };
    const auto first = [&](double v, int k) {
      return std::max(0, within(std::ceil((v - low_[k]) / cell_mm), k));
    };
    const auto last = [&](double v, int k) {
      return std::min((k == 0 ? columns_ : rows_) - 1,
                      within(std::floor((v - low_[k]) / cell_mm), k));
    };
    for (int r = first(std::min({a.y(), b.y(), c.y()}), 1);
         r <= last(std::max({a.y(), b.y(), c.y()}), 1); ++r)
      for (int k = first(std::min({a.x(), b.x(), c.x()}), 0);
           k <= last(std::max({a.x(), b.x(), c.x()}), 0); ++k) {
        const Eigen::Vector2d share =
            to_shares * (low_ + cell_mm * Eigen::Vector2d(k, r) - a.head<2>());
        if (share.minCoeff() < -1e-9 || share.sum() > 1 + 1e-9) continue;
        const double z = a.z() + share.x() * (b - a).z() + share.y() * (c - a).z();
        double& kept = heights_[static_cast<std::size_t>(r * columns_ + k)];
        if (z > above_) kept = std::min(kept, z);
      }
  }

  Eigen::Vector2d low_;
  double above_;
  int columns_ = 0, rows_ = 0;
  std::vector<double> heights_;
};

/// From the lowest surface above up to the lining: it lies within gums and crowns, but covers a
/// palate that is bare bone. Crowns are what is hardly above the lowest of its row: the arch rises
/// to the back.
class Above {
 public:
  Above(std::span<const Part> parts, const Ceiling& bone, const Eigen::AlignedBox3d& region,
        double mid)
      : bare_(std::none_of(parts.begin(), parts.end(),
                           [](const Part& part) { return part.role == Role::upper_gums; })),
        front_(region.min().y()) {
    constexpr double arch_mm = 9;  // above the line of the lips, at most
    const auto rows = static_cast<std::size_t>(region.sizes().y() / row_mm) + 1;
    std::vector<double> lowest(rows, Ceiling::none);
    for (std::size_t r = 0; r < rows; ++r)
      for (double x = region.min().x(); x < region.max().x(); x += 0.5)
        lowest[r] = std::min(lowest[r], bone.at(x, front_ + static_cast<double>(r) * row_mm));
    constexpr std::size_t gap = 3;  // rows: between two teeth
    for (std::size_t r = 0; r < rows; ++r) {
      const auto first = lowest.begin() + static_cast<std::ptrdiff_t>(r - std::min(r, gap));
      const auto last = lowest.begin() + static_cast<std::ptrdiff_t>(std::min(r + gap + 1, rows));
      const double z = *std::min_element(first, last);
      lowest_.push_back(z < mid + arch_mm ? z : -Ceiling::none);
    }
  }
  bool bare() const { return bare_; }
  double at(double y, double surface_z) const {
    constexpr double crowns_mm = 2.5, to_palate_mm = 2.5;
    if (!bare_) return within_mm;
    const double row =
        std::clamp((y - front_) / row_mm, 0.0, static_cast<double>(lowest_.size() - 1));
    const double palate =
        smooth((surface_z - lowest_[static_cast<std::size_t>(row)] - crowns_mm) / to_palate_mm);
    return within_crowns_mm - palate * (within_crowns_mm + gum_mm);
  }

 private:
  static constexpr double row_mm = 1;
  bool bare_;
  double front_;
  std::vector<double> lowest_;
};

/// The soft palate goes on where the bone ends, down to the throat.
struct SoftPalate {
  double begin_y, begin_z, lowest_z;
  double at(double y) const {
    return std::max(lowest_z, begin_z - soft_palate_slope * std::max(0.0, y - begin_y));
  }
};

SoftPalate soft_palate(const Ceiling& bone, const Above& above, const Eigen::AlignedBox3d& teeth,
                       double mid) {
  SoftPalate soft = {teeth.max().y(), mid + fornix_up_mm, mid + 4};
  bool found = false;
  for (double y = teeth.min().y(); y < teeth.max().y() + throat_mm; y += 0.5) {
    const double z = bone.at(teeth.center().x(), y);
    // Where mucosa ends before its bone, too.
    const bool steps_up = found && y > teeth.max().y() && z > soft.begin_z;
    if (z < mid + palate_mm && !steps_up) {
      soft.begin_y = y;
      soft.begin_z = z + above.at(y, z);
      found = true;
    } else if (found) {
      break;
    }
  }
  return soft;
}

/// Half the mouth's width by the way back, from the teeth: it never narrows.
class Width {
 public:
  Width(std::span<const Vector3d> arches, const Eigen::AlignedBox3d& teeth)
      : front_(teeth.min().y()) {
    half_.assign(static_cast<std::size_t>(teeth.sizes().y()) + 1, 0);
    for (const auto& v : arches) {
      double& half = half_[static_cast<std::size_t>(v.y() - front_)];
      half = std::max(half, std::abs(v.x() - teeth.center().x()));
    }
    for (std::size_t i = 1; i < half_.size(); ++i) half_[i] = std::max(half_[i], half_[i - 1]);
  }
  double at(double y) const {
    const auto i = static_cast<std::size_t>(std::max(0.0, y - front_));
    return half_[std::min(i, half_.size() - 1)] + behind_teeth_mm;
  }

 private:
  double front_;
  std::vector<double> half_;
};

/// Of a rim's vertex: -1 at one corner of the mouth, 1 at the other; and which lip it is on.
struct RimPlace {
  double across;
  bool upper;
};

std::vector<RimPlace> rim_places(const TriMesh& face, const std::vector<int>& rim) {
  const auto n = rim.size();
  const auto place = [&](std::size_t i) -> const Vector3d& {
    return face.vertices[static_cast<std::size_t>(rim[i % n])];
  };
  std::size_t right = 0, left = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (place(i).x() < place(right).x()) right = i;
    if (place(i).x() > place(left).x()) left = i;
  }
  std::vector<RimPlace> places(n);
  const auto walk = [&](std::size_t from, std::size_t to, double start) {
    const std::size_t count = (to + n - from) % n;
    double length = 0, height = 0;
    for (std::size_t k = 0; k < count; ++k) {
      length += (place(from + k + 1) - place(from + k)).norm();
      height += place(from + k).z();
    }
    double gone = 0;
    for (std::size_t k = 0; k < count; ++k) {
      places[(from + k) % n] = {start - 2 * start * gone / length, false};
      gone += (place(from + k + 1) - place(from + k)).norm();
    }
    return height / static_cast<double>(std::max<std::size_t>(count, 1));
  };
  const double there = walk(right, left, -1), back = walk(left, right, 1);
  for (std::size_t k = 0; k < n; ++k)
    places[k].upper = ((k + n - right) % n < (left + n - right) % n) == (there > back);
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

/// Heights of neighbouring rings and columns drawn together, but at the lips and the throat: mucosa
/// leaves crowns along an even line.
void even_out(std::vector<Vector3f>& places, std::size_t around) {
  constexpr int rounds = 6;
  constexpr std::size_t from = 3;  // rings from the lips on
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

/// Neighbours round a rim.
void draw_together(std::vector<Vector3f>& places) {
  constexpr int rounds = 12;
  const std::size_t n = places.size();
  for (int round = 0; round < rounds; ++round) {
    const auto before = places;
    for (std::size_t i = 0; i < n; ++i)
      places[i] = 0.5f * before[i] + 0.25f * (before[(i + 1) % n] + before[(i + n - 1) % n]);
  }
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
  constexpr double widest_mouth_mm = 300;  // what is larger has stray vertices
  if (teeth.sizes().maxCoeff() > widest_mouth_mm) return std::nullopt;
  MouthLining lining;
  lining.rim = mouth_rim(face, teeth);
  if (lining.rim.empty()) return std::nullopt;
  constexpr double beside_mm = 45;  // of the teeth's middle
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
  // A lip that ends at its edge is thin: the lining leaves it to the back before it turns aside.
  const double turned = lining.cut ? 0.35 : 0;
  const auto places = rim_places(face, lining.rim);
  const auto n = lining.rim.size();
  double corners = 0, found = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (std::abs(places[i].across) > 0.7) {
      corners += face.vertices[static_cast<std::size_t>(lining.rim[i])].z();
      ++found;
    }
  const double mid = found > 0 ? corners / found : teeth.center().z();
  lining.mid_z = static_cast<float>(mid);
  auto region = teeth;
  region.extend(teeth.max() + Vector3d(5, throat_mm + 5, 0));
  region.extend(teeth.min() - Vector3d(5, 10, 0));
  const Ceiling bone(parts, region, mid + 1);
  const Above above(parts, bone, region, mid);
  const Width width(arches, teeth);
  const SoftPalate soft = soft_palate(bone, above, teeth, mid);
  const double throat = teeth.max().y() + throat_mm;

  lining.rest.resize((rings + 1) * n + 1);
  lining.jaw.resize(lining.rest.size());
  lining.lip.resize(lining.rest.size());
  std::vector<Vector3f> starts;
  for (const int v : lining.rim)
    starts.push_back(face.vertices[static_cast<std::size_t>(v)].cast<float>());
  if (lining.cut) draw_together(starts);
  Vector3d middle = Vector3d::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3d start = starts[i].cast<double>();
    const auto [across, is_upper] = places[i];
    // Round at the sides, as far as the rim is not.
    const double turn = std::sqrt(std::max(0.0, 1 - std::pow(across, 20)));
    const double fornix = mid + (is_upper ? fornix_up_mm : -fornix_down_mm);
    // It rises before the first crown, however near that stands, and leaves the lip there.
    double rises_mm = 0.1 * (throat - start.y()), leaves_mm = 0.35 * (throat - start.y());
    for (double way = 0; is_upper && way < rises_mm; way += 0.5)
      if (bone.at(start.x(), start.y() + way) < fornix) {
        rises_mm = std::max(1.0, way - within_mm);
        leaves_mm = 2 * rises_mm;
      }
    bool behind_teeth = false;
    double bone_z = 0, bone_y = 0;  // where bone was last above
    for (int ring = 0; ring <= rings; ++ring) {
      const std::size_t v = static_cast<std::size_t>(ring) * n + i;
      const double t = std::pow(static_cast<double>(ring) / rings, 1.4);
      const double y = start.y() + t * (throat - start.y());
      const double half =
          width.at(y) * (1 - throat_narrower * smooth((y - teeth.max().y() + 3) / 12));
      const double x = start.x() + smooth(4 * t) * (teeth.center().x() + across * half - start.x());
      double z = fornix;
      if (is_upper) {
        const double hit = bone.at(x, y);
        if (hit < fornix) behind_teeth = true;
        z = std::min(fornix, hit + above.at(y, hit));
        if (behind_teeth && std::abs(across) < palate_share) {
          if (hit < mid + palate_mm && (y < soft.begin_y || hit < bone_z + 4)) {
            bone_z = hit + above.at(y, hit);
            bone_y = y;
          }
          z = bone_z + smooth((y - bone_y) / 6) * (soft.at(y) - bone_z);
        }
      }
      z = mid + turn * (z - mid);
      const double in = ring == 0 ? 0 : smooth(turned + (y - start.y()) / rises_mm);
      lining.rest[v] = Vector3d(x, y, start.z() + in * (z - start.z())).cast<float>();
      lining.jaw[v] = static_cast<float>(is_upper ? 0.5 - 0.5 * turn : 0.5 + 0.5 * turn);
      lining.lip[v] = static_cast<float>(1 - smooth((y - start.y()) / leaves_mm));
      if (ring == rings) middle += lining.rest[v].cast<double>() / static_cast<double>(n);
    }
  }
  if (above.bare()) even_out(lining.rest, n);
  lining.rest.back() = middle.cast<float>();
  lining.jaw.back() = 0.5f;
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
  std::vector<Vector3f> now(lining.rest.size()), rim_way(n);
  for (std::size_t v = 0; v < now.size(); ++v) {
    const Vector3f with_jaw = (X_CM * lining.rest[v].cast<double>()).cast<float>();
    now[v] = lining.rest[v] + lining.jaw[v] * (with_jaw - lining.rest[v]);
    if (v < n) rim_way[v] = rim[v] - now[v];
    now[v] = v < n ? rim[v] : Vector3f(now[v] + lining.lip[v] * rim_way[v % n]);
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
