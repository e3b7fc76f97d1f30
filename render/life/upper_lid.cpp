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
constexpr double step_along = 2 * deg, farthest_along = 80 * deg;
constexpr double step_up = 1 * deg, farthest_up = 60 * deg;
constexpr float near_mm = 15;  // before the eyeball: its lids and what is beside them
constexpr double thin_mm = 4,
                 deep_mm = 13;  // skin further before the eyeball moves less, not at all
constexpr int tapering = 7;     // columns beyond the opening
constexpr double narrowest = 10 * deg;
constexpr double overlap = 2 * deg;           // of the closed lids
constexpr double tarsus = 5 * deg;            // skin above the edge that does not stretch
constexpr double fold_above_edge = 28 * deg;  // to where the skin does not move
constexpr float clear_mm = 0.15f;             // of the eyeball
constexpr double iris_shown = 21 * deg;       // edge of a lid that covers the top of the iris
constexpr double lid_per_gaze = 0.8;          // rotation of the lid over that of the eye
constexpr double highest = -0.2;              // above rest, fraction of the way down
constexpr double beside_edge = 3 * deg;
// Where the change of the opening is measured, about the axis; edges count by their distance.
constexpr double measured_every = 8 * deg, measured_over = 6 * deg;
constexpr int measured = 17;
constexpr auto columns = static_cast<std::size_t>(2 * farthest_along / step_along) + 1;

double along_of(std::size_t column) {
  return -farthest_along + step_along * static_cast<double>(column);
}

}  // namespace

float Eyeball::reach(const Vector3f& direction, const Vector3f& gaze) const {
  if (profile.empty()) return radius;
  const float at = std::acos(std::clamp(direction.dot(gaze), -1.f, 1.f)) / step_rad;
  const auto i = std::min(static_cast<std::size_t>(at), profile.size() - 1);
  return std::max(profile[i], profile[std::min(i + 1, profile.size() - 1)]);
}

UpperLid::Angles UpperLid::angles_of(const Vector3d& p) const {
  const Vector3d v = p - eyeball_.centre.cast<double>();
  const double ahead = v.dot(ahead_), up = v.dot(up_);
  return {std::atan2(v.dot(axis_), std::hypot(ahead, up)), std::atan2(up, ahead)};
}

Vector3d UpperLid::direction(const Angles& a) const {
  return std::sin(a.along) * axis_ +
         std::cos(a.along) * (std::cos(a.up) * ahead_ + std::sin(a.up) * up_);
}

/// Finds the opening column by column, from the middle to both canthi.
void UpperLid::scan(const TriMesh& near) {
  const TriangleTree tree(near);
  const Vector3d centre = eyeball_.centre.cast<double>();
  const auto open = [&](double along, double up) {
    return !tree.ray_cast(centre, direction({along, up}));
  };
  const auto edge = [&](double along, double inside, double outside) {
    for (int i = 0; i < 6; ++i) {
      const double between = (inside + outside) / 2;
      (open(along, between) ? inside : outside) = between;
    }
    return (inside + outside) / 2;
  };
  gaps_.assign(columns, {});
  const auto middle = columns / 2;
  // The opening of a column is the one that goes on from its neighbour.
  const auto find = [&](std::size_t column, double near_up) -> bool {
    const double along = along_of(column);
    double inside = near_up;
    for (double off = 0; !open(along, inside); off += step_up) {
      if (off > farthest_up / 3) return false;
      if (open(along, near_up + off)) inside = near_up + off;
      if (open(along, near_up - off)) inside = near_up - off;
    }
    double top = inside, bottom = inside;
    while (top < farthest_up && open(along, top)) top += step_up;
    while (bottom > -farthest_up && open(along, bottom)) bottom -= step_up;
    if (top >= farthest_up || bottom <= -farthest_up) return false;
    gaps_[column] = {edge(along, bottom + step_up, bottom), edge(along, top - step_up, top)};
    return true;
  };
  if (!find(middle, 0)) return;
  for (const int way : {-1, 1})
    for (std::size_t c = middle; c > 0 && c + 1 < columns;) {
      const Gap& before = gaps_[c];
      c = static_cast<std::size_t>(static_cast<int>(c) + way);
      if (!find(c, (before.top + before.bottom) / 2)) break;
    }
}

/// Takes the line between the canthi as the axis. False where there is none.
bool UpperLid::lean_on_canthi() {
  std::optional<Vector3d> first, last;
  for (std::size_t c = 0; c < columns; ++c) {
    if (!(gaps_[c].top > gaps_[c].bottom)) continue;
    const Vector3d at = direction({along_of(c), (gaps_[c].top + gaps_[c].bottom) / 2});
    if (!first) first = at;
    last = at;
  }
  if (!first || (*last - *first).norm() < narrowest) return false;
  axis_ = (*last - *first).normalized();
  up_ = axis_.cross(Vector3d(0, -1, 0)).normalized();
  if (up_.z() < 0) up_ = -up_;
  ahead_ = up_.cross(axis_);
  if (ahead_.y() > 0) ahead_ = -ahead_;
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
      *at = {middle - left, middle + left};
    }
  };
  continue_it(gaps_.begin(), gaps_.end());
  continue_it(gaps_.rbegin(), gaps_.rend());
}

