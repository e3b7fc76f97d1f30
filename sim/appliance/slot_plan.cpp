#include "sim/appliance/slot_plan.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/units.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double least_facing = 0.25;  // cosine of a bone's normal with the withdrawal path
constexpr double most_slant =
    0.75;  // of a wall's normal with the withdrawal path: 41 degrees to the wall
constexpr double free_path_mm = 80;
constexpr int direction_count = 240, most_samples = 160;
constexpr double from_behind = 0.35;  // back component of a withdrawal that no one would use
constexpr double joint_mm = 1.5;      // gaps of a run, and distance of runs that meet at a bend
constexpr double shortest_run_mm = 6, end_inset_mm = 2.5;
constexpr double smoothing_mm = 4;
constexpr double island_fraction = 0.4;  // of the longest group of runs
constexpr double near_runs_mm = 8;       // shells of runs that are nearer grow together
constexpr double shortest_slot_mm = 3;
constexpr double longest_slot_mm = 24, bridge_mm = 3;
constexpr double screw_mm = 6;  // length in the bone
constexpr double screw_margin_mm = 1.5;
constexpr double pair_mm = 8;  // of two holes on one side

bool is_left_of_middle(const ClinicalFrame& frame, const CutEdge& edge) {
  return frame.left.dot(edge.point - frame.origin) > 0;
}

/// Whether a saw reaches the edge from this side.
bool is_accessible(const TriangleTree& bone, const CutLine& line, const CutEdge& edge,
                   const Vector3d& out) {
  return edge.normal.dot(out) > least_facing &&
         std::abs(line.walls[edge.wall].normal.dot(out)) < most_slant &&
         !bone.ray_cast(edge.point + 0.1 * edge.normal, out, free_path_mm);
}

/// A guide for both sides comes from the midsagittal plane.
bool is_on_both_sides(const ClinicalFrame& frame, const std::vector<CutEdge>& edges) {
  double left = 0, whole = 0;
  for (const CutEdge& edge : edges) {
    whole += edge.length_mm;
    if (is_left_of_middle(frame, edge)) left += edge.length_mm;
  }
  return left > 0.25 * whole && left < 0.75 * whole;
}

/// In the clinical frame.
std::vector<Vector3d> candidate_directions(bool midsagittal) {
  std::vector<Vector3d> directions;
  if (midsagittal) {
    for (int elevation = -90; elevation <= 90; elevation += 5)
      directions.push_back({0, -std::cos(elevation * degree), std::sin(elevation * degree)});
    return directions;
  }
  // Spread evenly by the golden angle.
  for (int i = 0; i < direction_count; ++i) {
    const double z = 1 - (2 * i + 1.0) / direction_count, angle = i * 137.50776405 * degree;
    const double r = std::sqrt(1 - z * z);
    const Vector3d d(r * std::cos(angle), r * std::sin(angle), z);
    if (d.y() < from_behind) directions.push_back(d);
  }
  return directions;
}

Vector3d choose_direction(const TriangleTree& bone, const ClinicalFrame& frame, const CutLine& line,
                          const std::vector<CutEdge>& edges) {
  const std::size_t step = std::max<std::size_t>(1, edges.size() / most_samples);
  Vector3d best = -Vector3d::UnitY();
  double most = -1;
  for (const Vector3d& candidate : candidate_directions(is_on_both_sides(frame, edges))) {
    const Vector3d direction = frame.vector(candidate);
    double score = 0;
    for (std::size_t e = 0; e < edges.size(); e += step)
      if (is_accessible(bone, line, edges[e], direction))
        score += edges[e].length_mm * edges[e].normal.dot(direction);
    if (score > most) {
      most = score;
      best = direction;
    }
  }
  return best;
}

/// Heights with the mean of their neighbours along the run, weighted by nearness.
std::vector<double> smoothed(const SlotRun& run) {
  std::vector<double> even(run.h.size());
  for (std::size_t i = 0; i < even.size(); ++i) {
    double sum = 0, weights = 0;
    for (std::size_t j = 0; j < even.size(); ++j) {
      const double weight = std::max(0.0, 1 - std::abs(run.t[j] - run.t[i]) / smoothing_mm);
      sum += weight * run.h[j];
      weights += weight;
    }
    even[i] = sum / weights;
  }
  return even;
}

