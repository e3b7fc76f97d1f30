#include "engine/rigid/touch_finder.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "engine/core/error.h"
#include "engine/core/parallel.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double infinity = std::numeric_limits<double>::infinity();
// Shares of the band beyond the gap: distance up to which samples are collected for several steps,
// and up to which they can be touches.
constexpr double collect_share = 0.65, active_share = 0.3;
constexpr double least_band_mm = 0.2;  // that must be left beyond the gap
constexpr double flat_cos = 0.985;     // of the faces at a sample: within 10 degrees
// A sample may have come nearer than its way by this much more; if it was more still, it is found
// so much later.
constexpr double late_mm = 0.03;
constexpr std::size_t run = 512;

}  // namespace

Pose TouchFinder::relative(const Look& look, std::span<const Pose> X_WB) {
  return X_WB[static_cast<std::size_t>(look.field_of)].inverse() *
         X_WB[static_cast<std::size_t>(look.samples_of)];
}

/// No sample's way between the poses is longer. Infinite from a pose that was never taken.
double TouchFinder::moved(const Look& look, const Pose& from, const Pose& to) const {
  const Vector3d& c = look.samples->samples.centroid;
  return (to * c - from * c).norm() + rotation_angle(from.inverse() * to) * look.radius_mm;
}

void TouchFinder::search(Look& look, const Pose& X_FS) const {
  look.near.clear();
  look.stale = false;
  collect_near(look.samples->samples, look.field->field, X_FS, look.reach_mm, look.near);
  look.horizon_mm.clear();
  for (const NearSample& n : look.near) look.horizon_mm.push_back(n.distance_mm);
}

void TouchFinder::add_pair(int a, int b, std::span<const Surface> of_a,
                           std::span<const Surface> of_b, double gap_mm) {
  const int pair = looks_.empty() ? 0 : looks_.back().pair + 1;
  const auto add = [&](const Surface& samples, const Surface& field, bool samples_on_b) {
    Look look;
    look.pair = pair;
    look.samples_on_b = samples_on_b;
    look.samples_of = samples_on_b ? b : a;
    look.field_of = samples_on_b ? a : b;
    look.samples = samples;
    look.field = field;
    for (const Vector3d& p : samples->samples.points)
      look.radius_mm = std::max(look.radius_mm, (p - samples->samples.centroid).norm());
    const double room = field->field.settings().band_mm - gap_mm;
    if (!(room >= least_band_mm))
      throw InputError(
          "a gap of " + std::to_string(gap_mm) + " mm cannot be kept by a distance field of " +
          std::to_string(field->field.settings().band_mm) + " mm: give the surface a wider band");
    look.gap_mm = gap_mm;
    look.reach_mm = gap_mm + collect_share * room;
    look.reserve_mm = (collect_share - active_share) * room - field_bend_mm;
    most_active_mm_ = std::min(most_active_mm_, active_share * room);
    looks_.push_back(std::move(look));
    looked_at_.push_back({Eigen::Quaterniond::Identity(), Vector3d::Constant(infinity)});
  };
  for (const Surface& s : of_a)
    for (const Surface& t : of_b) {
      add(t, s, true);
      add(s, t, false);
    }
}

void TouchFinder::allow_overlap(int pair, std::span<const Pose> X_WB) {
  for (Look& look : looks_) {
    if (look.pair != pair) continue;
    const Pose X_FS = relative(look, X_WB);
    const SurfaceSamples& samples = look.samples->samples;
    std::vector<NearSample> near;
    collect_near(samples, look.field->field, X_FS, look.reach_mm, near);
    look.allowed.assign(samples.points.size(), 0.0f);
    for (const NearSample& n : near) {
      const FieldSample here = look.field->field.at(X_FS * samples.points[n.sample]);
      if (!here.known)
        look.allowed[n.sample] = -std::numeric_limits<float>::infinity();
      else if (here.distance_mm < look.gap_mm)
        look.allowed[n.sample] = static_cast<float>(here.distance_mm - look.gap_mm);
    }
  }
}

void TouchFinder::set_looked_at(std::vector<Pose> poses) {
  looked_at_ = std::move(poses);
  for (Look& look : looks_) look.stale = true;
}

void TouchFinder::locate(std::span<const Pose> X_WB) {
  for (std::size_t l = 0; l < looks_.size(); ++l) {
    Look& look = looks_[l];
    const Pose last = look.X_FS;
    look.X_FS = relative(look, X_WB);
    look.walked_mm = moved(look, looked_at_[l], look.X_FS);
    look.path_mm += moved(look, last, look.X_FS);
    if (!(look.walked_mm <= look.reserve_mm)) {
      looked_at_[l] = look.X_FS;
      look.walked_mm = 0;
      look.stale = true;
    }
    if (!look.stale) continue;
    search(look, looked_at_[l]);
    look.path_mm = look.walked_mm;
  }
}

