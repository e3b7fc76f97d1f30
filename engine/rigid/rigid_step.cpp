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

constexpr int most_halvings = 7;  // of a step
constexpr double least_active_mm = 0.01;
// Depth, as a share of the slop: where bodies come to rest, and how much deeper a contact that is
// not yet among those that push may go before it joins.
constexpr double rest_share = 0.5, unseen_share = 0.25;
constexpr double parted_share = 0.2;     // of what is too deep, in a step
constexpr std::size_t join_at_once = 8;  // of a pair

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

void RigidWorld::State::add_push(int index, const Vector3d& impulse, std::vector<PushRow>& rows) {
  const Touch& touch = touches[static_cast<std::size_t>(index)];
  const RigidPair& pair = pairs[static_cast<std::size_t>(touch.pair)];
  const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
  PushRow row;
  row.a = members[a].solver;
  row.b = members[b].solver;
  row.normal = touch.normal;
  row.arm_a = touch.point - centers[a];
  row.arm_b = touch.point - centers[b];
  if (row.a < 0) row.carried -= motions[a].velocity + motions[a].spin.cross(row.arm_a);
  if (row.b < 0) row.carried += motions[b].velocity + motions[b].spin.cross(row.arm_b);
  row.gap = touch.gap_mm + rest_share * settings.slop_mm;
  const double deeper = -touch.gap_mm - settings.slop_mm;
  if (deeper > 0) row.part = std::min(parted_share * deeper, settings.push_out_mm_s * part_s);
  row.friction = pair.friction;
  row.impulse = impulse;
  rows.push_back(row);
  touch_of_push.push_back(index);
  joined[static_cast<std::size_t>(index)] = 1;
  ++pushes_of_pair[static_cast<std::size_t>(touch.pair)];
}

/// What pushed in the step before pushes again, where it is still near.
void RigidWorld::State::start_pushes() {
  pushes.clear();
  touch_of_push.clear();
  joined.assign(touches.size(), 0);
  pushes_of_pair.assign(pairs.size(), 0);
  auto held = memory.begin();
  for (std::size_t t = 0; t < touches.size() && held != memory.end(); ++t) {
    const auto key = std::pair(touches[t].look, touches[t].sample);
    while (held != memory.end() && std::pair(held->look, held->sample) < key) ++held;
    if (held != memory.end() && std::pair(held->look, held->sample) == key)
      add_push(static_cast<int>(t), mm_per_m * part_s * held->force_N, pushes);
  }
}

bool RigidWorld::State::join(std::span<const SolverMotion> free, std::vector<PushRow>& rows) {
  for (std::size_t i = 0; i < count(); ++i)
    if (is_free(i)) body_motions[i] = free[static_cast<std::size_t>(members[i].solver)];
  violators.clear();
  const double rest = rest_share * settings.slop_mm, unseen = unseen_share * settings.slop_mm;
  for (std::size_t t = 0; t < touches.size(); ++t) {
    if (joined[t]) continue;
    const Touch& touch = touches[t];
    const RigidPair& pair = pairs[static_cast<std::size_t>(touch.pair)];
    if (pushes_of_pair[static_cast<std::size_t>(touch.pair)] >= settings.max_contacts) continue;
    const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
    const Vector3d v =
        body_motions[b].velocity + body_motions[b].spin.cross(touch.point - centers[b]) -
        body_motions[a].velocity - body_motions[a].spin.cross(touch.point - centers[a]);
    const double way = part_s * v.dot(touch.normal), gap = touch.gap_mm + rest;
    const bool overlaps = gap + way < -unseen && way < -std::max(gap, 0.0);
    if (overlaps || touch.gap_mm < -settings.slop_mm)
      violators.push_back({-(gap + std::min(way, 0.0)), static_cast<int>(t), 0});
  }
  if (violators.empty()) return false;
  const auto pair_of = [&](std::size_t v) {
    return touches[static_cast<std::size_t>(violators[v].touch)].pair;
  };
  for (std::size_t first = 0, last = 0; first < violators.size(); first = last) {
    while (last < violators.size() && pair_of(last) == pair_of(first)) ++last;
    pick(first, last, rows);
  }
  return true;
}