/// Runs of neighbouring points along each wall.
std::vector<SlotRun> find_runs(const CutLine& line, const std::vector<CutEdge>& edges,
                               const Vector3d& out) {
  std::vector<SlotRun> runs;
  for (int wall = 0; wall < static_cast<int>(line.walls.size()); ++wall) {
    const Plane& plane = line.walls[wall];
    SlotRun run;
    run.across = plane.normal;
    run.outward = (out - out.dot(plane.normal) * plane.normal).normalized();
    run.along = run.outward.cross(run.across);
    run.w0 = plane.offset_mm;
    std::vector<std::array<double, 2>> points;
    for (const CutEdge& edge : edges)
      if (edge.wall == wall)
        points.push_back({run.along.dot(edge.point), run.outward.dot(edge.point)});
    std::sort(points.begin(), points.end());
    const auto finish = [&] {
      run.even_h = smoothed(run);
      if (!run.t.empty() && run.t.back() - run.t.front() >= shortest_run_mm) runs.push_back(run);
      run.t.clear();
      run.h.clear();
    };
    for (const auto& [t, h] : points) {
      if (!run.t.empty() && t - run.t.back() > joint_mm) finish();
      // Both sides of a kerf have points: the outermost within a step counts.
      if (!run.t.empty() && t - run.t.back() < 0.25) {
        run.h.back() = std::max(run.h.back(), h);
        continue;
      }
      run.t.push_back(t);
      run.h.push_back(h);
    }
    finish();
  }
  return runs;
}

bool ends_at(const SlotRun& run, const Vector3d& end) {
  return (run.point(run.t.front()) - end).norm() < 2 * joint_mm ||
         (run.point(run.t.back()) - end).norm() < 2 * joint_mm;
}

bool meet(const SlotRun& a, const SlotRun& b) {
  return ends_at(a, b.point(b.t.front())) || ends_at(a, b.point(b.t.back()));
}

/// Whether another run goes on where one ends.
bool goes_on(const std::vector<SlotRun>& runs, const SlotRun& run, double at) {
  return std::any_of(runs.begin(), runs.end(), [&](const SlotRun& other) {
    return &other != &run && ends_at(other, run.point(at));
  });
}

/// Drops short groups of runs that meet, such as the back of the nasal cavity seen through it.
void drop_islands(std::vector<SlotRun>& runs) {
  std::vector<std::size_t> group(runs.size());
  std::vector<double> length(runs.size(), 0);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    group[i] = i;
    for (std::size_t j = 0; j < i; ++j)
      if (meet(runs[i], runs[j])) std::replace(group.begin(), group.end(), group[j], group[i]);
  }
  for (std::size_t i = 0; i < runs.size(); ++i)
    length[group[i]] += runs[i].t.back() - runs[i].t.front();
  const double longest = length.empty() ? 0 : *std::max_element(length.begin(), length.end());
  std::vector<SlotRun> kept;
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (length[group[i]] > island_fraction * longest) kept.push_back(runs[i]);
  runs = std::move(kept);
}

void divide(const std::vector<SlotRun>& runs, SlotRun& run) {
  double low = run.t.front(), high = run.t.back();
  if (!goes_on(runs, run, low)) low += end_inset_mm;
  if (!goes_on(runs, run, high)) high -= end_inset_mm;
  const double length = high - low;
  if (length < shortest_slot_mm) return;
  const int count =
      static_cast<int>(std::ceil((length + bridge_mm) / (longest_slot_mm + bridge_mm)));
  const double each = (length - (count - 1) * bridge_mm) / count;
  for (int i = 0; i < count; ++i) {
    const double from = low + i * (each + bridge_mm);
    run.slots.push_back({from, from + each});
  }
}

