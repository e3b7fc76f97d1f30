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

#include "engine/mesh/measure.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

struct FieldSettings {
  double spacing_mm = 0.25;   // smallest detail of a tooth's cusps; error grows with its square
  double band_mm = 1.0;       // distances are kept up to here on both sides of the surface
  std::optional<Box> region;  // the field is made within this box only (body coordinates)
};

/// Distance at a point. `known` is false well beyond the band, outside the region and where the side
/// cannot be told (behind the rim of an open surface, where a surface runs through itself).
struct FieldSample {
  double distance_mm = 0;                              // negative inside
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();  // of the interpolated distance, about unit
  bool known = false;
};

/// Signed distance of a surface in a narrow band, sampled on a grid in sparse bricks of 8 x 8 x 8
/// cells, trilinear in between. Samples are exact: the nearest triangle of each shell, with the
/// sign of its pseudonormal. Closed shells count as their union, cavities are filled. Open shells
/// are solid behind their faces as far as the band reaches, and have no inside where their rim is
/// nearest; the cells where that changes are not `known`. Queries are const and thread-safe.
class DistanceField {
 public:
  /// The mesh must be welded, with valid indices and finite coordinates. Same bits for any number
  /// of threads.
  DistanceField(const TriMesh& mesh, const FieldSettings& settings, int threads = 1);

  FieldSample at(const Eigen::Vector3d& p) const;

  /// No smaller than this is the signed distance at p, near or far; infinite outside the region.
  double lower_bound(const Eigen::Vector3d& p) const;

  const FieldSettings& settings() const { return settings_; }
  std::size_t brick_count() const { return bricks_.size(); }
  std::size_t memory_bytes() const;
  /// Hash of all samples.
  std::uint64_t hash() const;

  /// Bits of the field, sealed by a hash; `from_bytes` gives nothing when they are damaged or were
  /// made under another name.
  std::string to_bytes(std::uint64_t name) const;
  static std::optional<DistanceField> from_bytes(std::string_view bytes, std::uint64_t name,
                                                 const FieldSettings& settings);

  static constexpr int cells = 8;  // along an edge of a brick
  static constexpr int corners = cells + 1;

 private:
  DistanceField() = default;
  struct Brick {
    std::array<float, corners * corners * corners> value;  // x fastest
    std::bitset<cells * cells * cells> unknown;            // cells across which the side jumps
  };
  std::size_t slot(int x, int y, int z) const {
    return static_cast<std::size_t>(x + size_[0] * (y + size_[1] * z));
  }
  void lay_out(const TriMesh& mesh);
  static void mark_unknown(Brick& brick, double spacing_mm);

  friend class FieldBuilder;

  FieldSettings settings_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();  // corner of the first brick
  double per_mm_ = 0;                                 // 1 / spacing
  std::array<int, 3> size_ = {0, 0, 0};               // of the grid, in bricks
  std::vector<std::int32_t> brick_;                   // of each place: its brick or -1; x fastest
  std::vector<float> bound_;  // of each place: lower bound of the distance at its centre; where
                              // below zero without a brick: wholly inside
  std::vector<Brick> bricks_;
};

/// The field kept in a cache folder under the hash of mesh and settings; made and put there when it
/// is absent or damaged. A cache that cannot be written is no error.
DistanceField kept_field(const std::filesystem::path& cache, const TriMesh& mesh,
                         const FieldSettings& settings, int threads = 1);

/// $XDG_CACHE_HOME/condyle, else ~/.cache/condyle; empty when neither is set.
std::filesystem::path field_cache_folder();

}  // namespace condyle
