#include "engine/segmentation/metal_artifacts.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/core/parallel.h"
#include "engine/segmentation/metal_slices.h"

namespace condyle {
namespace {

constexpr int ray_air_hu = -1000, lowest_hu = -1024;
constexpr int overflow_hu = -300;  // metal of a lower value exceeded the scanner's range
constexpr int overflow_rounds = 3, overflow_neighbours = 4;
constexpr double thinnest_metal_mm = 2;  // bright and thinner: enamel, or a streak
constexpr double beside_metal_mm = 1;    // rays this near to it are interpolated, too
constexpr double pixel_mm = 0.9;         // of the pixels that are projected, about
constexpr int most_pixels = 12;          // of such distances, in very fine scans
constexpr double in_trace = 0.3;         // of a pixel: so much metal lies on a ray through it
constexpr int directions_per_pixel = 2;  // of a slice's width, over half a turn

using Mask = std::vector<std::uint8_t>;

/// A picture of square or oblong pixels.
struct Picture {
  std::array<int, 2> size;
  std::array<double, 2> spacing_mm;
  std::vector<float> values = {};

  std::size_t pixels() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]);
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size[0]) +
           static_cast<std::size_t>(x);
  }
};

/// Sums of a picture's values along parallel rays: directions over half a turn, and rays that are a
/// pixel apart.
class Projections {
 public:
  explicit Projections(const Picture& like)
      : step_mm_(std::min(like.spacing_mm[0], like.spacing_mm[1])) {
    const double diagonal_mm =
        std::hypot(like.size[0] * like.spacing_mm[0], like.size[1] * like.spacing_mm[1]);
    rays_ = static_cast<int>(std::ceil(diagonal_mm / step_mm_)) + 4;
    directions_ = directions_per_pixel * std::max(like.size[0], like.size[1]);
    sums_.assign(static_cast<std::size_t>(rays_) * static_cast<std::size_t>(directions_), 0);
  }

  int directions() const { return directions_; }
  int rays() const { return rays_; }
  float* of(int direction) { return sums_.data() + direction * static_cast<std::ptrdiff_t>(rays_); }
  const float* of(int direction) const {
    return sums_.data() + direction * static_cast<std::ptrdiff_t>(rays_);
  }

  void project(const Picture& picture) {
    for (int d = 0; d < directions_; ++d) {
      float* const sums = of(d);
      for_pixels(picture, d, [&](std::size_t p, int ray, float beyond) {
        const float value = picture.values[p];
        sums[ray] += (1 - beyond) * value;
        sums[ray + 1] += beyond * value;
      });
    }
  }

  /// The picture with these projections: filtered back projection (Ramachandran, Lakshminarayanan).
  void reconstruct(Picture& picture) const {
    picture.values.assign(picture.pixels(), 0);
    std::vector<float> filtered(static_cast<std::size_t>(rays_));
    for (int d = 0; d < directions_; ++d) {
      if (!filter(d, filtered)) continue;
      for_pixels(picture, d, [&](std::size_t p, int ray, float beyond) {
        picture.values[p] += (1 - beyond) * filtered[static_cast<std::size_t>(ray)] +
                             beyond * filtered[static_cast<std::size_t>(ray) + 1];
      });
    }
    const double pixels_per_ray =
        picture.spacing_mm[0] * picture.spacing_mm[1] / (step_mm_ * step_mm_);
    const auto scale = static_cast<float>(std::numbers::pi / directions_ * pixels_per_ray);
    for (float& value : picture.values) value *= scale;
  }

 private:
  /// body(pixel, ray, share of the next ray)
  template <class Body>
  void for_pixels(const Picture& picture, int direction, const Body& body) const {
    const double angle = std::numbers::pi * direction / directions_;
    const double across = std::cos(angle) * picture.spacing_mm[0] / step_mm_,
                 down = std::sin(angle) * picture.spacing_mm[1] / step_mm_;
    const double middle = 0.5 * (rays_ - 1);
    for (int y = 0; y < picture.size[1]; ++y) {
      const double start =
          middle + down * (y - 0.5 * (picture.size[1] - 1)) - across * 0.5 * (picture.size[0] - 1);
      const std::size_t row = picture.index(0, y);
      for (int x = 0; x < picture.size[0]; ++x) {
        const double at = start + across * x;
        const int ray = static_cast<int>(at);
        body(row + static_cast<std::size_t>(x), ray, static_cast<float>(at - ray));
      }
    }
  }

  /// Convolves the projections of a direction with the ramp filter; false where all are zero.
  bool filter(int direction, std::vector<float>& filtered) const {
    const float* const sums = of(direction);
    std::fill(filtered.begin(), filtered.end(), 0.f);
    bool any = false;
    for (int source = 0; source < rays_; ++source) {
      if (sums[source] == 0) continue;
      any = true;
      for (int ray = 0; ray < rays_; ++ray) {
        const int off = ray - source;
        if (off == 0)
          filtered[static_cast<std::size_t>(ray)] += 0.25f * sums[source];
        else if (off % 2 != 0)
          filtered[static_cast<std::size_t>(ray)] -=
              sums[source] / static_cast<float>(std::numbers::pi * std::numbers::pi * off * off);
      }
    }
    return any;
  }

