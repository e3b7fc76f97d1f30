#include "engine/collide/slide_walk.h"

#include <algorithm>
#include <cmath>

#include "engine/core/infinity.h"

namespace condyle {
namespace {

constexpr double step_fraction = 0.25;  // longest step as a fraction of the band
// Contacts somewhat beyond a step's length may matter, with friction more of them.
constexpr double margin_mm = 0.02, rubbing_margin_mm = 0.05;
// With friction a contact acts from the point of first contact, which shorter steps locate more
// accurately.
constexpr double rubbing_step_mm = 0.1, rubs_below_mm = 0.03;
constexpr double kept_slop = 0.7;  // fraction of the slop that is not corrected
constexpr double first_radius_mm = 0.15, min_radius_mm = 0.05;
constexpr double gained_mm = 5e-4;  // least gain of a step
constexpr double cut_reach_mm = 0.1;
constexpr std::size_t max_cuts = 24;
constexpr double still_mm = 1e-4;  // shorter steps make no progress
// Contradictory contacts (bodies of two patients in one place, surfaces turned inside out) request
// displacements larger than any head; after this many such steps the walk is abandoned.
constexpr double infeasible_mm = 1000;
constexpr int max_infeasible = 3;
// After this many successive steps that neither reduce the overlap nor bring the body nearer, more
// would not either.
constexpr int max_idle = 80;
constexpr double parted_mm = 1e-3;  // least reduction of the overlap

}  // namespace

SlideWalk::SlideWalk(const SlidingContact& model, SlideProbe& probe, const Pose& from,
                     const Pose& target, double settled_mm)
    : model_(model),
      probe_(probe),
      from_(from),
      target_(target),
      settled_mm_(settled_mm),
      X_(from) {
  const SlideSettings& settings = model_.settings_;
  longest_ = step_fraction * model_.band_mm_;
  if (settings.friction > 0) longest_ = std::min(longest_, rubbing_step_mm);
  solver_.friction = settings.friction;
  solver_.rotation_length_mm = model_.rotation_length_mm_;
  solver_.max_contacts = settings.max_contacts;
  solver_.thinning_mm = settings.thinning_mm;
  const double whole = probe_.max_displacement_mm(probe_.between(from, target));
  max_steps_ = 24 + static_cast<int>(3 * whole / longest_);
  radius_ = std::min(longest_, first_radius_mm);
  lately_.fill(infinity);
  min_depth_ = min_left_ = infinity;
  out_.reached = true;
}

SlideResult SlideWalk::run() {
  go_on(max_steps_ + 1);
  return std::move(out_);
}

bool SlideWalk::go_on(int steps) {
  for (; !ended_ && steps > 0; --steps) ended_ = step();
  return ended_;
}

/// Whether the body overlaps and the walk does not part it: the contacts contradict each other.
bool SlideWalk::gets_nowhere(double left) {
  const bool gains = out_.depth_mm <= model_.settings_.slop_mm ||
                     out_.depth_mm < min_depth_ - parted_mm || left < min_left_ - gained_mm;
  min_depth_ = std::min(min_depth_, out_.depth_mm);
  min_left_ = std::min(min_left_, left);
  idle_ = gains ? 0 : idle_ + 1;
  return idle_ >= max_idle;
}

/// True where it was the last step.
bool SlideWalk::step() {
  const SlideSettings& settings = model_.settings_;
  if (out_.steps == max_steps_) {
    end();
    return true;
  }
  const Twist left = probe_.between(X_, target_);
  const double distance = probe_.max_displacement_mm(left);
  const double active = radius_ + (settings.friction > 0 ? rubbing_margin_mm : margin_mm);
  probe_.look_at(X_, active);
  if (probe_.deepest_gap() > active) {
    const double clear = probe_.clearance(X_);
    if (clear >= distance) {
      out_ = {target_, false, true, 0, {}, out_.steps, out_.reached};
      return true;
    }
    X_ = probe_.moved(X_, left * (std::max(clear, radius_) / distance));
    radius_ = longest_;
    ++out_.steps;
    return false;
  }
  out_.reached &= probe_.deepest_gap() >= -(longest_ + settings.slop_mm);
  make_rows();
  const TwistSolution solution = nearest_allowed(step_fraction_ * left, rows_, solver_);
  Twist x = solution.x;
  const double length = probe_.max_displacement_mm(x);
  report(solution);
  double& before = lately_[static_cast<std::size_t>(out_.steps) % lately_.size()];
  const bool stalls = settings.friction == 0 && before - left.norm() < gained_mm;
  before = left.norm();
  out_.settled = (length <= settled_mm_ * step_fraction_ || length <= still_mm || stalls) &&
                 out_.depth_mm <= settings.slop_mm;
  if (out_.steps == 0) start_ = out_;
  if (out_.settled || gets_nowhere(left.norm())) {
    end();
    return true;
  }
  infeasible_ = length > infeasible_mm ? infeasible_ + 1 : 0;
  if (infeasible_ >= max_infeasible && start_.X_FM.t == from_.t) {  // the body stays at its start
    start_.steps = out_.steps;
    out_ = std::move(start_);
    return true;
  }
  if (length > radius_) x *= radius_ / length;
  const bool arrives = length <= radius_ && step_fraction_ == 1 && solution.pushes.empty();
  // Alternating steps are too long: at a crease of the surface each step encounters only one side.
  // The constraints of the other side are kept. Steps in a consistent direction may grow.
  const double agree = x.dot(last_);
  if (agree < 0) {
    step_fraction_ = std::max(0.5 * step_fraction_, 1e-3);
    keep_cuts(solution);
  } else if (agree > 0.5 * x.norm() * last_.norm()) {
    step_fraction_ = std::min(2 * step_fraction_, 1.0);
  }
  last_ = x;
  X_ = arrives ? target_ : probe_.moved(X_, x);
  radius_ = std::min(longest_, std::max(2 * std::min(length, radius_), min_radius_mm));
  ++out_.steps;
  return false;
}

/// Where nothing was gained the body stays at its start.
void SlideWalk::end() {
  const SlideSettings& settings = model_.settings_;
  const bool start_is_free = start_.X_FM.t == from_.t && start_.depth_mm <= settings.slop_mm;
  if (out_.steps == 0 || !start_is_free || settings.friction > 0 ||
      probe_.between(from_, target_).norm() > probe_.between(out_.X_FM, target_).norm() + gained_mm)
    return;
  start_.steps = out_.steps;
  start_.settled = start_.reached = true;
  out_ = std::move(start_);
}

void SlideWalk::make_rows() {
  const Eigen::Vector3d pivot = X_ * model_.pivot_;
  rows_.clear();
  row_candidate_.clear();
  for (std::size_t i = 0; i < probe_.candidates().size(); ++i) {
    const SlideCandidate& c = probe_.candidates()[i];
    if (!c.known || !c.faces || c.gradient.squaredNorm() < 0.1) continue;
    // Penetration within the slop is neither increased nor corrected: staying in place is always
    // feasible.
    const double open =
        c.gap > 0 ? c.gap : std::min(0.0, c.gap + kept_slop * model_.settings_.slop_mm);
    rows_.push_back(contact_row(c.point - pivot, c.gradient, open, model_.rotation_length_mm_));
    rows_.back().rubs = c.gap < rubs_below_mm;
    row_candidate_.push_back(static_cast<int>(i));
  }
  for (const Cut& cut : cuts_) {
    const Twist since = probe_.between(cut.X, X_);
    if (probe_.max_displacement_mm(since) > cut_reach_mm) continue;
    rows_.push_back(cut.row);
    rows_.back().gap_mm = std::max(0.0, cut.row.gap_mm + cut.row.along.dot(since));
    row_candidate_.push_back(-1);
  }
}

void SlideWalk::report(const TwistSolution& solution) {
  out_.X_FM = X_;
  out_.depth_mm = std::max(0.0, -probe_.worst_gap());
  out_.touching = !solution.pushes.empty();
  out_.contacts.clear();
  for (const Push& push : solution.pushes) {
    const int index = row_candidate_[push.row];
    if (index < 0) continue;
    const SlideCandidate& c = probe_.candidates()[index];
    out_.contacts.push_back(
        {c.point, rows_[push.row].normal, c.gap, push.length_mm / step_fraction_});
  }
}

void SlideWalk::keep_cuts(const TwistSolution& solution) {
  for (const Push& push : solution.pushes)
    if (row_candidate_[push.row] >= 0) cuts_.push_back({rows_[push.row], X_});
  if (cuts_.size() > max_cuts)
    cuts_.erase(cuts_.begin(), cuts_.end() - static_cast<std::ptrdiff_t>(max_cuts));
}

}  // namespace condyle
