#include "engine/collide/slide.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "engine/collide/contact_twist.h"
#include "engine/core/parallel.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double infinity = std::numeric_limits<double>::infinity();
// Shares of the band: way of one step, distance up to which a sample can matter in it, and distance
// up to which samples are collected for several steps.
constexpr double step_share = 0.25, active_share = 0.3, collect_share = 0.65;
// With friction a contact drags from where it meets, which shorter steps find better.
constexpr double rubbing_step_mm = 0.1, rubs_below_mm = 0.03;
constexpr double settled_mm = 0.002;  // motion that is still wanted of a settled pose
// Interpolated distances change by more than the way, but by no more than this in all.
constexpr double bent_mm = 0.05;
// How far a contact's normal may lie off the normals of the faces at its sample: 30 degrees.
constexpr double facing_cos = 0.866, facing_sin = 0.5;
constexpr double faces_below_mm = 0.05;  // but what is deeper must out in any case
constexpr double kept_slop = 0.7;        // share of the slop that is not undone
constexpr int max_walks = 2;
constexpr double first_radius_mm = 0.15;
constexpr double least_radius_mm = 0.05;
constexpr double gained_mm = 5e-4;  // what a move must bring
constexpr double cut_reach_mm = 0.1;
constexpr std::size_t max_cuts = 24;
constexpr double still_mm = 1e-4;  // steps shorter than this lead nowhere

bool is_finite(const Pose& X) { return X.R.coeffs().allFinite() && X.t.allFinite(); }

std::vector<SlidePair> all_pairs(std::size_t fixed, std::size_t moving) {
  std::vector<SlidePair> pairs;
  for (std::size_t f = 0; f < fixed; ++f)
    for (std::size_t m = 0; m < moving; ++m)
      pairs.push_back({static_cast<int>(f), static_cast<int>(m), 0});
  return pairs;
}

bool same_bits(const Pose& x, const Pose& y) { return x.R.coeffs() == y.R.coeffs() && x.t == y.t; }

}  // namespace

SlideBody make_slide_body(const TriMesh& mesh, const SlideBodySettings& settings, int threads) {
  SampleSettings samples = settings.samples;
  if (settings.field.region && !samples.region) samples.region = settings.field.region;
  return {kept_field(settings.cache, mesh, settings.field, threads), sample_surface(mesh, samples)};
}

SlidingContact::SlidingContact(std::vector<std::shared_ptr<const SlideBody>> fixed,
                               std::vector<std::shared_ptr<const SlideBody>> moving,
                               const SlideSettings& settings)
    : SlidingContact(fixed, moving, all_pairs(fixed.size(), moving.size()), settings) {}

SlidingContact::SlidingContact(std::vector<std::shared_ptr<const SlideBody>> fixed,
                               std::vector<std::shared_ptr<const SlideBody>> moving,
                               const std::vector<SlidePair>& pairs, const SlideSettings& settings)
    : fixed_(std::move(fixed)), moving_(std::move(moving)), settings_(settings) {
  band_mm_ = infinity;
  for (const SlidePair& pair : pairs) {
    const auto in = [](int index, std::size_t size) {
      return index >= 0 && static_cast<std::size_t>(index) < size;
    };
    if (!in(pair.fixed, fixed_.size()) || !in(pair.moving, moving_.size()))
      throw std::invalid_argument("sliding contact: a pair names a surface that is not there");
    const SlideBody &f = *fixed_[pair.fixed], &m = *moving_[pair.moving];
    const double band = std::min(f.field.settings().band_mm, m.field.settings().band_mm);
    if (!(pair.gap_mm >= 0 && pair.gap_mm <= 0.5 * band))
      throw std::invalid_argument("sliding contact: a gap is below 0 or above half the band");
    pairs_.push_back({&m, &f, true, pair.gap_mm, {}});
    pairs_.push_back({&f, &m, false, pair.gap_mm, {}});
    band_mm_ = std::min(band_mm_, band - pair.gap_mm);
  }
  double count = 0, square = 0;
  Vector3d sum = Vector3d::Zero();
  for (const auto& m : moving_) {
    const auto n = static_cast<double>(m->samples.points.size());
    sum += n * m->samples.centroid;
    count += n;
  }
  if (count > 0) pivot_ = sum / count;
  if (settings_.pivot) pivot_ = *settings_.pivot;
  for (const auto& m : moving_)
    for (const auto& p : m->samples.points) {
      square += (p - pivot_).squaredNorm();
      radius_mm_ = std::max(radius_mm_, (p - pivot_).norm());
    }
  if (count > 0) rotation_length_mm_ = std::max(std::sqrt(square / count), 1e-3);
  if (settings_.rotation_length_mm > 0) rotation_length_mm_ = settings_.rotation_length_mm;
}

