#include "sim/dynamics/jaw_world.h"

#include "engine/core/error.h"
#include "engine/core/units.h"
#include "engine/core/user_cache.h"
#include "engine/mesh/measure.h"
#include "sim/dynamics/body_mass.h"
#include "sim/motion/condylar_kinematics.h"
#include "sim/motion/jaw_joints.h"
#include "sim/occlusion/arches.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double worn_band_mm = 2;
constexpr double around_overlap_mm = 10;
constexpr double min_forward_mm = -0.5, guide_step_mm = 0.5;
// of forward travel: the fossa path is tabulated by rotation, to this travel
constexpr double farthest_turned_mm = 16;

Vector3d landmark(const Case& patient, const char* name) {
  const auto point = patient.landmarks.find(name);
  if (!point)
    throw InputError(patient.name + ": the landmark " + name +
                     " is missing; the jaw cannot be suspended without it");
  return *point;
}

/// The surfaces that bite: the teeth; where an arch has none, the crowns of the bone that carries
/// them.
struct BitingSurfaces {
  const TriMesh *upper = nullptr, *lower = nullptr;
  std::optional<Box> upper_crowns, lower_crowns;  // of a bone: only there does it bite
};

BitingSurfaces biting_surfaces(const Case& patient) {
  const auto teeth = [&](BodyId arch) {
    const Part* part = patient.teeth_of(arch);
    return part && !part->mesh.empty() ? &part->mesh : nullptr;
  };
  BitingSurfaces found{teeth(patient.jaw.upper_arch), teeth(patient.jaw.lower_arch), {}, {}};
  if (found.upper && found.lower) return found;
  const Arches arches = find_arches(patient);
  if (!found.upper)
    found.upper = &arches.upper.part->mesh, found.upper_crowns = arches.upper.crowns;
  if (!found.lower)
    found.lower = &arches.lower.part->mesh, found.lower_crowns = arches.lower.crowns;
  return found;
}

/// Depth to which crowns overlap at rest, by the samples of each in the field of the other.
double rest_depth(const ContactSurface& a, const ContactSurface& b) {
  double depth = 0;
  for (const auto& [samples, field] : {std::pair{&a, &b}, std::pair{&b, &a}})
    for (const Vector3d& p : samples->samples.points) {
      const FieldSample here = field->field.at(p);
      if (here.known) depth = std::max(depth, -here.distance_mm);
    }
  return depth;
}

using Surfaces = std::vector<std::shared_ptr<const ContactSurface>>;

/// Bone and crowns that move with the cranium and with the jaw, except the biting crowns; other
/// bodies at the given poses, in the coordinates of the cranium and of the jaw.
std::array<Surfaces, 2> make_bones(const Case& patient, const BodyPoses& given, int threads,
                                   const Progress& progress) {
  const BodyPoses at = completed(patient.bodies, given);
  constexpr double spacing_mm = 0.5, sample_mm = 0.6, reach_mm = 20;
  const bool bites = patient.has_both_arches();
  std::array<std::vector<TriMesh>, 2> meshes;
  std::array<Box, 2> boxes;
  for (const Part& part : patient.parts) {
    if (!collides(part.role) || part.mesh.empty() || (bites && is_teeth(part.role))) continue;
    const BodyId jaw = patient.jaw.lower_arch;
    const bool moves = patient.bodies.is_within(part.body, jaw);
    TriMesh mesh = part.mesh;
    if (const Pose X = pose_in(moves ? jaw : cranium_body, part.body, at); !bit_identical(X, {}))
      for (Vector3d& v : mesh.vertices) v = X * v;
    boxes[moves].add(bounding_box(mesh));
    meshes[moves].push_back(std::move(mesh));
  }
  std::array<Surfaces, 2> made;
  for (std::size_t side = 0; side < 2; ++side)
    for (const TriMesh& mesh : meshes[side]) {
      ContactSurfaceSettings how;
      how.field.spacing_mm = spacing_mm;
      how.samples.spacing_mm = sample_mm;
      how.cache = user_cache_folder();
      Box& region = how.field.region.emplace(boxes[1 - side]);
      if (region.empty()) continue;
      region.low.array() -= reach_mm;
      region.high.array() += reach_mm;
      made[side].push_back(std::make_shared<const ContactSurface>(
          make_contact_surface(mesh, how, threads, progress)));
    }
  return made;
}

