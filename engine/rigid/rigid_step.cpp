#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "engine/rigid/rigid_world_state.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int max_halvings = 7;  // of a step
constexpr double min_active_mm = 0.01;
// Fractions of the slop: depth at which bodies come to rest, and additional depth at which an
// inactive contact is added.
constexpr double rest_fraction = 0.5, tolerated_fraction = 0.25;
constexpr double corrected_fraction = 0.2;  // of the excess depth, per step
constexpr std::size_t added_at_once = 8;    // of a pair

Quaterniond turned(const Vector3d& turn) {
  const double angle = turn.norm();
  return angle > 0 ? Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) : Quaterniond::Identity();
}

}  // namespace

void RigidWorld::State::add_spring_forces(const RigidSpring& spring) {
  const auto a = static_cast<std::size_t>(spring.a), b = static_cast<std::size_t>(spring.b);
  const Vector3d p_a = poses[a] * spring.p_A, p_b = poses[b] * spring.p_B;
  const double length = (p_b - p_a).norm();
  if (!(length > 0)) return;  // no direction
  const Vector3d along = (p_b - p_a) / length;
  const auto velocity = [&](std::size_t i, const Vector3d& p) {
    return Vector3d(motions[i].velocity + motions[i].spin.cross(p - centers[i]));
  };
  const double stretch = length - spring.rest_length_mm;
  if (spring.slack_when_short && stretch < 0) return;
  double pull = spring.stiffness_N_mm * stretch +
                spring.damping_N_s_mm * along.dot(velocity(b, p_b) - velocity(a, p_a));
  if (spring.slack_when_short) pull = std::max(pull, 0.0);
  const Vector3d force = mm_per_m * pull * along;
  for (const auto& [i, p, sign] : {std::tuple{a, p_a, 1.0}, std::tuple{b, p_b, -1.0}}) {
    if (!is_free(i)) continue;
    SolverBody& body = solver_bodies[static_cast<std::size_t>(members[i].solver)];
    body.force += sign * force;
    body.torque += (p - centers[i]).cross(sign * force);
  }
}

void RigidWorld::State::collect_forces() {
  for (std::size_t i = 0; i < count(); ++i) {
    centers[i] = center(i);
    body_motions[i] = {motions[i].velocity, motions[i].spin};
    if (!is_free(i)) continue;
    const Member& m = members[i];
    SolverBody& body = solver_bodies[static_cast<std::size_t>(m.solver)];
    body.R_WP = poses[i].R.toRotationMatrix() * m.principal;
    body.motion = body_motions[i];
    const Vector3d arm = m.body.drag_at ? Vector3d(poses[i] * *m.body.drag_at - centers[i])
                                        : Vector3d(Vector3d::Zero());
    const Vector3d drag =
        -mm_per_m * m.body.drag_N_s_mm * (motions[i].velocity + motions[i].spin.cross(arm));
    body.force = m.body.mass.mass_kg * settings.gravity_mm_s2 + drag;
    body.torque = arm.cross(drag) - mm_per_m * m.body.turning_drag_N_mm_s * motions[i].spin;
  }
  for (const RigidForce& f : forces) {
    const auto i = static_cast<std::size_t>(f.body);
    if (!is_free(i)) continue;
    const bool turns = f.frame == RigidForce::Frame::body;
    const Vector3d force = mm_per_m * (turns ? Vector3d(poses[i].R * f.force_N) : f.force_N);
    const Vector3d torque =
        mm_per_m * (turns ? Vector3d(poses[i].R * f.torque_N_mm) : f.torque_N_mm);
    SolverBody& body = solver_bodies[static_cast<std::size_t>(members[i].solver)];
    body.force += force;
    body.torque += torque + (poses[i] * f.point - centers[i]).cross(force);
  }
  for (const RigidSpring& spring : springs) add_spring_forces(spring);
}

void RigidWorld::State::prepare_joints(RigidWorld::Step& result) {
  joint_rows.clear();
  start_impulses.resize(joint_forces.size());
  for (std::size_t r = 0; r < joint_forces.size(); ++r)
    start_impulses[r] = mm_per_m * part_s * joint_forces[r];
  std::size_t first = 0;
  const auto seen = [&](int body) {
    const auto i = static_cast<std::size_t>(body);
    return JointBody{members[i].solver, poses[i], centers[i], body_motions[i]};
  };
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const auto size = static_cast<std::size_t>(rows_of[j]);
    const double error =
        joints[j].append(seen(joints[j].a()), seen(joints[j].b()), part_s,
                         std::span<const double>(start_impulses).subspan(first, size), joint_rows);
    result.joint_error_mm = std::max(result.joint_error_mm, error);
    first += size;
  }
}

