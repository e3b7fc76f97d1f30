#include "sim/dynamics/jaw_world.h"

#include "engine/core/error.h"
#include "engine/core/units.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"
#include "sim/motion/condylar_path.h"
#include "sim/motion/jaw_joints.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double bone_kg_mm3 = 1.9e-6;
constexpr double box_share = 0.12;  // of its box that a mandible fills
constexpr double worn_band_mm = 2;
constexpr double around_overlap_mm = 10;
constexpr double least_forward_mm = -0.5, guide_step_mm = 0.5;
constexpr double farthest_turned_mm = 16;  // the jaw opens no farther with the condyles

Vector3d landmark(const Case& patient, const char* name) {
  const auto point = patient.landmarks.find(name);
  if (!point)
    throw InputError(patient.name + ": the landmark " + name +
                     " is missing; the jaw cannot be hung without it");
  return *point;
}

const Part& part(const Case& patient, Role role, const char* name) {
  const Part* found = patient.find(role);
  if (!found || found->mesh.empty())
    throw InputError(patient.name + ": " + name + " are missing; the jaw cannot close without");
  return *found;
}

/// Of a mandible whose surface is open: of a box that weighs as much as a mandible of its size.
MassProperties mandible_mass(const TriMesh& mesh) {
  const Topology topology = inspect(mesh);
  if (topology.closed() && topology.volume_mm3 > 0) return mass_properties(mesh, bone_kg_mm3);
  const Box box = bounding_box(mesh);
  const Vector3d size = box.size(), square = size.cwiseProduct(size);
  MassProperties out;
  out.mass_kg = box_share * bone_kg_mm3 * size.prod();
  out.center = box.center();
  out.inertia =
      (out.mass_kg / 12 *
       Vector3d(square.y() + square.z(), square.z() + square.x(), square.x() + square.y()))
          .asDiagonal();
  return out;
}

MassProperties jaw_mass(const Case& patient) {
  if (patient.mechanics)
    return {patient.mechanics->mandible.mass_kg, patient.mechanics->mandible.center,
            patient.mechanics->mandible.inertia};
  return mandible_mass(part(patient, Role::mandible, "mandibles").mesh);
}

/// How deep crowns overlap where they lie, by the samples of each in the field of the other.
double rest_depth(const SlideBody& a, const SlideBody& b) {
  double depth = 0;
  for (const auto& [samples, field] : {std::pair{&a, &b}, std::pair{&b, &a}})
    for (const Vector3d& p : samples->samples.points) {
      const FieldSample here = field->field.at(p);
      if (here.known) depth = std::max(depth, -here.distance_mm);
    }
  return depth;
}

using Surfaces = std::vector<std::shared_ptr<const SlideBody>>;

/// Bone and crowns of the cranium and of the mandible beside those that bite, as the poses have the
/// free parts, in the coordinates of what carries them.
std::array<Surfaces, 2> make_bones(const Case& patient, const BodyPoses& at, int threads,
                                   const Progress& progress) {
  constexpr double spacing_mm = 0.5, sample_mm = 0.6, reach_mm = 20;
  const bool bites = patient.find(Role::upper_teeth) && patient.find(Role::lower_teeth);
  std::array<std::vector<TriMesh>, 2> meshes;
  std::array<Box, 2> boxes;
  for (std::size_t i = 0; i < patient.parts.size(); ++i) {
    const Part& part = patient.parts[i];
    if (!collides(part.role) || part.mesh.empty() || (bites && is_teeth(part.role))) continue;
    const bool is_free = body_of(part.role) == Body::free;
    const bool moves = (is_free ? part.carrier : body_of(part.role)) == Body::mandible;
    TriMesh mesh = part.mesh;
    if (is_free) {
      const Pose X = (moves ? at.X_CM : Pose{}).inverse() * pose_of(patient.parts, i, at);
      for (Vector3d& v : mesh.vertices) v = X * v;
    }
    boxes[moves].add(bounding_box(mesh));
    meshes[moves].push_back(std::move(mesh));
  }
  std::array<Surfaces, 2> made;
  for (std::size_t side = 0; side < 2; ++side)
    for (const TriMesh& mesh : meshes[side]) {
      SlideBodySettings how;
      how.field.spacing_mm = spacing_mm;
      how.samples.spacing_mm = sample_mm;
      how.cache = field_cache_folder();
      Box& region = how.field.region.emplace(boxes[1 - side]);
      if (region.empty()) continue;
      region.low.array() -= reach_mm;
      region.high.array() += reach_mm;
      made[side].push_back(
          std::make_shared<const SlideBody>(make_slide_body(mesh, how, threads, progress)));
    }
  return made;
}

