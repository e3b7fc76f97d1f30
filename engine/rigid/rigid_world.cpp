#include "engine/rigid/rigid_world.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "engine/core/error.h"
#include "engine/rigid/joint_rows.h"
#include "engine/rigid/row_solver.h"
#include "engine/rigid/touch_finder.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double mm_per_m = 1000;  // 1 N = 1000 kg mm/s^2
constexpr double most_force_N = 1e5;
constexpr int most_halvings = 7;  // of a step
constexpr double least_active_mm = 0.05;
// Depth, as a share of the slop: where bodies come to rest, and how much deeper a contact that is
// not yet among those that push may go before it joins.
constexpr double rest_share = 0.5, unseen_share = 0.25;
constexpr double parted_share = 0.2;     // of what is too deep, in a step
constexpr std::size_t join_at_once = 8;  // of a pair

std::string text(double value) { return std::to_string(value); }

void require(bool good, const std::string& problem) {
  if (!good) throw InputError("dynamics: " + problem);
}

Quaterniond turned(const Vector3d& turn) {
  const double angle = turn.norm();
  return angle > 0 ? Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) : Quaterniond::Identity();
}

}  // namespace

struct RigidWorld::State : MoreContacts {
  /// A body with what follows from its mass.
  struct Member {
    RigidBody body;  // pose and motion at the start; `now` has the present ones
    int solver = -1;
    Matrix3d inverse_inertia = Matrix3d::Zero();  // body coordinates
    Matrix3d principal = Matrix3d::Identity();    // axes, body coordinates
    double give_per_mm2 = 0;                      // largest 1 / principal moment
    double radius_mm = 0;                         // of the surfaces about the centre of mass
  };

  RigidSettings settings;
  std::vector<Member> members;
  std::vector<RigidForce> forces;
  std::vector<RigidSpring> springs;
  std::vector<JointRows> joints;
  std::vector<int> rows_of;
  std::vector<RigidPair> pairs;
  TouchFinder finder;
  RowSolver solver;

  double time_s = 0;
  std::vector<RigidMotion> motions;
  std::vector<Pose> poses;
  std::vector<RigidState::Touch> memory;
  std::vector<double> joint_forces;
  std::vector<RigidContact> contacts;

  // Of the step that runs.
  double part_s = 0;
  std::vector<Vector3d> centers;
  std::vector<SolverMotion> body_motions;  // of all bodies
  std::vector<SolverBody> solver_bodies;
  std::vector<SolverMotion> solved, shifts;
  std::vector<JointRow> joint_rows;
  std::vector<double> start_impulses;
  std::vector<PushRow> pushes;
  std::vector<int> touch_of_push;
  std::vector<Touch> touches;
  std::vector<char> joined;
  std::vector<int> pushes_of_pair;
  struct Violator {
    double depth = 0;
    int touch = 0;
    double apart2 = 0;  // to those that join with it
  };
  std::vector<Violator> violators;
  RigidState before;
  std::vector<RigidContact> contacts_before;

  std::size_t count() const { return members.size(); }
  Vector3d center(std::size_t i) const { return poses[i] * members[i].body.mass.center; }
  bool is_free(std::size_t i) const { return members[i].solver >= 0; }

  void check_body(int body) const {
    require(body >= 0 && body < static_cast<int>(count()),
            "there is no body " + std::to_string(body));
  }
  static void check_pose(const Pose& X_WB) {
    require(X_WB.t.allFinite() && std::abs(X_WB.R.norm() - 1) < 1e-6,
            "a pose is not finite or its rotation not of unit length");
  }
  void check_motion(const RigidMotion& motion, double radius_mm) const {
    const double speed = motion.velocity.norm() + motion.spin.norm() * radius_mm;
    require(speed <= settings.max_speed_mm_s, "a motion of " + text(speed) +
                                                  " mm/s is not finite or above " +
                                                  text(settings.max_speed_mm_s));
  }
  static void check_force(const Vector3d& force_N) {
    require(force_N.norm() <= most_force_N, "a force of " + text(force_N.norm()) +
                                                " N is not finite or above " + text(most_force_N));
  }
  /// Velocity that a unit impulse at a point gives it, at most.
  double give(int body, const Vector3d& p_B) const {
    const Member& m = members[static_cast<std::size_t>(body)];
    if (m.solver < 0) return 0;
    return 1 / m.body.mass.mass_kg + (p_B - m.body.mass.center).squaredNorm() * m.give_per_mm2;
  }

