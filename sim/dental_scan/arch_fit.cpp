#include "sim/dental_scan/arch_fit.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/mesh/measure.h"
#include "engine/registration/rigid_fit.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int crown_point_count = 4000;
constexpr std::size_t half_point_count = 1000;
constexpr int attitudes = 24;            // about the bite's direction: 15 degrees apart
constexpr double molar_fraction = 0.58;  // of the arch's depth, in front of the first molars
constexpr double far_pick_mm = 4;        // of picked points after their rigid fit
// A mirror image or the other arch that fits so much better is what was scanned.
constexpr double much_better = 0.7, as_good = 1.05;

/// Rotations that take one direction to another, evenly turned about it.
std::vector<Matrix3d> turns(const Vector3d& from, const Vector3d& to) {
  std::vector<Matrix3d> all;
  all.reserve(attitudes);
  const Matrix3d first = Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix();
  for (int i = 0; i < attitudes; ++i)
    all.push_back(Eigen::AngleAxisd(2 * std::numbers::pi * i / attitudes, to) * first);
  return all;
}

BestFitSettings fit_settings(int threads) {
  BestFitSettings settings;
  settings.fit.threads = threads;
  settings.fit.small_mm = 1e-4;
  // Surfaces from voxels have noisy normals; those of a scan are exact.
  settings.fit.planes_of_points = true;
  settings.fit.least_cos = 0.2;
  return settings;
}

/// The best pose of crowns in every attitude about the target's.
RankedPose fit_anyhow(const CrownPoints& crowns, const ArchTarget& target,
                      const BestFitSettings& settings) {
  std::vector<Pose> starts;
  for (const Matrix3d& R : turns(crowns.bite, target.bite()))
    starts.push_back({Eigen::Quaterniond(R), target.center() - R * crowns.center});
  return rank_starts(crowns.points, target.pairs(), starts, settings).front();
}

/// Poses in which the arch has slid by about a tooth.
std::vector<Pose> slid(const Pose& X_CS, const ArchTarget& target) {
  constexpr double tooth_rad = 16 * std::numbers::pi / 180, tooth_mm = 7;
  std::vector<Pose> all;
  const auto add = [&](double angle, double back_mm) {
    Pose move;
    move.R = Eigen::AngleAxisd(angle, target.bite());
    move.t = target.center() - move.R * target.center() + back_mm * Vector3d::UnitY();
    all.push_back(move * X_CS);
  };
  for (const double sign : {-1.0, 1.0}) {
    add(sign * tooth_rad, 0);
    add(0.5 * sign * tooth_rad, 0);
    add(0, sign * tooth_mm);
    add(0, 0.5 * sign * tooth_mm);
  }
  return all;
}

/// The start by picked points.
Pose picked_start(const DentalScan& scan, const ArchFitRequest& request, double& worst_mm) {
  std::vector<Vector3d> p_S, p_C;
  std::vector<std::string> names;
  std::string unknown;
  for (const auto& [name, p] : request.picks.points) {
    if (const auto partner = request.landmarks.find(name)) {
      p_S.push_back(p);
      p_C.push_back(*partner);
      names.push_back(name);
    } else {
      unknown += (unknown.empty() ? "" : ", ") + name;
    }
  }
  const auto X_CS = rigid_fit(p_S, p_C);
  if (!X_CS)
    throw InputError(fmt::format(
        "the points on {}: {} of them have a partner among the case's landmarks; three that are "
        "not on a line are needed{}",
        scan.source, names.size(), unknown.empty() ? "" : "; the case has no landmark " + unknown));
  std::string worst;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (const double mm = (*X_CS * p_S[i] - p_C[i]).norm(); mm > worst_mm)
      worst_mm = mm, worst = names[i];
  if (worst_mm > far_pick_mm)
    throw InputError(fmt::format(
        "the points on {} do not fit the case's landmarks: {} remains {:.1f} mm off (at most "
        "{:.0f}); check names and sides, and that the scan is not mirrored",
        scan.source, worst, worst_mm, far_pick_mm));
  return *X_CS;
}

/// Half of the points, by the sign of the distance from the midline plane in the case.
OrientedPoints half_of(const OrientedPoints& points, const Pose& X_CS, double midline, bool left) {
  OrientedPoints half;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (((X_CS * points.points[i]).x() > midline) == left) {
      half.points.push_back(points.points[i]);
      half.normals.push_back(points.normals[i]);
    }
  return half.thinned(half_point_count);
}

