#include "sim/ct_session/solid_picture.h"

#include <algorithm>
#include <cmath>

#include "engine/core/parallel.h"
#include "engine/core/units.h"
#include "engine/volume/lines.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double coarse_mm = 1.3;
constexpr int block = 6;  // values along an edge
constexpr std::int16_t around_hu = -1024;

/// Means of `times` values along each axis.
Volume thinned(const Volume& volume, const std::array<int, 3>& times, int threads) {
  Volume coarse;
  coarse.axes = volume.axes;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    coarse.size[a] = std::max(1, volume.size[a] / times[a]);
    coarse.spacing_mm[axis] = volume.spacing_mm[axis] * times[a];
  }
  coarse.origin = volume.position(0.5 * (times[0] - 1), 0.5 * (times[1] - 1), 0.5 * (times[2] - 1));
  coarse.values.resize(lattice_count(coarse.size));
  const int total = times[0] * times[1] * times[2];
  parallel_for(static_cast<std::size_t>(coarse.size[2]), threads, [&](std::size_t slice) {
    const int k = static_cast<int>(slice);
    for (int j = 0; j < coarse.size[1]; ++j)
      for (int i = 0; i < coarse.size[0]; ++i) {
        int sum = 0;
        for (int c = 0; c < times[2]; ++c)
          for (int b = 0; b < times[1]; ++b)
            for (int a = 0; a < times[0]; ++a)
              sum += volume.at(std::min(volume.size[0] - 1, i * times[0] + a),
                               std::min(volume.size[1] - 1, j * times[1] + b),
                               std::min(volume.size[2] - 1, k * times[2] + c));
        coarse.values[coarse.index(i, j, k)] = static_cast<std::int16_t>(sum / total);
      }
  });
  return coarse;
}

}  // namespace

SolidScan::SolidScan(const Volume& volume, double threshold_hu, int threads,
                     const Progress& progress) {
  report(progress, "preparing the 3-D view", 0);
  std::array<int, 3> times;
  for (std::size_t a = 0; a < 3; ++a)
    times[a] = std::max(
        1, static_cast<int>(coarse_mm / volume.spacing_mm[static_cast<Eigen::Index>(a)] + 0.5));
  coarse_ = thinned(volume, times, threads);
  report(progress, "preparing the 3-D view", 0.7);
  find_blocks();
  frame_bone(threshold_hu);
  report(progress, "preparing the 3-D view", 1);
}

void SolidScan::find_blocks() {
  for (std::size_t a = 0; a < 3; ++a) block_count_[a] = (coarse_.size[a] + block - 1) / block;
  highest_.assign(lattice_count(block_count_), around_hu);
  std::size_t n = 0;
  for (int c = 0; c < block_count_[2]; ++c)
    for (int b = 0; b < block_count_[1]; ++b)
      for (int a = 0; a < block_count_[0]; ++a, ++n) {
        const std::array<int, 3> first = {a * block, b * block, c * block};
        std::array<int, 3> low, high;
        for (std::size_t x = 0; x < 3; ++x) {
          low[x] = std::max(0, first[x] - 1);
          high[x] = std::min(coarse_.size[x] - 1, first[x] + block);
        }
        for (int k = low[2]; k <= high[2]; ++k)
          for (int j = low[1]; j <= high[1]; ++j)
            for (int i = low[0]; i <= high[0]; ++i)
              highest_[n] = std::max(highest_[n], coarse_.at(i, j, k));
      }
}

void SolidScan::frame_bone(double threshold_hu) {
  Vector3d low = Vector3d::Constant(1e9), high = -low;
  for (int k = 0; k < coarse_.size[2]; ++k)
    for (int j = 0; j < coarse_.size[1]; ++j)
      for (int i = 0; i < coarse_.size[0]; ++i) {
        if (coarse_.at(i, j, k) < threshold_hu) continue;
        const Vector3d p = coarse_.position(i, j, k);
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
      }
  if (low.x() > high.x()) {
    low = coarse_.position(0, 0, 0);
    high = coarse_.position(coarse_.size[0] - 1, coarse_.size[1] - 1, coarse_.size[2] - 1);
  }
  centre_ = 0.5 * (low + high);
  radius_mm_ = std::max(1.0, 0.5 * (high - low).norm());
}

double SolidScan::value(const Vector3d& at) const {
  std::array<int, 3> low;
  std::array<double, 3> t;
  for (std::size_t a = 0; a < 3; ++a) {
    const double place = at[static_cast<Eigen::Index>(a)];
    if (!(place >= 0 && place <= coarse_.size[a] - 1)) return around_hu;
    low[a] = std::min(static_cast<int>(place), std::max(0, coarse_.size[a] - 2));
    t[a] = place - low[a];
  }
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::array<int, 3> place = low;
    for (std::size_t a = 0; a < 3; ++a) {
      const bool second = (corner >> a & 1) != 0;
      weight *= second ? t[a] : 1 - t[a];
      if (second) place[a] = std::min(place[a] + 1, coarse_.size[a] - 1);
    }
    if (weight > 0) sum += weight * coarse_.at(place[0], place[1], place[2]);
  }
  return sum;
}