void RigidWorld::State::add_constraint(int index, const Vector3d& impulse,
                                       std::vector<ContactConstraint>& rows) {
  const SurfaceContact& contact = contact_points[static_cast<std::size_t>(index)];
  const RigidPair& pair = pairs[static_cast<std::size_t>(contact.pair)];
  const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
  ContactConstraint row;
  row.a = members[a].solver;
  row.b = members[b].solver;
  row.normal = contact.normal;
  row.arm_a = contact.point - centers[a];
  row.arm_b = contact.point - centers[b];
  if (row.a < 0) row.carried -= motions[a].velocity + motions[a].spin.cross(row.arm_a);
  if (row.b < 0) row.carried += motions[b].velocity + motions[b].spin.cross(row.arm_b);
  row.gap = contact.gap_mm + rest_fraction * settings.slop_mm;
  const double deeper = -contact.gap_mm - settings.slop_mm;
  if (deeper > 0)
    row.part = std::min(corrected_fraction * deeper, settings.depenetration_mm_s * part_s);
  row.friction = pair.friction;
  row.impulse = impulse;
  rows.push_back(row);
  point_of_constraint.push_back(index);
  added[static_cast<std::size_t>(index)] = 1;
  ++constraints_of_pair[static_cast<std::size_t>(contact.pair)];
}

/// Warm start: contacts of the previous step that are still near start with their forces.
void RigidWorld::State::warm_start_contacts() {
  constraints.clear();
  point_of_constraint.clear();
  added.assign(contact_points.size(), 0);
  constraints_of_pair.assign(pairs.size(), 0);
  auto held = memory.begin();
  for (std::size_t t = 0; t < contact_points.size() && held != memory.end(); ++t) {
    const auto key = std::pair(contact_points[t].query, contact_points[t].sample);
    while (held != memory.end() && std::pair(held->query, held->sample) < key) ++held;
    if (held != memory.end() && std::pair(held->query, held->sample) == key)
      add_constraint(static_cast<int>(t), mm_per_m * part_s * held->force_N, constraints);
  }
}

bool RigidWorld::State::add_new(std::span<const SolverMotion> free,
                                std::vector<ContactConstraint>& rows) {
  for (std::size_t i = 0; i < count(); ++i)
    if (is_free(i)) body_motions[i] = free[static_cast<std::size_t>(members[i].solver)];
  violators.clear();
  const double rest = rest_fraction * settings.slop_mm,
               unseen = tolerated_fraction * settings.slop_mm;
  for (std::size_t t = 0; t < contact_points.size(); ++t) {
    if (added[t]) continue;
    const SurfaceContact& contact = contact_points[t];
    const RigidPair& pair = pairs[static_cast<std::size_t>(contact.pair)];
    if (constraints_of_pair[static_cast<std::size_t>(contact.pair)] >= settings.max_contacts)
      continue;
    const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
    const Vector3d v =
        body_motions[b].velocity + body_motions[b].spin.cross(contact.point - centers[b]) -
        body_motions[a].velocity - body_motions[a].spin.cross(contact.point - centers[a]);
    const double displacement = part_s * v.dot(contact.normal), gap = contact.gap_mm + rest;
    const bool overlaps = gap + displacement < -unseen && displacement < -std::max(gap, 0.0);
    if (overlaps || contact.gap_mm < -settings.slop_mm)
      violators.push_back({-(gap + std::min(displacement, 0.0)), static_cast<int>(t), 0});
  }
  if (violators.empty()) return false;
  const auto pair_of = [&](std::size_t v) {
    return contact_points[static_cast<std::size_t>(violators[v].contact)].pair;
  };
  for (std::size_t first = 0, last = 0; first < violators.size(); first = last) {
    while (last < violators.size() && pair_of(last) == pair_of(first)) ++last;
    pick(first, last, rows);
  }
  return true;
}

/// Adds the deepest violator of a pair, then those that are deep and far from the ones added: a few
/// widely spaced contacts support a body better than a cluster of the deepest.
void RigidWorld::State::pick(std::size_t first, std::size_t last,
                             std::vector<ContactConstraint>& rows) {
  const double thinning2 = settings.thinning_mm * settings.thinning_mm;
  for (std::size_t v = first; v < last; ++v) violators[v].apart2 = 1e12;
  const auto pair = static_cast<std::size_t>(
      contact_points[static_cast<std::size_t>(violators[first].contact)].pair);
  for (std::size_t k = 0; k < added_at_once && constraints_of_pair[pair] < settings.max_contacts;
       ++k) {
    std::size_t best = last;
    double limit = 0;
    for (std::size_t v = first; v < last; ++v) {
      if (violators[v].apart2 < thinning2) continue;
      const double weight = violators[v].depth * violators[v].depth * violators[v].apart2;
      if (best == last || weight > limit) {
        best = v;
        limit = weight;
      }
    }
    if (best == last) return;
    const Vector3d point = contact_points[static_cast<std::size_t>(violators[best].contact)].point;
    add_constraint(violators[best].contact, Vector3d::Zero(), rows);
    for (std::size_t v = first; v < last; ++v)
      violators[v].apart2 =
          std::min(violators[v].apart2,
                   (contact_points[static_cast<std::size_t>(violators[v].contact)].point - point)
                       .squaredNorm());
  }
}