void TouchFinder::find(std::span<const Pose> X_WB, double active_mm, int threads,
                       std::vector<Touch>& found) {
  R_FS_.resize(looks_.size());
  R_WF_.resize(looks_.size());
  places_.clear();
  for (std::size_t l = 0; l < looks_.size(); ++l) {
    const Look& look = looks_[l];
    R_FS_[l] = look.X_FS.R.toRotationMatrix();
    R_WF_[l] = X_WB[static_cast<std::size_t>(look.field_of)].R.toRotationMatrix();
    const double within = look.gap_mm + active_mm + look.path_mm + late_mm;
    for (std::size_t n = 0; n < look.near.size(); ++n)
      if (look.horizon_mm[n] <= within)
        places_.push_back({static_cast<int>(l), static_cast<int>(n)});
  }
  seen_.resize(places_.size());
  counts_.resize(places_.size());
  const auto see = [&](std::size_t p) {
    const auto l = static_cast<std::size_t>(places_[p].look);
    Look& look = looks_[l];
    const auto near = static_cast<std::size_t>(places_[p].near);
    const int sample = look.near[near].sample;
    const SurfaceSamples& s = look.samples->samples;
    const Vector3d p_F = R_FS_[l] * s.points[sample] + look.X_FS.t;
    const SampleLook here =
        look_at_sample(look.field->field, p_F, R_FS_[l] * s.normals[sample], s.spread[sample]);
    look.horizon_mm[near] = look.path_mm + (here.known ? here.distance_mm : -look.reach_mm);
    Touch& touch = seen_[p];
    touch.gap_mm = here.distance_mm - look.gap_mm;
    if (!look.allowed.empty()) touch.gap_mm -= static_cast<double>(look.allowed[sample]);
    counts_[p] =
        here.known && here.faces && touch.gap_mm <= active_mm && here.gradient.squaredNorm() > 0.1;
    if (!counts_[p]) return;
    touch.pair = look.pair;
    touch.look = static_cast<int>(l);
    touch.sample = sample;
    touch.point = R_WF_[l] * p_F + X_WB[static_cast<std::size_t>(look.field_of)].t;
    // A sample on a flat face meets edges and corners along its own normal, which the interpolated
    // distance rounds off.
    const Vector3d out_of_field = s.spread[sample] > flat_cos
                                      ? Vector3d(R_FS_[l] * -s.normals[sample])
                                      : here.gradient.normalized();
    touch.normal = (look.samples_on_b ? 1.0 : -1.0) * (R_WF_[l] * out_of_field);
  };
  const std::size_t runs = (places_.size() + run - 1) / run;
  const auto see_run = [&](std::size_t r) {
    for (std::size_t p = r * run; p < std::min(places_.size(), (r + 1) * run); ++p) see(p);
  };
  if (threads > 1 && runs > 2)
    parallel_for(runs, threads, see_run);
  else
    for (std::size_t r = 0; r < runs; ++r) see_run(r);
  found.clear();
  for (std::size_t p = 0; p < places_.size(); ++p)
    if (counts_[p]) found.push_back(seen_[p]);
}

double TouchFinder::way(std::span<const Pose> X_WB, std::span<const Vector3d> centers,
                        std::span<const SolverMotion> motions, double step_s,
                        double counts_mm) const {
  double longest = 0;
  for (std::size_t l = 0; l < looks_.size(); ++l) {
    const Look& look = looks_[l];
    const auto s = static_cast<std::size_t>(look.samples_of),
               f = static_cast<std::size_t>(look.field_of);
    const Vector3d middle = X_WB[s] * look.samples->samples.centroid;
    const auto velocity = [&](std::size_t body) {
      return Vector3d(motions[body].velocity + motions[body].spin.cross(middle - centers[body]));
    };
    const double way = step_s * ((velocity(s) - velocity(f)).norm() +
                                 (motions[s].spin - motions[f].spin).norm() * look.radius_mm);
    if (way <= std::max(longest, counts_mm)) continue;
    // Samples that are not among the near ones are at least this far from the surface.
    if (look.near.empty() && look.reach_mm - look.walked_mm - field_bend_mm > look.gap_mm + way)
      continue;
    if (clearance_bound(look.samples->samples, look.field->field, look.X_FS, look.gap_mm + way) >=
        look.gap_mm + way)
      continue;
    longest = way;
  }
  return longest;
}

}  // namespace condyle