/// One walk from a pose to another.
class SlideWalk {
 public:
  SlideWalk(const SlidingContact& model, int threads, SlideMemory* memory = nullptr)
      : model_(model), threads_(threads), memory_(memory) {}

  SlideResult run(const Pose& from, const Pose& wanted);
  SlideResult walk(const Pose& from, const Pose& wanted);
  bool remembers() const {
    return memory_->owner == &model_ && memory_->baseline == model_.baseline_;
  }
  double depth_at(const Pose& X) {
    collect(X);
    evaluate(X, infinity);
    return std::max(0.0, -worst_gap_);
  }
  void allow(const Pose& rest, std::vector<SlidingContact::Pair>& pairs) {
    collect(rest);
    evaluate(rest, infinity);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      pairs[i].allowed.assign(pairs[i].samples->samples.points.size(), 0.0f);
      for (const Candidate& c : candidates_)
        if (c.pair == static_cast<int>(i) && c.distance < 0)
          pairs[i].allowed[c.sample] =
              c.known ? static_cast<float>(c.distance) : -std::numeric_limits<float>::infinity();
    }
  }

 private:
  struct Candidate {
    int pair = 0, sample = 0;
    bool known = false;
    bool faces = false;                    // the other body, with a face at the sample
    double distance = 0;                   // at the last look
    Vector3d gradient = Vector3d::Zero();  // in fixed coordinates, for motion of the moving body
    Vector3d point = Vector3d::Zero();     // in fixed coordinates
  };

  void collect(const Pose& X);
  void remember(const Pose& X, double reserve_mm);
  struct Way {  // from the samples to the field
    const SlidingContact::Pair* pair;
    int index;
    Eigen::Matrix3d R;
    Vector3d t;
  };
  void collect_ball(int index, const Way& way, std::vector<Candidate>& found) const;
  double clearance(const Pose& X) const;
  void evaluate(const Pose& X, double active_mm);
  void look(Candidate& c, const Pose& X, const Pose& X_inverse) const;
  double allowed(const Candidate& c) const {
    const auto& pair = model_.pairs_[c.pair];
    return pair.allowed.empty() ? 0.0 : static_cast<double>(pair.allowed[c.sample]);
  }
  void make_rows(const Pose& X, double active_mm);
  void report(const Pose& X, const TwistSolution& solution, double share, SlideResult& out) const;
  void keep_cuts(const Pose& X, const TwistSolution& solution);

  Twist between(const Pose& X, const Pose& to) const {
    Twist x;
    const Eigen::AngleAxisd turn((to.R * X.R.conjugate()).normalized());
    double angle = turn.angle();
    Vector3d axis = turn.axis();
    if (angle > M_PI) angle -= 2 * M_PI;
    x << to * model_.pivot_ - X * model_.pivot_, angle * model_.rotation_length_mm_ * axis;
    return x;
  }
  Pose moved(const Pose& X, const Twist& x) const {
    const Vector3d turn = x.tail<3>() / model_.rotation_length_mm_;
    const double angle = turn.norm();
    Pose out;
    out.R = angle > 0
                ? (Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * X.R).normalized()
                : X.R;
    out.t = X * model_.pivot_ + x.head<3>() - out.R * model_.pivot_;
    return out;
  }
  /// No point of the moving body goes farther.
  double way_of(const Twist& x) const {
    return x.head<3>().norm() + x.tail<3>().norm() / model_.rotation_length_mm_ * model_.radius_mm_;
  }

  const SlidingContact& model_;
  int threads_;
  SlideMemory* memory_;
  std::vector<Candidate> candidates_;
  std::vector<double> horizon_;  // of each: way walked at its last look plus its distance then
  std::vector<int> relevant_;    // those looked at in this step
  std::vector<ContactRow> rows_;
  std::vector<int> row_candidate_;  // of each row, -1 for a cut
  struct Cut {                      // a row that held at a pose nearby
    ContactRow row;
    Pose X;
  };
  std::vector<Cut> cuts_;
  bool surely_settled_ = false;
  double walked_ = 0;            // since the candidates were collected
  double worst_gap_ = infinity;  // beyond what is allowed
};

