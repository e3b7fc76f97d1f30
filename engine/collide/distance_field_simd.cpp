// Distances of sixteen points at once.
#include <algorithm>

#include "engine/collide/distance_field.h"

// The loops below are compiled once for each of these targets; all perform the same operations.
// ThreadSanitizer is not ready when the program chooses a target.
#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__)
#define CONDYLE_FOR_EACH_PROCESSOR __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define CONDYLE_FOR_EACH_PROCESSOR
#endif

namespace condyle {
namespace {

constexpr int at_once = 16;
constexpr int cells = DistanceField::cells, row = DistanceField::corners;

struct Lookup {
  const std::int32_t* whole;
  const float* values;  // of the first brick
  int brick_floats;     // from one brick to the next
  int size[3];          // of the grid, in bricks
  float turn[9];        // rotation from points to cells, by rows
  float middle[3];      // cells
};

CONDYLE_FOR_EACH_PROCESSOR
unsigned look_up(const Lookup& l, const DistanceField::Batch16& points, float* distance) {
  alignas(64) float a[at_once], b[at_once], c[at_once];
  alignas(64) std::int32_t at[at_once], slot[at_once], within[at_once];
  const float end_x = static_cast<float>(cells * l.size[0]),
              end_y = static_cast<float>(cells * l.size[1]),
              end_z = static_cast<float>(cells * l.size[2]);
  const std::int32_t size_x = l.size[0], size_xy = l.size[0] * l.size[1];
  for (int i = 0; i < at_once; ++i) {
    const float px = points.x[i], py = points.y[i], pz = points.z[i];
    const float x = l.middle[0] + (l.turn[0] * px + l.turn[1] * py + l.turn[2] * pz);
    const float y = l.middle[1] + (l.turn[3] * px + l.turn[4] * py + l.turn[5] * pz);
    const float z = l.middle[2] + (l.turn[6] * px + l.turn[7] * py + l.turn[8] * pz);
    // Points outside the grid, and NaN, are moved to a valid cell and masked out.
    const float in_x = std::min(std::max(0.0f, x), end_x - 1),
                in_y = std::min(std::max(0.0f, y), end_y - 1),
                in_z = std::min(std::max(0.0f, z), end_z - 1);
    within[i] = (x >= 0 ? 1 : 0) & (y >= 0 ? 1 : 0) & (z >= 0 ? 1 : 0) & (x < end_x ? 1 : 0) &
                (y < end_y ? 1 : 0) & (z < end_z ? 1 : 0);
    const auto ix = static_cast<std::int32_t>(in_x), iy = static_cast<std::int32_t>(in_y),
               iz = static_cast<std::int32_t>(in_z);
    a[i] = x - static_cast<float>(ix);
    b[i] = y - static_cast<float>(iy);
    c[i] = z - static_cast<float>(iz);
    static_assert(cells == 8);
    slot[i] = (ix >> 3) + size_x * (iy >> 3) + size_xy * (iz >> 3);
    at[i] = (ix & 7) + row * ((iy & 7) + row * (iz & 7));
  }
  unsigned known = 0;
  for (int i = 0; i < at_once; ++i) {
    const std::int32_t brick = l.whole[slot[i]];
    known |= static_cast<unsigned>(within[i] & (brick >= 0 ? 1 : 0)) << i;
    at[i] += std::max(brick, 0) * l.brick_floats;
  }
  constexpr int dy = row, dz = row * row;
  for (int i = 0; i < at_once; ++i) {
    const float* const p = l.values + at[i];
    const float v00 = p[0] + a[i] * (p[1] - p[0]), v10 = p[dy] + a[i] * (p[dy + 1] - p[dy]),
                v01 = p[dz] + a[i] * (p[dz + 1] - p[dz]),
                v11 = p[dz + dy] + a[i] * (p[dz + dy + 1] - p[dz + dy]);
    const float v0 = v00 + b[i] * (v10 - v00), v1 = v01 + b[i] * (v11 - v01);
    distance[i] = v0 + c[i] * (v1 - v0);
  }
  return known;
}

}  // namespace

void DistanceField::find_whole() {
  static_assert(sizeof(Brick) % sizeof(float) == 0);
  whole_ = brick_;
  // Above this the index of a float exceeds 32 bits.
  const auto most = static_cast<std::int64_t>(INT32_MAX / (sizeof(Brick) / sizeof(float))) - 1;
  for (std::int32_t& index : whole_)
    if (index >= most || (index >= 0 && bricks_[static_cast<std::size_t>(index)].unknown.any()))
      index = -1;
}

unsigned DistanceField::distances(const Batch16& points, const Eigen::Matrix3f& R_F,
                                  const Eigen::Vector3d& middle_F,
                                  std::array<float, 16>& distance_mm) const {
  if (bricks_.empty()) return 0;
  Lookup lookup{whole_.data(),
                bricks_[0].value.data(),
                sizeof(Brick) / sizeof(float),
                {size_[0], size_[1], size_[2]},
                {},
                {}};
  const auto scale = static_cast<float>(per_mm_);
  for (int row = 0; row < 3; ++row) {
    for (int k = 0; k < 3; ++k) lookup.turn[3 * row + k] = scale * R_F(row, k);
    lookup.middle[row] = static_cast<float>((middle_F[row] - origin_[row]) * per_mm_);
  }
  return look_up(lookup, points, distance_mm.data());
}

}  // namespace condyle