/// Drop of the condyles by their forward travel; on a fossa as the jaw turns when it opens.
void find_guides(const Case& patient, bool fossa, int threads, JawWorld& jaw) {
  const auto both = [&](Pchip path, const char* guide) {
    jaw.drop_mm.fill(path);
    jaw.guide = guide;
  };
  if (patient.mechanics && patient.mechanics->guide)
    return both(known_path(*patient.mechanics->guide), "on the guide of the jaw's mechanics");
  if (fossa) {
    const JawJoints joints(patient, {}, JointReach::straight, threads);
    if (joints.surfaces()) {
      const Coupling coupling;
      std::vector<double> forward, drop;
      for (const JawSide side : {JawSide::left, JawSide::right}) {
        forward.clear();
        drop.clear();
        for (double s = 0; s <= longest_forward_mm; s += guide_step_mm) {
          forward.push_back(s);
          drop.push_back(joints.drop_mm(side, s, coupling.theta(std::min(s, farthest_turned_mm))));
        }
        jaw.drop_mm[side == JawSide::left ? 0 : 1] = Pchip(forward, drop);
      }
      jaw.guide = "at their disc's gap on the fossa";
      return;
    }
  }
  if (patient.condylar_path)
    both(known_path(*patient.condylar_path), "on the patient's own path");
  else
    both(average_path(), "on an average path");
}

}  // namespace

JawWorld make_jaw_world(const Case& patient, const JawWorldSettings& settings, int threads,
                        const Progress& progress) {
  const std::array<Vector3d, 2> condyles = {landmark(patient, "left_condyle"),
                                            landmark(patient, "right_condyle")};
  const Vector3d incisor = landmark(patient, "lower_incisal_point");

  RigidSettings world_settings;
  JawWorld jaw{
      .world = RigidWorld(world_settings), .condyles = condyles, .drop_mm = {}, .guide = {}};
  find_guides(patient, settings.fossa, threads, jaw);
  RigidBody cranium, mandible;
  if (settings.teeth) {
    const TriMesh &upper = part(patient, Role::upper_teeth, "upper teeth").mesh,
                  &lower = part(patient, Role::lower_teeth, "lower teeth").mesh;
    SlideBodySettings how;
    how.cache = field_cache_folder();
    if (settings.worn_crowns) how.field.band_mm = worn_band_mm;
    const auto surface = [&](const TriMesh& mesh) {
      return std::make_shared<const SlideBody>(make_slide_body(mesh, how, threads, progress));
    };
    cranium.surfaces = {surface(upper)};
    mandible.surfaces = {surface(lower)};
    if (settings.worn_crowns) jaw.worn_mm = rest_depth(*cranium.surfaces[0], *mandible.surfaces[0]);
  }
  Surfaces skull;
  if (settings.bones) {
    auto [fixed_bones, moving_bones] = make_bones(patient, *settings.bones, threads, progress);
    skull = std::move(fixed_bones);
    mandible.surfaces.insert(mandible.surfaces.end(), moving_bones.begin(), moving_bones.end());
  }
  const int fixed = jaw.world.add_body(cranium);

  mandible.mass = jaw_mass(patient);
  const double per_step = settings.lost_in_step / world_settings.step_s;
  mandible.drag_N_s_mm = settings.drag_kg_s.value_or(per_step * mandible.mass.mass_kg) / mm_per_m;
  mandible.turning_drag_N_mm_s =
      settings.turning_drag_kg_mm2_s.value_or(per_step * least_moment(mandible.mass)) / mm_per_m;
  mandible.drag_at = settings.drag_at;
  jaw.mandible = jaw.world.add_body(mandible);
  if (settings.teeth)
    jaw.bite = jaw.world.add_pair(
        {.a = fixed, .b = jaw.mandible, .friction = settings.friction, .gap_mm = -jaw.worn_mm});
  if (!skull.empty()) {
    const int bones = jaw.world.add_body({.surfaces = std::move(skull)});
    jaw.bones = jaw.world.add_pair({.a = bones, .b = jaw.mandible, .friction = 0});
    // At rest, where they are so far. Bone that crowns are drawn on is held by the bite.
    jaw.world.allow_overlap(*jaw.bones, around_overlap_mm);
  }
  jaw.world.set_pose(jaw.mandible, settings.X_CM);

  const double first_mm = settings.stops ? 0 : least_forward_mm;
  for (std::size_t side = 0; side < 2; ++side) {
    const Vector3d& condyle = condyles[side];
    RigidJoint guide{.kind = RigidJoint::Kind::guide, .a = fixed, .b = jaw.mandible};
    guide.p_B = condyle;
    for (double forward = first_mm; forward <= longest_forward_mm; forward += guide_step_mm)
      guide.curve_A.push_back(condyle -
                              Vector3d(0, forward, jaw.drop_mm[side](std::max(forward, 0.0))));
    guide.sideways_A = Vector3d::UnitX();
    jaw.world.add_joint(guide);
    if (!settings.stops) continue;
    RigidJoint stop{.kind = RigidJoint::Kind::plane, .a = fixed, .b = jaw.mandible};
    stop.p_A = stop.p_B = condyle;
    stop.axis_A = (side == 0 ? -1 : 1) * Vector3d::UnitX();
    jaw.world.add_joint(stop);
  }
  const Vector3d middle = 0.5 * (condyles[0] + condyles[1]);
  jaw.bite_force = jaw.world.add_force({.body = jaw.mandible,
                                        .point = middle + settings.bite_place * (incisor - middle),
                                        .force_N = settings.bite_force_N});
  return jaw;
}

}  // namespace condyle
