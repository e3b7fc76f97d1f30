#include "sim/dynamics/muscle_jaw.h"

#include <Eigen/Dense>
#include <algorithm>

#include "engine/core/error.h"
#include "engine/core/units.h"
#include "sim/muscles/default_muscles.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double arm_mm = 50;  // size of a jaw about its centre of mass
// Frame damping in the mechanics file acts at the origin of the bone's frame, where it slows a
// rotating jaw twice as much as at the centre of mass. It acts at the centre of mass where the
// origin of the patient's coordinates is elsewhere.
constexpr double longest_arm_mm = 150;
Vector3d damped_place(const BoneMechanics& bone) {
  return bone.center.norm() < longest_arm_mm ? Vector3d(Vector3d::Zero()) : bone.center;
}
// Drag of a jaw in its soft tissue, where the case has none.
constexpr double default_drag_kg_s = 20, default_angular_drag_kg_mm2_s = 200;
const BoneMechanics default_hyoid = {.mass_kg = 0.01,
                                     .center = Vector3d::Zero(),
                                     .inertia = Eigen::Matrix3d::Identity(),
                                     .drag_kg_s = 10,
                                     .turning_drag_kg_mm2_s = 100};

JawWorldSettings world_settings(const Case& patient, const MuscleJawSettings& settings) {
  JawWorldSettings world;
  world.X_CM = settings.X_CM;
  world.bite_force_N.setZero();
  world.friction = settings.friction;
  world.teeth = settings.teeth;
  world.worn_crowns = world.stops = true;
  world.fossa = settings.fossa;
  world.bones = settings.bones;
  const bool known = patient.mechanics && patient.mechanics->mandible.drag_kg_s > 0;
  world.drag_kg_s = known ? patient.mechanics->mandible.drag_kg_s : default_drag_kg_s;
  world.turning_drag_kg_mm2_s =
      known ? patient.mechanics->mandible.turning_drag_kg_mm2_s : default_angular_drag_kg_mm2_s;
  if (known) world.drag_at = settings.damped_at.value_or(damped_place(patient.mechanics->mandible));
  return world;
}

BoneMechanics hyoid_of(const Case& patient, const std::vector<Muscle>& muscles) {
  if (patient.mechanics && patient.mechanics->hyoid) return *patient.mechanics->hyoid;
  BoneMechanics bone = default_hyoid;
  if (const auto center = hyoid_center(muscles)) bone.center = *center;
  return bone;
}

Vector3d hyoid_drag_at(const Case& patient, const BoneMechanics& hyoid) {
  return patient.mechanics && patient.mechanics->hyoid ? damped_place(hyoid) : hyoid.center;
}

std::vector<Muscle> muscles_left(const Case& patient, const std::vector<std::string>& without) {
  std::vector<Muscle> muscles = muscles_of(patient);
  std::erase_if(muscles, [&](const Muscle& muscle) {
    return std::find(without.begin(), without.end(), muscle.name) != without.end();
  });
  return muscles;
}

}  // namespace

/// Present line of action of a muscle.
struct MuscleJaw::Line {
  Vector3d origin, insertion;  // cranium
  Vector3d toward_origin;      // unit, direction of the force on the insertion
  double length_mm = 0, speed_mm_s = 0;
};

MuscleJaw::MuscleJaw(const Case& patient, const MuscleJawSettings& settings, int threads,
                     const Progress& progress)
    : muscles_(muscles_left(patient, settings.without)),
      settings_(settings),
      world_settings_(world_settings(patient, settings)),
      jaw_(make_jaw_world(patient, world_settings_, threads, progress)),
      mass_(jaw_.world.mass(jaw_.mandible)),
      hyoid_(hyoid_of(patient, muscles_), hyoid_drag_at(patient, hyoid_of(patient, muscles_))),
      bite_(bite_plane(patient)),
      states_(muscles_.size()) {
  const auto pulled = [&](const Vector3d& point) {
    return jaw_.world.add_force({.body = jaw_.mandible, .point = point});
  };
  for (const Muscle& m : muscles_)
    forces_.push_back(m.origin_body == MuscleBody::mandible      ? pulled(m.origin)
                      : m.insertion_body == MuscleBody::mandible ? pulled(m.insertion)
                                                                 : -1);
  if (settings_.bolus.side != BolusSettings::Side::none) {
    const Vector3d& point =
        settings_.bolus.side == BolusSettings::Side::left ? bite_.left : bite_.right;
    bolus_.emplace(settings_.bolus, point, bite_.normal);
    bolus_force_ = pulled(point);
  }
  if (!settings_.teeth)
    for (const Vector3d& point : {bite_.left, bite_.right}) {
      RigidJoint stop{.kind = RigidJoint::Kind::plane, .a = 0, .b = jaw_.mandible};
      stop.p_A = stop.p_B = point;
      stop.axis_A = bite_.normal;
      jaw_.world.add_joint(stop);
    }
  if (settings_.hyoid == MuscleJawSettings::HyoidMode::prescribed && !settings_.hyoid_displacement)
    throw InputError("the hyoid is prescribed, but its displacement is missing");
}

