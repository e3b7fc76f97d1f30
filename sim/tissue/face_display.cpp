#include "sim/tissue/face_display.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "engine/math/smooth_step.h"
#include "sim/tissue/tissue_defaults.h"

namespace condyle {
namespace {

/// How strongly the motion of a column is smoothed, by its distance from the mouth.
double evened(double to_mouth_mm) {
  using namespace tissue_defaults;
  return evened_fraction * smooth_step((to_mouth_mm - evened_from_mm) / evened_over_mm);
}

/// See OralFissure::sampled_at: from the edges of the mesh at the corners of the mouth, and at most
/// half as long as the mouth is wide.
double corner_reach(const HandleSet& handles, const Nodes& rest, const MouthOutline& mouth) {
  if (!mouth.found()) return 0;
  // Fitted: with more, 2,000 nodes agree better with 8,000, and the vermilion vanishes at the
  // corners of the open mouth.
  constexpr double over_edge = 1.8;
  double sum = 0;
  int count = 0;
  for (const int corner : {mouth.right_corner, mouth.left_corner})
    for (const int next : handles.ring[corner]) {
      sum += (rest[handles.node[next]] - rest[handles.node[corner]]).norm();
      ++count;
    }
  assert(count > 0);
  const double width =
      (rest[handles.node[mouth.left_corner]] - rest[handles.node[mouth.right_corner]]).norm();
  return std::min(over_edge * sum / count, 0.5 * width);
}

}  // namespace

std::shared_ptr<const FaceDisplay> make_face_display(
    const TissueMesh& mesh, const SkinRegion& region, const CoarseSkin& skin,
    const std::vector<Column>& columns, const std::vector<signed char>& side, const TriMesh& face) {
  auto made = std::make_shared<FaceDisplay>();
  made->region = region.shape;
  made->fissure = region.fissure;
  made->handles = make_handles(mesh.triangles, mesh.sheets, mesh.rest);
  made->handle_side = side;
  made->corner_reach_mm = corner_reach(made->handles, mesh.rest, skin.mouth);
  for (std::size_t c = 0; c < columns.size(); ++c)
    made->handle_evened.push_back(skin.rim[c] || skin.border[c] ? 0 : evened(columns[c].to_mouth));
  made->face_rest = face.vertices;
  made->face_side = region.face_side;
  for (std::size_t v = 0; v < made->face_rest.size(); ++v) {
    const CarriedPoint point =
        carry_face_point(mesh, *made, region.carried_at[v], made->face_side[v]);
    if (point.fade <= 0) continue;
    made->carried_vertex.push_back(static_cast<int>(v));
    made->carried.push_back(point);
    made->carried_from.push_back(
        made->fissure.sampled_at(made->face_rest[v], made->corner_reach_mm));
  }
  return made;
}

}  // namespace condyle
