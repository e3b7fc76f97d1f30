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

const Pose nowhere = {Eigen::Quaterniond::Identity(),
                      Vector3d::Constant(std::numeric_limits<double>::infinity())};
// Shares of the band beyond the gap: distance up to which samples are collected for several steps,
// and up to which they can be touches.
constexpr double collect_share = 0.65, active_share = 0.3;
constexpr double least_band_mm = 0.2;  // that must be left beyond the gap
constexpr double flat_cos = 0.985;     // of the faces at a sample: within 10 degrees
constexpr double sift_mm = 0.02;       // way after which samples are sifted anew
constexpr double slope = 1.25;         // of interpolated distances at most, on short ways
constexpr double within_share = 1.5, widest_share = 8;  // of the gap that is asked for
constexpr int most_wide_parts = 32;
constexpr double late_mm = 0.03;  // on the way since a search
constexpr int group_size = 256;   // neighbours at most
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

/// Of the near samples those that can be touches until the bodies have moved on, less those that
/// stay behind a neighbour.
void TouchFinder::sift(Look& look, const LookedAt& place) {
  look.is_sifted = true;
  look.sifted.clear();
  group_.clear();
  const SurfaceSamples& s = look.samples->samples;
  const Eigen::Matrix3d R = place.sifted_at.R.toRotationMatrix();
  const double reach = place.within_mm + slope * sift_mm;
  const double was_within =
      look.gap_mm + reach + moved(look, place.near_at, place.sifted_at) + late_mm;
  int group = -1;
  for (const NearSample& n : look.near) {
    if (n.distance_mm > was_within) continue;
    const auto i = static_cast<std::size_t>(n.sample);
    if (look.group[i] != group) {
      thin(look, place.within_mm + sift_mm);
      group = look.group[i];
    }
    const FieldSample here = look.field->field.at(R * s.points[i] + place.sifted_at.t);
    double gap = here.distance_mm - look.gap_mm;
    if (!look.allowed.empty()) gap -= static_cast<double>(look.allowed[i]);
    if (here.known && gap > reach) continue;
    const SampleLook seen = judged(here, R * s.normals[i], s.spread[i]);
    if (seen.known && seen.faces)
      group_.push_back({n.sample, gap, here.gradient});
    else
      look.sifted.push_back(n.sample);
  }
  thin(look, place.within_mm + sift_mm);
  std::sort(look.sifted.begin(), look.sifted.end());
}

/// Keeps the deepest of a group and whatever may get deeper than those kept on a way of any of its
/// samples: gaps change by their gradients times the way, ways differ by the turn.
void TouchFinder::thin(Look& look, double way_mm) {
  std::sort(group_.begin(), group_.end(), [](const Candidate& x, const Candidate& y) {
    return std::pair(x.gap_mm, x.sample) < std::pair(y.gap_mm, y.sample);
  });
  const std::vector<Vector3d>& points = look.samples->samples.points;
  const double turn = way_mm / look.radius_mm;
  std::size_t kept = 0;
  for (const Candidate& c : group_) {
    bool behind = false;
    for (std::size_t k = 0; k < kept && !behind; ++k)
      behind = c.gap_mm - group_[k].gap_mm >=
               way_mm * (c.gradient - group_[k].gradient).norm() +
                   turn * (points[c.sample] - points[group_[k].sample]).norm();
    if (behind) continue;
    look.sifted.push_back(c.sample);
    group_[kept++] = c;
  }
  group_.clear();
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
    look.group.resize(samples->samples.points.size());
    int groups = 0, grouped = 0;
    for (const auto& ball : samples->samples.balls) {
      if (ball.count > group_size || ball.first < grouped) continue;
      grouped = ball.first + ball.count;
      std::fill_n(look.group.begin() + ball.first, ball.count, groups++);
    }
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
    looked_at_.push_back({nowhere, nowhere});
  };
  for (const Surface& s : of_a)
    for (const Surface& t : of_b) {
      add(t, s, true);
      add(s, t, false);
    }
}

