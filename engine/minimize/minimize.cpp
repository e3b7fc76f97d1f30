#include "engine/minimize/minimize.h"

#include <cassert>
#include <optional>

#include "engine/minimize/minimizer_parts.h"

namespace condyle {
namespace {

using namespace minimizers;
using Status = MinimizeResult::Status;

constexpr double flat =
    0.1;  // slope after a full step, of that before it, that needs no other step
// Iterations that shorten the remaining distance by a factor each leave the sum of a geometric
// series; before the first nothing is known of that factor.
constexpr double unknown_fraction = 0.3, least_contraction = 0.95;

/// Preconditioned Polak-Ribiere with a parabolic line search: where every squared length is
/// quadratic along a direction and every volume cubic, one step with the exact slope and curvature
/// is nearly always accepted. The first step of a fresh preconditioner is of full length, if that
/// leaves the line nearly flat; else the slopes at both ends give the step. A renewed
/// preconditioner begins anew, downhill.
class ConjugateGradients {
 public:
  ConjugateGradients(Objective& objective, const Preconditioner& preconditioner,
                     const MinimizeSettings& settings, Points& x)
      : objective_(objective),
        settings_(settings),
        counted_(objective, settings, result_),
        given_(preconditioner),
        preconditioner_(&preconditioner),
        x_(x),
        trial_(x.size()) {}

  MinimizeResult run() {
    f_ = counted_.value_and_gradient(x_, g_);
    if (!std::isfinite(f_) || !begin()) {
      result_.status = Status::bad_start;
      result_.energy = f_;
      result_.residual = largest_norm(g_);
      return result_;
    }
    for (;
         !result_.converged() && result_.iterations < settings_.max_iterations && !counted_.spent();
         ++result_.iterations)
      if (!iterate()) break;
    result_.energy = f_;
    result_.residual = largest_norm(g_);
    result_.bytes = bytes_of(g_, g_new_, z_, d_, trial_) + given_.bytes();
    return result_;
  }

 private:
  /// The first direction with the present preconditioner. Returns false if it is not finite.
  bool begin() {
    preconditioner_->solve(g_, z_);
    gz_ = dot(g_, z_);
    if (!std::isfinite(gz_)) return false;
    remaining_ = shortest_ = largest_norm(z_);
    d_.resize(x_.size());
    turn_downhill();
    if (arrived(unknown_fraction * settings_.tolerance_mm, 1)) result_.status = Status::converged;
    return true;
  }

  void turn_downhill() {
    for (std::size_t i = 0; i < x_.size(); ++i) d_[i] = -z_[i];
    slope_ = -gz_;
    length_ = remaining_;
  }

  /// One line search. Returns false where the minimisation ends in this iteration.
  bool iterate() {
    const double longest = settings_.max_step_mm / length_;
    const bool full = settings_.fresh && result_.iterations == 0 && 1 < longest;
    const auto step = full ? std::optional(1.0) : newton_step(longest);
    if (!step) {
      result_.status = Status::stalled;
      return false;
    }
    if (!search_line(*step, longest, full)) {  // as low as the arithmetic goes
      if (remaining_ < settings_.tolerance_mm)
        result_.status = Status::converged;
      else if (!counted_.spent())
        result_.status = Status::stalled;
      return false;
    }
    if (!settings_.check_last && result_.iterations + 1 >= settings_.max_iterations) {
      g_.swap(g_new_);
      return true;
    }
    if (const Preconditioner* other = renewed()) {
      preconditioner_ = other;
      g_.swap(g_new_);
      if (begin()) return true;
      ++result_.iterations;
      result_.status = Status::stalled;
      return false;
    }
    return turn();
  }

  /// By slope and curvature along d; none where the curvature is not positive.
  std::optional<double> newton_step(double longest) {
    const auto curvature = objective_.curvature(x_, d_);
    const double bend =
        curvature.exact > 0.1 * curvature.gauss_newton ? curvature.exact : curvature.gauss_newton;
    if (!(bend > 0)) return std::nullopt;
    return std::min(-slope_ / bend, longest);
  }