  double step_mm_;
  int rays_, directions_;
  std::vector<float> sums_;
};

/// Replaces the sums by their difference from what is interpolated across the rays through metal;
/// zero elsewhere.
void subtract_interpolated(const Projections& metal, Projections& sums) {
  const int rays = sums.rays();
  for (int d = 0; d < sums.directions(); ++d) {
    const float* const through = metal.of(d);
    float* const sum = sums.of(d);
    std::vector<float> difference(static_cast<std::size_t>(rays), 0);
    for (int first = 0; first < rays; ++first) {
      if (through[first] <= in_trace) continue;
      int last = first;
      while (last + 1 < rays && through[last + 1] > in_trace) ++last;
      const float before = first > 0 ? sum[first - 1] : 0;
      const float after = last + 1 < rays ? sum[last + 1] : 0;
      for (int ray = first; ray <= last; ++ray) {
        const float share =
            static_cast<float>(ray - first + 1) / static_cast<float>(last - first + 2);
        difference[static_cast<std::size_t>(ray)] = sum[ray] - (before + share * (after - before));
      }
      first = last;
    }
    std::copy(difference.begin(), difference.end(), sum);
  }
}

/// Pixels whose neighbours up to a distance are all in the mask, or one of them is.
Mask spread(const Mask& mask, const SliceLattice& lattice, double mm, bool all) {
  std::array<int, 2> reach;
  for (std::size_t a = 0; a < 2; ++a) {
    const double pixels = mm / lattice.spacing_mm[static_cast<Eigen::Index>(a)];
    // Of fine pixels never more than that distance, lest small metal be lost.
    reach[a] = static_cast<int>(all && pixels >= 1 ? std::floor(pixels) : std::round(pixels));
    reach[a] = std::min(reach[a], most_pixels);
  }
  Mask result(mask.size(), all ? 1 : 0);
  for (int y = 0; y < lattice.size[1]; ++y)
    for (int x = 0; x < lattice.size[0]; ++x) {
      const std::size_t here =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(lattice.size[0]) +
          static_cast<std::size_t>(x);
      if ((mask[here] != 0) == all) continue;
      for (int v = std::max(0, y - reach[1]); v <= std::min(lattice.size[1] - 1, y + reach[1]); ++v)
        for (int u = std::max(0, x - reach[0]); u <= std::min(lattice.size[0] - 1, x + reach[0]);
             ++u)
          result[static_cast<std::size_t>(v) * static_cast<std::size_t>(lattice.size[0]) +
                 static_cast<std::size_t>(u)] = all ? 0 : 1;
    }
  return result;
}

/// One slice of a scan.
class MetalSlice {
 public:
  MetalSlice(const Volume& volume, const SliceLattice& lattice, int slice, int level_hu)
      : lattice_(lattice), level_hu_(level_hu), values_(lattice.pixels()) {
    // About square, since neighbouring rays lie a pixel apart.
    const double coarse_mm = std::max({pixel_mm, lattice.spacing_mm[0], lattice.spacing_mm[1]});
    for (std::size_t a = 0; a < 2; ++a)
      block_[a] = std::max(1, static_cast<int>(std::lround(
                                  coarse_mm / lattice.spacing_mm[static_cast<Eigen::Index>(a)])));
    for (std::size_t p = 0; p < values_.size(); ++p) {
      const auto at = lattice.place(p, slice);
      values_[p] = volume.at(at[0], at[1], at[2]);
    }
    find_metal();
  }

  bool has_metal() const {
    const auto count = std::count(metal_.begin(), metal_.end(), std::uint8_t{1});
    return static_cast<double>(count) * lattice_.spacing_mm.prod() >= least_metal_mm2;
  }

  void correct() {
    Picture picture = coarse(
        [&](std::size_t p) { return static_cast<float>(std::max(0, values_[p] - ray_air_hu)); });
    const Mask wide = spread(metal_, lattice_, beside_metal_mm, false);
    const Picture metal = coarse([&](std::size_t p) { return static_cast<float>(wide[p]); });
    Projections sums(picture), through(metal);
    sums.project(picture);
    through.project(metal);
    subtract_interpolated(through, sums);
    sums.reconstruct(picture);
    subtract(picture);
  }

  void write(int slice, Volume& volume) const {
    for (std::size_t p = 0; p < values_.size(); ++p) {
      const auto at = lattice_.place(p, slice);
      volume.values[volume.index(at[0], at[1], at[2])] = values_[p];
    }
  }

 private:
  /// What is bright and compact, with its interior.
  void find_metal() {
    metal_.assign(values_.size(), 0);
    bool any = false;
    for (std::size_t p = 0; p < values_.size(); ++p) {
      metal_[p] = values_[p] >= level_hu_ ? 1 : 0;
      any |= metal_[p] != 0;
    }
    if (!any) return;
    for (int round = 0; round < overflow_rounds; ++round) fill_overflow();
    const double half_mm = 0.5 * thinnest_metal_mm;
    const Mask bright = metal_;
    metal_ = spread(spread(bright, lattice_, half_mm, true), lattice_, 2 * half_mm, false);
    for (std::size_t p = 0; p < metal_.size(); ++p) metal_[p] &= bright[p];
  }

