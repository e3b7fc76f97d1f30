#include "render/life/upper_lid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/math/smooth_step.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double deg = 3.14159265358979 / 180;
constexpr double step_mm = 0.5, farthest_mm = 18;  // along the axis
constexpr double step_up = 1 * deg, farthest_up = 60 * deg;
constexpr float near_mm = 15;  // before the eyeball: its lids and what is beside them
constexpr double recess_mm = 0.8, outside = 3 * deg;  // of the caruncle from the lids beside it
constexpr double thin_mm = 2,
                 deep_mm = 11;  // skin further before the lids moves less, not at all
constexpr int tapering = 6;     // columns beyond the opening
constexpr double spread_mm = 4;
constexpr double narrowest = 10 * deg, shortest_mm = 3;
constexpr double overlap = 2.5 * deg;         // of the closed lids
constexpr double tarsus = 5 * deg;            // skin above the edge that does not stretch
constexpr double fold_above_edge = 28 * deg;  // to where the skin does not move
// The crease of a closed lid above its edge, and the fold that hangs over it.
constexpr double crease_above_edge = 40 * deg, crease_width = 7 * deg;
constexpr double crease_mm = 0.6, crease_shade = 0.3;
constexpr float clear_mm = 0.15f;        // of the eyeball
constexpr double iris_shown = 21 * deg;  // edge of a lid that covers the top of the iris
constexpr double lid_per_gaze = 0.8;     // rotation of the lid over that of the eye
constexpr double highest = -0.2;         // above rest, fraction of the way down
constexpr double beside_edge = 3 * deg;
// Where the change of the opening is measured along the axis; edges count by their distance.
constexpr double measured_every = 1.2, measured_over = 0.9;  // mm
constexpr int measured = 25;
constexpr auto columns = static_cast<std::size_t>(2 * farthest_mm / step_mm) + 1;

/// Interpolates what was measured along the axis.
float widened(std::span<const float> measures, float along) {
  const float at =
      std::clamp(along / static_cast<float>(measured_every) + measured / 2, 0.f, measured - 1.001f);
  const auto i = static_cast<std::size_t>(at);
  return measures[i] + (at - static_cast<float>(i)) * (measures[i + 1] - measures[i]);
}

double along_of(std::size_t column) { return -farthest_mm + step_mm * static_cast<double>(column); }

}  // namespace

float Eyeball::reach(const Vector3f& direction, const Vector3f& gaze) const {
  if (profile.empty()) return radius;
  const float at = std::acos(std::clamp(direction.dot(gaze), -1.f, 1.f)) / step_rad;
  const auto last = profile.size() - 1;
  const auto i = std::min(static_cast<std::size_t>(at), last);
  // Without terraces: between the larger values of the steps on both sides of its ends.
  const float here = std::max(profile[i > 0 ? i - 1 : 0], profile[i]),
              next = std::max(profile[i], profile[std::min(i + 1, last)]);
  return here + std::min(at - static_cast<float>(i), 1.f) * (next - here);
}

UpperLid::Place UpperLid::place_of(const Vector3d& p) const {
  const Vector3d v = p - eyeball_.centre.cast<double>();
  const double ahead = v.dot(ahead_), up = v.dot(up_);
  return {v.dot(axis_), std::hypot(ahead, up), std::atan2(up, ahead)};
}

Vector3d UpperLid::point_at(const Place& at) const {
  return eyeball_.centre.cast<double>() + at.along * axis_ +
         at.away * (std::cos(at.up) * ahead_ + std::sin(at.up) * up_);
}