std::optional<UpperLid> UpperLid::find(std::span<const Vector3f> rest,
                                       std::span<const Eigen::Vector3i> triangles,
                                       const Eyeball& eyeball) {
  UpperLid lid(eyeball);
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
        for (double Gap::*side : {&Gap::bottom, &Gap::top}) {
          const auto& [l, m, r] = std::tie(before[c - 1], before[c], before[c + 1]);
          if (l.top > l.bottom && r.top > r.bottom)
            lid.gaps_[c].*side = 0.25 * l.*side + 0.5 * m.*side + 0.25 * r.*side;
        }
  }
  lid.taper();
  for (const Gap& gap : lid.gaps_) lid.widest_ = std::max(lid.widest_, gap.top - gap.bottom);
  if (lid.widest_ < narrowest) return std::nullopt;
  lid.staring_ = std::clamp((lid.gap_at(0).top - iris_shown) / lid.way_at(0), 0.0, 0.25);
  lid.collect(rest);
  return lid;
}

UpperLid::Gap UpperLid::gap_at(double along) const {
  const double at = std::clamp((along + farthest_along) / step_along, 0.0,
                               static_cast<double>(columns - 1) - 1e-6);
  const auto c = static_cast<std::size_t>(at);
  const double t = at - static_cast<double>(c);
  const Gap &a = gaps_[c], &b = gaps_[c + 1];
  const bool has_a = a.top > a.bottom, has_b = b.top > b.bottom;
  if (has_a && has_b) return {(1 - t) * a.bottom + t * b.bottom, (1 - t) * a.top + t * b.top};
  if (!has_a && !has_b) return {};
  // It closes within the step beyond its last column.
  const Gap& last = has_a ? a : b;
  const double open = has_a ? 1 - t : t, middle = (last.top + last.bottom) / 2;
  return {middle + open * (last.bottom - middle), middle + open * (last.top - middle)};
}

double UpperLid::way_at(double along) const {
  const Gap gap = gap_at(along);
  const double way = gap.top - gap.bottom;
  return way + overlap * std::min(1.0, way / (4 * overlap));
}

void UpperLid::collect(std::span<const Vector3f> rest) {
  const float far = eyeball_.radius + near_mm;
  for (std::size_t v = 0; v < rest.size(); ++v) {
    const float away = (rest[v] - eyeball_.centre).norm();
    if (away > far) continue;
    const Angles at = angles_of(rest[v].cast<double>());
    const Gap gap = gap_at(at.along);
    const double way = way_at(at.along);
    if (!(way > 0)) continue;
    if (away < eyeball_.radius + thin_mm) collect_edge(static_cast<int>(v), at, gap);
    if (at.up < (gap.bottom + gap.top) / 2) continue;
    const double above = (at.up - gap.top - tarsus) / (fold_above_edge - tarsus);
    const double deep = (away - eyeball_.radius - thin_mm) / (deep_mm - thin_mm);
    const double moves = (1 - smooth_step(above)) * (1 - smooth_step(deep));
    if (moves > 0)
      members_.push_back({static_cast<int>(v), static_cast<float>(way * moves),
                          static_cast<float>(moves), static_cast<float>(at.along)});
  }
}

void UpperLid::collect_edge(int vertex, const Angles& at, const Gap& gap) {
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
      sum += weight * (angles_of(now).up - of.up);
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

double UpperLid::lowered(double closure, double gaze_up) const {
  const double open = staring_ - lid_per_gaze * gaze_up / widest_;
  return std::clamp(open + closure * (1 - open), highest, 1.0);
}

void UpperLid::move(double lowered, const Vector3f& gaze, std::span<Vector3f> places) const {
  if (lowered == 0) return;
  const Vector3f axis = axis_.cast<float>(), ahead = ahead_.cast<float>(), up = up_.cast<float>();
  const std::vector<float> wider = widening(places);
  const auto widened = [&](float along) {
    const float at = std::clamp(along / static_cast<float>(measured_every) + measured / 2, 0.f,
                                measured - 1.001f);
    const auto i = static_cast<std::size_t>(at);
    return wider[i] + (at - static_cast<float>(i)) * (wider[i + 1] - wider[i]);
  };
  for (const auto& [vertex, turn, share, along] : members_) {
    Vector3f& p = places[static_cast<std::size_t>(vertex)];
    const Vector3f v = p - eyeball_.centre;
    const float angle = -static_cast<float>(lowered) * (turn + share * widened(along));
    const float c = std::cos(angle), s = std::sin(angle);
    const float x = v.dot(ahead), z = v.dot(up);
    Vector3f there = v.dot(axis) * axis + (c * x - s * z) * ahead + (s * x + c * z) * up;
    const float far = there.norm();
    const Vector3f direction = there / far;
    const float least = eyeball_.reach(direction, gaze) + clear_mm;
    if (far < least) there = least * direction;
    p = eyeball_.centre + there;
  }
}

bool UpperLid::is_above(const Vector3f& point) const {
  const Angles at = angles_of(point.cast<double>());
  const Gap gap = gap_at(at.along);
  return gap.top > gap.bottom && at.up > (gap.bottom + gap.top) / 2;
}

Eigen::Matrix3f UpperLid::turn_at(const Vector3f& point, double lowered) const {
  const double angle = lowered * way_at(angles_of(point.cast<double>()).along);
  // Down is from up_ to ahead_.
  const Vector3d about = up_.cross(ahead_);
  return Eigen::AngleAxisd(angle, about).toRotationMatrix().cast<float>();
}

}  // namespace condyle
