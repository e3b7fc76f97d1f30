#include "render/shaders/skin_detail.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "engine/core/hash.h"
#include "engine/core/user_cache.h"

namespace condyle {
namespace {

constexpr int detail_side = SkinDetail::side;

/// A random point in each cell of a lattice with period `cells`, in cells from its corner.
class CellPoints {
 public:
  explicit CellPoints(int cells) : cells_(cells) {
    for (int z = 0; z < cells; ++z)
      for (int y = 0; y < cells; ++y)
        for (int x = 0; x < cells; ++x)
          points_.emplace_back(random_of({x, y, z, 0}), random_of({x, y, z, 1}),
                               random_of({x, y, z, 2}));
  }

  int cells() const { return cells_; }
  const Eigen::Vector3f& in(const Eigen::Vector3i& cell) const {
    const auto wrap = [&](int i) { return static_cast<std::size_t>((i + cells_) % cells_); };
    return points_[(wrap(cell.z()) * cells_ + wrap(cell.y())) * cells_ + wrap(cell.x())];
  }

 private:
  /// 0 to 1
  static float random_of(const std::array<int, 4>& key) {
    return static_cast<float>(hash_bytes(key.data(), sizeof key) >> 40) /
           static_cast<float>(1 << 24);
  }

  int cells_;
  std::vector<Eigen::Vector3f> points_;
};

/// Cellular pattern of skin: flat cells with creases between them, at a position from 0 to 1 of the
/// period. source: Worley, A cellular texture basis function, 1996
float cells_height(const Eigen::Vector3f& at, const CellPoints& points) {
  const Eigen::Vector3f place = points.cells() * at;
  const Eigen::Vector3i base = place.array().floor().cast<int>();
  float nearest = std::numeric_limits<float>::infinity(), second = nearest;
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const Eigen::Vector3i cell = base + Eigen::Vector3i(dx, dy, dz);
        const Eigen::Vector3f middle = cell.cast<float>() + points.in(cell);
        const float away = (middle - place).norm();
        if (away < nearest) {
          second = nearest;
          nearest = away;
        } else {
          second = std::min(second, away);
        }
      }
  return std::min((second - nearest) / 0.35f, 1.f);
}

SkinDetail make_skin_detail() {
  const ResultCache results(user_cache_folder(), "skin-detail");
  constexpr std::uint64_t inputs = 0;  // it depends on the program alone
  SkinDetail detail;
  detail.rgba.resize(std::size_t{4} * detail_side * detail_side * detail_side);
  if (const auto bytes = results.read(inputs); bytes && bytes->size() == detail.rgba.size()) {
    std::copy(bytes->begin(), bytes->end(), detail.rgba.begin());
    return detail;
  }
  // Two sizes of cells, neither a multiple of the other.
  const CellPoints large(17), small(26);
  std::vector<float> height(std::size_t{detail_side} * detail_side * detail_side);
  const auto at = [](int x, int y, int z) {
    const auto wrap = [](int i) {
      return static_cast<std::size_t>((i + detail_side) % detail_side);
    };
    return (wrap(z) * detail_side + wrap(y)) * detail_side + wrap(x);
  };
  float mean = 0;
  for (int z = 0; z < detail_side; ++z)
    for (int y = 0; y < detail_side; ++y)
      for (int x = 0; x < detail_side; ++x) {
        const Eigen::Vector3f place =
            Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)) /
            detail_side;
        const float h = 0.6f * cells_height(place, large) + 0.4f * cells_height(place, small);
        height[at(x, y, z)] = h;
        mean += h / static_cast<float>(height.size());
      }
  const auto byte = [](float value) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(128 + 127 * value, 0.f, 255.f)));
  };
  for (int z = 0; z < detail_side; ++z)
    for (int y = 0; y < detail_side; ++y)
      for (int x = 0; x < detail_side; ++x) {
        auto* texel = &detail.rgba[4 * at(x, y, z)];
        texel[0] = byte(height[at(x + 1, y, z)] - height[at(x - 1, y, z)]);
        texel[1] = byte(height[at(x, y + 1, z)] - height[at(x, y - 1, z)]);
        texel[2] = byte(height[at(x, y, z + 1)] - height[at(x, y, z - 1)]);
        texel[3] = byte(height[at(x, y, z)] - mean);
      }
  results.write(inputs, std::string(detail.rgba.begin(), detail.rgba.end()));
  return detail;
}

}  // namespace

const SkinDetail& skin_detail() {
  static const SkinDetail made = make_skin_detail();
  return made;
}

}  // namespace condyle
