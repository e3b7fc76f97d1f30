#include "sim/appliance/splint.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/core/units.h"
#include "engine/field/isosurface.h"
#include "engine/field/mesh_field.h"
#include "engine/field/smooth.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/appliance/bite_opening.h"
#include "sim/appliance/grid_frame.h"
#include "sim/appliance/insertion.h"
#include "sim/appliance/outline.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double rounding_mm = 2.4;   // of the plate's edges
constexpr double most_tilt_deg = 12;  // of an insertion from the occlusal plane's normal
constexpr double thin_radius_mm = 0.5, printed_radius_mm = 0.4;
constexpr double thin_tolerance_mm = 0.12;
constexpr double most_fossa_mm = 2;  // of the plate in fossae, beyond the depth of the prints
constexpr double relief_error_mm = 0.05;
constexpr double grid_margin_mm = 0.8;
constexpr double shortest_across_mm = 25, shortest_along_mm = 12;  // of an arch, one tooth is not
constexpr double print_thickness_slack_mm = 0.1;  // prints come nearer by the grid's error

/// One arch in the grid's axes: x left, y back, z up.
struct PlacedArch {
  const SplintArch& arch;
  bool upper;
  TriMesh mesh;
  TipHeights tips;
  Vector3d seat;  // direction of insertion, grid
  double tilt_deg = 0;
};

Vector3d occlusal_up(const SplintArch& arch) {
  return (arch.molars[0] - arch.molars[1])
      .cross(0.5 * (arch.molars[0] + arch.molars[1]) - arch.edge)
      .normalized();
}

/// Rows: left, back and up, between the occlusal planes of both arches.
Matrix3d axes_of(const SplintArches& arches, const Pose& X_lower) {
  const Vector3d up =
      (occlusal_up(arches.upper) + X_lower.R * occlusal_up(arches.lower)).normalized();
  const Vector3d across = arches.upper.molars[0] - arches.upper.molars[1];
  Matrix3d R;
  R.row(2) = up.transpose();
  R.row(0) = (across - across.dot(up) * up).normalized().transpose();
  R.row(1) = R.row(2).cross(R.row(0));
  return R;
}

void check_settings(const SplintSettings& settings) {
  check_lengths(settings, splint_lengths);
  if (const auto& opening = settings.opening_mm; opening && !(*opening >= -15 && *opening <= 25))
    throw InputError(fmt::format("opening {} mm: it is from -15 to 25 mm", *opening));
}

PlacedArch place(const SplintArch& arch, bool upper, const Matrix3d& R, const Pose& X,
                 double depth_mm) {
  PlacedArch placed{arch, upper, in_axes(arch.mesh, R, X), {}, Vector3d::UnitZ()};
  const double level = (R * (X * ((arch.edge + arch.molars[0] + arch.molars[1]) / 3))).z();
  placed.tips = find_tips(placed.mesh, level, upper);
  double left = 1e9, right = -1e9, front = 1e9, back = -1e9;
  for (const auto& tip : placed.tips.tips) {
    left = std::min(left, tip.x);
    right = std::max(right, tip.x);
    front = std::min(front, tip.y);
    back = std::max(back, tip.y);
  }
  if (right - left < shortest_across_mm || back - front < shortest_along_mm)
    throw InputError(
        fmt::format("{}: the teeth extend {:.0f} mm across and {:.0f} mm along the jaw; a splint "
                    "needs an arch of "
                    "at least {:.0f} and {:.0f} mm, with teeth on both sides",
                    arch.name, std::max(0.0, right - left), std::max(0.0, back - front),
                    shortest_across_mm, shortest_along_mm));
  // The surface within the print counts for the withdrawal path.
  std::vector<char> counts(placed.mesh.triangles.size());
  for (std::size_t t = 0; t < counts.size(); ++t) {
    const auto& v = placed.mesh.triangles[t];
    const Vector3d p =
        (placed.mesh.vertices[v[0]] + placed.mesh.vertices[v[1]] + placed.mesh.vertices[v[2]]) / 3;
    const double beyond = (upper ? 1 : -1) * (p.z() - placed.tips(p.x(), p.y()));
    counts[t] = beyond < depth_mm && beyond > -depth_mm;
  }
  const Vector3d normal = upper ? Vector3d::UnitZ() : Vector3d(-Vector3d::UnitZ());
  placed.seat = find_insertion(placed.mesh, counts, normal, most_tilt_deg);
  placed.tilt_deg = std::acos(std::clamp(placed.seat.dot(normal), -1.0, 1.0)) * degrees_per_radian;
  return placed;
}

/// The grip, less the error of the samples on turned axes.
double held_mm(const SplintSettings& settings) {
  return settings.grip_mm - std::min(relief_error_mm, settings.gap_mm);
}