/// Finds the opening column by column, from the middle to both canthi: where no skin is before the
/// eyeball, and where it lies deeper than the lids above and below, as the caruncle does.
void UpperLid::scan(const TriMesh& near) {
  const TriangleTree tree(near);
  const double reach = eyeball_.radius + near_mm;
  /// Distance of the foremost skin from the axis; 0: none.
  const auto away = [&](double along, double up) {
    const Vector3d axis_point = point_at({along, 0, up}), from = point_at({along, reach, up});
    const auto hit = tree.ray_cast(from, (axis_point - from).normalized(), reach);
    return hit ? reach - hit->distance : 0;
  };
  gaps_.assign(columns, {});
  const auto middle = columns / 2;
  // The opening of a column is the one that goes on from its neighbour.
  const auto find = [&](std::size_t column, const Gap& before) -> bool {
    const double along = along_of(column);
    const double lids =
        std::min(away(along, before.top + outside), away(along, before.bottom - outside));
    const auto open = [&](double up) { return away(along, up) < lids - recess_mm; };
    const auto edge = [&](double inside, double beyond) {
      for (int i = 0; i < 6; ++i) {
        const double between = (inside + beyond) / 2;
        (open(between) ? inside : beyond) = between;
      }
      return (inside + beyond) / 2;
    };
    double inside = before.bottom;
    while (!open(inside))
      if ((inside += step_up) > before.top) return false;
    double top = inside, bottom = inside;
    while (top < before.top + outside && open(top)) top += step_up;
    while (bottom > before.bottom - outside && open(bottom)) bottom -= step_up;
    gaps_[column] = {edge(bottom + step_up, bottom), edge(top - step_up, top), lids};
    return true;
  };
  const auto gap_before_eye = [&]() -> Gap {
    Gap gap;
    while (gap.top < farthest_up && away(0, gap.top) == 0) gap.top += step_up;
    while (gap.bottom > -farthest_up && away(0, gap.bottom) == 0) gap.bottom -= step_up;
    return gap;
  };
  const Gap first = gap_before_eye();
  if (first.top >= farthest_up || first.bottom <= -farthest_up || !find(middle, first)) return;
  for (const int way : {-1, 1})
    for (std::size_t c = middle; c > 0 && c + 1 < columns;) {
      const Gap& before = gaps_[c];
      c = static_cast<std::size_t>(static_cast<int>(c) + way);
      if (!find(c, before)) break;
    }
}

/// Takes the line between the canthi, seen from the front, as the axis. False where there is none.
bool UpperLid::lean_on_canthi() {
  std::optional<Vector3d> first, last;
  for (std::size_t c = 0; c < columns; ++c) {
    const Gap& gap = gaps_[c];
    if (!(gap.top > gap.bottom)) continue;
    last = point_at({along_of(c), gap.away, (gap.top + gap.bottom) / 2});
    if (!first) first = last;
  }
  if (!first) return false;
  Vector3d between = *last - *first;
  between.y() = 0;
  if (between.norm() < shortest_mm) return false;
  axis_ = between.normalized();
  up_ = axis_.cross(ahead_).normalized();
  if (up_.z() < 0) up_ = -up_;
  return true;
}

/// Continues the gap beyond its ends, ever narrower: the lid also moves before the caruncle, where
/// the opening ends bluntly.
void UpperLid::taper() {
  const auto open = [](const Gap& gap) { return gap.top > gap.bottom; };
  const auto continue_it = [&](auto first, auto last) {
    const auto end = std::find_if(std::find_if(first, last, open), last,
                                  [&](const Gap& gap) { return !open(gap); });
    if (end == last || end == first) return;
    const Gap edge = *std::prev(end);
    const double middle = (edge.top + edge.bottom) / 2, half = (edge.top - edge.bottom) / 2;
    int beyond = 1;
    for (auto at = end; at != last && beyond <= tapering; ++at, ++beyond) {
      const double left = half * (1 - static_cast<double>(beyond) / (tapering + 1));
      *at = {middle - left, middle + left, edge.away};
    }
  };
  continue_it(gaps_.begin(), gaps_.end());
  continue_it(gaps_.rbegin(), gaps_.rend());
}