/// Samples that lie within reach of the other body's surface, or inside it.
void SlideWalk::collect(const Pose& X) {
  const Pose X_inverse = X.inverse();
  std::vector<std::vector<Candidate>> found(model_.pairs_.size());
  parallel_for(found.size(), threads_, [&](std::size_t i) {
    const auto& pair = model_.pairs_[i];
    const Pose& X_FS = pair.samples_move ? X : X_inverse;
    const Way way{&pair, static_cast<int>(i), X_FS.R.toRotationMatrix(), X_FS.t};
    if (!pair.samples->samples.balls.empty()) collect_ball(0, way, found[i]);
  });
  candidates_.clear();
  for (const auto& part : found) candidates_.insert(candidates_.end(), part.begin(), part.end());
  horizon_.resize(candidates_.size());
  for (std::size_t i = 0; i < horizon_.size(); ++i) horizon_[i] = candidates_[i].distance;
  walked_ = 0;
  if (!memory_) return;
  memory_->near.clear();
  for (const Candidate& c : candidates_) memory_->near.push_back({c.pair, c.sample, c.distance});
  memory_->X_FM = X;
  memory_->owner = &model_;
  memory_->baseline = model_.baseline_;
}

/// What an earlier walk collected, if that was near enough.
void SlideWalk::remember(const Pose& X, double reserve_mm) {
  if (memory_ && remembers()) {
    walked_ = way_of(between(memory_->X_FM, X));
    if (walked_ <= reserve_mm) {
      candidates_.assign(memory_->near.size(), {});
      horizon_.resize(candidates_.size());
      for (std::size_t i = 0; i < candidates_.size(); ++i) {
        candidates_[i].pair = memory_->near[i].pair;
        candidates_[i].sample = memory_->near[i].sample;
        horizon_[i] = memory_->near[i].distance_mm;
      }
      return;
    }
  }
  collect(X);
}

void SlideWalk::collect_ball(int index, const Way& way, std::vector<Candidate>& found) const {
  const double reach = collect_share * model_.band_mm_;
  const DistanceField& field = way.pair->field->field;
  const SurfaceSamples& s = way.pair->samples->samples;
  const SurfaceSamples::Ball& ball = s.balls[index];
  const Vector3d center = way.R * ball.center + way.t;
  // Within the band the field tells more than its bounds do.
  const FieldSample at_center = field.at(center);
  const double gap = way.pair->gap_mm;
  const double bound =
      (at_center.known ? at_center.distance_mm - bent_mm : field.lower_bound(center)) - gap;
  if (bound > ball.radius + reach) return;
  if (ball.right == 0) {
    for (int i = ball.first; i < ball.first + ball.count; ++i) {
      const FieldSample here = field.at(way.R * s.points[i] + way.t);
      if (here.distance_mm - gap > reach) continue;
      Candidate c;
      c.pair = way.index;
      c.sample = i;
      c.distance = here.known ? here.distance_mm - gap : -reach;
      found.push_back(c);
    }
    return;
  }
  collect_ball(index + 1, way, found);
  collect_ball(ball.right, way, found);
}

/// No larger than the distance of the bodies; asked where no sample is within reach.
double SlideWalk::clearance(const Pose& X) const {
  const Pose X_inverse = X.inverse();
  double least = infinity;
  std::vector<int> stack;
  for (const auto& pair : model_.pairs_) {
    const SurfaceSamples& s = pair.samples->samples;
    if (s.balls.empty()) continue;
    const Pose& X_FS = pair.samples_move ? X : X_inverse;
    stack.assign(1, 0);
    while (!stack.empty()) {
      const int index = stack.back();
      stack.pop_back();
      const SurfaceSamples::Ball& ball = s.balls[index];
      const double bound =
          pair.field->field.lower_bound(X_FS * ball.center) - ball.radius - pair.gap_mm;
      if (bound >= least) continue;
      if (ball.right == 0) {
        least = bound;
      } else {
        stack.push_back(ball.right);
        stack.push_back(index + 1);
      }
    }
  }
  return least;
}

