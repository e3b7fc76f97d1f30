#include "engine/rigid/constraint_solver.h"

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace condyle {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int sweeps_between_additions = 6;
constexpr int shift_sweeps = 8;
constexpr double shift_softness = 0.02;  // compliance that distributes contradictory displacements
constexpr double no_shift_mm = 1e-9;

btVector3 to_bullet(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Vector3d from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Map<Vector3d> view(btVector3& v) { return Eigen::Map<Vector3d>(v.m_floats); }

/// The rows of one joint as a constraint of Bullet.
class RowsConstraint : public btTypedConstraint {
 public:
  RowsConstraint(btRigidBody& a, btRigidBody& b)
      : btTypedConstraint(btTypedConstraintType(MAX_CONSTRAINT_TYPE), a, b) {}
  std::span<const JointRow> rows;

  void getInfo1(btConstraintInfo1* info) override {
    info->m_numConstraintRows = static_cast<int>(rows.size());
    info->nub = 0;
  }
  void getInfo2(btConstraintInfo2* info) override {
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const JointRow& row = rows[r];
      const std::size_t at = r * static_cast<std::size_t>(info->rowskip);
      for (int k = 0; k < 3; ++k) {
        info->m_J1linearAxis[at + k] = -row.along[k];
        info->m_J1angularAxis[at + k] = -row.turn_a[k];
        info->m_J2linearAxis[at + k] = row.along[k];
        info->m_J2angularAxis[at + k] = row.turn_b[k];
      }
      info->m_constraintError[at] = row.target_velocity;
      info->m_lowerLimit[at] = row.low;
      info->m_upperLimit[at] = row.high;
    }
  }
  void setParam(int, btScalar, int) override {}
  btScalar getParam(int, int) const override { return 0; }
};

/// A contact constraint with precomputed data.
struct Contact {
  int a, b;
  double friction;
  Vector3d axis[3];               // normal and two tangents
  Vector3d turn_a[3], turn_b[3];  // arm x axis
  Vector3d spin_a[3], spin_b[3];  // angular velocities due to unit impulses
  double before[3];               // velocity along the axes before any impulse of this step
  double min_velocity;            // least velocity along the normal
  double mobility;                // 1 / effective mass along the normal
  double tangential_mass;         // smallest effective mass along the tangents
  double impulse[3];
};

}  // namespace

struct ConstraintSolver::State : btSequentialImpulseConstraintSolver {
  std::vector<std::unique_ptr<btRigidBody>> bodies;
  std::vector<btCollisionObject*> objects;
  std::unique_ptr<btRigidBody> ground;
  std::vector<std::unique_ptr<RowsConstraint>> joints;
  std::vector<btTypedConstraint*> joint_constraints;

  // Data of the current solve.
  const SolverSettings* settings = nullptr;
  std::vector<JointRow>* joint_rows = nullptr;
  std::vector<ContactConstraint>* constraints = nullptr;
  ContactGenerator* more = nullptr;
  std::vector<Contact> contacts;
  std::vector<double> inverse_mass;
  std::vector<Matrix3d> inverse_inertia;
  std::vector<SolverMotion> now;
  int sweeps = 0, since_addition = 0;

  State()
      : ground(std::make_unique<btRigidBody>(
            btRigidBody::btRigidBodyConstructionInfo(0, nullptr, nullptr))) {}

  btRigidBody& bullet_body(int i) { return i < 0 ? *ground : *bodies[static_cast<std::size_t>(i)]; }

