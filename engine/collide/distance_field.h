#pragma once

#include <Eigen/Core>
#include <array>
#include <bitset>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/progress.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// A brick is eight spacings wide and takes 3 kB; a surface of A mm^2 needs about A * (2 band + 8
/// spacing) / (8 spacing)^3 of them. At 0.25 mm and a band of 1 mm an arch of crowns takes 10 MB;
/// joints need the same resolution. For smooth bone 0.4 mm suffices (a third of the memory; the
/// error, an eighth of the squared spacing times the curvature, stays below 0.01 mm where the
/// radius is above 4 mm). Whole bones should be given a region: the part that other bodies can
/// approach, enlarged by the band.
struct FieldSettings {
  double spacing_mm = 0.25;   // smallest detail of a tooth's cusps; error grows with its square
  double band_mm = 1.0;       // distances are stored up to this value on both sides of the surface
  std::optional<Box> region;  // the field is limited to this box (body coordinates)
};

/// Distance at a point. `known` is false well beyond the band, outside the region and where the
/// side is ambiguous (behind the rim of an open surface, at self-intersections).
struct FieldSample {
  double distance_mm = 0;  // negative inside
  Eigen::Vector3d gradient =
      Eigen::Vector3d::Zero();  // of the interpolated distance; length about 1
  bool known = false;
};

/// Signed distance of a surface in a narrow band, sampled on a grid in sparse bricks of 8 x 8 x 8
/// cells, trilinear in between. Samples are exact: the nearest triangle of each shell, with the
/// sign of its pseudonormal. Closed shells count as their union, cavities are filled. Open shells
/// are solid behind their faces as far as the band reaches, and have no inside where their rim is
/// nearest; the cells where that changes are not `known`. Queries are const and thread-safe.
class DistanceField {
 public:
  /// The mesh must be welded, with valid indices and finite coordinates. Deterministic:
  /// bit-identical for any number of threads.
  DistanceField(const TriMesh& mesh, const FieldSettings& settings, int threads = 1,
                const Progress& progress = {});

  /// The field of a piece of a mesh that was cut, on the grid and with the settings of the uncut
  /// mesh's field. What the cut left as it was is copied, bit for bit.
  DistanceField(const TriMesh& piece, const TriMesh& uncut, const DistanceField& uncut_field,
                int threads = 1, const Progress& progress = {});

  FieldSample at(const Eigen::Vector3d& p) const;

  /// The same query in two parts, for callers that need few gradients.
  struct Spot {
    double distance_mm = 0;
    bool known = false;
    const float* corner = nullptr;  // null: no gradient
    double a = 0, b = 0, c = 0;     // within its cell
  };
  Spot spot(const Eigen::Vector3d& p) const;
  Eigen::Vector3d gradient(const Spot& spot) const;

  /// Batch16 points about a middle, and how their coordinates lie in the field's: R_F takes one
  /// into the other, in floats.
  struct Batch16 {
    alignas(64) std::array<float, 16> x, y, z;
  };
  /// The distances that spot() gives for all of them, to 1e-4 mm, in a quarter of the time.
  /// `middle_F`: their centre. Returns a bit for each known point; the distances of the others are
  /// undefined. Bit-identical on every processor.
  unsigned distances(const Batch16& points, const Eigen::Matrix3f& R_F,
                     const Eigen::Vector3d& middle_F, std::array<float, 16>& distance_mm) const;

  /// Lower bound of the signed distance at p, near or far; infinite outside the region.
  double lower_bound(const Eigen::Vector3d& p) const;

  const FieldSettings& settings() const { return settings_; }
  std::size_t brick_count() const { return bricks_.size(); }
  std::size_t memory_bytes() const;
  /// Hash of all samples.
  std::uint64_t hash() const;
  /// Of the place and size of the grid.
  std::uint64_t grid_hash() const;

  /// Binary form of the field with a checksum; `from_bytes` returns nothing when the data are
  /// damaged or carry another name.
  std::string to_bytes(std::uint64_t name) const;
  static std::optional<DistanceField> from_bytes(std::string_view bytes, std::uint64_t name,
                                                 const FieldSettings& settings);

  static constexpr int cells = 8;  // along an edge of a brick
  static constexpr int corners = cells + 1;

 private:
  DistanceField() = default;
  struct Brick {
    std::array<float, corners * corners * corners> value;  // x fastest
    std::bitset<cells * cells * cells> unknown;  // cells across which the sign is discontinuous
  };
  std::size_t slot(int x, int y, int z) const {
    return x + size_[0] * (y + std::size_t(size_[1]) * z);
  }
  void lay_out(const TriMesh& mesh);
  static void mark_unknown(Brick& brick, double spacing_mm);
  void find_whole();

