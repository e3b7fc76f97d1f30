#include "tools/bench/baseline/rigid_scenes.h"

#include <btBulletDynamicsCommon.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <memory>

#include "engine/core/units.h"
#include "engine/rigid/rigid_world.h"
#include "tools/bench/baseline/tissue_target.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double density_kg_mm3 = 1.9e-6, gravity_mm_s2 = 9810, step_s = 1e-3;
constexpr double friction = 0.5;
const Vector3d plank(4, 6, 20), block(14, 10, 10), ground(120, 60, 6);  // sizes
constexpr int planks = 4;

double mass_of(const Vector3d& size) { return density_kg_mm3 * size.prod(); }

TriMesh box_mesh(const Vector3d& size) {
  TriMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back((i & 1 ? 0.5 : -0.5) * size.x(), (i & 2 ? 0.5 : -0.5) * size.y(),
                               (i & 4 ? 0.5 : -0.5) * size.z());
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// Bodies of either kind, numbered in order of addition; each is a box about its centre of mass.
class Scene {
 public:
  virtual ~Scene() = default;
  virtual int add_box(const Vector3d& size, const Pose& X_WB, bool is_free) = 0;
  virtual void add_ball(int a, int b, const Vector3d& p_A, const Vector3d& p_B) = 0;
  virtual void step() = 0;
  virtual Pose pose(int body) const = 0;
  virtual double kinetic_energy() const = 0;  // mJ, of all free bodies
};

class OwnScene final : public Scene {
 public:
  explicit OwnScene(const Vector3d& gravity)
      : world_({.step_s = step_s, .gravity_mm_s2 = gravity}) {}

  int add_box(const Vector3d& size, const Pose& X_WB, bool is_free) override {
    const TriMesh mesh = box_mesh(size);
    DynamicBody body;
    if (is_free) body.mass = mass_properties(mesh, density_kg_mm3);
    body.X_WB = X_WB;
    if (touch_) {
      body.surfaces = {std::make_shared<const ContactSurface>(make_contact_surface(mesh))};
    }
    const int id = world_.add_body(body);
    if (touch_ && id > 0) world_.add_pair({.a = id - 1, .b = id, .friction = friction});
    return id;
  }
  void add_ball(int a, int b, const Vector3d& p_A, const Vector3d& p_B) override {
    world_.add_joint({.kind = RigidJoint::Kind::ball, .a = a, .b = b, .p_A = p_A, .p_B = p_B});
  }
  void step() override { world_.step(); }
  Pose pose(int body) const override { return world_.pose(body); }
  double kinetic_energy() const override { return world_.kinetic_energy(); }
  void make_surfaces() { touch_ = true; }

 private:
  RigidWorld world_;
  bool touch_ = false;
};

class BulletScene final : public Scene {
 public:
  explicit BulletScene(const Vector3d& gravity) {
    world_.setGravity({gravity.x(), gravity.y(), gravity.z()});
  }
  ~BulletScene() override {
    for (auto& joint : joints_) world_.removeConstraint(joint.get());
    for (auto& body : bodies_) world_.removeRigidBody(body.get());
  }

  int add_box(const Vector3d& size, const Pose& X_WB, bool is_free) override {
    const Vector3d half = 0.5 * size;
    shapes_.push_back(std::make_unique<btBoxShape>(btVector3(half.x(), half.y(), half.z())));
    const double mass = is_free ? mass_of(size) : 0;
    btVector3 inertia(0, 0, 0);
    // Inertia of the box itself; the shape's own includes its margin.
    if (is_free)
      inertia = mass / 12 *
                btVector3(size.y() * size.y() + size.z() * size.z(),
                          size.z() * size.z() + size.x() * size.x(),
                          size.x() * size.x() + size.y() * size.y());
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shapes_.back().get(), inertia);
    info.m_startWorldTransform =
        btTransform(btQuaternion(X_WB.R.x(), X_WB.R.y(), X_WB.R.z(), X_WB.R.w()),
                    btVector3(X_WB.t.x(), X_WB.t.y(), X_WB.t.z()));
    info.m_friction = std::sqrt(friction);  // Bullet multiplies those of both bodies
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    bodies_.back()->setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(bodies_.back().get());
    return static_cast<int>(bodies_.size()) - 1;
  }
  void add_ball(int a, int b, const Vector3d& p_A, const Vector3d& p_B) override {
    joints_.push_back(std::make_unique<btPoint2PointConstraint>(
        *bodies_[static_cast<std::size_t>(a)], *bodies_[static_cast<std::size_t>(b)],
        btVector3(p_A.x(), p_A.y(), p_A.z()), btVector3(p_B.x(), p_B.y(), p_B.z())));
    world_.addConstraint(joints_.back().get(), true);  // linked bodies do not collide
  }
  void step() override { world_.stepSimulation(step_s, 0); }
  Pose pose(int body) const override {
    const btTransform& X = bodies_[static_cast<std::size_t>(body)]->getWorldTransform();
    const btQuaternion q = X.getRotation();
    return {Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()),
            {X.getOrigin().x(), X.getOrigin().y(), X.getOrigin().z()}};
  }
  double kinetic_energy() const override {
    double sum = 0;
    for (const auto& body : bodies_) {
      if (body->getInvMass() == 0) continue;
      const btVector3 w = body->getAngularVelocity();
      sum += 0.5 / body->getInvMass() * body->getLinearVelocity().length2() +
             0.5 * w.dot(body->getInvInertiaTensorWorld().inverse() * w);
    }
    return 1e-3 * sum;  // kg mm^2/s^2
  }

 private:
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
};