  void collect_forces();
  void add_spring_forces(const RigidSpring& spring);
  void prepare_joints(RigidWorld::Step& result);
  void start_pushes();
  void add_push(int touch, const Vector3d& impulse, std::vector<PushRow>& rows);
  bool join(std::span<const SolverMotion> free, std::vector<PushRow>& rows) override;
  void pick(std::size_t first, std::size_t last, std::vector<PushRow>& rows);
  bool advance(double step_s, int halvings, int threads, RigidWorld::Step& result);
  void integrate();
  void remember();
  RigidState save() const;
  void load(const RigidState& state);
};

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
    body.force = m.body.mass.mass_kg * settings.gravity_mm_s2 -
                 mm_per_m * m.body.drag_N_s_mm * motions[i].velocity;
    body.torque = -mm_per_m * m.body.turning_drag_N_mm_s * motions[i].spin;
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
  integrate();
  remember();
  ++result.parts;
  return true;
}

RigidState RigidWorld::State::save() const {
  RigidState out;
  out.time_s = time_s;
  for (std::size_t i = 0; i < count(); ++i) out.bodies.push_back({poses[i], motions[i]});
  out.touches = memory;
  out.joint_forces_N = joint_forces;
  out.looked_at = finder.looked_at();
  return out;
}

void RigidWorld::State::load(const RigidState& in) {
  for (std::size_t i = 0; i < count(); ++i) {
    poses[i] = in.bodies[i].X_WB;
    motions[i] = in.bodies[i].motion;
  }
  time_s = in.time_s;
  memory = in.touches;
  joint_forces = in.joint_forces_N;
  finder.set_looked_at(in.looked_at);
}

RigidWorld::RigidWorld(const RigidSettings& settings) : state_(std::make_unique<State>()) {
  require(settings.step_s >= 1e-5 && settings.step_s <= 0.02,
          "a step of " + text(settings.step_s) + " s is not between 0.00001 and 0.02");
  require(settings.gravity_mm_s2.allFinite() && settings.gravity_mm_s2.norm() <= 1e6,
          "gravity is not finite or beyond 1e6 mm/s^2");
  require(settings.slop_mm >= 1e-4 && settings.slop_mm <= 1,
          "a slop of " + text(settings.slop_mm) + " mm is not between 0.0001 and 1");
  require(settings.max_contacts > 0 && settings.max_sweeps > 0 && settings.thinning_mm >= 0 &&
              settings.push_out_mm_s >= 0 && settings.tolerance_mm_s >= 0 &&
              settings.max_speed_mm_s > 0,
          "a setting of the solver is below its range");
  state_->settings = settings;
}

RigidWorld::~RigidWorld() = default;
RigidWorld::RigidWorld(RigidWorld&&) noexcept = default;

int RigidWorld::add_body(const RigidBody& body) {
  State& s = *state_;
  const MassProperties& mass = body.mass;
  require(std::isfinite(mass.mass_kg) && mass.mass_kg >= 0 && mass.center.allFinite() &&
              mass.inertia.allFinite(),
          "a mass of " + text(mass.mass_kg) + " kg, its centre or inertia is not usable");
  State::Member m;
  m.body = body;
  for (const auto& surface : body.surfaces)
    for (const Vector3d& p : surface->samples.points)
      m.radius_mm = std::max(m.radius_mm, (p - mass.center).norm());
  s.check_pose(body.X_WB);
  s.check_motion(body.motion, m.radius_mm);
  if (mass.mass_kg > 0) {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(mass.inertia);
    require(mass.inertia.isApprox(mass.inertia.transpose(), 1e-9) && axes.eigenvalues()[0] > 0,
            "the inertia of a body is not symmetric and positive");
    m.principal = axes.eigenvectors();
    if (m.principal.determinant() < 0) m.principal.col(2) *= -1;
    m.inverse_inertia = mass.inertia.inverse();
    m.give_per_mm2 = 1 / axes.eigenvalues()[0];
    const double drag = mm_per_m * body.drag_N_s_mm / mass.mass_kg * s.settings.step_s,
                 turning = mm_per_m * body.turning_drag_N_mm_s * m.give_per_mm2 * s.settings.step_s;
    require(drag >= 0 && drag < 2 && turning >= 0 && turning < 2,
            "a drag times the step over the mass is " + text(std::max(drag, turning)) +
                ": at 2 or more it would swing up instead of slowing down");
    m.solver = static_cast<int>(s.solver_bodies.size());
    s.solver.add_body(mass.mass_kg, axes.eigenvalues());
    s.solver_bodies.emplace_back();
  }
  s.members.push_back(m);
  s.poses.push_back({body.X_WB.R.normalized(), body.X_WB.t});
  s.motions.push_back(body.motion);
  s.centers.emplace_back();
  s.body_motions.emplace_back();
  return static_cast<int>(s.count()) - 1;
}

