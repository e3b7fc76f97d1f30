#include "engine/rigid/contact_finder.h"

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
// Fractions of the band beyond the gap: distance up to which samples are collected for several
// steps, and up to which they can be contacts.
constexpr double collect_fraction = 0.65, active_fraction = 0.3;
constexpr double min_band_mm = 0.2;  // that must remain beyond the gap
constexpr double flat_cos = 0.985;   // between the faces at a sample: within 10 degrees
constexpr double sift_mm = 0.02;     // displacement after which samples are selected again
constexpr double slope =
    1.25;  // largest gradient of interpolated distances over short displacements
constexpr double within_fraction = 1.5, widest_fraction = 8;  // relative to the requested gap
constexpr int max_wide_parts = 32;
constexpr double late_mm = 0.03;  // margin for the displacement since a search
constexpr int group_size = 256;   // largest number of neighbours
constexpr std::size_t run = 512;

}  // namespace

Pose ContactFinder::relative(const SampleQuery& query, std::span<const Pose> X_WB) {
  return X_WB[static_cast<std::size_t>(query.field_of)].inverse() *
         X_WB[static_cast<std::size_t>(query.samples_of)];
}

/// Upper bound of the displacement of any sample between the poses; infinite for an unset pose.
double ContactFinder::moved(const SampleQuery& query, const Pose& from, const Pose& to) const {
  const Vector3d& c = query.samples->samples.centroid;
  return (to * c - from * c).norm() + rotation_angle(from.inverse() * to) * query.radius_mm;
}

/// Selects the near samples that can become contacts within the next displacement, without those
/// that remain behind a neighbour.
void ContactFinder::sift(SampleQuery& query, const SampleCacheKey& place) {
  query.is_sifted = true;
  query.sifted.clear();
  group_.clear();
  const SurfaceSamples& s = query.samples->samples;
  const Eigen::Matrix3d R = place.sifted_at.R.toRotationMatrix();
  const double reach = place.within_mm + slope * sift_mm;
  const double was_within =
      query.gap_mm + reach + moved(query, place.near_at, place.sifted_at) + late_mm;
  int group = -1;
  for (const NearSample& n : query.near) {
    if (n.distance_mm > was_within) continue;
    const auto i = static_cast<std::size_t>(n.sample);
    if (query.group[i] != group) {
      thin(query, place.within_mm + sift_mm);
      group = query.group[i];
    }
    const DistanceField& field = query.field->field;
    const DistanceField::Spot spot = field.spot(R * s.points[i] + place.sifted_at.t);
    double gap = spot.distance_mm - query.gap_mm;
    if (!query.allowed.empty()) gap -= static_cast<double>(query.allowed[i]);
    if (spot.known && gap > reach) continue;
    const FieldSample here{spot.distance_mm, field.gradient(spot), spot.known};
    const SampleDistance seen = classified(here, R * s.normals[i], s.spread[i]);
    if (seen.known && seen.faces)
      group_.push_back({n.sample, gap, here.gradient});
    else
      query.sifted.push_back(n.sample);
  }
  thin(query, place.within_mm + sift_mm);
  std::sort(query.sifted.begin(), query.sifted.end());
}

/// Keeps the deepest sample of a group and all that may become deeper than the kept ones within the
/// displacement: gaps change by their gradients times the displacement, and displacements of two
/// samples differ by the rotation.
void ContactFinder::thin(SampleQuery& query, double displacement_mm) {
  std::sort(group_.begin(), group_.end(), [](const Candidate& x, const Candidate& y) {
    return std::pair(x.gap_mm, x.sample) < std::pair(y.gap_mm, y.sample);
  });
  const std::vector<Vector3d>& points = query.samples->samples.points;
  const double turn = displacement_mm / query.radius_mm;
  std::size_t kept = 0;
  for (const Candidate& c : group_) {
    bool behind = false;
    for (std::size_t k = 0; k < kept && !behind; ++k)
      behind = c.gap_mm - group_[k].gap_mm >=
               displacement_mm * (c.gradient - group_[k].gradient).norm() +
                   turn * (points[c.sample] - points[group_[k].sample]).norm();
    if (behind) continue;
    query.sifted.push_back(c.sample);
    group_[kept++] = c;
  }
  group_.clear();
}