/// Follows a ray, all in steps of the lattice; `direction`: of one step along it. Blocks without
/// bone are passed in one step.
bool SolidScan::hits(const Vector3d& from, const Vector3d& direction, double threshold_hu,
                     Vector3d& at) const {
  double begin = 0, end = 1e9;
  for (Eigen::Index a = 0; a < 3; ++a) {
    const double last = coarse_.size[static_cast<std::size_t>(a)] - 1;
    if (std::abs(direction[a]) < 1e-12) {
      if (from[a] < 0 || from[a] > last) return false;
      continue;
    }
    const double p = -from[a] / direction[a], q = (last - from[a]) / direction[a];
    begin = std::max(begin, std::min(p, q));
    end = std::min(end, std::max(p, q));
  }
  const double longest = direction.cwiseAbs().maxCoeff();
  double before = begin;
  for (double t = begin; t <= end;) {
    const Vector3d p = from + t * direction;
    std::size_t number = 0, stride = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      const int b = std::clamp(static_cast<int>(p[static_cast<Eigen::Index>(a)]) / block, 0,
                               block_count_[a] - 1);
      number += stride * static_cast<std::size_t>(b);
      stride *= static_cast<std::size_t>(block_count_[a]);
    }
    if (highest_[number] < threshold_hu) {  // to where the ray leaves the block
      double leave = 1e9;
      for (std::size_t a = 0; a < 3; ++a) {
        const auto axis = static_cast<Eigen::Index>(a);
        if (std::abs(direction[axis]) < 1e-12) continue;
        const int b = std::clamp(static_cast<int>(p[axis]) / block, 0, block_count_[a] - 1);
        const double border = direction[axis] > 0 ? (b + 1) * block : b * block;
        leave = std::min(leave, (border - p[axis]) / direction[axis]);
      }
      before = t;
      t += std::max(leave, 0.0) + 0.02 / longest;
      continue;
    }
    if (value(p) >= threshold_hu) {
      double low = before, high = t;
      for (int i = 0; i < 6 && high > low; ++i) {
        const double middle = 0.5 * (low + high);
        (value(from + middle * direction) >= threshold_hu ? high : low) = middle;
      }
      at = from + high * direction;
      return true;
    }
    before = t;
    t += 0.6 / longest;
  }
  return false;
}

CtPixels SolidScan::picture(int side_pixels, double threshold_hu, double turn_deg, double tilt_deg,
                            int threads) const {
  const double t = turn_deg * degree, e = tilt_deg * degree;
  const Vector3d toward(std::sin(t) * std::cos(e), -std::cos(t) * std::cos(e), std::sin(e));
  const Vector3d right(std::cos(t), std::sin(t), 0), up = toward.cross(right);
  const auto lattice = [&](const Vector3d& v) {
    return Vector3d((coarse_.axes.transpose() * v).cwiseQuotient(coarse_.spacing_mm));
  };
  const Vector3d ray = lattice(-toward),
                 start = lattice(centre_ - coarse_.origin + 4 * radius_mm_ * toward);
  CtPixels picture{side_pixels, side_pixels, {}};
  const auto side = static_cast<std::size_t>(side_pixels);
  picture.rgba.assign(side * side * 4, 255);
  parallel_for(side, threads, [&](std::size_t row) {
    for (std::size_t column = 0; column < side; ++column) {
      const auto along = [&](std::size_t i) {
        return radius_mm_ * (2 * (static_cast<double>(i) + 0.5) / side_pixels - 1);
      };
      const Vector3d from = start + lattice(along(column) * right - along(row) * up);
      double light = 0;
      Vector3d at;
      if (hits(from, ray, threshold_hu, at)) {
        Vector3d slope;
        for (Eigen::Index a = 0; a < 3; ++a) {
          const Vector3d step = 0.8 * Vector3d::Unit(a);
          slope[a] = value(at - step) - value(at + step);
        }
        const Vector3d normal = coarse_.axes * slope.cwiseQuotient(coarse_.spacing_mm);
        const double facing =
            normal.norm() > 0 ? normal.normalized().dot(toward + 0.25 * up - 0.2 * right) : 0;
        light = 0.18 + 0.78 * std::max(0.0, facing) / 1.05;
      }
      std::uint8_t* out = &picture.rgba[(row * side + column) * 4];
      constexpr double ivory[] = {240, 228, 205}, dark[] = {20, 24, 28};
      for (int c = 0; c < 3; ++c)
        out[c] = static_cast<std::uint8_t>(
            std::lround(light > 0 ? std::min(255.0, ivory[c] * light) : dark[c]));
    }
  });
  return picture;
}

}  // namespace condyle