  friend class FieldBuilder;

  FieldSettings settings_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();  // corner of the first brick
  double per_mm_ = 0;                                 // 1 / spacing
  std::array<int, 3> size_ = {0, 0, 0};               // of the grid, in bricks
  std::vector<std::int32_t> brick_;  // per grid position: its brick or -1; x fastest
  std::vector<float> bound_;  // of each place: lower bound of the distance at its centre; where
                              // below zero without a brick: wholly inside
  std::vector<Brick> bricks_;
  std::vector<std::int32_t> whole_;  // as brick_, but -1 where a brick has unknown cells
};

/// Inline because sliding contact evaluates it some hundred thousand times per frame.
inline DistanceField::Spot DistanceField::spot(const Eigen::Vector3d& p) const {
  Spot spot;
  spot.distance_mm = settings_.band_mm;
  const double ux = (p.x() - origin_.x()) * per_mm_, uy = (p.y() - origin_.y()) * per_mm_,
               uz = (p.z() - origin_.z()) * per_mm_;
  if (!(ux >= 0 && uy >= 0 && uz >= 0 && ux < cells * size_[0] && uy < cells * size_[1] &&
        uz < cells * size_[2]))
    return spot;
  const auto x = static_cast<std::uint32_t>(static_cast<std::int32_t>(ux)),
             y = static_cast<std::uint32_t>(static_cast<std::int32_t>(uy)),
             z = static_cast<std::uint32_t>(static_cast<std::int32_t>(uz));
  const std::size_t place =
      slot(static_cast<int>(x / cells), static_cast<int>(y / cells), static_cast<int>(z / cells));
  const std::int32_t index = brick_[place];
  if (index < 0) {
    if (bound_[place] < 0) spot.distance_mm = -settings_.band_mm;
    return spot;
  }
  const Brick& brick = bricks_[static_cast<std::size_t>(index)];
  const std::uint32_t i = x % cells, j = y % cells, k = z % cells;
  const float* v = &brick.value[i + corners * (j + corners * k)];
  constexpr int dy = corners, dz = corners * corners;
  spot.corner = v;
  spot.a = ux - x;
  spot.b = uy - y;
  spot.c = uz - z;
  // Along x on the four edges, then y, then z.
  const double v00 = v[0] + spot.a * (v[1] - v[0]), v10 = v[dy] + spot.a * (v[dy + 1] - v[dy]),
               v01 = v[dz] + spot.a * (v[dz + 1] - v[dz]),
               v11 = v[dz + dy] + spot.a * (v[dz + dy + 1] - v[dz + dy]);
  const double v0 = v00 + spot.b * (v10 - v00), v1 = v01 + spot.b * (v11 - v01);
  spot.distance_mm = v0 + spot.c * (v1 - v0);
  spot.known = !brick.unknown[i + cells * (j + cells * k)];
  return spot;
}

inline Eigen::Vector3d DistanceField::gradient(const Spot& spot) const {
  const float* v = spot.corner;
  if (!v) return Eigen::Vector3d::Zero();
  constexpr int dy = corners, dz = corners * corners;
  const double s00 = v[1] - v[0], s10 = v[dy + 1] - v[dy], s01 = v[dz + 1] - v[dz],
               s11 = v[dz + dy + 1] - v[dz + dy];
  const double v00 = v[0] + spot.a * s00, v10 = v[dy] + spot.a * s10, v01 = v[dz] + spot.a * s01,
               v11 = v[dz + dy] + spot.a * s11;
  const double s0 = s00 + spot.b * (s10 - s00), s1 = s01 + spot.b * (s11 - s01);
  return {per_mm_ * (s0 + spot.c * (s1 - s0)),
          per_mm_ * ((v10 - v00) + spot.c * ((v11 - v01) - (v10 - v00))),
          per_mm_ * (v01 + spot.b * (v11 - v01) - (v00 + spot.b * (v10 - v00)))};
}

inline FieldSample DistanceField::at(const Eigen::Vector3d& p) const {
  const Spot here = spot(p);
  return {here.distance_mm, gradient(here), here.known};
}

/// The field from a cache folder, stored under the hash of mesh and settings; computed and stored
/// when it is absent or damaged. Failure to write the cache is not an error.
DistanceField cached_field(const std::filesystem::path& cache, const TriMesh& mesh,
                           const FieldSettings& settings, int threads = 1,
                           const Progress& progress = {});

/// The same of a piece of a mesh that was cut; see DistanceField.
DistanceField cached_piece_field(const std::filesystem::path& cache, const TriMesh& piece,
                                 const TriMesh& uncut, const DistanceField& uncut_field,
                                 int threads = 1, const Progress& progress = {});

}  // namespace condyle
