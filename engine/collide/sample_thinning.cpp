#include "engine/collide/sample_thinning.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>
#include <utility>

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double alike_cos = 0.966;  // 15 degrees between normals

using Cell = Eigen::Matrix<std::int32_t, 3, 1>;

std::uint64_t key(const Cell& c) {
  std::uint64_t h = 0;
  for (int k = 0; k < 3; ++k) h = h * 0x9e3779b97f4a7c15u + static_cast<std::uint32_t>(c[k]);
  return h ^ (h >> 29);
}

}  // namespace

SamplePoints thinned(const SamplePoints& all, double reach_mm, double rise_mm) {
  const std::size_t count = all.points.size();
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  // Independent of the last bits: a rotated surface keeps the same samples.
  const auto sharpness = [&](int p) { return std::lround(100 * all.spread[p]); };
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return sharpness(a) < sharpness(b); });
  // Kept samples by cells of the size of the reach, as linked lists.
  std::unordered_map<std::uint64_t, int> first;
  first.reserve(count / 2);
  std::vector<int> next(count, -1);
  std::vector<bool> kept(count, false);
  const auto stands_for = [&](int q, int p, double reach) {
    const Vector3d offset = all.points[p] - all.points[q];
    return offset.squaredNorm() <= reach * reach &&
           all.normals[p].dot(all.normals[q]) >= alike_cos &&
           std::abs(offset.dot(all.normals[q])) <= 0.5 * rise_mm;
  };
  for (const int p : order) {
    const double cosine = std::min(1.0, static_cast<double>(all.spread[p]));
    const double sine = std::sqrt(1 - cosine * cosine);
    const double reach = cosine > 0 ? std::min(reach_mm, rise_mm * cosine / (sine + 1e-9)) : 0;
    const Cell here = (all.points[p] / reach_mm).array().floor().matrix().cast<std::int32_t>();
    const auto covered = [&](const Cell& cell) {
      const auto found = first.find(key(cell));
      for (int q = found == first.end() ? -1 : found->second; q >= 0; q = next[q])
        if (stands_for(q, p, reach)) return true;
      return false;
    };
    bool drop = covered(here);
    for (int k = 0; k < 27 && !drop; ++k)
      drop = k != 13 && covered(here + Cell(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
    if (drop) continue;
    kept[p] = true;
    const auto [place, fresh] = first.try_emplace(key(here), p);
    if (!fresh) next[p] = std::exchange(place->second, p);
  }
  SamplePoints out;
  for (std::size_t p = 0; p < count; ++p) {
    if (!kept[p]) continue;
    out.points.push_back(all.points[p]);
    out.normals.push_back(all.normals[p]);
    out.spread.push_back(all.spread[p]);
  }
  return out;
}

}  // namespace condyle