void ContactFinder::add_pair(int a, int b, std::span<const Surface> of_a,
                             std::span<const Surface> of_b, double gap_mm) {
  const int pair = queries_.empty() ? 0 : queries_.back().pair + 1;
  const auto add = [&](const Surface& samples, const Surface& field, bool samples_on_b) {
    SampleQuery query;
    query.pair = pair;
    query.samples_on_b = samples_on_b;
    query.samples_of = samples_on_b ? b : a;
    query.field_of = samples_on_b ? a : b;
    query.samples = samples;
    query.field = field;
    for (const Vector3d& p : samples->samples.points)
      query.radius_mm = std::max(query.radius_mm, (p - samples->samples.centroid).norm());
    query.group.resize(samples->samples.points.size());
    int groups = 0, grouped = 0;
    for (const auto& ball : samples->samples.balls) {
      if (ball.count > group_size || ball.first < grouped) continue;
      grouped = ball.first + ball.count;
      std::fill_n(query.group.begin() + ball.first, ball.count, groups++);
    }
    const double room = field->field.settings().band_mm - gap_mm;
    if (!(room >= min_band_mm))
      throw InputError(
          "a gap of " + std::to_string(gap_mm) + " mm cannot be kept by a distance field of " +
          std::to_string(field->field.settings().band_mm) + " mm: give the surface a wider band");
    query.gap_mm = gap_mm;
    query.reach_mm = gap_mm + collect_fraction * room;
    query.reserve_mm = (collect_fraction - active_fraction) * room - field_bend_mm;
    max_active_mm_ = std::min(max_active_mm_, active_fraction * room);
    queries_.push_back(std::move(query));
    keys_.push_back({nowhere, nowhere});
  };
  for (const Surface& s : of_a)
    for (const Surface& t : of_b) {
      add(t, s, true);
      add(s, t, false);
    }
}

void ContactFinder::allow_overlap(int pair, std::span<const Pose> X_WB, double around_mm) {
  constexpr float anywhere = -std::numeric_limits<float>::infinity();
  for (std::size_t l = 0; l < queries_.size(); ++l) {
    SampleQuery& query = queries_[l];
    if (query.pair != pair) continue;
    keys_[l].sifted_at = nowhere;
    const Pose X_FS = relative(query, X_WB);
    const SurfaceSamples& samples = query.samples->samples;
    std::vector<NearSample> near;
    collect_near(samples, query.field->field, X_FS, query.reach_mm, near);
    query.allowed.assign(samples.points.size(), 0.0f);
    for (const NearSample& n : near) {
      const FieldSample here = query.field->field.at(X_FS * samples.points[n.sample]);
      if (!here.known)
        query.allowed[n.sample] = anywhere;
      else if (here.distance_mm < query.gap_mm)
        query.allowed[n.sample] = static_cast<float>(here.distance_mm - query.gap_mm);
    }
    if (!(around_mm > 0)) continue;
    std::vector<Vector3d> overlapping;
    for (std::size_t i = 0; i < samples.points.size(); ++i)
      if (query.allowed[i] < 0) overlapping.push_back(samples.points[i]);
    for (const int i : samples_around(samples, overlapping, around_mm)) query.allowed[i] = anywhere;
  }
}

void ContactFinder::set_sample_caches(std::vector<SampleCacheKey> places) {
  keys_ = std::move(places);
  for (SampleQuery& query : queries_) query.is_searched = query.is_sifted = false;
}

void ContactFinder::locate(std::span<const Pose> X_WB) {
  for (std::size_t l = 0; l < queries_.size(); ++l) {
    SampleQuery& query = queries_[l];
    SampleCacheKey& place = keys_[l];
    query.X_FS = relative(query, X_WB);
    query.walked_mm = moved(query, place.near_at, query.X_FS);
    if (!(query.walked_mm <= query.reserve_mm)) {
      place.near_at = query.X_FS;
      place.sifted_at = nowhere;
      query.walked_mm = 0;
      query.is_searched = false;
    }
    if (query.is_searched) continue;
    query.is_searched = true;
    query.near.clear();
    collect_near(query.samples->samples, query.field->field, place.near_at, query.reach_mm,
                 query.near);
  }
}