  /// Velocities of the free bodies with all impulses so far.
  void read_motions() {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      btSolverBody& body = m_tmpSolverBodyPool[static_cast<int>(i)];
      now[i].velocity = from_bullet(body.m_linearVelocity + body.m_externalForceImpulse +
                                    body.internalGetDeltaLinearVelocity());
      now[i].spin = from_bullet(body.m_angularVelocity + body.m_externalTorqueImpulse +
                                body.internalGetDeltaAngularVelocity());
    }
  }

  void apply(const Contact& c, int k, double impulse) {
    if (c.a >= 0) {
      btSolverBody& body = m_tmpSolverBodyPool[c.a];
      view(body.internalGetDeltaLinearVelocity()) -=
          impulse * inverse_mass[static_cast<std::size_t>(c.a)] * c.axis[k];
      view(body.internalGetDeltaAngularVelocity()) -= impulse * c.spin_a[k];
    }
    if (c.b >= 0) {
      btSolverBody& body = m_tmpSolverBodyPool[c.b];
      view(body.internalGetDeltaLinearVelocity()) +=
          impulse * inverse_mass[static_cast<std::size_t>(c.b)] * c.axis[k];
      view(body.internalGetDeltaAngularVelocity()) += impulse * c.spin_b[k];
    }
  }

  double velocity(const Contact& c, int k) {
    double v = c.before[k];
    if (c.a >= 0) {
      btSolverBody& body = m_tmpSolverBodyPool[c.a];
      v -= c.axis[k].dot(view(body.internalGetDeltaLinearVelocity())) +
           c.turn_a[k].dot(view(body.internalGetDeltaAngularVelocity()));
    }
    if (c.b >= 0) {
      btSolverBody& body = m_tmpSolverBodyPool[c.b];
      v += c.axis[k].dot(view(body.internalGetDeltaLinearVelocity())) +
           c.turn_b[k].dot(view(body.internalGetDeltaAngularVelocity()));
    }
    return v;
  }

  /// Element of the inverse effective mass matrix of the contact's axes.
  double coupling(const Contact& c, int j, int k) const {
    double sum = 0;
    if (c.a >= 0)
      sum += (j == k ? inverse_mass[static_cast<std::size_t>(c.a)] : 0.0) +
             c.turn_a[j].dot(c.spin_a[k]);
    if (c.b >= 0)
      sum += (j == k ? inverse_mass[static_cast<std::size_t>(c.b)] : 0.0) +
             c.turn_b[j].dot(c.spin_b[k]);
    return sum;
  }

  /// Prepares newly added constraints and applies their initial impulses.
  void take_new_constraints() {
    for (std::size_t i = contacts.size(); i < constraints->size(); ++i) {
      const ContactConstraint& row = (*constraints)[i];
      Contact c;
      c.a = row.a;
      c.b = row.b;
      c.friction = row.friction;
      c.axis[0] = row.normal;
      c.axis[1] = row.normal.unitOrthogonal();
      c.axis[2] = row.normal.cross(c.axis[1]);
      for (int k = 0; k < 3; ++k) {
        c.turn_a[k] = row.arm_a.cross(c.axis[k]);
        c.turn_b[k] = row.arm_b.cross(c.axis[k]);
        c.spin_a[k] = c.spin_b[k] = Vector3d::Zero();
        c.before[k] = row.carried.dot(c.axis[k]);
        if (c.a >= 0) {
          const btSolverBody& body = m_tmpSolverBodyPool[c.a];
          c.spin_a[k] = inverse_inertia[static_cast<std::size_t>(c.a)] * c.turn_a[k];
          c.before[k] -=
              c.axis[k].dot(from_bullet(body.m_linearVelocity + body.m_externalForceImpulse)) +
              c.turn_a[k].dot(from_bullet(body.m_angularVelocity + body.m_externalTorqueImpulse));
        }
        if (c.b >= 0) {
          const btSolverBody& body = m_tmpSolverBodyPool[c.b];
          c.spin_b[k] = inverse_inertia[static_cast<std::size_t>(c.b)] * c.turn_b[k];
          c.before[k] +=
              c.axis[k].dot(from_bullet(body.m_linearVelocity + body.m_externalForceImpulse)) +
              c.turn_b[k].dot(from_bullet(body.m_angularVelocity + body.m_externalTorqueImpulse));
        }
        c.impulse[k] = row.impulse.dot(c.axis[k]);
      }
      c.min_velocity = -std::max(row.gap, 0.0) / settings->step_s;
      c.mobility = coupling(c, 0, 0);
      Matrix2d K;
      K << coupling(c, 1, 1), coupling(c, 1, 2), coupling(c, 2, 1), coupling(c, 2, 2);
      // A common step length for both tangents: friction ends up opposite to the slip for any
      // inertia.
      c.tangential_mass = 1 / (0.5 * K.trace() + std::hypot(0.5 * (K(0, 0) - K(1, 1)), K(0, 1)));
      c.impulse[0] = std::clamp(c.impulse[0], 0.0, settings->max_impulse);
      for (int k = 0; k < 3; ++k) apply(c, k, c.impulse[k]);
      contacts.push_back(c);
    }
  }

  /// Returns the largest change of a velocity, mm/s.
  double sweep_contact(Contact& c) {
    const double v = velocity(c, 0);
    const double push =
        std::clamp(c.impulse[0] + (c.min_velocity - v) / c.mobility, 0.0, settings->max_impulse);
    double change = 0;
    if (push != c.impulse[0]) {
      apply(c, 0, push - c.impulse[0]);
      change = std::abs(push - c.impulse[0]) * c.mobility;
      c.impulse[0] = push;
    }
    const double limit = c.friction * push;
    if (limit == 0 && c.impulse[1] == 0 && c.impulse[2] == 0) return change;
    const Vector2d slip(velocity(c, 1), velocity(c, 2));
    Vector2d drag = Vector2d(c.impulse[1], c.impulse[2]) - c.tangential_mass * slip;
    if (drag.norm() > limit) drag *= limit / drag.norm();
    for (int k = 0; k < 2; ++k) {
      const double more_drag = drag[k] - c.impulse[k + 1];
      if (more_drag == 0) continue;
      apply(c, k + 1, more_drag);
      change = std::max(change, std::abs(more_drag) / c.tangential_mass);
      c.impulse[k + 1] = drag[k];
    }
    return change;
  }

  // Called by Bullet after the conversion of bodies and joints. Joints are warm-started here, which
  // Bullet does not do.
  void convertContacts(btPersistentManifold**, int, const btContactSolverInfo&) override {
    for (int r = 0; r < m_tmpSolverNonContactConstraintPool.size(); ++r) {
      const JointRow& row = (*joint_rows)[static_cast<std::size_t>(r)];
      btSolverConstraint& c = m_tmpSolverNonContactConstraintPool[r];
      const double impulse = std::clamp(row.impulse, row.low, row.high);
      c.m_appliedImpulse = impulse;
      btSolverBody &a = m_tmpSolverBodyPool[c.m_solverBodyIdA],
                   &b = m_tmpSolverBodyPool[c.m_solverBodyIdB];
      a.internalApplyImpulse(c.m_contactNormal1 * a.internalGetInvMass(), c.m_angularComponentA,
                             impulse);
      b.internalApplyImpulse(c.m_contactNormal2 * b.internalGetInvMass(), c.m_angularComponentB,
                             impulse);
    }
    contacts.clear();
    take_new_constraints();
  }

  /// A sweep over joints, then over contacts in alternating order. 0 ends the solve.
  btScalar solveSingleIteration(int iteration, btCollisionObject** all, int count,
                                btPersistentManifold** manifolds, int manifold_count,
                                btTypedConstraint** held, int held_count,
                                const btContactSolverInfo& info, btIDebugDraw* drawer) override {
    double change = std::sqrt(btSequentialImpulseConstraintSolver::solveSingleIteration(
        iteration, all, count, manifolds, manifold_count, held, held_count, info, drawer));
    if (iteration % 2 == 0)
      for (auto& c : contacts) change = std::max(change, sweep_contact(c));
    else
      for (auto c = contacts.rbegin(); c != contacts.rend(); ++c)
        change = std::max(change, sweep_contact(*c));
    ++sweeps;
    const bool quiet = change <= settings->tolerance;
    if (!quiet && ++since_addition < sweeps_between_additions) return 1;
    since_addition = 0;
    read_motions();
    if (more->add_new(now, *constraints)) {
      take_new_constraints();
      return 1;
    }
    return quiet ? 0 : 1;
  }

  btScalar solveGroupCacheFriendlyFinish(btCollisionObject** all, int count,
                                         const btContactSolverInfo& info) override {
    for (int r = 0; r < m_tmpSolverNonContactConstraintPool.size(); ++r)
      (*joint_rows)[static_cast<std::size_t>(r)].impulse =
          m_tmpSolverNonContactConstraintPool[r].m_appliedImpulse;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Contact& c = contacts[i];
      (*constraints)[i].impulse =
          c.impulse[0] * c.axis[0] + c.impulse[1] * c.axis[1] + c.impulse[2] * c.axis[2];
    }
    read_motions();
    return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyFinish(all, count, info);
  }

  /// Displacements that correct position errors of joints and penetration, by the same sweeps on
  /// poses.
  void shift(std::vector<SolverMotion>& shifts) {
    bool needed = false;
    for (const JointRow& row : *joint_rows) needed |= std::abs(row.error) > no_shift_mm;
    for (const ContactConstraint& row : *constraints) needed |= row.part > 0;
    if (!needed) return;
    const auto free = [](int i) { return static_cast<std::size_t>(i); };
    std::vector<double>& impulse = shift_impulse;
    impulse.assign(joint_rows->size() + constraints->size(), 0.0);
    for (int s = 0; s < shift_sweeps; ++s) {
      std::size_t at = 0;
      for (const JointRow& row : *joint_rows) {
        double mobility = 0, x = 0;
        Vector3d spin_a = Vector3d::Zero(), spin_b = spin_a;
        if (row.a >= 0) {
          spin_a = inverse_inertia[free(row.a)] * row.turn_a;
          mobility += inverse_mass[free(row.a)] * row.along.squaredNorm() + row.turn_a.dot(spin_a);
          x -= row.along.dot(shifts[free(row.a)].velocity) +
               row.turn_a.dot(shifts[free(row.a)].spin);
        }
        if (row.b >= 0) {
          spin_b = inverse_inertia[free(row.b)] * row.turn_b;
          mobility += inverse_mass[free(row.b)] * row.along.squaredNorm() + row.turn_b.dot(spin_b);
          x += row.along.dot(shifts[free(row.b)].velocity) +
               row.turn_b.dot(shifts[free(row.b)].spin);
        }
        double& total = impulse[at++];
        const double target = -settings->undone * row.error;
        double sum =
            total + ((target - x) / mobility - shift_softness * total) / (1 + shift_softness);
        if (row.low >= 0) sum = std::max(sum, 0.0);
        const double step = sum - total;
        total = sum;
        if (row.a >= 0) {
          shifts[free(row.a)].velocity -= step * inverse_mass[free(row.a)] * row.along;
          shifts[free(row.a)].spin -= step * spin_a;
        }
        if (row.b >= 0) {
          shifts[free(row.b)].velocity += step * inverse_mass[free(row.b)] * row.along;
          shifts[free(row.b)].spin += step * spin_b;
        }
      }
      for (std::size_t i = 0; i < contacts.size(); ++i) {
        const Contact& c = contacts[i];
        double x = 0;
        if (c.a >= 0)
          x -= c.axis[0].dot(shifts[free(c.a)].velocity) + c.turn_a[0].dot(shifts[free(c.a)].spin);
        if (c.b >= 0)
          x += c.axis[0].dot(shifts[free(c.b)].velocity) + c.turn_b[0].dot(shifts[free(c.b)].spin);
        double& total = impulse[at++];
        const double least = (*constraints)[i].part - std::max((*constraints)[i].gap, 0.0);
        const double sum =
            std::max(0.0, total + ((least - x) / c.mobility - shift_softness * total) /
                                      (1 + shift_softness));
        const double step = sum - total;
        total = sum;
        if (c.a >= 0) {
          shifts[free(c.a)].velocity -= step * inverse_mass[free(c.a)] * c.axis[0];
          shifts[free(c.a)].spin -= step * c.spin_a[0];
        }
        if (c.b >= 0) {
          shifts[free(c.b)].velocity += step * inverse_mass[free(c.b)] * c.axis[0];
          shifts[free(c.b)].spin += step * c.spin_b[0];
        }
      }
    }
  }
  std::vector<double> shift_impulse;
};