std::unique_ptr<Scene> make_scene(RigidMethod method, const Vector3d& gravity, bool contact) {
  if (method == RigidMethod::bullet) return std::make_unique<BulletScene>(gravity);
  auto scene = std::make_unique<OwnScene>(gravity);
  if (contact) scene->make_surfaces();
  return scene;
}

void run(
    Scene& scene, int steps, std::vector<double>& step_ms,
    const std::function<void()>& after = [] {}) {
  for (int k = 0; k < steps; ++k) {
    const Stopwatch watch;
    scene.step();
    step_ms.push_back(watch.cpu_ms());
    after();
  }
}

/// A block on a plane that is inclined along x: gravity is, the plane is not.
struct Slope {
  std::unique_ptr<Scene> scene;
  int body = 0;
  double x() const { return scene->pose(body).t.x(); }
};
Slope make_slope(RigidMethod method, double degrees) {
  const double a = degrees * degree;
  Slope slope{make_scene(method, gravity_mm_s2 * Vector3d(std::sin(a), 0, -std::cos(a)), true), 0};
  Pose X;
  X.t.z() = -0.5 * ground.z();
  slope.scene->add_box(ground, X, false);
  X.t = {-30, 0, 0.5 * block.z()};
  slope.body = slope.scene->add_box(block, X, true);
  return slope;
}

}  // namespace

RigidRun swing_chain(RigidMethod method) {
  RigidRun result;
  const auto scene = make_scene(method, {0, 0, -gravity_mm_s2}, false);
  const Vector3d top(0, 0, 0.5 * plank.z());
  Pose X;
  X.R = Eigen::AngleAxisd(40 * degree, Vector3d::UnitX());
  std::vector<int> bodies = {scene->add_box(plank, Pose{}, false)};
  for (int k = 0; k < planks; ++k) {
    const Vector3d hook = k == 0 ? Vector3d(0, 0, 0) : Vector3d(X.t - X.R * top);
    X.t = hook - X.R * top;
    bodies.push_back(scene->add_box(plank, X, true));
    scene->add_ball(bodies[static_cast<std::size_t>(k)], bodies.back(),
                    k == 0 ? Vector3d(0, 0, 0) : Vector3d(-top), top);
  }
  const double weight_N = 1e-3 * mass_of(plank) * gravity_mm_s2;
  const auto energy = [&] {
    double sum = scene->kinetic_energy();
    for (int k = 1; k <= planks; ++k)
      sum += weight_N * scene->pose(bodies[static_cast<std::size_t>(k)]).t.z();
    return sum;
  };
  const double start = energy();
  double fall_energy = 0;  // potential energy between the start and hanging straight down
  for (int k = 1; k <= planks; ++k)
    fall_energy += weight_N * (k - 0.5) * plank.z() * (1 - std::cos(40 * degree));
  run(*scene, 2000, result.step_ms, [&] {
    for (int k = 0; k < planks; ++k) {
      const Pose above = scene->pose(bodies[static_cast<std::size_t>(k)]),
                 here = scene->pose(bodies[static_cast<std::size_t>(k) + 1]);
      const Vector3d hook = k == 0 ? Vector3d(0, 0, 0) : Vector3d(above * Vector3d(-top));
      result.joint_error_mm = std::max(result.joint_error_mm, (here * top - hook).norm());
    }
    result.energy_gain = std::max(result.energy_gain, (energy() - start) / fall_energy);
  });
  result.energy_loss = (start - energy()) / fall_energy;
  return result;
}

RigidRun slide_block(RigidMethod method) {
  constexpr int settle = 200, rest = 2000, slide = 100;
  RigidRun result;
  const Slope held = make_slope(method, 20);
  run(*held.scene, settle, result.step_ms);
  const double from = held.x();
  run(*held.scene, rest, result.step_ms, [&] {
    const Pose X = held.scene->pose(held.body);
    for (const Vector3d& corner : box_mesh(block).vertices)
      result.depth_mm = std::max(result.depth_mm, -(X * corner).z());
  });
  result.drift_mm = std::abs(held.x() - from);

  const Slope loose = make_slope(method, 35);
  const double begin = loose.x(), time_s = slide * step_s;
  run(*loose.scene, slide, result.step_ms);
  const double expected = 0.5 * gravity_mm_s2 *
                          (std::sin(35 * degree) - friction * std::cos(35 * degree)) * time_s *
                          (time_s + step_s);  // semi-implicit steps
  result.slide_error = std::abs(loose.x() - begin - expected) / expected;
  return result;
}

}  // namespace condyle