/// The plate and the prints, sampled on one grid.
class SplintField {
 public:
  SplintField(const PlacedArch& upper, const PlacedArch& lower, const SplintSettings& settings)
      : settings_(settings) {
    outline_ = plate_outline({{upper.mesh, upper.tips, true}, {lower.mesh, lower.tips, false}},
                             settings.depth_mm, settings.wall_mm, settings.voxel_mm);
    find_heights(upper, lower);
    box_.low.array() -= grid_margin_mm + grid_shift_mm;
    box_.high.array() += grid_margin_mm + grid_shift_mm;
    axes_ = even_grid({box_.low, box_.high}, settings.voxel_mm);
    make_plate();
  }

  /// Distance from the plate without prints, negative inside.
  double plate(const Vector3d& p) const {
    return rounded(outline_(p.x(), p.y()), p.z() - top_(p.x(), p.y()),
                   bottom_(p.x(), p.y()) - p.z());
  }

  /// Takes the print of an arch out of the plate.
  void print(const PlacedArch& arch) {
    const double band = band_mm();
    const SampledField distance = mesh_field(arch.mesh, axes_, band, settings_.threads);
    const ReliefField relief(arch.mesh, arch.seat, box_, settings_.voxel_mm, band,
                             settings_.threads);
    const double held = held_mm(settings_);
    for_samples(field_, settings_.threads, [&](const Vector3d& p, std::size_t at) {
      float& value = field_.values[at];
      if (value > far_mm) return;
      const double solid = std::min(distance.values[at] - settings_.gap_mm, relief(p) + held);
      value = std::max(value, static_cast<float>(-solid));
    });
  }

  TriMesh surface() {
    remove_thin(field_, printed_radius_mm, thin_tolerance_mm, settings_.threads);
    return isosurface(field_);
  }

 private:
  static constexpr float far_mm = 1;
  double band_mm() const {
    return std::max(settings_.grip_mm, thin_radius_mm) + settings_.gap_mm + 2 * settings_.voxel_mm;
  }

  static double rounded(double side, double above, double below) {
    return smooth_max(smooth_max(side, above, rounding_mm), below, rounding_mm);
  }

  void find_heights(const PlacedArch& upper, const PlacedArch& lower) {
    top_ = bottom_ = outline_;
    for (int j = 0; j < outline_.rows; ++j)
      for (int i = 0; i < outline_.columns; ++i) {
        if (outline_.at(i, j) > grid_margin_mm) continue;
        const double x = outline_.low.x() + outline_.step_mm * i,
                     y = outline_.low.y() + outline_.step_mm * j;
        const double top = upper.tips(x, y) + settings_.depth_mm,
                     bottom = lower.tips(x, y) - settings_.depth_mm;
        top_.at(i, j) = static_cast<float>(top);
        bottom_.at(i, j) = static_cast<float>(bottom);
      }
    fill_fossae(top_, upper.mesh, true, most_fossa_mm);
    fill_fossae(bottom_, lower.mesh, false, most_fossa_mm);
    for (int j = 0; j < outline_.rows; ++j)
      for (int i = 0; i < outline_.columns; ++i) {
        if (outline_.at(i, j) > grid_margin_mm) continue;
        const Eigen::Vector2d p = outline_.low + outline_.step_mm * Eigen::Vector2d(i, j);
        box_.add(Vector3d(p.x(), p.y(), top_.at(i, j)));
        box_.add(Vector3d(p.x(), p.y(), bottom_.at(i, j)));
      }
  }

  void make_plate() {
    field_ = {axes_, {}};
    field_.values.resize(axes_[0].size() * axes_[1].size() * axes_[2].size());
    const Eigen::Vector3i size = field_.size();
    parallel_for(axes_[0].size(), settings_.threads, [&](std::size_t layer) {
      const int i = static_cast<int>(layer);
      for (int j = 0; j < size.y(); ++j) {
        const Vector3d p = field_.position(i, j, 0);
        const double side = outline_(p.x(), p.y());
        float* column = &field_.values[field_.index(i, j, 0)];
        if (side > grid_margin_mm - 2 * settings_.voxel_mm) {
          std::fill_n(column, size.z(), static_cast<float>(side));
          continue;
        }
        const double top = top_(p.x(), p.y()), bottom = bottom_(p.x(), p.y());
        for (int k = 0; k < size.z(); ++k) {
          const double z = axes_[2][static_cast<std::size_t>(k)];
          column[k] = static_cast<float>(rounded(side, z - top, bottom - z));
        }
      }
    });
  }

  const SplintSettings& settings_;
  FlatGrid outline_, top_, bottom_;
  Box box_;
  std::array<GridAxis, 3> axes_;
  SampledField field_;
};

