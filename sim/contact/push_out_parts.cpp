#include "sim/contact/push_out_parts.h"

#include <fmt/core.h>

#include "engine/collide/depenetration.h"
#include "engine/mesh/measure.h"
#include "sim/frame/body_poses.h"

namespace condyle {
namespace {

constexpr double min_depth_mm = 0.5;

struct Bone {
  const Part* part;
  CollisionMesh surface;
  Solid solid;
  explicit Bone(const Part& of) : part(&of), surface(of.mesh), solid(of.mesh) {}
};

/// The bone that it lies deepest in; none if it is outside all.
struct Inside {
  const Bone* bone = nullptr;
  double depth_mm = min_depth_mm;
};
Inside deepest_bone(const Bone& own, const std::vector<Bone>& others) {
  Inside in;
  for (const auto& other : others)
    if (const double d = overlap_depth(other.solid, {}, own.solid, {}).depth_mm; d > in.depth_mm)
      in = {&other, d};
  return in;
}

/// Whether it is enclosed by another's surfaces.
bool box_within(const TriMesh& mesh, const TriMesh& other) {
  const Box box = bounding_box(mesh), around = bounding_box(other);
  return around.contains(box.low) && around.contains(box.high);
}

/// Out of all closed bones at once: leaving one alone could lead into the next.
void push(Part& part, const std::vector<Bone>& others, Case& patient) {
  const Bone own(part);
  const Inside in = deepest_bone(own, others);
  if (!in.bone) {
    for (const auto& other : others)
      if (other.solid.open_shell_count() > 0 && box_within(part.mesh, other.part->mesh))
        patient.notes.push_back(
            fmt::format("{}: was not moved: {} is an open surface without an inside to "
                        "push it out of",
                        part.name, other.part->name));
    return;
  }
  TriMesh together;
  for (const auto& other : others) {
    if (other.solid.open_shell_count() > 0) continue;
    const auto first = static_cast<int>(together.vertices.size());
    const TriMesh& mesh = other.part->mesh;
    together.vertices.insert(together.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const auto& t : mesh.triangles)
      together.triangles.push_back(t + Eigen::Vector3i::Constant(first));
  }
  Depenetration out;
  if (!together.empty()) {
    const CollisionMesh surface(together);
    const Solid solid(together);
    out = push_out({surface, solid}, {}, {own.surface, own.solid}, {});
  }
  if (out.status != Depenetration::Status::found) {
    patient.notes.push_back(
        fmt::format("{}: lies {:.1f} mm deep inside {}, and no exit from all bones was found; "
                    "move it by hand",
                    part.name, in.depth_mm, in.bone->part->name));
    return;
  }
  const Eigen::Vector3d shift = out.length_mm * out.direction;
  for (auto& v : part.mesh.vertices) v += shift;
  patient.notes.push_back(fmt::format(
      "{}: was {:.1f} mm deep inside {} and was moved out by ({:.2f}, {:.2f}, {:.2f}) mm",
      part.name, in.depth_mm, in.bone->part->name, shift.x(), shift.y(), shift.z()));
}

}  // namespace

void push_out_pieces(Case& patient) {
  std::vector<Bone> others;
  std::vector<Part*> pieces;
  for (auto& part : patient.parts)
    if (patient.bodies.roams(part.body))
      pieces.push_back(&part);
    else if (collides(part.role))
      others.emplace_back(part);
  for (Part* piece : pieces) {
    push(*piece, others, patient);
    others.emplace_back(*piece);
  }
}

}  // namespace condyle
