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
  if (!origin) return mesh;
  std::vector<Eigen::Vector3i> kept;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (origin->triangle[i] >= 0) kept.push_back(mesh.triangles[i]);
  mesh.triangles = std::move(kept);
  return mesh;
}

/// The body of each triangle of an uncut bone: of the piece that its centre lies on.
std::vector<BodyId> owners_of(const TriMesh& surface, const Operated& operated,
                              const std::vector<BodyId>& bodies) {
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
  std::vector<BodyId> owners;
  owners.reserve(surface.triangles.size());
  for (const auto& t : surface.triangles) {
    const Eigen::Vector3d center =
        (surface.vertices[t[0]] + surface.vertices[t[1]] + surface.vertices[t[2]]) / 3;
    double nearest = std::numeric_limits<double>::infinity();
    BodyId owner = bodies.front();
    for (const Surface& candidate : surfaces) {
      const SurfacePoint found = candidate.tree.nearest(center, nearest);
      if (found.triangle < 0 || found.distance >= nearest) continue;
      nearest = found.distance;
      owner = candidate.body;
    }
    owners.push_back(owner);
  }
  return owners;
}

/// The bodies of the operated patient that were made from one of the uncut one, itself first.
std::vector<BodyId> bodies_from(const Case& uncut, BodyId whole, const Operated& operated) {
  std::set<std::string> parts;
  for (const Part& part : uncut.parts)
    if (part.body == whole && collides(part.role)) parts.insert(part.name);
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

}  // namespace

OperatedTissue operated_tissue(const Case& uncut, const std::shared_ptr<const TissueModel>& tissue,
                               const Operated& operated, const Plan& plan,
                               const StrippingSettings& stripping, int threads) {
  std::vector<CutBone> cuts;
  for (const BodyId whole : {uncut.jaw.upper_arch, uncut.jaw.lower_arch}) {
    const std::vector<BodyId> bodies = bodies_from(uncut, whole, operated);
    if (bodies.size() < 2) continue;
    CutBone cut;
    cut.whole = whole;
    cut.septum = whole == uncut.jaw.upper_arch ? stripping.septum : 0;
    cut.surface = jaw_mesh(uncut, whole);
    cut.owner = owners_of(cut.surface, operated, bodies);
    for (const BodyId body : bodies) {
      TriMesh mesh = jaw_mesh(operated.patient, body);
      if (!mesh.empty()) cut.pieces.push_back({body, std::move(mesh)});
    }
    cuts.push_back(std::move(cut));
  }
  OperatedTissue operated_tissue{tissue, strip(*tissue, operated, plan, cuts, stripping)};
  if (cuts.empty()) return operated_tissue;
  operated_tissue.model = carry_to_pieces(*strip_anchors(tissue, operated_tissue.stripping.kept),
                                          cuts, operated.patient.jaw, threads);
  return operated_tissue;
}

}  // namespace condyle