std::optional<UpperLid> UpperLid::find(std::span<const Vector3f> rest,
                                       std::span<const Eigen::Vector3i> triangles,
                                       const Eyeball& eyeball, FaceSide side) {
  UpperLid lid(eyeball, side);
  TriMesh near;
  const float far = eyeball.radius + near_mm;
  std::vector<int> own(rest.size(), -1);
  for (std::size_t v = 0; v < rest.size(); ++v)
    if ((rest[v] - eyeball.centre).norm() < far) {
      own[v] = static_cast<int>(near.vertices.size());
      near.vertices.push_back(rest[v].cast<double>());
    }
  for (const auto& t : triangles) {
    const Eigen::Vector3i corners(own[static_cast<std::size_t>(t[0])],
                                  own[static_cast<std::size_t>(t[1])],
                                  own[static_cast<std::size_t>(t[2])]);
    if (corners.minCoeff() >= 0) near.triangles.push_back(corners);
  }
  if (near.triangles.empty()) return std::nullopt;
  lid.scan(near);
  if (!lid.lean_on_canthi()) return std::nullopt;
  lid.scan(near);
  for (int pass = 0; pass < 2; ++pass) {  // the rim has the steps of its triangles
    const auto before = lid.gaps_;
    for (std::size_t c = 1; c + 1 < columns; ++c)
      if (before[c].top > before[c].bottom)
        for (double Gap::*edge : {&Gap::bottom, &Gap::top, &Gap::away}) {
          const auto& [l, m, r] = std::tie(before[c - 1], before[c], before[c + 1]);
          if (l.top > l.bottom && r.top > r.bottom)
            lid.gaps_[c].*edge = 0.25 * l.*edge + 0.5 * m.*edge + 0.25 * r.*edge;
        }
  }
  lid.taper();
  for (std::size_t c = 0; c < columns; ++c) {
    const double wide = lid.gaps_[c].top - lid.gaps_[c].bottom;
    if (!(wide > 0)) continue;
    lid.widest_ = std::max(lid.widest_, wide);
    lid.first_ = std::min(lid.first_, along_of(c));
    lid.last_ = std::max(lid.last_, along_of(c));
  }
  if (lid.widest_ < narrowest) return std::nullopt;
  lid.staring_ = std::clamp((lid.gap_at(0).top - iris_shown) / lid.way_at(0), 0.0, 0.25);
  lid.collect(rest);
  return lid;
}

UpperLid::Gap UpperLid::gap_at(double along) const {
  const double at =
      std::clamp((along + farthest_mm) / step_mm, 0.0, static_cast<double>(columns - 1) - 1e-6);
  const auto c = static_cast<std::size_t>(at);
  const double t = at - static_cast<double>(c);
  const Gap &a = gaps_[c], &b = gaps_[c + 1];
  const bool has_a = a.top > a.bottom, has_b = b.top > b.bottom;
  const auto between = [&](double Gap::*of) { return (1 - t) * a.*of + t * b.*of; };
  if (has_a && has_b) return {between(&Gap::bottom), between(&Gap::top), between(&Gap::away)};
  if (!has_a && !has_b) return {};
  // It closes within the step beyond its last column.
  const Gap& last = has_a ? a : b;
  const double open = has_a ? 1 - t : t, middle = (last.top + last.bottom) / 2;
  return {middle + open * (last.bottom - middle), middle + open * (last.top - middle), last.away};
}

double UpperLid::way_at(double along) const {
  const Gap gap = gap_at(along);
  const double way = gap.top - gap.bottom;
  return way + overlap * std::min(1.0, way / (4 * overlap));
}

/// Skin above a canthus is drawn along by the lid beside it.
double UpperLid::spread_way(double along) const {
  double sum = 0, all = 0;
  for (int i = -2; i <= 2; ++i) {
    const double weight = 3 - std::abs(i);
    sum += weight * way_at(along + i * spread_mm / 2);
    all += weight;
  }
  return sum / all;
}

void UpperLid::collect(std::span<const Vector3f> rest) {
  const float far = eyeball_.radius + near_mm;
  for (std::size_t v = 0; v < rest.size(); ++v) {
    if ((rest[v] - eyeball_.centre).norm() > far) continue;
    const Place at = place_of(rest[v].cast<double>());
    Gap gap = gap_at(std::clamp(at.along, first_, last_));
    if (at.along < first_ || at.along > last_) gap.top = gap.bottom = (gap.top + gap.bottom) / 2;
    const double above = (at.up - gap.top - tarsus) / (fold_above_edge - tarsus);
    const double spread = smooth_step(2 * above);
    const double way = (1 - spread) * way_at(at.along) + spread * spread_way(at.along);
    if (!(way > 0)) continue;
    if (at.away < gap.away + thin_mm) collect_edge(static_cast<int>(v), at, gap);
    const double middle = (gap.bottom + gap.top) / 2;
    if (at.up < middle) continue;
    const double deep = (at.away - gap.away - thin_mm) / (deep_mm - thin_mm);
    // The caruncle stays behind the lid.
    const double behind = smooth_step((gap.away - at.away) / recess_mm - 1),
                 on_lid = at.up < gap.top ? smooth_step((at.up - middle) / (gap.top - middle)) : 1;
    const double moves =
        (1 - smooth_step(above)) * (1 - smooth_step(deep)) * (1 - behind * (1 - on_lid));
    if (!(moves > 0)) continue;
    const double beside = way / (widest_ + overlap);  // 1 at the middle, 0 at the canthi
    const double from_crease =
        (at.up - gap.top + way * (1 - moves) - crease_above_edge * std::sqrt(beside)) /
        crease_width;
    const double strength = smooth_step((beside - 0.4) / 0.5) * (1 - behind);
    const auto bump = [](double x) { return std::exp(-x * x); };
    const double crease = strength * bump(from_crease),
                 fold = strength * bump((from_crease - 2) / 1.2);
    members_.push_back({static_cast<int>(v), static_cast<float>(way * moves),
                        static_cast<float>(moves), static_cast<float>(at.along),
                        static_cast<float>(crease),
                        static_cast<float>(crease_mm * (0.5 * fold - crease))});
  }
}

