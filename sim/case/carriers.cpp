#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/case/import_checks.h"

namespace condyle {
namespace {

/// Distance from the part's vertices to the nearest bone or teeth of a body; infinite without any.
double distance_to_body(const Case& patient, const Part& part, Body body) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& other : patient.parts) {
    if (body_of(other.role) != body || !collides(other.role)) continue;
    const TriangleTree tree(other.mesh);
    for (const auto& v : part.mesh.vertices)
      nearest = std::min(nearest, tree.nearest(v, nearest).distance);
  }
  return nearest;
}

/// How deep a vertex of the part lies in a bone or tooth of the body, mm; 0 outside all. An open
/// surface has an inside in rough terms only.
struct Inside {
  double depth_mm = 0;
  bool open = false;
};
Inside depth_in_body(const Case& patient, const Part& part, Body body) {
  Inside deepest;
  for (const auto& other : patient.parts) {
    if (body_of(other.role) != body || !collides(other.role)) continue;
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

}  // namespace

void choose_carriers(Case& patient, const std::map<std::string, Body>& asked) {
  std::string free;
  for (auto& part : patient.parts) {
    if (body_of(part.role) != Body::free) continue;
    free += (free.empty() ? "" : ", ") + part.name;
    if (const auto found = asked.find(part.name); found != asked.end()) {
      part.carrier = found->second;
      continue;
    }
    const double to_cranium = distance_to_body(patient, part, Body::cranium),
                 to_mandible = distance_to_body(patient, part, Body::mandible);
    part.carrier = to_mandible < to_cranium ? Body::mandible : Body::cranium;
    constexpr double deep_mm = 0.5;
    const Inside inside = depth_in_body(patient, part, part.carrier);
    const bool deep = inside.depth_mm > deep_mm;
    const std::string where =
        deep ? fmt::format("{:.1f} mm deep inside", inside.depth_mm)
             : fmt::format("{:.1f} mm from", std::min(to_cranium, to_mandible));
    const std::string way_out = !deep         ? ""
                                : inside.open ? "; that surface is open, so no way out can be "
                                                "told: close it, or move the part by hand"
                                              : ", --push-out moves it out";
    patient.notes.push_back(fmt::format(
        "{}: lies {} the {} and goes along with it; --carrier-of {}={} would change "
        "that{}",
        part.name, where, carrier_name(part.carrier), part.name,
        carrier_name(part.carrier == Body::mandible ? Body::cranium : Body::mandible), way_out));
  }
  for (const auto& [name, body] : asked) {
    const auto named = [&](const Part& part) {
      return part.name == name && body_of(part.role) == Body::free;
    };
    if (std::none_of(patient.parts.begin(), patient.parts.end(), named))
      throw InputError("--carrier-of " + name + "=" + carrier_name(body) +
                       ": no segment or transplant has that name; there are " +
                       (free.empty() ? "none" : free));
  }
}

}  // namespace condyle