  /// Moves x along d to a lower value, with the gradient there in g_new. Returns false, with x
  /// unchanged, where none is found. `full`: the first step was not derived from the curvature.
  bool search_line(double step, double longest, bool full) {
    double f_new = 0;
    bool accepted = false;
    for (int attempt = 0; attempt < 30 && !accepted && !counted_.spent(); ++attempt) {
      step_along(x_, step, d_, trial_);
      f_new = counted_.value_and_gradient(trial_, g_new_);
      if (full && std::isfinite(f_new)) {
        full = false;
        const double slope_new = dot(g_new_, d_);
        if (slope_new > slope_ && std::abs(slope_new) > flat * -slope_) {
          step = std::min(slope_ / (slope_ - slope_new), longest);
          continue;
        }
      }
      // Near the minimum the energies differ by less than their rounding; then the slope decides.
      const double rounding = 1e-13 * std::abs(f_);
      accepted = f_new <= f_ + 1e-4 * step * slope_ ||
                 (std::abs(f_new - f_) <= rounding && std::abs(dot(g_new_, d_)) <= 0.9 * -slope_);
      if (!accepted) {
        const double fit = f_new - f_ - step * slope_;  // parabola through f, slope and f_new
        const double parabolic = fit > 0 ? -slope_ * step * step / (2 * fit) : 0.3 * step;
        step = std::isfinite(f_new) ? std::clamp(parabolic, 0.1 * step, 0.6 * step) : 0.75 * step;
      }
    }
    if (!accepted) return false;
    x_.swap(trial_);
    f_ = f_new;
    return true;
  }

  /// Another preconditioner for the point reached, or null.
  const Preconditioner* renewed() {
    if (!settings_.renew || result_.iterations + 1 >= settings_.max_iterations || counted_.spent())
      return nullptr;
    MinimizeResult done = result_;
    ++done.iterations;
    return settings_.renew(x_, done);
  }

  /// The next conjugate direction. Returns false where x is within the tolerance.
  bool turn() {
    preconditioner_->solve(g_new_, z_);
    const double gz_new = dot(g_new_, z_);
    const double beta = std::max(0.0, (gz_new - dot(g_, z_)) / gz_);
    g_.swap(g_new_);
    gz_ = gz_new;
    remaining_ = largest_norm(z_);
    const double contraction = std::min(remaining_ / shortest_, least_contraction);
    shortest_ = std::min(shortest_, remaining_);
    if (arrived(settings_.tolerance_mm * (1 - contraction), softest_)) {
      ++result_.iterations;
      result_.status = Status::converged;
      return false;
    }
    for (std::size_t i = 0; i < x_.size(); ++i) d_[i] = beta * d_[i] - z_[i];
    slope_ = dot(g_, d_);
    length_ = largest_norm(d_);
    if (slope_ >= 0) turn_downhill();
    return true;
  }

  bool arrived(double enough, double least) {
    return remaining_ < far_below_ * enough ||
           (remaining_ * least < enough && remaining_ * stretch(least) < enough);
  }

  /// The distance along z is longer than the preconditioner says where that is stiffer than the
  /// objective, and shorter where it is softer: at most to `least`, as other parts may be as stiff.
  double stretch(double least) {
    const auto curvature = objective_.curvature(x_, z_);
    return curvature.gauss_newton > 0 ? std::max(least, gz_ / curvature.gauss_newton) : 1.0;
  }

  Objective& objective_;
  const MinimizeSettings& settings_;
  MinimizeResult result_;
  Counted counted_;
  const Preconditioner& given_;
  const Preconditioner* preconditioner_;
  Points& x_;
  Points g_, g_new_, z_, d_, trial_;
  double f_ = 0;          // the value at x
  double gz_ = 0;         // g . z
  double remaining_ = 0;  // distance to the minimum by the preconditioner
  double shortest_ = 0;   // of all so far
  double slope_ = 0;      // along d
  double length_ = 0;     // of the longest vector of d
  // A fresh preconditioner is not five times too stiff: far below, the curvature is not checked.
  const double far_below_ = settings_.fresh ? 0.2 : 0.0, softest_ = settings_.fresh ? 0.5 : 1.0;
};

}  // namespace

MinimizeResult minimize(Objective& objective, const Preconditioner& preconditioner,
                        const MinimizeSettings& settings, Points& x) {
  assert(settings.tolerance_mm >= 0 && settings.max_step_mm > 0);
  return ConjugateGradients(objective, preconditioner, settings, x).run();
}

}  // namespace condyle