void TouchFinder::allow_overlap(int pair, std::span<const Pose> X_WB, double around_mm) {
  constexpr float anywhere = -std::numeric_limits<float>::infinity();
  for (std::size_t l = 0; l < looks_.size(); ++l) {
    Look& look = looks_[l];
    if (look.pair != pair) continue;
    looked_at_[l].sifted_at = nowhere;
    const Pose X_FS = relative(look, X_WB);
    const SurfaceSamples& samples = look.samples->samples;
    std::vector<NearSample> near;
    collect_near(samples, look.field->field, X_FS, look.reach_mm, near);
    look.allowed.assign(samples.points.size(), 0.0f);
    for (const NearSample& n : near) {
      const FieldSample here = look.field->field.at(X_FS * samples.points[n.sample]);
      if (!here.known)
        look.allowed[n.sample] = anywhere;
      else if (here.distance_mm < look.gap_mm)
        look.allowed[n.sample] = static_cast<float>(here.distance_mm - look.gap_mm);
    }
    if (!(around_mm > 0)) continue;
    std::vector<Vector3d> overlapping;
    for (std::size_t i = 0; i < samples.points.size(); ++i)
      if (look.allowed[i] < 0) overlapping.push_back(samples.points[i]);
    for (const int i : samples_around(samples, overlapping, around_mm)) look.allowed[i] = anywhere;
  }
}

void TouchFinder::set_looked_at(std::vector<LookedAt> places) {
  looked_at_ = std::move(places);
  for (Look& look : looks_) look.is_searched = look.is_sifted = false;
}

void TouchFinder::locate(std::span<const Pose> X_WB) {
  for (std::size_t l = 0; l < looks_.size(); ++l) {
    Look& look = looks_[l];
    LookedAt& place = looked_at_[l];
    look.X_FS = relative(look, X_WB);
    look.walked_mm = moved(look, place.near_at, look.X_FS);
    if (!(look.walked_mm <= look.reserve_mm)) {
      place.near_at = look.X_FS;
      place.sifted_at = nowhere;
      look.walked_mm = 0;
      look.is_searched = false;
    }
    if (look.is_searched) continue;
    look.is_searched = true;
    look.near.clear();
    collect_near(look.samples->samples, look.field->field, place.near_at, look.reach_mm, look.near);
  }
}

void TouchFinder::find(std::span<const Pose> X_WB, double active_mm, int threads,
                       std::vector<Touch>& found) {
  R_FS_.resize(looks_.size());
  R_WF_.resize(looks_.size());
  places_.clear();
  for (std::size_t l = 0; l < looks_.size(); ++l) {
    Look& look = looks_[l];
    LookedAt& place = looked_at_[l];
    R_FS_[l] = look.X_FS.R.toRotationMatrix();
    R_WF_[l] = X_WB[static_cast<std::size_t>(look.field_of)].R.toRotationMatrix();
    if (!(moved(look, place.sifted_at, look.X_FS) <= sift_mm && active_mm <= place.within_mm)) {
      place.sifted_at = look.X_FS;
      place.within_mm = within_share * active_mm;
      place.wide_parts = 0;
      look.is_sifted = false;
    }
    if (!look.is_sifted) sift(look, place);
    for (const int sample : look.sifted) places_.push_back({static_cast<int>(l), sample});
  }
  seen_.resize(places_.size());
  counts_.resize(places_.size());
  const auto see = [&](std::size_t p) {
    const auto l = static_cast<std::size_t>(places_[p].look);
    const Look& look = looks_[l];
    const int sample = places_[p].sample;
    const SurfaceSamples& s = look.samples->samples;
    const Vector3d p_F = R_FS_[l] * s.points[sample] + look.X_FS.t;
    const FieldSample in_field = look.field->field.at(p_F);
    Touch& touch = seen_[p];
    touch.gap_mm = in_field.distance_mm - look.gap_mm;
    if (!look.allowed.empty()) touch.gap_mm -= static_cast<double>(look.allowed[sample]);
    counts_[p] = in_field.known && touch.gap_mm <= active_mm;
    if (!counts_[p]) return;
    const SampleLook here = judged(in_field, R_FS_[l] * s.normals[sample], s.spread[sample]);
    counts_[p] = here.faces && here.gradient.squaredNorm() > 0.1;
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

void TouchFinder::narrow(double active_mm) {
  for (LookedAt& place : looked_at_) {
    place.wide_parts = place.within_mm > widest_share * active_mm ? place.wide_parts + 1 : 0;
    if (place.wide_parts >= most_wide_parts) place.sifted_at = nowhere;
  }
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
    if (look.near.empty() || way > most_active_mm_) {
      // Samples that are not among the near ones are at least this far from the surface.
      const double away = look.reach_mm - look.walked_mm - field_bend_mm;
      if (look.near.empty() && away > look.gap_mm + way) continue;
      if (clearance_bound(look.samples->samples, look.field->field, look.X_FS, look.gap_mm + way) >=
          look.gap_mm + way)
        continue;
    }
    longest = way;
  }
  return longest;
}

}  // namespace condyle