int RigidWorld::add_force(const RigidForce& force) {
  State& s = *state_;
  s.check_body(force.body);
  require(force.point.allFinite() && force.torque_N_mm.allFinite() &&
              force.torque_N_mm.norm() <= most_force_N * 1000,
          "a force's point or torque is not finite or too large");
  s.check_force(force.force_N);
  s.forces.push_back(force);
  return static_cast<int>(s.forces.size()) - 1;
}

int RigidWorld::add_spring(const RigidSpring& spring) {
  State& s = *state_;
  s.check_body(spring.a);
  s.check_body(spring.b);
  require(spring.p_A.allFinite() && spring.p_B.allFinite() && spring.rest_length_mm >= 0 &&
              std::isfinite(spring.rest_length_mm),
          "a spring's points or length are not usable");
  const double give = mm_per_m * (s.give(spring.a, spring.p_A) + s.give(spring.b, spring.p_B));
  const double step = s.settings.step_s;
  const double damping = spring.damping_N_s_mm * give * step,
               stiffness = spring.stiffness_N_mm * give * step * step;
  require(damping >= 0 && damping < 2, "a damper's c dt/m is " + text(damping) +
                                           ": at 2 or more it would swing up instead of "
                                           "slowing down; less damping than " +
                                           text(2 / (give * step)) + " N s/mm is needed here");
  require(stiffness >= 0 && stiffness < 2, "a spring's k dt^2/m is " + text(stiffness) +
                                               ": from 2 on steps are too long for it; "
                                               "less than " +
                                               text(2 / (give * step * step)) +
                                               " N/mm is needed here");
  s.springs.push_back(spring);
  return static_cast<int>(s.springs.size()) - 1;
}

int RigidWorld::add_joint(const RigidJoint& joint) {
  State& s = *state_;
  s.check_body(joint.a);
  s.check_body(joint.b);
  require(joint.a != joint.b, "a joint needs two bodies");
  require(
      s.is_free(static_cast<std::size_t>(joint.a)) || s.is_free(static_cast<std::size_t>(joint.b)),
      "a joint between two bodies that are not free");
  s.joints.emplace_back(joint);
  s.rows_of.push_back(s.joints.back().count());
  s.joint_forces.resize(s.joint_forces.size() + static_cast<std::size_t>(s.rows_of.back()), 0.0);
  return static_cast<int>(s.joints.size()) - 1;
}

int RigidWorld::add_pair(const RigidPair& pair) {
  State& s = *state_;
  s.check_body(pair.a);
  s.check_body(pair.b);
  require(pair.a != pair.b, "a pair needs two bodies");
  require(pair.friction >= 0 && pair.friction <= 10,
          "a friction of " + text(pair.friction) + " is not between 0 and 10");
  require(pair.gap_mm >= 0, "a gap of " + text(pair.gap_mm) + " mm is below 0");
  const auto& a = s.members[static_cast<std::size_t>(pair.a)].body.surfaces;
  const auto& b = s.members[static_cast<std::size_t>(pair.b)].body.surfaces;
  require(!a.empty() && !b.empty(), "a pair of bodies of which one has no surface");
  s.finder.add_pair(pair.a, pair.b, a, b, pair.gap_mm);
  s.pairs.push_back(pair);
  return static_cast<int>(s.pairs.size()) - 1;
}

void RigidWorld::allow_overlap(int pair) {
  require(pair >= 0 && pair < static_cast<int>(state_->pairs.size()),
          "there is no pair " + std::to_string(pair));
  state_->finder.allow_overlap(pair, state_->poses);
}

