#include "sim/prediction/operated_tissue.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "engine/mesh/triangle_tree.h"
#include "sim/tissue/anatomy.h"
#include "sim/tissue/pieces.h"
#include "sim/tissue/strip.h"

namespace condyle {
namespace {

/// The bone of a body's part that was there before the cuts.
TriMesh uncut_surface(const Part& part, const SurfaceOrigin* origin) {
  TriMesh mesh = part.mesh;
  if (!origin || origin->triangle.size() != mesh.triangles.size()) return mesh;
  std::vector<Eigen::Vector3i> kept;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (origin->triangle[i] >= 0) kept.push_back(mesh.triangles[i]);
  mesh.triangles = std::move(kept);
  return mesh;
}

/// Sets the body of each triangle of an uncut bone, of the piece that its centre lies on, and
/// whether it lies on bone that was resected.
void find_owners(const Operated& operated, const std::vector<BodyId>& bodies,
                 const std::vector<const Resection*>& resections, CutBone& cut) {
  struct Surface {
    TriangleTree tree;
    BodyId body;
  };
  std::vector<Surface> surfaces;
  for (const Part& part : operated.patient.parts) {
    if (!collides(part.role) || std::find(bodies.begin(), bodies.end(), part.body) == bodies.end())
      continue;
    const auto origin = operated.origin.find(part.name);
    surfaces.push_back({TriangleTree(uncut_surface(
                            part, origin == operated.origin.end() ? nullptr : &origin->second)),
                        part.body});
  }
  std::vector<TriangleTree> gone;
  for (const Resection* resection : resections)
    for (const Part& part : resection->parts)
      if (collides(part.role))
        gone.emplace_back(uncut_surface(part, is_teeth(part.role) ? nullptr : &resection->origin));
  if (!gone.empty()) cut.resected.reserve(cut.surface.triangles.size());
  for (const auto& t : cut.surface.triangles) {
    const auto& v = cut.surface.vertices;
    const Eigen::Vector3d center = (v[t[0]] + v[t[1]] + v[t[2]]) / 3;
    double nearest = std::numeric_limits<double>::infinity();
    BodyId owner = bodies.front();
    for (const Surface& candidate : surfaces) {
      const SurfacePoint found = candidate.tree.nearest(center, nearest);
      if (found.triangle < 0 || found.distance >= nearest) continue;
      nearest = found.distance;
      owner = candidate.body;
    }
    cut.owner.push_back(owner);
    if (gone.empty()) continue;
    cut.resected.push_back(std::any_of(gone.begin(), gone.end(), [&](const TriangleTree& tree) {
      const SurfacePoint found = tree.nearest(center, nearest);
      return found.triangle >= 0 && found.distance < nearest;
    }));
  }
}

/// Names of the bones and teeth of a body.
std::set<std::string> bones_of(const Case& uncut, BodyId whole) {
  std::set<std::string> parts;
  for (const Part& part : uncut.parts)
    if (part.body == whole && collides(part.role)) parts.insert(part.name);
  return parts;
}

/// The bodies of the operated patient that were made from one of the uncut one, itself first.
std::vector<BodyId> bodies_from(const Case& uncut, BodyId whole, const Operated& operated) {
  const std::set<std::string> parts = bones_of(uncut, whole);
  std::vector<BodyId> bodies;
  if (const auto same = operated.patient.bodies.find(uncut.bodies[whole].name))
    bodies.push_back(*same);
  for (const Part& part : operated.patient.parts) {
    const auto origin = operated.origin.find(part.name);
    if (origin == operated.origin.end() || !parts.contains(origin->second.part)) continue;
    if (std::find(bodies.begin(), bodies.end(), part.body) == bodies.end())
      bodies.push_back(part.body);
  }
  return bodies;
}

/// The pieces of grafts that take the place of bone resected from a body.
std::vector<BodySurface> grafts_for(const std::vector<const Resection*>& resections,
                                    const Operated& operated) {
  std::vector<BodySurface> grafts;
  for (const GraftLayout& graft : operated.grafts)
    if (std::any_of(resections.begin(), resections.end(), [&](const Resection* resection) {
          return resection->segment == graft.step.replaces;
        }))
      for (const GraftPiece& piece : graft.pieces)
        if (const auto body = operated.patient.bodies.find(piece.body))
          grafts.push_back({*body, piece.mesh});
  return grafts;
}

}  // namespace

OperatedTissue operated_tissue(const Case& uncut, const std::shared_ptr<const TissueModel>& tissue,
                               const Operated& operated, const Plan& plan,
                               const StrippingSettings& stripping, int threads) {
  std::vector<CutBone> cuts;
  for (const BodyId whole : {uncut.jaw.upper_arch, uncut.jaw.lower_arch}) {
    const std::vector<BodyId> bodies = bodies_from(uncut, whole, operated);
    const std::set<std::string> parts = bones_of(uncut, whole);
    std::vector<const Resection*> resections;
    for (const Resection& resection : operated.resections)
      if (parts.contains(resection.origin.part)) resections.push_back(&resection);
    if (bodies.empty() || (bodies.size() < 2 && resections.empty())) continue;
    CutBone cut;
    cut.whole = whole;
    cut.septum = whole == uncut.jaw.upper_arch ? stripping.septum : 0;
    cut.surface = jaw_mesh(uncut, whole);
    find_owners(operated, bodies, resections, cut);
    cut.grafts = grafts_for(resections, operated);
    for (const BodyId body : bodies) {
      TriMesh mesh = jaw_mesh(operated.patient, body);
      if (!mesh.empty()) cut.pieces.push_back({body, std::move(mesh)});
    }
    cuts.push_back(std::move(cut));
  }
  OperatedTissue operated_tissue{tissue, strip(*tissue, operated, plan, cuts, stripping)};
  if (cuts.empty()) return operated_tissue;
  operated_tissue.grafted =
      std::any_of(cuts.begin(), cuts.end(), [](const CutBone& cut) { return !cut.grafts.empty(); });
  operated_tissue.model = carry_to_pieces(*strip_anchors(tissue, operated_tissue.stripping.kept),
                                          cuts, operated.patient.jaw, threads);
  return operated_tissue;
}

}  // namespace condyle