double median_of(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::infinity();
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// A short bar between two runs that has little bone in front of it: points deep in a cavity would
/// need it to be raised far.
SlotPlan::Bar bar_between(const SlotRun& one, const SlotRun& two, const Vector3d& out) {
  constexpr double depth_weight = 2;
  SlotPlan::Bar best;
  double least = 1e300;
  for (const double s : one.t)
    for (const double t : two.t) {
      const Vector3d a = one.point(s), b = two.point(t);
      const double cost = (a - b).norm() - depth_weight * std::min(out.dot(a), out.dot(b));
      if (cost < least) {
        least = cost;
        best = {a, b};
      }
    }
  return best;
}

/// Joins groups of runs that are farther from each other than this, nearest first.
std::vector<SlotPlan::Bar> find_bars(const std::vector<SlotRun>& runs, const Vector3d& out,
                                     double joined_mm) {
  std::vector<std::size_t> group(runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) group[i] = i;
  std::vector<SlotPlan::Bar> bars;
  while (true) {
    double least = 1e9;
    std::size_t from = 0, to = 0, one = 0, two = 0;
    for (std::size_t i = 0; i < runs.size(); ++i)
      for (std::size_t j = i + 1; j < runs.size(); ++j) {
        if (group[i] == group[j]) continue;
        for (const double s : runs[i].t)
          for (const double t : runs[j].t) {
            const Vector3d a = runs[i].point(s), b = runs[j].point(t);
            if (const double d = (a - b).norm(); d < least) {
              least = d;
              one = i;
              two = j;
              from = group[i];
              to = group[j];
            }
          }
      }
    if (least == 1e9) return bars;
    if (least > joined_mm) bars.push_back(bar_between(runs[one], runs[two], out));
    std::replace(group.begin(), group.end(), to, from);
  }
}

/// Raises a bar until it clears the bone between its ends.
void lift(SlotPlan::Bar& bar, const TriangleTree& bone, const Vector3d& out) {
  constexpr double highest_mm = 20, clearance_mm = 0.5;
  const auto is_free = [&] {
    for (double s = 0.2; s < 0.81; s += 0.05) {
      const Vector3d p = bar.from + s * (bar.to - bar.from) + bar.lift_mm * out;
      if (bone.signed_distance(p) < SlotPlan::bar_radius_mm + clearance_mm ||
          bone.ray_cast(p, out, free_path_mm))
        return false;
    }
    return true;
  };
  while (bar.lift_mm < highest_mm && !is_free()) bar.lift_mm += 0.5;
}

/// Depth of the bone below the points of the runs, in the wall's plane.
double bone_depth(const TriangleTree& bone, const std::vector<SlotRun>& runs) {
  std::vector<double> depths;
  for (const SlotRun& run : runs)
    for (double t = run.t.front(); t < run.t.back(); t += 1) {
      const auto hit = bone.ray_cast(run.point(t) - 0.1 * run.outward, -run.outward, 100);
      if (hit) depths.push_back(hit->distance + 0.1);
    }
  return median_of(std::move(depths));
}

/// The run next to a point, and where: t, and the side of the slot.
struct Beside {
  const SlotRun* run = nullptr;
  double t = 0, w = 0, distance = 1e9;
};
Beside beside(const SlotPlan& plan, const Vector3d& p) {
  Beside nearest;
  for (const SlotRun& run : plan.runs) {
    if (run.slots.empty()) continue;
    const double t = std::clamp(run.along.dot(p), run.t.front(), run.t.back());
    const double distance = (run.point(t) - p).norm();
    if (distance < nearest.distance) nearest = {&run, t, run.across.dot(p) - run.w0, distance};
  }
  return nearest;
}

bool is_dangerous(const std::vector<DangerZone>& dangers, const Vector3d& p, const Vector3d& in) {
  for (const DangerZone& zone : dangers)
    for (const Vector3d& q : zone.points) {
      const double s = std::clamp(in.dot(q - p), 0.0, screw_mm);
      if ((p + s * in - q).norm() < zone.radius_mm + screw_margin_mm) return true;
    }
  return false;
}

}  // namespace

double SlotRun::height(const std::vector<double>& heights, double at) const {
  const auto above = std::upper_bound(t.begin(), t.end(), at);
  if (above == t.begin()) return heights.front();
  if (above == t.end()) return heights.back();
  const auto i = static_cast<std::size_t>(above - t.begin());
  const double part = (at - t[i - 1]) / (t[i] - t[i - 1]);
  return heights[i - 1] + part * (heights[i] - heights[i - 1]);
}

