#include "sim/contact/push_out_parts.h"

#include <fmt/core.h>

#include "engine/collide/push_out.h"
#include "sim/frame/body_poses.h"

namespace condyle {
namespace {

constexpr double deep_mm = 0.5;
constexpr int most_pushes = 8;

struct Bone {
  const Part* part;
  CollisionMesh surface;
  Solid solid;
  explicit Bone(const Part& of) : part(&of), surface(of.mesh), solid(of.mesh) {}
};

/// Out of the bone that it lies deepest in; false when it is in none, or no way out is found.
bool push_once(Part& part, const std::vector<Bone>& others, Case& patient) {
  const Bone own(part);
  const Bone* in = nullptr;
  double depth = deep_mm;
  for (const auto& other : others)
    if (const double d = overlap_depth(other.solid, {}, own.solid, {}).depth_mm; d > depth) {
      depth = d;
      in = &other;
    }
  if (!in) return false;
  const PushOut out = push_out({in->surface, in->solid}, {}, {own.surface, own.solid}, {});
  if (out.status != PushOut::Status::found) return false;
  const Eigen::Vector3d way = out.length_mm * out.direction;
  for (auto& v : part.mesh.vertices) v += way;
  patient.notes.push_back(fmt::format(
      "{}: was {:.1f} mm deep inside {} and was moved out by ({:.2f}, {:.2f}, {:.2f}) mm",
      part.name, depth, in->part->name, way.x(), way.y(), way.z()));
  return true;
}

}  // namespace

void push_out_free_parts(Case& patient) {
  std::vector<Bone> others;
  for (const auto& part : patient.parts)
    if (collides(part.role) && body_of(part.role) != Body::free) others.emplace_back(part);
  for (const std::size_t i : free_parts(patient.parts)) {
    for (int k = 0; k < most_pushes && push_once(patient.parts[i], others, patient); ++k) {
    }
    others.emplace_back(patient.parts[i]);
  }
}

}  // namespace condyle
