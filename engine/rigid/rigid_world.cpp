#include "engine/rigid/rigid_world.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "engine/rigid/rigid_world_state.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

std::string text(double value) { return std::to_string(value); }

}  // namespace

RigidState RigidWorld::State::save() const {
  RigidState out;
  out.time_s = time_s;
  for (std::size_t i = 0; i < count(); ++i) out.bodies.push_back({poses[i], motions[i]});
  out.contact_forces = memory;
  out.joint_forces_N = joint_forces;
  out.sample_caches = finder.sample_caches();
  return out;
}

void RigidWorld::State::load(const RigidState& in) {
  for (std::size_t i = 0; i < count(); ++i) {
    poses[i] = in.bodies[i].X_WB;
    motions[i] = in.bodies[i].motion;
  }
  time_s = in.time_s;
  memory = in.contact_forces;
  joint_forces = in.joint_forces_N;
  finder.set_sample_caches(in.sample_caches);
}

RigidWorld::RigidWorld(const RigidSettings& settings) : state_(std::make_unique<State>()) {
  require(settings.step_s >= 1e-5 && settings.step_s <= 0.02,
          "a step of " + text(settings.step_s) + " s is not between 0.00001 and 0.02");
  require(settings.gravity_mm_s2.allFinite() && settings.gravity_mm_s2.norm() <= 1e6,
          "gravity is not finite or beyond 1e6 mm/s^2");
  require(settings.slop_mm >= 1e-4 && settings.slop_mm <= 1,
          "a slop of " + text(settings.slop_mm) + " mm is not between 0.0001 and 1");
  require(settings.max_contacts > 0 && settings.max_sweeps > 0 && settings.thinning_mm >= 0 &&
              settings.depenetration_mm_s >= 0 && settings.tolerance_mm_s >= 0 &&
              settings.max_speed_mm_s > 0,
          "a setting of the solver is below its range");
  state_->settings = settings;
}

RigidWorld::~RigidWorld() = default;
RigidWorld::RigidWorld(RigidWorld&&) noexcept = default;

int RigidWorld::add_body(const DynamicBody& body) {
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
    m.max_inverse_moment = 1 / axes.eigenvalues()[0];
    const double arm = body.drag_at ? (*body.drag_at - mass.center).norm() : 0;
    const double drag = mm_per_m * body.drag_N_s_mm * s.settings.step_s *
                        (1 / mass.mass_kg + arm * arm * m.max_inverse_moment),
                 turning =
                     mm_per_m * body.turning_drag_N_mm_s * m.max_inverse_moment * s.settings.step_s;
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
              force.torque_N_mm.norm() <= force_limit_N * 1000,
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
  const double mobility =
      mm_per_m * (s.mobility(spring.a, spring.p_A) + s.mobility(spring.b, spring.p_B));
  const double step = s.settings.step_s;
  const double damping = spring.damping_N_s_mm * mobility * step,
               stiffness = spring.stiffness_N_mm * mobility * step * step;
  require(damping >= 0 && damping < 2, "a damper's c dt/m is " + text(damping) +
                                           ": at 2 or more it would swing up instead of "
                                           "slowing down; less damping than " +
                                           text(2 / (mobility * step)) + " N s/mm is needed here");
  require(stiffness >= 0 && stiffness < 2, "a spring's k dt^2/m is " + text(stiffness) +
                                               ": from 2 on steps are too long for it; "
                                               "less than " +
                                               text(2 / (mobility * step * step)) +
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
  require(std::isfinite(pair.gap_mm), "a gap is not finite");
  const auto& a = s.members[static_cast<std::size_t>(pair.a)].body.surfaces;
  const auto& b = s.members[static_cast<std::size_t>(pair.b)].body.surfaces;
  require(!a.empty() && !b.empty(), "a pair of bodies of which one has no surface");
  s.finder.add_pair(pair.a, pair.b, a, b, pair.gap_mm);
  s.pairs.push_back(pair);
  return static_cast<int>(s.pairs.size()) - 1;
}

void RigidWorld::allow_overlap(int pair, double around_mm) {
  require(pair >= 0 && pair < static_cast<int>(state_->pairs.size()),
          "there is no pair " + std::to_string(pair));
  state_->finder.allow_overlap(pair, state_->poses, around_mm);
}

void RigidWorld::set_force(int force, const Vector3d& force_N) {
  require(force >= 0 && force < static_cast<int>(state_->forces.size()),
          [&] { return "there is no force " + std::to_string(force); });
  require(force_N.norm() <= force_limit_N, [&] {
    return "a force of " + text(force_N.norm()) + " N is not finite or above " +
           text(force_limit_N);
  });
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
              in.sample_caches.size() == s.finder.sample_caches().size(),
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
