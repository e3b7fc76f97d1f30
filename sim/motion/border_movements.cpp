// The border movements: the limits of motion set by joints and teeth.

#include <algorithm>
#include <cmath>

#include "sim/motion/movements.h"

namespace condyle {
namespace {

constexpr double default_retrusion_mm = 0.7;

}  // namespace

/// Retrusion ends where the gap to the rear wall of the fossa is half that at rest.
double Movements::retruded_mm() {
  const double requested = parameters_.retrusion_mm.value_or(default_retrusion_mm);
  if (!joints_->surfaces()) return requested;
  constexpr double step_mm = 0.05, min_fraction = 0.5;
  TrianglePair left, right;
  double reached = 0;
  for (double s = step_mm; s <= requested + 1e-9; s += step_mm) {
    const Pose X_CM = joints_->pose(at_condyles(-s, -s));
    const auto& joint = *joints_->surfaces();
    if (joint.gap_mm(JawSide::left, X_CM, left) < min_fraction * joint.rest_gap_mm(JawSide::left) ||
        joint.gap_mm(JawSide::right, X_CM, right) <
            min_fraction * joint.rest_gap_mm(JawSide::right))
      break;
    reached = s;
  }
  if (reached < requested - step_mm)
    add_note("retrusion stops where the gap of a condyle to the rear wall of the fossa is halved");
  return reached;
}

/// Starts with a pure hinge where the fossa permits it; else the coupling of the opening.
Coupling Movements::hinge_border() const {
  Coupling hinge = limits_.coupling;
  hinge.early = 0;
  if (!joints_->surfaces() || parameters_.early_translation) return limits_.coupling;
  constexpr double min_fraction = 0.5;
  TrianglePair left, right;
  for (double theta = 0; theta < hinge.hinge; theta += degree) {
    const Pose X_CM = joints_->pose({joints_->closed_theta() + theta, 0, 0, 0});
    const auto& joint = *joints_->surfaces();
    if (joint.gap_mm(JawSide::left, X_CM, left) < min_fraction * joint.rest_gap_mm(JawSide::left) ||
        joint.gap_mm(JawSide::right, X_CM, right) <
            min_fraction * joint.rest_gap_mm(JawSide::right))
      return limits_.coupling;
  }
  return hinge;
}

/// From tooth contact (progress 0) to maximum opening (1): the orbiting condyle stays forward while
/// the other one follows the opening.
JawInputs Movements::lateral_border(bool to_left, double forward_mm, double bite,
                                    double progress) const {
  const double widest = limits_.widest_theta, theta = bite + (widest - bite) * progress;
  const double behind = limits_.coupling.forward_mm(theta);
  const double open = limits_.coupling.forward_mm(widest);
  const double ahead = std::max(forward_mm + (open - forward_mm) * progress, behind);
  JawInputs in = to_left ? at_condyles(behind, ahead) : at_condyles(ahead, behind);
  in.theta = theta;
  return in;
}

/// Largest forward travel of the orbiting condyle without contact of bone, at tooth contact and
/// along the border.
double Movements::free_aside(bool to_left, double forward_mm, bool whole_border) {
  constexpr double step_mm = 0.25;
  const auto is_free = [&](double s) {
    const JawInputs bite = to_left ? biting(0, s) : biting(s, 0);
    if (!free_(joints_->pose(bite))) return false;
    for (double p = 0.1; whole_border && p < 0.75; p += 0.1)
      if (!free_(joints_->pose(lateral_border(to_left, s, bite.theta, p)))) return false;
    return true;
  };
  double s = forward_mm;
  while (s > step_mm && !is_free(s)) s -= step_mm;
  if (s < forward_mm)
    add_note(std::string("laterotrusion to the ") + (to_left ? "left" : "right") +
             " ends where bone meets bone");
  return s;
}

std::vector<std::pair<std::string, Movements::Leg>> Movements::border_legs() {
  const double back = retruded_mm();
  const double front = forward_for(parameters_.protrusion_mm.value_or(8), "protrusion", false);
  const double widest = limits_.widest_theta;
  const double open = limits_.coupling.forward_mm(widest);
  const double aside_mm = parameters_.laterotrusion_mm.value_or(9);
  const auto inputs = [joints = joints_](double theta, double left, double right) {
    return JawInputs{theta, left, right, joints->bennett_shift_mm(left, right)};
  };

  std::vector<std::pair<std::string, Leg>> legs;
  if (back > 0) legs.emplace_back("retruded contact", straight_glide(0, 0, -back, -back));
  const double start = biting(-back, -back).theta;
  const Coupling hinge = hinge_border();
  const double ratio = open / std::max(hinge.forward_mm(widest), 1e-9);
  legs.emplace_back("posterior border", leg(
                                            [=](double p) {
                                              const double theta = start + (widest - start) * p;
                                              const double s =
                                                  ratio * hinge.forward_mm(theta) - back * (1 - p);
                                              return inputs(theta, s, s);
                                            },
                                            false));
  const double protruded = biting(front, front).theta;
  legs.emplace_back("anterior border", leg(
                                           [=](double p) {
                                             const double s = open + (front - open) * p;
                                             return inputs(widest + (protruded - widest) * p, s, s);
                                           },
                                           false));
  legs.emplace_back("protruded contact", straight_glide(front, front, 0, 0));

  for (const bool to_left : {true, false}) {
    double s = forward_aside_for(aside_mm, to_left, "laterotrusion", false);
    if (!parameters_.laterotrusion_mm) s = free_aside(to_left, s, true);
    const double bite = (to_left ? biting(0, s) : biting(s, 0)).theta;
    // Tabulated, because the leg outlives this object.
    constexpr int samples = 64;
    std::vector<double> progress, thetas, lefts, rights;
    for (int i = 0; i <= samples; ++i) {
      progress.push_back(static_cast<double>(i) / samples);
      const JawInputs in = lateral_border(to_left, s, bite, progress.back());
      thetas.push_back(in.theta);
      lefts.push_back(in.left_mm);
      rights.push_back(in.right_mm);
    }
    const auto border = [=, theta = Pchip(progress, thetas), left = Pchip(progress, lefts),
                         right = Pchip(progress, rights)](double p) {
      return inputs(theta(p), left(p), right(p));
    };
    const std::string side = to_left ? "left" : "right";
    if (to_left) {
      legs.emplace_back("left contact", straight_glide(0, 0, 0, s));
      legs.emplace_back("left border", leg(border, false));
    } else {
      legs.emplace_back("right border", leg([=](double p) { return border(1 - p); }, false));
      legs.emplace_back("right contact", straight_glide(s, 0, 0, 0));
    }
  }
  return legs;
}

void Movements::posselt(const Pace& pace) {
  traces_borders_ = true;
  if (here_.theta != biting(0, 0).theta || here_.left_mm != 0 || here_.right_mm != 0) {
    begin("closing");
    close({});
  }
  auto legs = border_legs();
  std::optional<double> each = pace.duration_s;
  double whole = 0;
  for (const auto& [name, made] : legs) whole += path_length_mm(made);
  for (auto& [name, made] : legs) {
    const double length = path_length_mm(made);
    begin(name);
    append(std::move(made),
           {.duration_s = each ? std::optional(*each * length / whole) : std::nullopt,
            .speed_mm_s = pace.speed_mm_s});
  }
}

MotionBorders Movements::borders() {
  constexpr int points = 40;
  MotionBorders round;
  for (const auto& [name, made] : border_legs()) {
    const bool lateral = name.starts_with("left") || name.starts_with("right");
    auto& side = lateral ? round.frontal : round.sagittal;
    for (int i = 0; i < points; ++i)
      side.push_back(joints_->incisor(made.resolved(static_cast<double>(i) / points)));
  }
  return round;
}

}  // namespace condyle
