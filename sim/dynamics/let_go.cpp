#include "sim/dynamics/let_go.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "engine/collide/solid.h"
#include "engine/core/error.h"
#include "engine/mesh/measure.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

// Share of its speed that a part loses in a step to the hand: settles within some steps, far from
// the 2 at which damping would swing up.
constexpr double lost_in_step = 0.2;

constexpr double deep_start_mm = 1, deep_rest_mm = 0.1;

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

void refuse_bad(const Case& patient, const std::vector<std::size_t>& parts,
                const std::vector<std::size_t>& free, const LetGoSettings& settings) {
  for (const std::size_t part : parts) {
    if (std::find(free.begin(), free.end(), part) == free.end())
      throw InputError("only a segment or a transplant can be let go; part " +
                       std::to_string(part) + " is neither");
    if (std::count(parts.begin(), parts.end(), part) > 1)
      throw InputError(patient.parts[part].name + " is let go twice");
  }
  const std::string& name = patient.parts[parts[0]].name;
  if (!(settings.push_N.norm() > 0) || !settings.push_N.allFinite())
    throw InputError(name + ": it needs a push in some direction to settle");
  if (!(settings.speed_mm_s > 0) || !(settings.reach_mm > 0))
    throw InputError(name + ": the speed and the reach must be above 0");
}

/// With the inertia of the hand, or of the soft tissue around it: so large that the push and its
/// yielding end at the wanted speed.
RigidBody loose(const Part& part, const Pose& X_CP, double step_s, const LetGoSettings& settings,
                int threads, const Progress& progress) {
  RigidBody body;
  body.mass = mass_properties(part.mesh, 1e-6);
  const double mass_kg =
      1000 * settings.push_N.norm() * step_s / (lost_in_step * settings.speed_mm_s);
  body.mass.inertia *= mass_kg / body.mass.mass_kg;
  body.mass.mass_kg = mass_kg;
  body.drag_N_s_mm = lost_in_step * mass_kg / step_s / 1000;
  body.turning_drag_N_mm_s = lost_in_step * least_moment(body.mass) / step_s / 1000;
  body.X_WB = X_CP;
  body.surfaces = {
      std::make_shared<const SlideBody>(make_slide_body(part.mesh, {}, threads, progress))};
  return body;
}

/// Parts of which one may lie in the other.
struct PairParts {
  int below, lies;
};

/// The deepest of all pairs, by the exact surfaces.
struct Deepest {
  double depth_mm = 0;
  PairParts pair = {};
};
Deepest deepest_of(const Case& patient, const std::vector<PairParts>& pairs,
                   const std::map<int, Solid>& solids, const BodyPoses& at) {
  Deepest deepest;
  for (const PairParts& pair : pairs) {
    const auto pose = [&](int part) {
      return pose_of(patient.parts, static_cast<std::size_t>(part), at);
    };
    const double depth = overlap_depth(solids.at(pair.below), pose(pair.below),
                                       solids.at(pair.lies), pose(pair.lies))
                             .depth_mm;
    if (depth > deepest.depth_mm) deepest = {depth, pair};
  }
  return deepest;
}

}  // namespace