void SlideWalk::look(Candidate& c, const Pose& X, const Pose& X_inverse) const {
  const auto& pair = model_.pairs_[c.pair];
  const SurfaceSamples& samples = pair.samples->samples;
  const Vector3d& p = samples.points[c.sample];
  const Vector3d& normal = samples.normals[c.sample];
  c.point = pair.samples_move ? X * p : p;
  const FieldSample here = pair.field->field.at(pair.samples_move ? c.point : X_inverse * p);
  c.known = here.known;
  c.distance = here.distance_mm - pair.gap_mm;
  c.gradient = pair.samples_move ? here.gradient : Vector3d(-(X.R * here.gradient));
  const Vector3d facing = pair.samples_move ? Vector3d(-(X.R * normal)) : normal;
  // Where two faces are as near, the gradient says nothing: the sample's own face does.
  if (c.gradient.squaredNorm() < 0.1 && c.distance < 0) c.gradient = facing;
  // Bodies touch face to face: past the end of the other body, the way to its edge is no contact,
  // and would hold up what only slides along. That edge has samples of its own.
  const double cosine = c.gradient.dot(facing) / c.gradient.norm();
  const double spread = samples.spread[c.sample];
  const double least =
      spread * facing_cos - std::sqrt(std::max(0.0, 1 - spread * spread)) * facing_sin;
  c.faces = c.distance < -faces_below_mm || spread < -facing_cos || cosine >= least;
}

/// Looks anew at the candidates that can be nearer than active_mm.
void SlideWalk::evaluate(const Pose& X, double active_mm) {
  constexpr std::size_t run = 512;
  relevant_.clear();
  for (std::size_t i = 0; i < horizon_.size(); ++i)
    if (horizon_[i] <= walked_ + active_mm + bent_mm) relevant_.push_back(static_cast<int>(i));
  const Pose X_inverse = X.inverse();
  const std::size_t runs = (relevant_.size() + run - 1) / run;
  const auto body = [&](std::size_t r) {
    for (std::size_t k = r * run; k < std::min(relevant_.size(), (r + 1) * run); ++k) {
      Candidate& c = candidates_[relevant_[k]];
      look(c, X, X_inverse);
      horizon_[relevant_[k]] = walked_ + (c.known ? c.distance : 0.0);
    }
  };
  if (threads_ > 1 && runs > 2)
    parallel_for(runs, threads_, body);
  else
    for (std::size_t r = 0; r < runs; ++r) body(r);
  worst_gap_ = infinity;
  for (const int i : relevant_)
    if (const Candidate& c = candidates_[i]; c.known)
      worst_gap_ = std::min(worst_gap_, c.distance - allowed(c));
}

void SlideWalk::make_rows(const Pose& X, double active_mm) {
  const Vector3d pivot = X * model_.pivot_;
  rows_.clear();
  row_candidate_.clear();
  for (const int i : relevant_) {
    const Candidate& c = candidates_[i];
    if (!c.known) continue;
    const double gap = c.distance - allowed(c);
    if (!c.faces || gap > active_mm || c.gradient.squaredNorm() < 0.1) continue;
    // Depth within the slop is neither deepened nor undone: to stay is always allowed.
    const double open = gap > 0 ? gap : std::min(0.0, gap + kept_slop * model_.settings_.slop_mm);
    rows_.push_back(contact_row(c.point - pivot, c.gradient, open, model_.rotation_length_mm_));
    rows_.back().rubs = gap < rubs_below_mm;
    row_candidate_.push_back(i);
  }
  for (const Cut& cut : cuts_) {
    const Twist since = between(cut.X, X);
    if (way_of(since) > cut_reach_mm) continue;
    rows_.push_back(cut.row);
    rows_.back().gap_mm = std::max(0.0, cut.row.gap_mm + cut.row.along.dot(since));
    row_candidate_.push_back(-1);
  }
}

/// A walk that ended on cuts or short steps may have ended early: it is walked again from there
/// until nothing is gained. So the answer, taken as a start, is its own answer.
SlideResult SlideWalk::run(const Pose& from, const Pose& wanted) {
  SlideResult out;
  if (!is_finite(from) || !is_finite(wanted)) {
    out.X_FM = from;
    return out;
  }
  if (memory_ && remembers() && same_bits(memory_->last.X_FM, from) &&
      same_bits(memory_->wanted, wanted))
    return memory_->last;
  Pose start = from;
  int steps = 0;
  for (int k = 0; k < max_walks; ++k) {
    out = walk(start, wanted);
    steps += out.steps;
    if (surely_settled_ || same_bits(out.X_FM, start)) break;
    start = out.X_FM;
  }
  out.steps = steps;
  if (memory_) {
    memory_->wanted = wanted;
    memory_->last = out;
    memory_->owner = &model_;
    memory_->baseline = model_.baseline_;
  }
  return out;
}