ConstraintSolver::ConstraintSolver() : state_(std::make_unique<State>()) {}
ConstraintSolver::~ConstraintSolver() = default;

void ConstraintSolver::add_body(double mass_kg, const Vector3d& principal_inertia) {
  State& s = *state_;
  btRigidBody::btRigidBodyConstructionInfo info(mass_kg, nullptr, nullptr,
                                                to_bullet(principal_inertia));
  s.bodies.push_back(std::make_unique<btRigidBody>(info));
  s.bodies.back()->setFlags(0);  // gyroscopic terms are integrated by the world
  s.objects.push_back(s.bodies.back().get());
  s.inverse_mass.push_back(1 / mass_kg);
  s.inverse_inertia.emplace_back();
  s.now.emplace_back();
}

int ConstraintSolver::solve(const SolverSettings& settings, std::span<const SolverBody> bodies,
                            std::vector<JointRow>& joints, std::span<const int> rows_of,
                            std::vector<ContactConstraint>& constraints, ContactGenerator& more,
                            std::vector<SolverMotion>& motions, std::vector<SolverMotion>& shifts) {
  State& s = *state_;
  shifts.assign(bodies.size(), {});
  motions.resize(bodies.size());
  if (bodies.empty()) return 0;
  s.settings = &settings;
  s.joint_rows = &joints;
  s.constraints = &constraints;
  s.more = &more;
  s.sweeps = s.since_addition = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const SolverBody& in = bodies[i];
    btRigidBody& body = *s.bodies[i];
    const Matrix3d& R = in.R_WP;
    body.setWorldTransform(btTransform(btMatrix3x3(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1),
                                                   R(1, 2), R(2, 0), R(2, 1), R(2, 2))));
    body.updateInertiaTensor();
    body.setLinearVelocity(to_bullet(in.motion.velocity));
    body.setAngularVelocity(to_bullet(in.motion.spin));
    body.clearForces();
    body.applyCentralForce(to_bullet(in.force));
    body.applyTorque(to_bullet(in.torque));
    const btMatrix3x3& I = body.getInvInertiaTensorWorld();
    for (int row = 0; row < 3; ++row)
      s.inverse_inertia[i].row(row) = from_bullet(I[row]).transpose();
  }
  std::size_t first = 0;
  for (std::size_t j = 0; j < rows_of.size(); ++j) {
    const auto count = static_cast<std::size_t>(rows_of[j]);
    const std::span<const JointRow> rows(joints.data() + first, count);
    if (j == s.joints.size()) {
      s.joints.push_back(
          std::make_unique<RowsConstraint>(s.bullet_body(rows[0].a), s.bullet_body(rows[0].b)));
      s.joint_constraints.push_back(s.joints.back().get());
    }
    s.joints[j]->rows = rows;
    first += count;
  }
  btContactSolverInfo info;
  info.m_timeStep = settings.step_s;
  info.m_numIterations = settings.max_sweeps;
  info.m_splitImpulse = 0;
  info.m_solverMode = 0;
  s.solveGroup(s.objects.data(), static_cast<int>(s.objects.size()), nullptr, 0,
               s.joint_constraints.data(), static_cast<int>(rows_of.size()), info, nullptr,
               nullptr);
  motions = s.now;
  s.shift(shifts);
  return s.sweeps;
}

}  // namespace condyle