/// Least distance between what is printed by the upper and by the lower arch.
double print_thickness(const TriMesh& splint, const TriMesh& upper, const TriMesh& lower,
                       double gap_mm, double voxel_mm, int threads) {
  const TriangleTree upper_tree(upper), lower_tree(lower);
  const double near = gap_mm + 0.5 * voxel_mm;
  std::vector<char> by_upper(splint.triangles.size()), by_lower(splint.triangles.size());
  constexpr std::size_t run = 256;
  const auto corner_sum = [&](std::size_t t) {
    const auto& v = splint.triangles[t];
    return Vector3d((splint.vertices[v[0]] + splint.vertices[v[1]] + splint.vertices[v[2]]) / 3);
  };
  parallel_for((by_upper.size() + run - 1) / run, threads, [&](std::size_t r) {
    const std::size_t end = std::min(by_upper.size(), (r + 1) * run);
    for (std::size_t t = r * run; t < end; ++t) {
      const Vector3d p = corner_sum(t);
      by_upper[t] = upper_tree.nearest(p, near).triangle >= 0;
      by_lower[t] = lower_tree.nearest(p, near).triangle >= 0;
    }
  });
  TriMesh below{splint.vertices, {}, {}};
  for (std::size_t t = 0; t < by_lower.size(); ++t)
    if (by_lower[t]) below.triangles.push_back(splint.triangles[t]);
  if (below.empty()) return std::numeric_limits<double>::infinity();
  const TriangleTree below_tree(below);
  std::vector<double> least((by_upper.size() + run - 1) / run,
                            std::numeric_limits<double>::infinity());
  parallel_for(least.size(), threads, [&](std::size_t r) {
    const std::size_t end = std::min(by_upper.size(), (r + 1) * run);
    for (std::size_t t = r * run; t < end; ++t)
      if (by_upper[t])
        for (int c = 0; c < 3; ++c)
          least[r] = std::min(
              least[r],
              below_tree.nearest(splint.vertices[splint.triangles[t][c]], least[r]).distance);
  });
  return *std::min_element(least.begin(), least.end());
}

}  // namespace

Splint make_splint(const SplintArches& arches, const SplintSettings& settings,
                   const Progress& progress) {
  check_settings(settings);
  report(progress, "opening the bite", 0);
  const double room = settings.thickness_mm + 2 * settings.gap_mm + print_thickness_slack_mm;
  const BiteOpening opening = settings.opening_mm
                                  ? turn_bite(arches, *settings.opening_mm, room, settings.threads)
                                  : open_bite(arches, room, settings.threads);
  Splint splint;
  splint.notes = arches.notes;
  splint.X_lower = opening.X_lower;
  splint.opening_mm = opening.incisal_mm;
  splint.opening_deg = opening.deg;
  splint.clearance_before_mm = opening.before_mm;
  splint.clearance_mm = opening.after_mm;

  report(progress, "printing the teeth", 0.3);
  const Matrix3d R = axes_of(arches, opening.X_lower);
  const PlacedArch upper = place(arches.upper, true, R, {}, settings.depth_mm);
  const PlacedArch lower = place(arches.lower, false, R, opening.X_lower, settings.depth_mm);
  SplintField field(upper, lower, settings);
  field.print(upper);
  field.print(lower);
  TriMesh mesh = field.surface();
  const double dropped_mm3 = keep_one_piece(mesh);
  if (mesh.empty()) throw InputError("no splint fits between the arches: they leave no room");
  if (dropped_mm3 > crumb_mm3)
    throw InputError(fmt::format(
        "the splint is not of one piece: a part of {:.0f} mm³ is not connected to the rest; less "
        "depth or more width of the wall connects it",
        dropped_mm3));

  report(progress, "measuring the splint", 0.7);
  const TriangleTree tree(mesh);
  splint.thickness_mm = print_thickness(mesh, upper.mesh, lower.mesh, settings.gap_mm,
                                        settings.voxel_mm, settings.threads);
  if (!std::isfinite(splint.thickness_mm))
    throw InputError("the splint does not cover both arches: one of them leaves no impression");
  if (splint.thickness_mm < settings.thickness_mm - 0.01)
    splint.notes.push_back(
        fmt::format("{:.2f} mm thick between cusps, less than the {:g} mm that "
                    "were requested",
                    splint.thickness_mm, settings.thickness_mm));
  std::vector<PrintedOn> prints;
  for (const PlacedArch* arch : {&upper, &lower})
    prints.push_back({arch->mesh,
                      {.on = arch->arch.name,
                       .seat = arch->seat,
                       .gap_mm = settings.gap_mm,
                       .held_mm = held_mm(settings),
                       .thin_mm = 2 * thin_radius_mm,
                       .body = [&](const Vector3d& p) { return field.plate(p); }}});
  splint.measure = measure_in_axes(mesh, tree, R, prints, settings.threads);
  check_withdrawal(splint.measure, settings.grip_mm, "splint");
  splint.measure.prints[0].tilt_deg = upper.tilt_deg;
  splint.measure.prints[1].tilt_deg = lower.tilt_deg;
  splint.mesh = in_axes(std::move(mesh), R.transpose());
  return splint;
}

}  // namespace condyle