SlideResult SlideWalk::walk(const Pose& from, const Pose& wanted) {
  const SlideSettings& settings = model_.settings_;
  const double band = model_.band_mm_;
  double longest = step_share * band;
  if (settings.friction > 0) longest = std::min(longest, rubbing_step_mm);
  const double collected = collect_share * band, reserve = collected - active_share * band;
  TwistSettings solver;
  solver.friction = settings.friction;
  solver.rotation_length_mm = model_.rotation_length_mm_;
  solver.max_contacts = settings.max_contacts;
  solver.thinning_mm = settings.thinning_mm;

  SlideResult out, start;
  Pose X = from;
  const double whole = way_of(between(from, wanted));
  const int max_steps = 24 + static_cast<int>(3 * whole / longest);
  double share = 1;
  double radius = std::min(longest, first_radius_mm);  // no step is longer
  Twist last = Twist::Zero();
  cuts_.clear();
  remember(X, reserve);
  std::array<double, 8> lately;  // how far from the wanted pose it was
  lately.fill(infinity);
  for (out.steps = 0; out.steps < max_steps; ++out.steps) {
    if (walked_ > reserve) collect(X);
    const Twist left = between(X, wanted);
    const double way = way_of(left);
    if (candidates_.empty()) {
      // Free: as far as the clearance lets it.
      const double clear = std::max(clearance(X), collected - walked_ - 1e-6);
      if (clear >= way) {
        surely_settled_ = true;
        out = {wanted, false, true, 0, {}, out.steps};
        return out;
      }
      X = moved(X, left * (clear / way));
      walked_ = infinity;
      continue;
    }
    const double active = radius + (active_share - step_share) * band;
    evaluate(X, active);
    make_rows(X, active);
    const TwistSolution solution = nearest_allowed(share * left, rows_, solver);
    Twist x = solution.x;
    const double step = way_of(x);
    report(X, solution, share, out);
    double& before = lately[static_cast<std::size_t>(out.steps) % lately.size()];
    const bool stalls = settings.friction == 0 && before - left.norm() < gained_mm;
    before = left.norm();
    out.settled = (step <= settled_mm * share || step <= still_mm || stalls) &&
                  out.depth_mm <= settings.slop_mm;
    if (out.steps == 0) start = out;
    surely_settled_ =
        out.settled && !stalls && share == 1 && out.contacts.size() == solution.pushes.size();
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
    X = arrives ? wanted : moved(X, x);
    const double walked = std::min(step, radius);
    walked_ += walked;
    radius = std::min(longest, std::max(2 * walked, least_radius_mm));
  }
  // Nothing gained: it stays where it was.
  const bool start_is_free = start.X_FM.t == from.t && start.depth_mm <= settings.slop_mm;
  if (out.steps > 0 && start_is_free && settings.friction == 0 &&
      between(from, wanted).norm() <= between(out.X_FM, wanted).norm() + gained_mm) {
    start.steps = out.steps;
    start.settled = true;
    return start;
  }
  return out;
}

void SlideWalk::report(const Pose& X, const TwistSolution& solution, double share,
                       SlideResult& out) const {
  out.X_FM = X;
  out.depth_mm = std::max(0.0, -worst_gap_);
  out.touching = !solution.pushes.empty();
  out.contacts.clear();
  for (const Push& push : solution.pushes) {
    const int index = row_candidate_[push.row];
    if (index < 0) continue;
    const Candidate& c = candidates_[index];
    out.contacts.push_back(
        {c.point, rows_[push.row].normal, c.distance - allowed(c), push.length_mm / share});
  }
}

void SlideWalk::keep_cuts(const Pose& X, const TwistSolution& solution) {
  for (const Push& push : solution.pushes)
    if (row_candidate_[push.row] >= 0) cuts_.push_back({rows_[push.row], X});
  if (cuts_.size() > max_cuts)
    cuts_.erase(cuts_.begin(), cuts_.end() - static_cast<std::ptrdiff_t>(max_cuts));
}

void SlidingContact::allow_overlap_at(const Pose& rest) {
  ++baseline_;
  for (auto& pair : pairs_) pair.allowed.clear();
  SlideWalk(*this, 1).allow(rest, pairs_);
}

SlideResult SlidingContact::slide(const Pose& from, const Pose& wanted, SlideMemory* memory,
                                  int threads) const {
  return SlideWalk(*this, threads, memory).run(from, wanted);
}

double SlidingContact::depth(const Pose& X_FM, int threads) const {
  return SlideWalk(*this, threads).depth_at(X_FM);
}

}  // namespace condyle