void RigidWorld::set_force(int force, const Vector3d& force_N) {
  require(force >= 0 && force < static_cast<int>(state_->forces.size()),
          "there is no force " + std::to_string(force));
  require(force_N.norm() <= most_force_N,
          "a force of " + text(force_N.norm()) + " N is not finite or above " + text(most_force_N));
  state_->forces[static_cast<std::size_t>(force)].force_N = force_N;
}

void RigidWorld::set_pose(int body, const Pose& X_WB) {
  state_->check_body(body);
  state_->check_pose(X_WB);
  state_->poses[static_cast<std::size_t>(body)] = {X_WB.R.normalized(), X_WB.t};
}

void RigidWorld::set_motion(int body, const RigidMotion& motion) {
  State& s = *state_;
  s.check_body(body);
  const auto i = static_cast<std::size_t>(body);
  s.check_motion(motion, s.members[i].radius_mm);
  s.motions[i] = motion;
}

RigidWorld::Step RigidWorld::step(int threads) {
  State& s = *state_;
  Step result;
  result.parts = 0;
  s.before = s.save();
  s.contacts_before = s.contacts;
  result.taken = s.advance(s.settings.step_s, 0, threads, result);
  if (!result.taken) {
    s.load(s.before);
    s.contacts = s.contacts_before;
  }
  return result;
}

const RigidSettings& RigidWorld::settings() const { return state_->settings; }
int RigidWorld::body_count() const { return static_cast<int>(state_->count()); }
const Pose& RigidWorld::pose(int body) const {
  state_->check_body(body);
  return state_->poses[static_cast<std::size_t>(body)];
}
const RigidMotion& RigidWorld::motion(int body) const {
  state_->check_body(body);
  return state_->motions[static_cast<std::size_t>(body)];
}
const MassProperties& RigidWorld::mass(int body) const {
  state_->check_body(body);
  return state_->members[static_cast<std::size_t>(body)].body.mass;
}

RigidState RigidWorld::state() const { return state_->save(); }

void RigidWorld::set_state(const RigidState& in) {
  const State& s = *state_;
  require(in.bodies.size() == s.count() && in.joint_forces_N.size() == s.joint_forces.size() &&
              in.looked_at.size() == s.finder.looked_at().size(),
          "the state is of another world");
  state_->load(in);
}

const std::vector<RigidContact>& RigidWorld::contacts() const { return state_->contacts; }

double RigidWorld::kinetic_energy() const {
  const State& s = *state_;
  double sum = 0;
  for (std::size_t i = 0; i < s.count(); ++i) {
    if (!s.is_free(i)) continue;
    const MassProperties& m = s.members[i].body.mass;
    const Vector3d spin = s.poses[i].R.conjugate() * s.motions[i].spin;
    sum += 0.5 * (m.mass_kg * s.motions[i].velocity.squaredNorm() + spin.dot(m.inertia * spin));
  }
  return sum / mm_per_m;
}

double RigidWorld::potential_energy() const {
  const State& s = *state_;
  double sum = 0;
  for (std::size_t i = 0; i < s.count(); ++i)
    if (s.is_free(i))
      sum -= s.members[i].body.mass.mass_kg * s.settings.gravity_mm_s2.dot(s.center(i)) / mm_per_m;
  for (const RigidSpring& k : s.springs) {
    const double stretch = (s.poses[static_cast<std::size_t>(k.b)] * k.p_B -
                            s.poses[static_cast<std::size_t>(k.a)] * k.p_A)
                               .norm() -
                           k.rest_length_mm;
    if (stretch > 0 || !k.slack_when_short) sum += 0.5 * k.stiffness_N_mm * stretch * stretch;
  }
  return sum;
}

Vector3d RigidWorld::momentum() const {
  const State& s = *state_;
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < s.count(); ++i)
    if (s.is_free(i)) sum += s.members[i].body.mass.mass_kg * s.motions[i].velocity;
  return sum;
}

Vector3d RigidWorld::angular_momentum() const {
  const State& s = *state_;
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < s.count(); ++i) {
    if (!s.is_free(i)) continue;
    const MassProperties& m = s.members[i].body.mass;
    const Vector3d spin = s.poses[i].R.conjugate() * s.motions[i].spin;
    sum += m.mass_kg * s.center(i).cross(s.motions[i].velocity) + s.poses[i].R * (m.inertia * spin);
  }
  return sum;
}

}  // namespace condyle
