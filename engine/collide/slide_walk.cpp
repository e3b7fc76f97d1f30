#include "engine/collide/slide_walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace condyle {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double step_share = 0.25;  // longest step, of the band
constexpr double margin_mm = 0.05;   // beyond a step's length contacts may matter
// With friction a contact drags from where it meets, which shorter steps find better.
constexpr double rubbing_step_mm = 0.1, rubs_below_mm = 0.03;
constexpr double kept_slop = 0.7;  // share of the slop that is not undone
constexpr double first_radius_mm = 0.15, least_radius_mm = 0.05;
constexpr double gained_mm = 5e-4;  // what a move must bring
constexpr double cut_reach_mm = 0.1;
constexpr std::size_t max_cuts = 24;
constexpr double still_mm = 1e-4;  // steps shorter than this lead nowhere

}  // namespace

void SlideWalk::make_rows(const Pose& X) {
  const Eigen::Vector3d pivot = X * model_.pivot_;
  rows_.clear();
  row_candidate_.clear();
  for (std::size_t i = 0; i < probe_.candidates().size(); ++i) {
    const SlideCandidate& c = probe_.candidates()[i];
    if (!c.known || !c.faces || c.gradient.squaredNorm() < 0.1) continue;
    // Depth within the slop is neither deepened nor undone: to stay is always allowed.
    const double open =
        c.gap > 0 ? c.gap : std::min(0.0, c.gap + kept_slop * model_.settings_.slop_mm);
    rows_.push_back(contact_row(c.point - pivot, c.gradient, open, model_.rotation_length_mm_));
    rows_.back().rubs = c.gap < rubs_below_mm;
    row_candidate_.push_back(static_cast<int>(i));
  }
  for (const Cut& cut : cuts_) {
    const Twist since = probe_.between(cut.X, X);
    if (probe_.way_of(since) > cut_reach_mm) continue;
    rows_.push_back(cut.row);
    rows_.back().gap_mm = std::max(0.0, cut.row.gap_mm + cut.row.along.dot(since));
    row_candidate_.push_back(-1);
  }
}

SlideResult SlideWalk::towards(const Pose& from, const Pose& wanted, double settled_mm) {
  const SlideSettings& settings = model_.settings_;
  double longest = step_share * model_.band_mm_;
  if (settings.friction > 0) longest = std::min(longest, rubbing_step_mm);
  TwistSettings solver;
  solver.friction = settings.friction;
  solver.rotation_length_mm = model_.rotation_length_mm_;
  solver.max_contacts = settings.max_contacts;
  solver.thinning_mm = settings.thinning_mm;

  SlideResult out, start;
  Pose X = from;
  const double whole = probe_.way_of(probe_.between(from, wanted));
  const int max_steps = 24 + static_cast<int>(3 * whole / longest);
  double share = 1;
  double radius = std::min(longest, first_radius_mm);  // no step is longer
  Twist last = Twist::Zero();
  cuts_.clear();
  std::array<double, 8> lately;  // how far from the wanted pose it was
  lately.fill(infinity);
  out.reached = true;
  for (out.steps = 0; out.steps < max_steps; ++out.steps) {
    const Twist left = probe_.between(X, wanted);
    const double way = probe_.way_of(left);
    const double active = radius + margin_mm;
    probe_.look_at(X, active);
    if (probe_.deepest_gap() > active) {
      const double clear = probe_.clearance(X);
      if (clear >= way) {
        out = {wanted, false, true, 0, {}, out.steps, out.reached};
        return out;
      }
      X = probe_.moved(X, left * (std::max(clear, radius) / way));
      radius = longest;
      continue;
    }
    out.reached &= probe_.deepest_gap() >= -(longest + settings.slop_mm);
    make_rows(X);
    const TwistSolution solution = nearest_allowed(share * left, rows_, solver);
    Twist x = solution.x;
    const double step = probe_.way_of(x);
    report(X, solution, share, out);
    double& before = lately[static_cast<std::size_t>(out.steps) % lately.size()];
    const bool stalls = settings.friction == 0 && before - left.norm() < gained_mm;
    before = left.norm();
    out.settled = (step <= settled_mm * share || step <= still_mm || stalls) &&
                  out.depth_mm <= settings.slop_mm;
    if (out.steps == 0) start = out;
    if (out.settled) break;
    if (step > radius) x *= radius / step;
    const bool arrives = step <= radius && share == 1 && solution.pushes.empty();
    // Steps that swing back and forth are too long: over a crease of the surface each sees one of
    // its sides. What held on the other side is kept. Steps that agree may grow.
    const double agree = x.dot(last);
    if (agree < 0) {
      share = std::max(0.5 * share, 1e-3);
      keep_cuts(X, solution);
    } else if (agree > 0.5 * x.norm() * last.norm()) {
      share = std::min(2 * share, 1.0);
    }
    last = x;
    X = arrives ? wanted : probe_.moved(X, x);
    radius = std::min(longest, std::max(2 * std::min(step, radius), least_radius_mm));
  }
  // Nothing gained: it stays where it was.
  const bool start_is_free = start.X_FM.t == from.t && start.depth_mm <= settings.slop_mm;
  if (out.steps > 0 && start_is_free && settings.friction == 0 &&
      probe_.between(from, wanted).norm() <= probe_.between(out.X_FM, wanted).norm() + gained_mm) {
    start.steps = out.steps;
    start.settled = start.reached = true;
    return start;
  }
  return out;
}

void SlideWalk::report(const Pose& X, const TwistSolution& solution, double share,
                       SlideResult& out) const {
  out.X_FM = X;
  out.depth_mm = std::max(0.0, -probe_.worst_gap());
  out.touching = !solution.pushes.empty();
  out.contacts.clear();
  for (const Push& push : solution.pushes) {
    const int index = row_candidate_[push.row];
    if (index < 0) continue;
    const SlideCandidate& c = probe_.candidates()[index];
    out.contacts.push_back({c.point, rows_[push.row].normal, c.gap, push.length_mm / share});
  }
}

void SlideWalk::keep_cuts(const Pose& X, const TwistSolution& solution) {
  for (const Push& push : solution.pushes)
    if (row_candidate_[push.row] >= 0) cuts_.push_back({rows_[push.row], X});
  if (cuts_.size() > max_cuts)
    cuts_.erase(cuts_.begin(), cuts_.end() - static_cast<std::ptrdiff_t>(max_cuts));
}

}  // namespace condyle