MuscleJaw::Line MuscleJaw::line(const Muscle& m) const {
  const auto place = [&](MuscleBody body, const Vector3d& p, Vector3d& p_C, Vector3d& velocity) {
    p_C = p;
    velocity.setZero();
    if (body == MuscleBody::mandible) {
      p_C = pose() * p;
      velocity = motion().velocity + motion().spin.cross(p_C - center());
    } else if (body == MuscleBody::hyoid) {
      p_C = hyoid_.pose() * p;
      velocity = hyoid_.velocity(p_C);
    }
  };
  Line out;
  Vector3d origin_velocity, insertion_velocity;
  place(m.origin_body, m.origin, out.origin, origin_velocity);
  place(m.insertion_body, m.insertion, out.insertion, insertion_velocity);
  const Vector3d span = out.origin - out.insertion;
  out.length_mm = span.norm();
  out.toward_origin = out.length_mm > 0 ? Vector3d(span / out.length_mm) : Vector3d::UnitZ();
  out.speed_mm_s = out.toward_origin.dot(origin_velocity - insertion_velocity);
  return out;
}

/// Directions in which the mandible is free to move: an orthonormal basis of (velocity, angular
/// velocity) compatible with guides, stops and loaded tooth contacts.
Eigen::MatrixXd MuscleJaw::free_directions() const {
  constexpr double seated_mm = 0.01, still_mm_s = 1;
  std::vector<Vector6d> held_rows;
  const auto hold = [&](const Vector3d& p_C, const Vector3d& along) {
    Vector6d row;
    row << along, (p_C - center()).cross(along);
    held_rows.push_back(row);
  };
  const Eigen::Matrix<double, 3, 6> guides = held();
  for (int k = 0; k < 3; ++k) held_rows.push_back(guides.row(k).transpose());
  for (std::size_t side = 0; side < 2; ++side) {
    const Vector3d& seat = jaw_.condyles[side];
    const Vector3d now = pose() * seat;
    const Vector3d velocity = motion().velocity + motion().spin.cross(now - center());
    if (seat.y() - now.y() < seated_mm && -velocity.y() < still_mm_s)
      hold(now, Vector3d(0, -1, -jaw_.inferior_mm[side].derivative(0)).normalized());
  }
  for (const RigidContact& contact : jaw_.world.contacts()) hold(contact.point, contact.normal);
  for (const Vector3d& seat : {bite_.left, bite_.right}) {
    if (settings_.teeth) break;
    const Vector3d now = pose() * seat;
    const Vector3d velocity = motion().velocity + motion().spin.cross(now - center());
    if ((now - seat).dot(bite_.normal) < seated_mm && velocity.dot(bite_.normal) < still_mm_s)
      hold(now, bite_.normal);
  }
  Eigen::MatrixXd rows(6, static_cast<Eigen::Index>(held_rows.size()));
  for (std::size_t k = 0; k < held_rows.size(); ++k) {
    rows.col(static_cast<Eigen::Index>(k)) = held_rows[k];
    // Angles are scaled by the size of a jaw.
    rows.col(static_cast<Eigen::Index>(k)).tail<3>() /= arm_mm;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(rows);
  qr.setThreshold(1e-3);
  const Eigen::MatrixXd Q = qr.householderQ() * Eigen::MatrixXd::Identity(6, 6);
  Eigen::MatrixXd free = Q.rightCols(6 - qr.rank());
  free.bottomRows<3>() /= arm_mm;
  return free;
}

/// Sets the forces of a step. The force of strong muscles falls so steeply with speed that an
/// explicit step would oscillate: it is evaluated at the predicted velocity at the end of the step.
void MuscleJaw::pull(std::span<const double> excitations) {
  const double h = step_s();
  const Eigen::Matrix3d R = pose().R.toRotationMatrix();
  Eigen::Matrix<double, 6, 6> inertia = Eigen::Matrix<double, 6, 6>::Zero();
  inertia.topLeftCorner<3, 3>() = mass_.mass_kg * Eigen::Matrix3d::Identity();
  inertia.bottomRightCorner<3, 3>() = R * mass_.inertia * R.transpose();
  Vector6d force = mm_per_m * other_forces();
  std::vector<Line> lines;
  std::vector<MuscleTension> tensions;
  std::vector<Vector6d> directions;
  for (std::size_t i = 0; i < muscles_.size(); ++i) {
    MuscleState& state = states_[i];
    state.excitation = excitations[i];
    state.activation = next_activation(settings_.law, state.activation, excitations[i], h);
    lines.push_back(line(muscles_[i]));
    const Line& now = lines.back();
    tensions.push_back(muscle_tension(muscles_[i], settings_.law, state.activation, now.length_mm,
                                      now.speed_mm_s));
    directions.push_back(direction(i, now));
    force += mm_per_m * tensions.back().at(state.activation) * directions.back();
    inertia += h * mm_per_m * tensions.back().slope_N_s_mm * directions.back() *
               directions.back().transpose();
  }
  const Eigen::MatrixXd free = free_directions();
  Vector6d change = Vector6d::Zero();  // of velocity and angular velocity in the step
  if (free.cols() > 0)
    change = free * (free.transpose() * inertia * free)
                        .ldlt()
                        .solve(Eigen::VectorXd(h * free.transpose() * force));
  for (std::size_t i = 0; i < muscles_.size(); ++i) {
    const Line& now = lines[i];
    const Muscle& m = muscles_[i];
    MuscleState& state = states_[i];
    state.force_N = std::max(
        tensions[i].at(state.activation) - tensions[i].slope_N_s_mm * directions[i].dot(change),
        0.0);
    state.length_mm = now.length_mm;
    state.speed_mm_s = now.speed_mm_s;
    if (forces_[i] >= 0) jaw_.world.set_force(forces_[i], state.force_N * directions[i].head<3>());
    if (m.origin_body == MuscleBody::hyoid)
      hyoid_.pull(now.origin, -now.toward_origin, state.force_N, tensions[i].slope_N_s_mm);
    if (m.insertion_body == MuscleBody::hyoid)
      hyoid_.pull(now.insertion, now.toward_origin, state.force_N, tensions[i].slope_N_s_mm);
  }
}

void MuscleJaw::move_hyoid() {
  using Mode = MuscleJawSettings::HyoidMode;
  if (settings_.hyoid == Mode::free)
    hyoid_.step(step_s(), jaw_.world.settings().gravity_mm_s2);
  else
    hyoid_.carry(
        {Eigen::Quaterniond::Identity(), settings_.hyoid == Mode::prescribed
                                             ? settings_.hyoid_displacement(time_s_ + step_s())
                                             : Vector3d(Vector3d::Zero())},
        step_s());
}

bool MuscleJaw::step(std::span<const double> excitations, int threads) {
  pull(excitations);
  if (bolus_) {
    const Vector3d p = pose() * bolus_->point();
    const Vector3d velocity = motion().velocity + motion().spin.cross(p - center());
    bolus_push_N_ = bolus_->push_N(p, velocity);
    jaw_.world.set_force(bolus_force_, bolus_push_N_ * bolus_->normal());
  }
  if (!jaw_.world.step(threads).taken) return false;
  move_hyoid();
  time_s_ += step_s();
  return true;
}

/// Unit force on the mandible and its torque about the centre of mass; zero if not attached there.
Vector6d MuscleJaw::direction(std::size_t muscle, const Line& now) const {
  Vector6d out = Vector6d::Zero();
  if (forces_[muscle] < 0) return out;
  const bool by_origin = muscles_[muscle].origin_body == MuscleBody::mandible;
  const Vector3d force = (by_origin ? -1 : 1) * now.toward_origin;
  out << force, ((by_origin ? now.origin : now.insertion) - center()).cross(force);
  return out;
}

std::vector<MuscleJaw::Pull> MuscleJaw::pulls() const {
  std::vector<Pull> out;
  for (std::size_t i = 0; i < muscles_.size(); ++i) {
    const Line now = line(muscles_[i]);
    Pull pull{direction(i, now), muscle_tension(muscles_[i], settings_.law, states_[i].activation,
                                                now.length_mm, now.speed_mm_s)};
    out.push_back(pull);
  }
  return out;
}

Vector6d MuscleJaw::other_forces() const {
  const Vector3d arm = pose() * world_settings_.drag_at.value_or(mass_.center) - center();
  const Vector3d drag =
      -*world_settings_.drag_kg_s * (motion().velocity + motion().spin.cross(arm));
  Vector6d out;
  out << mass_.mass_kg * jaw_.world.settings().gravity_mm_s2 + drag,
      arm.cross(drag) - *world_settings_.turning_drag_kg_mm2_s * motion().spin;
  out /= mm_per_m;
  if (bolus_) {
    const Vector3d force = bolus_push_N_ * bolus_->normal();
    Vector6d push;
    push << force, (pose() * bolus_->point() - center()).cross(force);
    out += push;
  }
  return out;
}

Eigen::Matrix<double, 3, 6> MuscleJaw::held() const {
  Eigen::Matrix<double, 3, 6> rows;
  const auto row = [&](int k, const Vector3d& p_C, const Vector3d& along) {
    rows.row(k) << along.transpose(), (p_C - center()).cross(along).transpose();
  };
  for (std::size_t k = 0; k < 2; ++k) {
    const Vector3d seat = jaw_.condyles[k], now = pose() * seat;
    const double slope = jaw_.inferior_mm[k].derivative(std::max(seat.y() - now.y(), 0.0));
    row(static_cast<int>(k), now, Vector3d(0, -slope, 1).normalized());
  }
  row(2, pose() * (0.5 * (jaw_.condyles[0] + jaw_.condyles[1])), Vector3d::UnitX());
  return rows;
}

}  // namespace condyle