double halves_difference(const OrientedPoints& points, const ArchTarget& target, const Pose& X_CS,
                         const BestFitSettings& settings) {
  std::array<Pose, 2> X;
  for (const bool left : {false, true}) {
    const OrientedPoints half = half_of(points, X_CS, target.marks()[0].x(), left);
    X[left] = fit_to_surface(half.points, half.normals, target.pairs(), X_CS, settings.fit).X_BA;
  }
  double largest = 0;
  for (const auto& mark : target.marks()) {
    const Vector3d p_S = X_CS.inverse() * mark;
    largest = std::max(largest, (X[0] * p_S - X[1] * p_S).norm());
  }
  return largest;
}

}  // namespace

ArchTarget::ArchTarget(const Part& teeth)
    : upper_(teeth.role == Role::upper_teeth), name_(teeth.name), pairs_(teeth.mesh) {
  constexpr double least_cos = 0.5;  // of an arch's plane to the horizontal one
  const Vector3d toward = upper_ ? Vector3d(-Vector3d::UnitZ()) : Vector3d::UnitZ();
  bite_ = flat_normal(teeth.mesh);
  if (bite_.dot(toward) < 0) bite_ = -bite_;
  if (bite_.dot(toward) < least_cos) bite_ = toward;
  const CrownPoints crowns = crown_points(teeth.mesh, bite_, crown_point_count);
  if (crowns.points.size() == 0) throw InputError(name_ + ": has no crowns to register a scan to");
  center_ = crowns.center;
  find_marks(teeth, crowns);
}

void ArchTarget::find_marks(const Part& teeth, const CrownPoints& crowns) {
  const auto tooth_center = [&](int fdi) -> std::optional<Vector3d> {
    for (const auto& tooth : teeth.teeth) {
      if (tooth.fdi != fdi) continue;
      Vector3d sum = Vector3d::Zero();
      for (int t = 0; t < tooth.triangle_count; ++t)
        for (const int v : teeth.mesh.triangles[tooth.first_triangle + t])
          sum += teeth.mesh.vertices[v];
      return sum / (3.0 * tooth.triangle_count);
    }
    return std::nullopt;
  };
  Box box;
  for (const auto& p : crowns.points.points) box.add(p);
  const Vector3d middle = box.center();
  const double molar_y = box.low.y() + molar_fraction * box.size().y();
  marks_ = {Vector3d(middle.x(), box.low.y(), middle.z()),
            Vector3d(box.high.x(), molar_y, middle.z()),
            Vector3d(box.low.x(), molar_y, middle.z())};
  const int quadrant = upper_ ? 20 : 30, other = upper_ ? 10 : 40;
  const auto a = tooth_center(quadrant + 1), b = tooth_center(other + 1);
  if (a && b) marks_[0] = 0.5 * (*a + *b);
  if (const auto molar = tooth_center(quadrant + 6)) marks_[1] = *molar;
  if (const auto molar = tooth_center(other + 6)) marks_[2] = *molar;
}

ArchFit fit_arch(const DentalScan& scan, const ArchTarget& target, const ArchFitRequest& request) {
  const BestFitSettings settings = fit_settings(request.threads);
  const Vector3d normal = flat_normal(scan.mesh);
  ArchFit fit;
  std::array<CrownPoints, 2> sides;  // either may have the crowns
  CrownPoints crowns;
  Pose start;
  if (request.picks.points.empty()) {
    sides = {crown_points(scan.mesh, normal, crown_point_count),
             crown_points(scan.mesh, -normal, crown_point_count)};
    const std::array ranked = {fit_anyhow(sides[0], target, settings),
                               fit_anyhow(sides[1], target, settings)};
    const int better = ranked[0].residual_mm <= ranked[1].residual_mm ? 0 : 1;
    crowns = sides[better];
    start = ranked[better].X_BA;
  } else {
    start = picked_start(scan, request, fit.picks_mm);
    crowns = crown_points(scan.mesh, start.R.conjugate() * target.bite(), crown_point_count);
    sides = {crowns, crowns};
  }
  const BestFit best =
      best_fit_to_surface(crowns.points, target.pairs(), start, settings, slid(start, target));
  fit.X_CS = best.fit.X_BA;
  fit.points = static_cast<int>(crowns.points.size());
  fit.mean_mm = best.residual.trimmed_mean_mm;
  fit.median_mm = best.residual.median_mm;
  fit.p95_mm = best.residual.p95_mm;
  fit.left_out = fit.points == 0 ? 1 : 1 - static_cast<double>(best.fit.pairs) / fit.points;
  fit.halves_mm = halves_difference(crowns.points, target, fit.X_CS, settings);
  if (request.mirror_test)
    fit.mirrored_mm = fit_anyhow(mirrored(crowns), target, settings).residual_mm;
  if (request.opposing && fit.mean_mm > good_fit_mm)
    fit.exchanged_mm = std::min(fit_anyhow(sides[0], *request.opposing, settings).residual_mm,
                                fit_anyhow(sides[1], *request.opposing, settings).residual_mm);
  return fit;
}