LetGo let_go(const Case& patient, std::size_t part, const BodyPoses& from,
             const LetGoSettings& settings, int threads, const Progress& progress) {
  const Progress making = [&](std::string_view, double) { report(progress, "letting go", 0); };
  making({}, 0);
  const std::vector<std::size_t> free = free_parts(patient.parts);
  std::vector<std::size_t> parts = {part};
  parts.insert(parts.end(), settings.yielding.begin(), settings.yielding.end());
  refuse_bad(patient, parts, free, settings);

  RigidSettings world_settings;
  world_settings.gravity_mm_s2.setZero();
  RigidWorld world(world_settings);
  std::vector<int> bodies;
  std::vector<Box> near;  // in the cranium
  for (const std::size_t p : parts) {
    const Pose X_CP = pose_of(patient.parts, p, from);
    bodies.push_back(world.add_body(
        loose(patient.parts[p], X_CP, world_settings.step_s, settings, threads, making)));
    near.push_back(grown(moved(bounding_box(patient.parts[p].mesh), X_CP), settings.reach_mm));
  }
  world.add_force(
      {.body = bodies[0], .point = world.mass(bodies[0]).center, .force_N = settings.push_N});

  std::vector<PairParts> pairs;
  const auto add_pair = [&](int below, std::size_t on, std::size_t mover) {
    world.add_pair({.a = below, .b = bodies[mover], .friction = settings.friction});
    pairs.push_back({static_cast<int>(on), static_cast<int>(parts[mover])});
  };
  for (std::size_t i = 0; i < patient.parts.size(); ++i) {
    const Part& other = patient.parts[i];
    if (std::find(parts.begin(), parts.end(), i) != parts.end() || !collides(other.role) ||
        other.mesh.empty())
      continue;
    const Pose X_CO = pose_of(patient.parts, i, from);
    const Box box = bounding_box(other.mesh);
    Box here;
    std::vector<std::size_t> movers;
    for (std::size_t m = 0; m < parts.size(); ++m) {
      const Box reach = moved(near[m], X_CO.inverse());
      if (!overlaps(reach, box)) continue;
      here.add(reach);
      movers.push_back(m);
    }
    if (movers.empty()) continue;
    SlideBodySettings surface;
    surface.field.region = here;
    RigidBody fixed;
    fixed.X_WB = X_CO;
    fixed.surfaces = {
        std::make_shared<const SlideBody>(make_slide_body(other.mesh, surface, threads, making))};
    if (fixed.surfaces[0]->samples.points.empty()) continue;
    const int below = world.add_body(fixed);
    for (const std::size_t m : movers) add_pair(below, i, m);
  }
  for (std::size_t a = 0; a < parts.size(); ++a)
    for (std::size_t b = a + 1; b < parts.size(); ++b)
      if (overlaps(near[a], near[b])) add_pair(bodies[b], parts[b], a);
  const std::string& name = patient.parts[part].name;
  if (std::none_of(pairs.begin(), pairs.end(), [&](const PairParts& pair) {
        return pair.below == static_cast<int>(part) || pair.lies == static_cast<int>(part);
      }))
    throw InputError(
        fmt::format("{}: nothing lies within {:g} mm of it; bring it nearer before letting it go",
                    name, settings.reach_mm));

  std::map<int, Solid> solids;
  for (const PairParts& pair : pairs) {
    making({}, 0);
    for (const int p : {pair.below, pair.lies})
      solids.try_emplace(p, patient.parts[static_cast<std::size_t>(p)].mesh);
  }
  if (const Deepest start = deepest_of(patient, pairs, solids, from);
      start.depth_mm > deep_start_mm) {
    const auto part_name = [&](int p) { return patient.parts[static_cast<std::size_t>(p)].name; };
    throw InputError(fmt::format(
        "{}: starts {:.1f} mm deep in {}; move it out, or import it again with --push-out",
        part_name(start.pair.lies), start.depth_mm, part_name(start.pair.below)));
  }

  LetGo out;
  out.rest = run_to_rest(world, bodies, settings.rest, threads, progress);
  // Farther away bone is not looked at.
  for (std::size_t m = 0; m < parts.size(); ++m) {
    const Vector3d& center = world.mass(bodies[m]).center;
    const Vector3d way =
        world.pose(bodies[m]) * center - pose_of(patient.parts, parts[m], from) * center;
    out.rest.reached &= way.norm() < settings.reach_mm;
  }
  out.poses = from;
  out.poses.X_CF.clear();
  for (const std::size_t f : free) {
    const auto loosed = std::find(parts.begin(), parts.end(), f);
    out.poses.X_CF.push_back(
        loosed == parts.end()
            ? pose_of(patient.parts, f, from)
            : world.pose(bodies[static_cast<std::size_t>(loosed - parts.begin())]));
  }
  out.rest.depth_mm = deepest_of(patient, pairs, solids, out.poses).depth_mm;
  out.rest.reached &= out.rest.depth_mm <= deep_rest_mm;
  for (const RigidContact& c : world.contacts()) {
    const PairParts& pair = pairs[static_cast<std::size_t>(c.pair)];
    out.contacts.push_back({pair.below, c.point, c.normal, c.gap_mm, c.push_N, pair.lies});
  }
  return out;
}

}  // namespace condyle