SlotPlan plan_slots(const TriangleTree& bone, const ClinicalFrame& frame, const CutLine& line,
                    const GuideSettings& settings) {
  std::vector<CutEdge> wanted, seen;
  for (const CutEdge& edge : line.edges)
    if (settings.side == GuideSide::both ||
        is_left_of_middle(frame, edge) == (settings.side == GuideSide::left))
      wanted.push_back(edge);
  if (wanted.empty())
    throw InputError(fmt::format("{} does not reach the {} side", line.title,
                                 settings.side == GuideSide::left ? "left" : "right"));
  SlotPlan plan;
  plan.out =
      settings.from ? frame.vector(*settings.from) : choose_direction(bone, frame, line, wanted);
  for (const CutEdge& edge : wanted)
    if (is_accessible(bone, line, edge, plan.out)) seen.push_back(edge);
  plan.runs = find_runs(line, seen, plan.out);
  drop_islands(plan.runs);
  for (SlotRun& run : plan.runs) divide(plan.runs, run);
  std::erase_if(plan.runs, [](const SlotRun& run) { return run.slots.empty(); });
  if (plan.runs.empty())
    throw InputError(
        fmt::format("{}: no slot leads a saw from this side: at least {} mm of the cut "
                    "must face it; try --from and --side",
                    line.title, shortest_slot_mm + 2 * end_inset_mm));
  for (const SlotRun& run : plan.runs) {
    plan.line_mm += run.t.back() - run.t.front();
    for (const SlotRun::Slot& slot : run.slots) plan.led_mm += slot.high - slot.low;
    for (double t = run.t.front(); t < run.t.back(); t += 0.7) plan.points.push_back(run.point(t));
    plan.points.push_back(run.point(run.t.back()));
  }
  plan.bars = find_bars(plan.runs, plan.out, near_runs_mm);
  for (SlotPlan::Bar& bar : plan.bars) lift(bar, bone, plan.out);
  plan.bone_mm = bone_depth(bone, plan.runs);
  if (settings.saw.blade_mm >= plan.bone_mm)
    throw InputError(
        fmt::format("saw {}: its blade of {} mm is thicker than the bone at {}, {:.2f} mm",
                    settings.saw.name, settings.saw.blade_mm, line.title, plan.bone_mm));
  return plan;
}

bool join_with_bars(SlotPlan& plan, const TriangleTree& bone) {
  std::vector<SlotPlan::Bar> bars = find_bars(plan.runs, plan.out, 2 * joint_mm);
  if (bars.size() <= plan.bars.size()) return false;
  plan.bars = std::move(bars);
  for (SlotPlan::Bar& bar : plan.bars) lift(bar, bone, plan.out);
  return true;
}

std::vector<ScrewHole> plan_holes(
    const GuideSupport& support, const TriangleTree& bone, const SlotPlan& plan,
    const GuideSettings& settings,
    const std::function<bool(const Vector3d&, const Vector3d&)>& has_shell,
    std::vector<std::string>& notes) {
  std::vector<ScrewHole> holes;
  if (settings.hole_mm == 0) return holes;
  const double nearest = 0.5 * settings.saw.blade_mm + settings.tolerance_mm +
                         settings.slot_wall_mm + 0.5 * settings.hole_mm + 1.2;
  struct Candidate {
    Vector3d point, axis;
    double along;  // seen along the withdrawal path
    bool above;
  };
  std::vector<Candidate> candidates;
  const Vector3d across_view = plan.runs.front().along;
  for (const auto& t : support.bone.triangles) {
    const Vector3d &a = support.bone.vertices[t[0]], &b = support.bone.vertices[t[1]],
                   &c = support.bone.vertices[t[2]];
    const Vector3d p = (a + b + c) / 3, normal = (b - a).cross(c - a).normalized();
    if (!(normal.dot(plan.out) > 0.7)) continue;
    const Beside at = beside(plan, p);
    if (at.distance < nearest || at.distance > settings.reach_mm || std::abs(at.w) < nearest ||
        bone.ray_cast(p + 0.1 * normal, plan.out, free_path_mm) ||
        is_dangerous(support.dangers, p, -normal) || !has_shell(p, normal))
      continue;
    candidates.push_back({p, normal, across_view.dot(p), at.w > 0});
  }
  for (const bool above : {true, false}) {
    const Candidate *low = nullptr, *high = nullptr;
    for (const Candidate& each : candidates)
      if (each.above == above) {
        if (!low || each.along < low->along) low = &each;
        if (!high || each.along > high->along) high = &each;
      }
    int made = 0;
    for (const Candidate* each : {low, high}) {
      if (!each || (made == 1 && (each->point - low->point).norm() < pair_mm)) continue;
      holes.push_back({each->point, each->axis, settings.hole_mm});
      ++made;
    }
    if (made < 2)
      notes.push_back(fmt::format(
          "one side of the cut has room for {} of two screws: the shell there is small, or roots, "
          "canals and foramina are near",
          made));
  }
  return holes;
}

}  // namespace condyle