  void fill_overflow() {
    const Mask before = metal_;
    const int width = lattice_.size[0];
    for (int y = 1; y + 1 < lattice_.size[1]; ++y)
      for (int x = 1; x + 1 < width; ++x) {
        const std::size_t p = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(x);
        if (before[p] != 0 || values_[p] >= overflow_hu) continue;
        int beside = 0;
        for (int v = -1; v <= 1; ++v)
          for (int u = -1; u <= 1; ++u)
            beside += before[p + static_cast<std::size_t>(v * width + u)];
        if (beside >= overflow_neighbours) metal_[p] = 1;
      }
  }

  /// Means over blocks of pixels.
  template <class Value>
  Picture coarse(const Value& value) const {
    Picture picture;
    for (std::size_t a = 0; a < 2; ++a) {
      const double fine_mm = lattice_.spacing_mm[static_cast<Eigen::Index>(a)];
      picture.size[a] = (lattice_.size[a] + block_[a] - 1) / block_[a];
      picture.spacing_mm[a] = block_[a] * fine_mm;
    }
    picture.values.assign(picture.pixels(), 0);
    for (std::size_t p = 0; p < values_.size(); ++p) {
      const int x = static_cast<int>(p) % lattice_.size[0],
                y = static_cast<int>(p) / lattice_.size[0];
      picture.values[picture.index(x / block_[0], y / block_[1])] +=
          value(p) / static_cast<float>(block_[0] * block_[1]);
    }
    return picture;
  }

  /// Subtracts streaks, interpolated between the blocks, except from metal.
  void subtract(const Picture& streaks) {
    for (std::size_t p = 0; p < values_.size(); ++p) {
      if (metal_[p] != 0) {
        values_[p] = static_cast<std::int16_t>(std::max<int>(values_[p], level_hu_));
        continue;
      }
      if (values_[p] < lowest_hu) continue;  // beyond the scanner's field of view
      std::array<int, 2> low;
      std::array<float, 2> beyond;
      const std::array<int, 2> pixel{static_cast<int>(p) % lattice_.size[0],
                                     static_cast<int>(p) / lattice_.size[0]};
      for (std::size_t a = 0; a < 2; ++a) {
        const double at = std::clamp((pixel[a] + 0.5) / block_[a] - 0.5, 0.0,
                                     static_cast<double>(std::max(0, streaks.size[a] - 1)));
        low[a] = std::min(static_cast<int>(at), std::max(0, streaks.size[a] - 2));
        beyond[a] = static_cast<float>(at - low[a]);
      }
      const auto row = [&](int y) {
        const float first = streaks.values[streaks.index(low[0], y)];
        const float next =
            streaks.values[streaks.index(std::min(low[0] + 1, streaks.size[0] - 1), y)];
        return first + beyond[0] * (next - first);
      };
      const float first = row(low[1]), next = row(std::min(low[1] + 1, streaks.size[1] - 1));
      const float corrected = static_cast<float>(values_[p]) - (first + beyond[1] * (next - first));
      values_[p] = static_cast<std::int16_t>(
          std::lround(std::clamp<float>(corrected, lowest_hu, static_cast<float>(level_hu_))));
    }
  }

  const SliceLattice& lattice_;
  int level_hu_;
  std::vector<std::int16_t> values_;
  Mask metal_;
  std::array<int, 2> block_;  // pixels of a coarse one
};

}  // namespace

std::optional<CorrectedScan> reduce_metal_artifacts(const Volume& volume, int threads,
                                                    const Progress& progress) {
  const int level_hu = metal_level(volume);
  const SliceLattice lattice(slice_axis(volume), volume.size, volume.spacing_mm);
  const auto slices = static_cast<std::size_t>(volume.size[lattice.axis]);
  std::vector<std::uint8_t> has_metal(slices, 0);
  parallel_for(slices, threads, [&](std::size_t s) {
    has_metal[s] = MetalSlice(volume, lattice, static_cast<int>(s), level_hu).has_metal() ? 1 : 0;
  });
  std::vector<int> found;
  for (std::size_t s = 0; s < slices; ++s)
    if (has_metal[s] != 0) found.push_back(static_cast<int>(s));
  if (found.empty()) return std::nullopt;

  CorrectedScan corrected{volume, static_cast<int>(found.size())};
  const std::size_t together = 4 * static_cast<std::size_t>(std::max(1, threads));
  for (std::size_t begin = 0; begin < found.size(); begin += together) {
    report(progress, "reducing metal artifacts",
           static_cast<double>(begin) / static_cast<double>(found.size()));
    const std::size_t count = std::min(together, found.size() - begin);
    parallel_for(count, threads, [&](std::size_t n) {
      const int slice = found[begin + n];
      MetalSlice at(volume, lattice, slice, level_hu);
      at.correct();
      at.write(slice, corrected.volume);
    });
  }
  return corrected;
}

}  // namespace condyle
