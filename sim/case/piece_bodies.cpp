#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/case/import_checks.h"

namespace condyle {
namespace {

/// Distance from the part's vertices to the nearest bone or teeth of a body; infinite without any.
double distance_to_body(const Case& patient, const Part& part, BodyId body) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& other : patient.parts) {
    if (is_piece(other.role) || other.body != body || !collides(other.role)) continue;
    const TriangleTree tree(other.mesh);
    for (const auto& v : part.mesh.vertices)
      nearest = std::min(nearest, tree.nearest(v, nearest).distance);
  }
  return nearest;
}

/// Depth of a vertex of the part in a bone or tooth of the body, mm; 0 outside all. The inside of
/// an open surface is approximate.
struct Inside {
  double depth_mm = 0;
  bool open = false;
};
Inside depth_in_body(const Case& patient, const Part& part, BodyId body) {
  Inside deepest;
  for (const auto& other : patient.parts) {
    if (is_piece(other.role) || other.body != body || !collides(other.role)) continue;
    const TriangleTree tree(other.mesh);
    const Box box = bounding_box(other.mesh);
    double depth = 0;
    for (const auto& v : part.mesh.vertices)
      if (box.contains(v, 0) && tree.winding_number(v) > 0.5)
        depth = std::max(depth, tree.nearest(v).distance);
    if (depth > deepest.depth_mm) deepest = {depth, !inspect(other.mesh).closed()};
  }
  return deepest;
}

/// The cranium or the mandible, whichever is nearer, with a note.
BodyId nearer_jaw(Case& patient, const Part& part) {
  const double to_cranium = distance_to_body(patient, part, cranium_body),
               to_mandible = distance_to_body(patient, part, mandible_body);
  const bool lower = to_mandible < to_cranium;
  const BodyId parent = lower ? mandible_body : cranium_body;
  constexpr double deep_mm = 0.5;
  const Inside inside = depth_in_body(patient, part, parent);
  const bool deep = inside.depth_mm > deep_mm;
  const std::string where = deep ? fmt::format("{:.1f} mm deep inside", inside.depth_mm)
                                 : fmt::format("{:.1f} mm from", std::min(to_cranium, to_mandible));
  const std::string exit_text = !deep         ? ""
                                : inside.open ? "; that surface is open, so no exit can be "
                                                "found: close it, or move the part by hand"
                                              : ", --push-out moves it out";
  const char *name = lower ? "mandible" : "cranium", *other = lower ? "cranium" : "mandible";
  patient.notes.push_back(
      fmt::format("{}: lies {} the {} and moves with it; --carrier-of {}={} would change "
                  "that{}",
                  part.name, where, name, part.name, other, exit_text));
  return parent;
}

void refuse_unknown(const Case& patient, const std::map<std::string, std::string>& asked) {
  std::string pieces;
  const auto is_known_piece = [&](const std::string& name) {
    return std::any_of(patient.parts.begin(), patient.parts.end(),
                       [&](const Part& part) { return part.name == name && is_piece(part.role); });
  };
  for (const auto& part : patient.parts)
    if (is_piece(part.role)) pieces += (pieces.empty() ? "" : ", ") + part.name;
  for (const auto& [name, parent] : asked) {
    const std::string option = "--carrier-of " + name + "=" + parent + ": ";
    if (!is_known_piece(name))
      throw InputError(option + "no segment or transplant is named \"" + name + "\"; " +
                       (pieces.empty() ? "the patient has none" : "there are " + pieces));
    if (!patient.bodies.find(parent) && !is_known_piece(parent))
      throw InputError(option + "\"" + parent + "\" is no body; there are cranium, mandible, " +
                       pieces);
  }
}

}  // namespace

void make_piece_bodies(Case& patient, const std::map<std::string, std::string>& asked) {
  refuse_unknown(patient, asked);
  // In the order of the parts, each as soon as its parent exists.
  std::vector<Part*> waiting;
  for (auto& part : patient.parts)
    if (is_piece(part.role)) waiting.push_back(&part);
  while (!waiting.empty()) {
    const std::size_t before = waiting.size();
    std::erase_if(waiting, [&](Part* part) {
      const auto named = asked.find(part->name);
      const auto parent = named == asked.end() ? std::optional(nearer_jaw(patient, *part))
                                               : patient.bodies.find(named->second);
      if (!parent) return false;
      part->body =
          patient.bodies.add({.name = part->name, .parent = *parent, .driver = BodyDriver::hand});
      return true;
    });
    if (waiting.size() == before)
      throw InputError("--carrier-of " + waiting[0]->name + "=" + asked.at(waiting[0]->name) +
                       ": pieces cannot be parents of each other");
  }
}

}  // namespace condyle