/// Conserves the angular momentum of the solution: the angular velocity of an asymmetric body
/// changes accordingly.
void RigidWorld::State::integrate() {
  for (std::size_t i = 0; i < count(); ++i) {
    const Member& m = members[i];
    Pose& X = poses[i];
    RigidMotion& motion = motions[i];
    Vector3d c = centers[i];
    if (m.solver < 0) {
      if (motion.velocity.isZero(0) && motion.spin.isZero(0)) continue;
      X.R = (turned(part_s * motion.spin) * X.R).normalized();
      c += part_s * motion.velocity;
    } else {
      const auto s = static_cast<std::size_t>(m.solver);
      const Matrix3d R = X.R.toRotationMatrix();
      const Vector3d L = R * (m.body.mass.inertia * (R.transpose() * solved[s].spin));
      const auto spin_at = [&](const Quaterniond& q) {
        return Vector3d(q * (m.inverse_inertia * (q.conjugate() * L)));
      };
      const Vector3d halfway = spin_at(turned(0.5 * part_s * solved[s].spin) * X.R);
      X.R = (turned(shifts[s].spin) * (turned(part_s * halfway) * X.R)).normalized();
      motion.spin = spin_at(X.R);
      motion.velocity = solved[s].velocity;
      c += part_s * motion.velocity + shifts[s].velocity;
    }
    X.t = c - X.R * m.body.mass.center;
  }
  time_s += part_s;
}

/// Stores the forces for the next step and reports the contact forces.
void RigidWorld::State::remember() {
  const double to_N = 1 / (mm_per_m * part_s);
  for (std::size_t r = 0; r < joint_rows.size(); ++r)
    joint_forces[r] = to_N * joint_rows[r].impulse;
  memory.clear();
  contacts.clear();
  for (std::size_t k = 0; k < constraints.size(); ++k) {
    const SurfaceContact& contact =
        contact_points[static_cast<std::size_t>(point_of_constraint[k])];
    const double push = constraints[k].impulse.dot(contact.normal);
    const Vector3d force = to_N * constraints[k].impulse;
    // Contacts without force that would be added again at the slightest motion are kept as well.
    const double gap = contact.gap_mm + rest_fraction * settings.slop_mm;
    if (push > 0 || gap < -tolerated_fraction * settings.slop_mm)
      memory.push_back({contact.query, contact.sample, force});
    if (!(push > 0)) continue;
    contacts.push_back({contact.pair, contact.point, contact.normal, contact.gap_mm, to_N * push,
                        force - to_N * push * contact.normal});
  }
  std::sort(memory.begin(), memory.end(), [](const auto& x, const auto& y) {
    return std::pair(x.query, x.sample) < std::pair(y.query, y.sample);
  });
}

bool RigidWorld::State::advance(double step_s, int halvings, int threads,
                                RigidWorld::Step& result) {
  part_s = step_s;
  collect_forces();
  prepare_joints(result);
  finder.locate(poses);
  const double limit = finder.max_active_mm();
  double active =
      std::min(limit, min_active_mm +
                          1.5 * finder.max_displacement(poses, centers, body_motions, step_s, 0));
  SolverSettings how;
  how.step_s = step_s;
  how.max_sweeps = settings.max_sweeps;
  how.tolerance = settings.tolerance_mm_s;
  how.max_impulse = mm_per_m * step_s * force_limit_N;
  for (;;) {
    finder.find(poses, active, threads, contact_points);
    for (const SurfaceContact& contact : contact_points)
      result.depth_mm = std::max(result.depth_mm, -contact.gap_mm);
    warm_start_contacts();
    if (solved.size() != solver_bodies.size()) solved.resize(solver_bodies.size());
    result.sweeps +=
        solver.solve(how, solver_bodies, joint_rows, rows_of, constraints, *this, solved, shifts);
    for (std::size_t i = 0; i < count(); ++i) {
      if (!is_free(i)) continue;
      const SolverMotion& x = solved[static_cast<std::size_t>(members[i].solver)];
      body_motions[i] = x;
      const double speed = x.velocity.norm() + x.spin.norm() * members[i].radius_mm;
      if (!(speed <= settings.max_speed_mm_s)) return false;
    }
    // Larger displacements than the active distance could have passed through a contact.
    const double displacement =
        finder.max_displacement(poses, centers, body_motions, step_s, active);
    if (displacement <= active) break;
    if (displacement > limit) {
      if (halvings == max_halvings) return false;
      return advance(0.5 * step_s, halvings + 1, threads, result) &&
             advance(0.5 * step_s, halvings + 1, threads, result);
    }
    active = std::min(limit, 1.5 * displacement);
    joint_rows.clear();
    prepare_joints(result);
  }
  finder.narrow(active);
  integrate();
  remember();
  ++result.parts;
  return true;
}

}  // namespace condyle