/// Of one pair's violators the deepest joins, then those that are deep and far from the others that
/// join: a few that stand wide apart hold a body better than the deepest in a heap.
void RigidWorld::State::pick(std::size_t first, std::size_t last, std::vector<PushRow>& rows) {
  const double thinning2 = settings.thinning_mm * settings.thinning_mm;
  for (std::size_t v = first; v < last; ++v) violators[v].apart2 = 1e12;
  const auto pair =
      static_cast<std::size_t>(touches[static_cast<std::size_t>(violators[first].touch)].pair);
  for (std::size_t k = 0; k < join_at_once && pushes_of_pair[pair] < settings.max_contacts; ++k) {
    std::size_t best = last;
    double most = 0;
    for (std::size_t v = first; v < last; ++v) {
      if (violators[v].apart2 < thinning2) continue;
      const double weight = violators[v].depth * violators[v].depth * violators[v].apart2;
      if (best == last || weight > most) {
        best = v;
        most = weight;
      }
    }
    if (best == last) return;
    const Vector3d point = touches[static_cast<std::size_t>(violators[best].touch)].point;
    add_push(violators[best].touch, Vector3d::Zero(), rows);
    for (std::size_t v = first; v < last; ++v)
      violators[v].apart2 = std::min(
          violators[v].apart2,
          (touches[static_cast<std::size_t>(violators[v].touch)].point - point).squaredNorm());
  }
}

/// Angular momentum stays what the solver left: with it the spin of an asymmetric body turns.
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

/// Keeps the forces for the next step, and tells who pushed.
void RigidWorld::State::remember() {
  const double to_N = 1 / (mm_per_m * part_s);
  for (std::size_t r = 0; r < joint_rows.size(); ++r)
    joint_forces[r] = to_N * joint_rows[r].impulse;
  memory.clear();
  contacts.clear();
  for (std::size_t k = 0; k < pushes.size(); ++k) {
    const Touch& touch = touches[static_cast<std::size_t>(touch_of_push[k])];
    const double push = pushes[k].impulse.dot(touch.normal);
    const Vector3d force = to_N * pushes[k].impulse;
    // Those that do not push, but would join again at the least motion, stay too.
    const double gap = touch.gap_mm + rest_share * settings.slop_mm;
    if (push > 0 || gap < -unseen_share * settings.slop_mm)
      memory.push_back({touch.look, touch.sample, force});
    if (!(push > 0)) continue;
    contacts.push_back({touch.pair, touch.point, touch.normal, touch.gap_mm, to_N * push,
                        force - to_N * push * touch.normal});
  }
  std::sort(memory.begin(), memory.end(), [](const auto& x, const auto& y) {
    return std::pair(x.look, x.sample) < std::pair(y.look, y.sample);
  });
}

bool RigidWorld::State::advance(double step_s, int halvings, int threads,
                                RigidWorld::Step& result) {
  part_s = step_s;
  collect_forces();
  prepare_joints(result);
  finder.locate(poses);
  const double most = finder.most_active_mm();
  double active =
      std::min(most, least_active_mm + 1.5 * finder.way(poses, centers, body_motions, step_s, 0));
  SolverSettings how;
  how.step_s = step_s;
  how.max_sweeps = settings.max_sweeps;
  how.tolerance = settings.tolerance_mm_s;
  how.max_impulse = mm_per_m * step_s * most_force_N;
  for (;;) {
    finder.find(poses, active, threads, touches);
    for (const Touch& touch : touches) result.depth_mm = std::max(result.depth_mm, -touch.gap_mm);
    start_pushes();
    if (solved.size() != solver_bodies.size()) solved.resize(solver_bodies.size());
    result.sweeps +=
        solver.solve(how, solver_bodies, joint_rows, rows_of, pushes, *this, solved, shifts);
    for (std::size_t i = 0; i < count(); ++i) {
      if (!is_free(i)) continue;
      const SolverMotion& x = solved[static_cast<std::size_t>(members[i].solver)];
      body_motions[i] = x;
      const double speed = x.velocity.norm() + x.spin.norm() * members[i].radius_mm;
      if (!(speed <= settings.max_speed_mm_s)) return false;
    }
    // What came nearer than was looked for might have been passed through.
    const double way = finder.way(poses, centers, body_motions, step_s, active);
    if (way <= active) break;
    if (way > most) {
      if (halvings == most_halvings) return false;
      return advance(0.5 * step_s, halvings + 1, threads, result) &&
             advance(0.5 * step_s, halvings + 1, threads, result);
    }
    active = std::min(most, 1.5 * way);
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
