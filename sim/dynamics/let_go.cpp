#include "sim/dynamics/let_go.h"

#include <algorithm>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

// Share of its speed that a part loses in a step to the hand: settles within some steps, far from
// the 2 at which damping would swing up.
constexpr double lost_in_step = 0.2;

Box moved(const Box& box, const Pose& X) {
  Box out;
  for (int corner = 0; corner < 8; ++corner)
    out.add(X * Vector3d((corner & 1) ? box.high.x() : box.low.x(),
                         (corner & 2) ? box.high.y() : box.low.y(),
                         (corner & 4) ? box.high.z() : box.low.z()));
  return out;
}

Box grown(Box box, double by) {
  box.low.array() -= by;
  box.high.array() += by;
  return box;
}

bool overlaps(const Box& a, const Box& b) {
  return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
}

}  // namespace

LetGo let_go(const Case& patient, std::size_t part, const BodyPoses& from,
             const LetGoSettings& settings, int threads) {
  const std::vector<std::size_t> free = free_parts(patient.parts);
  const auto found = std::find(free.begin(), free.end(), part);
  if (found == free.end())
    throw InputError("only a segment or a transplant can be let go; part " + std::to_string(part) +
                     " is neither");
  const Part& graft = patient.parts[part];
  const double push = settings.push_N.norm();
  if (!(push > 0) || !settings.push_N.allFinite())
    throw InputError(graft.name + ": it needs a push in some direction to settle");
  if (!(settings.speed_mm_s > 0) || !(settings.reach_mm > 0))
    throw InputError(graft.name + ": the speed and the reach must be above 0");

  RigidSettings world_settings;
  world_settings.gravity_mm_s2.setZero();
  RigidWorld world(world_settings);
  const double step = world_settings.step_s;
  const Pose X_CG = pose_of(patient.parts, part, from);
  RigidBody body;
  body.mass = mass_properties(graft.mesh, 1e-6);
  // The hand's inertia: so large that its push and its yielding end at the wanted speed.
  const double mass_kg = 1000 * push * step / (lost_in_step * settings.speed_mm_s);
  body.mass.inertia *= mass_kg / body.mass.mass_kg;
  body.mass.mass_kg = mass_kg;
  body.drag_N_s_mm = lost_in_step * mass_kg / step / 1000;
  body.turning_drag_N_mm_s = lost_in_step * least_moment(body.mass) / step / 1000;
  body.X_WB = X_CG;
  body.surfaces = {std::make_shared<const SlideBody>(make_slide_body(graft.mesh, {}, threads))};
  const int moving = world.add_body(body);
  world.add_force({.body = moving, .point = body.mass.center, .force_N = settings.push_N});

  const Box near = grown(moved(bounding_box(graft.mesh), X_CG), settings.reach_mm);
  std::vector<int> part_of_pair;
  for (std::size_t i = 0; i < patient.parts.size(); ++i) {
    const Part& other = patient.parts[i];
    if (i == part || !collides(other.role) || other.mesh.empty()) continue;
    const Pose X_CO = pose_of(patient.parts, i, from);
    const Box here = moved(near, X_CO.inverse());
    if (!overlaps(here, bounding_box(other.mesh))) continue;
    SlideBodySettings surface;
    surface.field.region = here;
    RigidBody fixed;
    fixed.X_WB = X_CO;
    fixed.surfaces = {
        std::make_shared<const SlideBody>(make_slide_body(other.mesh, surface, threads))};
    if (fixed.surfaces[0]->samples.points.empty()) continue;
    world.add_pair({.a = world.add_body(fixed), .b = moving, .friction = settings.friction});
    part_of_pair.push_back(static_cast<int>(i));
  }
  if (part_of_pair.empty())
    throw InputError(graft.name + ": nothing lies within " + std::to_string(settings.reach_mm) +
                     " mm of it; bring it nearer before letting it go");

  LetGo out;
  out.rest = run_to_rest(world, moving, settings.rest, threads);
  out.poses = from;
  out.poses.X_CF.clear();
  for (const std::size_t f : free) out.poses.X_CF.push_back(pose_of(patient.parts, f, from));
  out.poses.X_CF[static_cast<std::size_t>(found - free.begin())] = world.pose(moving);
  for (const RigidContact& c : world.contacts())
    out.contacts.push_back(
        {part_of_pair[static_cast<std::size_t>(c.pair)], c.point, c.normal, c.gap_mm, c.push_N});
  return out;
}

}  // namespace condyle