void ContactFinder::find(std::span<const Pose> X_WB, double active_mm, int threads,
                         std::vector<SurfaceContact>& found) {
  R_FS_.resize(queries_.size());
  R_WF_.resize(queries_.size());
  places_.clear();
  for (std::size_t l = 0; l < queries_.size(); ++l) {
    SampleQuery& query = queries_[l];
    SampleCacheKey& place = keys_[l];
    R_FS_[l] = query.X_FS.R.toRotationMatrix();
    R_WF_[l] = X_WB[static_cast<std::size_t>(query.field_of)].R.toRotationMatrix();
    if (!(moved(query, place.sifted_at, query.X_FS) <= sift_mm && active_mm <= place.within_mm)) {
      place.sifted_at = query.X_FS;
      place.within_mm = within_fraction * active_mm;
      place.wide_parts = 0;
      query.is_sifted = false;
    }
    if (!query.is_sifted) sift(query, place);
    for (const int sample : query.sifted) places_.push_back({static_cast<int>(l), sample});
  }
  seen_.resize(places_.size());
  counts_.resize(places_.size());
  const auto see = [&](std::size_t p) {
    const auto l = static_cast<std::size_t>(places_[p].query);
    const SampleQuery& query = queries_[l];
    const int sample = places_[p].sample;
    const SurfaceSamples& s = query.samples->samples;
    const Vector3d p_F = R_FS_[l] * s.points[sample] + query.X_FS.t;
    const DistanceField& field = query.field->field;
    const DistanceField::Spot spot = field.spot(p_F);
    SurfaceContact& contact = seen_[p];
    contact.gap_mm = spot.distance_mm - query.gap_mm;
    if (!query.allowed.empty()) contact.gap_mm -= static_cast<double>(query.allowed[sample]);
    counts_[p] = spot.known && contact.gap_mm <= active_mm;
    if (!counts_[p]) return;
    const FieldSample in_field{spot.distance_mm, field.gradient(spot), spot.known};
    const SampleDistance here =
        classified(in_field, R_FS_[l] * s.normals[sample], s.spread[sample]);
    counts_[p] = here.faces && here.gradient.squaredNorm() > 0.1;
    if (!counts_[p]) return;
    contact.pair = query.pair;
    contact.query = static_cast<int>(l);
    contact.sample = sample;
    contact.point = R_WF_[l] * p_F + X_WB[static_cast<std::size_t>(query.field_of)].t;
    // A sample on a flat face meets edges and corners along its own normal; the interpolated
    // distance would round these off.
    const Vector3d out_of_field = s.spread[sample] > flat_cos
                                      ? Vector3d(R_FS_[l] * -s.normals[sample])
                                      : here.gradient.normalized();
    contact.normal = (query.samples_on_b ? 1.0 : -1.0) * (R_WF_[l] * out_of_field);
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

void ContactFinder::narrow(double active_mm) {
  for (SampleCacheKey& place : keys_) {
    place.wide_parts = place.within_mm > widest_fraction * active_mm ? place.wide_parts + 1 : 0;
    if (place.wide_parts >= max_wide_parts) place.sifted_at = nowhere;
  }
}

double ContactFinder::max_displacement(std::span<const Pose> X_WB,
                                       std::span<const Vector3d> centers,
                                       std::span<const SolverMotion> motions, double step_s,
                                       double counts_mm) const {
  double longest = 0;
  for (std::size_t l = 0; l < queries_.size(); ++l) {
    const SampleQuery& query = queries_[l];
    const auto s = static_cast<std::size_t>(query.samples_of),
               f = static_cast<std::size_t>(query.field_of);
    const Vector3d middle = X_WB[s] * query.samples->samples.centroid;
    const auto velocity = [&](std::size_t body) {
      return Vector3d(motions[body].velocity + motions[body].spin.cross(middle - centers[body]));
    };
    const double displacement =
        step_s * ((velocity(s) - velocity(f)).norm() +
                  (motions[s].spin - motions[f].spin).norm() * query.radius_mm);
    if (displacement <= std::max(longest, counts_mm)) continue;
    if (query.near.empty() || displacement > max_active_mm_) {
      // All other samples are at least this far from the surface.
      const double away = query.reach_mm - query.walked_mm - field_bend_mm;
      if (query.near.empty() && away > query.gap_mm + displacement) continue;
      if (clearance_bound(query.samples->samples, query.field->field, query.X_FS,
                          query.gap_mm + displacement) >= query.gap_mm + displacement)
        continue;
    }
    longest = displacement;
  }
  return longest;
}

}  // namespace condyle