/// Inferior translation of the condyles by their forward travel; on a fossa along an opening of the
/// jaw.
void find_guides(const Case& patient, bool fossa, int threads, JawWorld& jaw) {
  const auto both = [&](Pchip path, const char* guide) {
    jaw.inferior_mm.fill(path);
    jaw.guide = guide;
  };
  if (patient.mechanics && patient.mechanics->guide)
    return both(path_of_case(*patient.mechanics->guide), "on the guide of the jaw's mechanics");
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
          drop.push_back(joints.inferior_translation_mm(
              side, s, coupling.theta(std::min(s, farthest_turned_mm))));
        }
        jaw.inferior_mm[side == JawSide::left ? 0 : 1] = Pchip(forward, drop);
      }
      jaw.guide = "at the disc gap on the fossa";
      return;
    }
  }
  if (patient.condylar_path)
    both(path_of_case(*patient.condylar_path), "on the patient's own path");
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
      .world = RigidWorld(world_settings), .condyles = condyles, .inferior_mm = {}, .guide = {}};
  find_guides(patient, settings.fossa, threads, jaw);
  DynamicBody cranium, mandible;
  if (settings.teeth) {
    const BitingSurfaces bite = biting_surfaces(patient);
    ContactSurfaceSettings how;
    how.cache = user_cache_folder();
    if (settings.worn_crowns) how.field.band_mm = worn_band_mm;
    const auto surface = [&](const TriMesh& mesh, const std::optional<Box>& crowns) {
      how.field.region = crowns;
      return std::make_shared<const ContactSurface>(
          make_contact_surface(mesh, how, threads, progress));
    };
    cranium.surfaces = {surface(*bite.upper, bite.upper_crowns)};
    mandible.surfaces = {surface(*bite.lower, bite.lower_crowns)};
    if (settings.worn_crowns) jaw.worn_mm = rest_depth(*cranium.surfaces[0], *mandible.surfaces[0]);
  }
  Surfaces skull;
  if (settings.bones) {
    auto [fixed_bones, moving_bones] = make_bones(patient, *settings.bones, threads, progress);
    skull = std::move(fixed_bones);
    mandible.surfaces.insert(mandible.surfaces.end(), moving_bones.begin(), moving_bones.end());
  }
  const int fixed = jaw.world.add_body(cranium);

  mandible.mass = body_mass(patient, patient.jaw.lower_arch);
  const double per_step = settings.lost_in_step / world_settings.step_s;
  mandible.drag_N_s_mm = settings.drag_kg_s.value_or(per_step * mandible.mass.mass_kg) / mm_per_m;
  mandible.turning_drag_N_mm_s =
      settings.turning_drag_kg_mm2_s.value_or(per_step * min_moment(mandible.mass)) / mm_per_m;
  mandible.drag_at = settings.drag_at;
  jaw.mandible = jaw.world.add_body(mandible);
  if (settings.teeth)
    jaw.bite = jaw.world.add_pair(
        {.a = fixed, .b = jaw.mandible, .friction = settings.friction, .gap_mm = -jaw.worn_mm});
  if (!skull.empty()) {
    const int bones = jaw.world.add_body({.surfaces = std::move(skull)});
    jaw.bones = jaw.world.add_pair({.a = bones, .b = jaw.mandible, .friction = 0});
    // The overlap at rest is allowed. Bone that carries the crowns is part of the bite.
    jaw.world.allow_overlap(*jaw.bones, around_overlap_mm);
  }
  jaw.world.set_pose(jaw.mandible, settings.X_CM);

  const double first_mm = settings.stops ? 0 : min_forward_mm;
  for (std::size_t side = 0; side < 2; ++side) {
    const Vector3d& condyle = condyles[side];
    RigidJoint guide{.kind = RigidJoint::Kind::guide, .a = fixed, .b = jaw.mandible};
    guide.p_B = condyle;
    for (double forward = first_mm; forward <= longest_forward_mm; forward += guide_step_mm)
      guide.curve_A.push_back(condyle -
                              Vector3d(0, forward, jaw.inferior_mm[side](std::max(forward, 0.0))));
    guide.sideways_A = Vector3d::UnitX();
    jaw.world.add_joint(guide);
    if (!settings.stops) continue;
    RigidJoint stop{.kind = RigidJoint::Kind::plane, .a = fixed, .b = jaw.mandible};
    stop.p_A = stop.p_B = condyle;
    stop.axis_A = (side == 0 ? -1 : 1) * Vector3d::UnitX();
    jaw.world.add_joint(stop);
  }
  const Vector3d middle = 0.5 * (condyles[0] + condyles[1]);
  jaw.bite_force =
      jaw.world.add_force({.body = jaw.mandible,
                           .point = middle + settings.bite_position * (incisor - middle),
                           .force_N = settings.bite_force_N});
  return jaw;
}

}  // namespace condyle
