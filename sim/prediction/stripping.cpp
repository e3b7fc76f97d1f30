#include "sim/prediction/stripping.h"

#include <algorithm>
#include <optional>
#include <string>

#include "engine/mesh/triangle_tree.h"
#include "sim/tissue/model.h"

namespace condyle {
namespace {

/// A cut of the plan as its cut faces, with the bodies of the segments that it made, or a trim.
struct CutSite {
  std::string osteotomy;  // empty: a trim
  TriangleTree faces;
  std::vector<BodyId> segments;
};

TriMesh cut_faces(const Operated& operated, int step) {
  TriMesh faces;
  for (const Part& part : operated.patient.parts) {
    const auto found = operated.origin.find(part.name);
    if (found == operated.origin.end()) continue;
    const SurfaceOrigin& origin = found->second;
    const int first = static_cast<int>(faces.vertices.size());
    faces.vertices.insert(faces.vertices.end(), part.mesh.vertices.begin(),
                          part.mesh.vertices.end());
    for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t)
      if (origin.made_by[t] == step)
        faces.triangles.emplace_back(part.mesh.triangles[t].array() + first);
  }
  return faces;
}

std::string osteotomy_of(const Plan& plan, int step) {
  for (const PlanStep& of : plan.steps)
    if (of.id == step)
      if (const auto* cut = std::get_if<CutStep>(&of.action)) return cut->osteotomy;
  return "";
}

std::vector<CutSite> sites_of(const Operated& operated, const Plan& plan) {
  std::vector<CutSite> sites;
  for (const CutReport& cut : operated.cuts) {
    TriMesh faces = cut_faces(operated, cut.step);
    if (faces.triangles.empty()) continue;
    CutSite site{osteotomy_of(plan, cut.step), TriangleTree(faces), {}};
    for (const CutPiece& piece : cut.pieces)
      if (const auto body = operated.patient.bodies.find(piece.body); body && !piece.stays)
        site.segments.push_back(*body);
    sites.push_back(std::move(site));
  }
  for (const TrimReport& trim : operated.trims)
    if (const TriMesh faces = cut_faces(operated, trim.step); !faces.triangles.empty())
      sites.push_back({"", TriangleTree(faces), {}});
  return sites;
}

/// Finds the piece of a cut bone that a point belongs to.
class PieceFinder {
 public:
  explicit PieceFinder(const CutBone& cut) : cut_(cut), tree_(cut.surface) {}
  BodyId whole() const { return cut_.whole; }
  /// The piece, or none where the bone was resected.
  std::optional<BodyId> owner(const Eigen::Vector3d& p) const {
    const int nearest = tree_.nearest(p).triangle;
    if (!cut_.resected.empty() && cut_.resected[nearest]) return std::nullopt;
    return cut_.owner[nearest];
  }

 private:
  const CutBone& cut_;
  TriangleTree tree_;
};

/// The one body that carries an anchor grown on bone.
BodyId carrier_of(const TissueSupport& support, std::size_t anchor) {
  for (const auto& [body, weight] : support.anchor[anchor])
    if (weight > 0.5) return body;
  return cranium_body;
}

bool holds(const std::vector<BodyId>& bodies, BodyId body) {
  return std::find(bodies.begin(), bodies.end(), body) != bodies.end();
}

}  // namespace

Stripping strip(const TissueModel& tissue, const Operated& operated, const Plan& plan,
                std::span<const CutBone> cuts, const StrippingSettings& settings) {
  const TissueMesh& mesh = *tissue.mesh;
  const TissueSupport& support = tissue.support;
  Stripping result;
  result.settings = settings;
  result.kept.assign(support.kind.size(), 1.0);
  const std::vector<CutSite> sites = sites_of(operated, plan);
  std::vector<PieceFinder> bones(cuts.begin(), cuts.end());
  for (std::size_t i = 0; i < support.kind.size(); ++i) {
    if (support.kind[i] != AnchorKind::bone) continue;
    ++result.attachments;
    const auto bone = std::find_if(bones.begin(), bones.end(), [&](const PieceFinder& of) {
      return of.whole() == carrier_of(support, i);
    });
    if (bone == bones.end()) continue;
    const Eigen::Vector3d& p = mesh.rest[mesh.elements.anchor_node[i]];
    const auto strip_to = [&](double fraction, int& count) {
      result.kept[i] = fraction;
      ++count;
    };
    const std::optional<BodyId> owner = bone->owner(p);
    if (!owner) {
      strip_to(settings.resected, result.resected);
      continue;
    }
    bool near = false, on_maxilla = false, above_chin = false, on_chin = false;
    for (const CutSite& site : sites) {
      const bool of_segment = holds(site.segments, *owner);
      const bool chin = site.osteotomy == "genioplasty";
      on_maxilla = on_maxilla || (of_segment && site.osteotomy == "le_fort_1");
      if (of_segment && chin) {
        on_chin = true;
        continue;
      }
      const double distance = site.faces.nearest(p).distance;
      above_chin = above_chin || (chin && distance < settings.freed_mm);
      near = near || distance < settings.reach_mm;
    }
    if (above_chin)
      strip_to(settings.above_chin, result.above_chin);
    else if (on_maxilla)
      strip_to(settings.on_maxilla, result.on_maxilla);
    else if (on_chin)
      strip_to(settings.on_chin, result.on_chin);
    else if (near)
      strip_to(settings.near_cut, result.near_cuts);
  }
  return result;
}

}  // namespace condyle