std::vector<float> crown_distances(const DentalScan& scan, const ArchTarget& target,
                                   const Pose& X_CS, int threads) {
  const BestFitSettings settings = fit_settings(threads);
  const std::vector<Vector3d> normals = vertex_normals(scan.mesh);
  std::vector<float> residual_mm(normals.size(), std::nanf(""));
  parallel_for(normals.size(), threads, [&](std::size_t i) {
    const auto pair = target.pairs().find(X_CS * scan.mesh.vertices[i], X_CS.R * normals[i],
                                          settings.fit.least_cos);
    if (pair && std::abs(pair->distance) <= settings.far_mm)
      residual_mm[i] = static_cast<float>(pair->distance);
  });
  return residual_mm;
}

std::string refusal(const ArchFit& fit, const DentalScan& scan, const ArchTarget& target,
                    bool accept_residual) {
  const char *arch = target.upper() ? "upper" : "lower",
             *other = target.upper() ? "lower" : "upper";
  if (fit.exchanged_mm && *fit.exchanged_mm < much_better * fit.mean_mm)
    return fmt::format(
        "{} is given as the {} arch, but fits the case's {} crowns better ({:.2f} against {:.2f} "
        "mm): the arches are exchanged",
        scan.source, arch, other, *fit.exchanged_mm, fit.mean_mm);
  if (fit.mirrored_mm && *fit.mirrored_mm < much_better * fit.mean_mm)
    return fmt::format(
        "{} is mirrored: its mirror image fits the case's {} crowns better ({:.2f} against {:.2f} "
        "mm)",
        scan.source, arch, *fit.mirrored_mm, fit.mean_mm);
  if (scan.inward && fit.mirrored_mm && *fit.mirrored_mm < as_good * fit.mean_mm &&
      !accept_residual)
    return fmt::format(
        "{} seems to be mirrored: its triangles face inward, and its mirror image fits as well "
        "({:.2f} against {:.2f} mm); export it again, or use --accept",
        scan.source, *fit.mirrored_mm, fit.mean_mm);
  if (fit.mean_mm > refused_fit_mm && !accept_residual)
    return fmt::format(
        "{} does not fit the case's {} crowns: mean distance {:.2f} mm after registration (good up "
        "to {} mm, refused above {} mm); check patient and arch, give picked points with "
        "--{}-points, or use --accept",
        scan.source, arch, fit.mean_mm, good_fit_mm, refused_fit_mm, arch);
  return "";
}

std::vector<std::string> fit_notes(const ArchFit& fit, const DentalScan& scan,
                                   const ArchTarget& target) {
  std::vector<std::string> notes = scan.notes;
  notes.push_back(fmt::format(
      "{} ({}): registered to {}: mean {:.2f} mm of the nearest four fifths of {} points on the "
      "crowns, median {:.2f}, 95 % within {:.2f} mm; the halves of the arch differ by {:.2f} mm",
      target.upper() ? "upper scan" : "lower scan", scan.source, target.name(), fit.mean_mm,
      fit.points, fit.median_mm, fit.p95_mm, fit.halves_mm));
  if (fit.mean_mm > noted_fit_mm)
    notes.push_back(
        fmt::format("{}: {:.2f} mm is above {} mm: look at the result before you use it",
                    scan.source, fit.mean_mm, noted_fit_mm));
  if (fit.halves_mm > noted_halves_mm)
    notes.push_back(fmt::format(
        "{}: left and right half, fitted alone, differ by {:.2f} mm at the first molars "
        "or incisors (more than {} mm): look at the result before you use it",
        scan.source, fit.halves_mm, noted_halves_mm));
  if (fit.mirrored_mm && *fit.mirrored_mm < as_good * fit.mean_mm)
    notes.push_back(scan.source +
                    ": the arch is so symmetric that its shape does not tell it from its mirror "
                    "image");
  return notes;
}

}  // namespace condyle