void UpperLid::collect_edge(int vertex, const Place& at, const Gap& gap) {
  if (std::abs(at.up - gap.top) < beside_edge)
    upper_edge_.push_back({vertex, at.along, at.up});
  else if (std::abs(at.up - gap.bottom) < beside_edge)
    lower_edge_.push_back({vertex, at.along, at.up});
}

/// By how much more than at rest the lids are apart, rad, at `measured` angles along the axis.
std::vector<float> UpperLid::widening(std::span<const Vector3f> places) const {
  const auto raised = [&](const std::vector<EdgeVertex>& edge, double along) {
    double sum = 0, all = 1e-9;
    for (const EdgeVertex& of : edge) {
      const double off = (of.along - along) / measured_over, weight = std::exp(-off * off);
      const Vector3d now = places[static_cast<std::size_t>(of.vertex)].cast<double>();
      sum += weight * (place_of(now).up - of.up);
      all += weight;
    }
    return sum / all;
  };
  std::vector<float> wider;
  for (int i = 0; i < measured; ++i) {
    const double along = measured_every * (i - measured / 2);
    wider.push_back(static_cast<float>(raised(upper_edge_, along) - raised(lower_edge_, along)));
  }
  return wider;
}

double UpperLid::lowered(const LifeSigns& signs) const {
  const double closure = side_ == FaceSide::left ? signs.lids.left : signs.lids.right;
  const double open = signs.alive ? staring_ - lid_per_gaze * signs.gaze_up / widest_ : 0;
  const double to = closure > 0 ? 1 : highest;
  return std::clamp(open + std::abs(closure) * (to - open), highest, 1.0);
}

void UpperLid::move(double lowered, const Vector3f& gaze, std::span<Vector3f> places) const {
  if (lowered == 0) return;
  const std::vector<float> wider = widening(places);
  const auto creased = static_cast<float>(smooth_step(2 * lowered));
  float farthest = eyeball_.radius;
  for (const float reach : eyeball_.profile) farthest = std::max(farthest, reach);
  for (const auto& [vertex, turn, share, along, crease, raised] : members_) {
    Vector3f& p = places[static_cast<std::size_t>(vertex)];
    const float angle = -static_cast<float>(lowered) * (turn + share * widened(wider, along));
    // A thin lid has no room for the crease.
    const float room = std::max(0.f, (p - eyeball_.centre).norm() - farthest - clear_mm);
    p = slid(p, angle, gaze, creased * std::max(raised, -room / 2));
  }
}

Vector3f UpperLid::slid(const Vector3f& p, float angle, const Vector3f& gaze, float off) const {
  const Vector3f axis = axis_.cast<float>(), ahead = ahead_.cast<float>(), up = up_.cast<float>();
  const Vector3f v = p - eyeball_.centre;
  const float c = std::cos(angle), s = std::sin(angle);
  const float x = v.dot(ahead), z = v.dot(up);
  Vector3f there = v.dot(axis) * axis + (c * x - s * z) * ahead + (s * x + c * z) * up;
  const Vector3f direction = there.normalized();
  const float far = there.norm() + off;
  there = std::max(far, eyeball_.reach(direction, gaze) + clear_mm) * direction;
  return eyeball_.centre + there;
}

void UpperLid::shade(double lowered, std::vector<SkinFolds::Shade>& shades) const {
  const double creased = smooth_step(2 * lowered);
  for (const Member& of : members_)
    if (of.crease > 0.01f)
      shades.push_back({of.vertex, static_cast<float>(1 - crease_shade * creased * of.crease)});
}

Eigen::Matrix3f UpperLid::turned(double angle) const {
  // Up is from ahead_ to up_.
  return Eigen::AngleAxisd(angle, ahead_.cross(up_)).toRotationMatrix().cast<float>();
}

}  // namespace condyle
