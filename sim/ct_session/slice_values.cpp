#include "sim/ct_session/slice_values.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace condyle {
namespace {

using Eigen::Vector3d;

/// For x, y and z the axis of the lattice that is nearest to it.
std::array<int, 3> lattice_axes(const Volume& volume) {
  std::array<int, 3> order = {0, 1, 2}, best = order;
  double most = -1;
  do {
    double sum = 0;
    for (int a = 0; a < 3; ++a) sum += std::abs(volume.axes(a, order[static_cast<std::size_t>(a)]));
    if (sum > most + 1e-9) most = sum, best = order;
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

/// An axis of the lattice, followed in the direction of an axis of the patient.
struct Along {
  int axis = 0, count = 0;
  bool backward = false;
  Vector3d step = Vector3d::Zero();
  int index(int i) const { return backward ? count - 1 - i : i; }
};

Along along(const Volume& volume, int patient_axis, double sign) {
  const int axis = lattice_axes(volume)[static_cast<std::size_t>(patient_axis)];
  Along found{axis, volume.size[static_cast<std::size_t>(axis)],
              sign * volume.axes(patient_axis, axis) < 0, volume.axes.col(axis)};
  found.step *= volume.spacing_mm[axis] * (found.backward ? -1 : 1);
  return found;
}

}  // namespace

Vector3d centre_of(const Volume& volume) {
  return volume.position(0.5 * (volume.size[0] - 1), 0.5 * (volume.size[1] - 1),
                         0.5 * (volume.size[2] - 1));
}

SliceValues slice_through(const Volume& volume, SliceSide side, const Vector3d& point) {
  constexpr int x = 0, y = 1, z = 2;
  const bool axial = side == SliceSide::axial, sagittal = side == SliceSide::sagittal;
  const Along right = along(volume, sagittal ? y : x, 1);
  const Along down = axial ? along(volume, y, 1) : along(volume, z, -1);
  const Along across = along(volume, axial ? z : sagittal ? x : y, 1);

  SliceValues slice;
  slice.width = right.count;
  slice.height = down.count;
  slice.count = across.count;
  slice.right = right.step;
  slice.down = down.step;
  slice.step = across.step;
  std::array<int, 3> at = {0, 0, 0};
  const auto set = [&](const Along& line, int i) {
    at[static_cast<std::size_t>(line.axis)] = line.index(i);
  };
  set(right, 0), set(down, 0), set(across, 0);
  const Vector3d first = volume.position(at[0], at[1], at[2]);
  const double steps = (point - first).dot(across.step) / across.step.squaredNorm();
  slice.number = static_cast<int>(
      std::lround(std::clamp(std::isfinite(steps) ? steps : 0.0, 0.0, across.count - 1.0)));
  slice.corner = first + slice.number * across.step;
  set(across, slice.number);
  slice.values.reserve(static_cast<std::size_t>(slice.width) *
                       static_cast<std::size_t>(slice.height));
  for (int row = 0; row < slice.height; ++row) {
    set(down, row);
    for (int column = 0; column < slice.width; ++column) {
      set(right, column);
      slice.values.push_back(volume.at(at[0], at[1], at[2]));
    }
  }
  return slice;
}

}  // namespace condyle
