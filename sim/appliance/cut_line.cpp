#include "sim/appliance/cut_line.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/similar_word.h"
#include "engine/mesh/topology.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double parallel_cos = 0.9999, on_wall_mm = 0.01;

const PlanStep& find_cut_step(const Plan& plan, const std::string& cut) {
  std::vector<std::string> known;
  std::vector<const PlanStep*> found;
  for (const PlanStep& step : plan.steps) {
    const auto* action = std::get_if<CutStep>(&step.action);
    if (!action) continue;
    const std::string name = action->osteotomy.empty()
                                 ? fmt::format("{}", fmt::join(action->pieces, "+"))
                                 : action->osteotomy;
    known.push_back(fmt::format("{} ({})", step.id, name));
    const bool makes =
        std::find(action->pieces.begin(), action->pieces.end(), cut) != action->pieces.end();
    if (std::to_string(step.id) == cut || name == cut || makes) found.push_back(&step);
  }
  if (known.empty()) throw InputError("the plan has no cut: a guide leads the saw of a cut");
  if (found.empty())
    throw InputError(
        fmt::format("the plan has no cut \"{}\"; it has {}", cut, fmt::join(known, ", ")));
  if (found.size() > 1)
    throw InputError(
        fmt::format("the plan has {} cuts \"{}\": name the step by its number; it has {}",
                    found.size(), cut, fmt::join(known, ", ")));
  return *found.front();
}

/// Collects the borders of cut faces of one step, by bone.
class LineReader {
 public:
  LineReader(const Operated& operated, CutLine& line) : line_(line) {
    for (const SawCut& saw : operated.saw_cuts)
      if (saw.step == line.step)
        for (const Region::Leaf& leaf : saw.cut.above.leaves())
          planes_.push_back({leaf.plane, 0.5 * saw.cut.kerf_mm, -1});
  }

  void read(const TriMesh& bone, const SurfaceOrigin& origin) {
    for (const Edge& edge : find_edges_of(bone)) {
      if (edge.count != 2) continue;
      const int a = edges_.sides[edge.first].triangle, b = edges_.sides[edge.first + 1].triangle;
      const bool cut_a = origin.made_by[a] == line_.step, cut_b = origin.made_by[b] == line_.step;
      if (cut_a == cut_b) continue;
      const int face = cut_a ? a : b, outside = cut_a ? b : a;
      if (origin.made_by[outside] != 0) continue;
      const Vector3d p = bone.vertices[edge.low], q = bone.vertices[edge.high];
      const int wall = wall_of(normal_of(bone, face), 0.5 * (p + q));
      if (wall < 0 || (q - p).norm() < 1e-6) continue;
      edges_of_[origin.part].push_back(
          {0.5 * (p + q), normal_of(bone, outside), (q - p).norm(), wall});
    }
  }

  /// The edges of one bone, that with the longest line where `on` is empty.
  void choose(const std::string& on) {
    for (const auto& [name, edges] : edges_of_) {
      double length = 0;  // both borders of the kerf have edges
      for (const CutEdge& edge : edges) length += 0.5 * edge.length_mm;
      line_.bones.push_back({name, length});
    }
    std::stable_sort(
        line_.bones.begin(), line_.bones.end(),
        [](const CrossedBone& a, const CrossedBone& b) { return a.length_mm > b.length_mm; });
    line_.bone = on.empty() ? line_.bones.front().name : on;
    const auto found = edges_of_.find(line_.bone);
    if (found != edges_of_.end()) {
      line_.edges = std::move(found->second);
      return;
    }
    std::vector<std::string> names;
    for (const CrossedBone& bone : line_.bones) names.push_back(bone.name);
    throw InputError(fmt::format("{} does not pass through a bone \"{}\"; it passes through {}",
                                 line_.title, on, fmt::join(names, ", ")));
  }
  bool empty() const { return edges_of_.empty(); }

 private:
  struct WallPlane {
    Plane plane;
    double half_kerf;
    int wall;  // in the line, -1: not used yet
  };

  const std::vector<Edge>& find_edges_of(const TriMesh& bone) {
    edges_ = find_edges(bone);
    return edges_.edges;
  }
  static Vector3d normal_of(const TriMesh& mesh, int t) {
    const auto& v = mesh.triangles[t];
    return (mesh.vertices[v[1]] - mesh.vertices[v[0]])
        .cross(mesh.vertices[v[2]] - mesh.vertices[v[0]])
        .normalized();
  }
  int wall_of(const Vector3d& normal, const Vector3d& p) {
    for (WallPlane& each : planes_) {
      if (std::abs(each.plane.normal.dot(normal)) < parallel_cos) continue;
      if (std::abs(std::abs(each.plane.distance(p)) - each.half_kerf) > on_wall_mm) continue;
      if (each.wall < 0) {
        each.wall = static_cast<int>(line_.walls.size());
        line_.walls.push_back(each.plane);
      }
      return each.wall;
    }
    return -1;
  }

  CutLine& line_;
  std::vector<WallPlane> planes_;
  EdgeList edges_;
  std::map<std::string, std::vector<CutEdge>> edges_of_;
};

}  // namespace

CutLine find_cut_line(const Operated& operated, const Plan& plan, const std::string& cut,
                      const std::string& on) {
  const PlanStep& step = find_cut_step(plan, cut);
  CutLine line;
  line.step = step.id;
  line.title = step_title(step.action);
  LineReader reader(operated, line);
  for (const Part& part : operated.patient.parts)
    if (const auto origin = operated.origin.find(part.name);
        origin != operated.origin.end() && part.role != Role::transplant)
      reader.read(part.mesh, origin->second);
  for (const Resection& resection : operated.resections)
    reader.read(resection.bone, resection.origin);
  if (reader.empty())
    throw InputError(fmt::format("{} leaves no line on the surface of a bone", step_name(step)));
  reader.choose(on);
  return line;
}

}  // namespace condyle
