#include "sim/tissue/face_display.h"

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

}  // namespace

std::shared_ptr<const FaceDisplay> make_face_display(
    const TissueMesh& mesh, const SkinRegion& region, const CoarseSkin& skin,
    const std::vector<Column>& columns, const std::vector<signed char>& side, const TriMesh& face) {
  auto made = std::make_shared<FaceDisplay>();
  made->region = region.shape;
  made->fissure = region.fissure;
  made->handles = make_handles(mesh.triangles, mesh.sheets, mesh.rest);
  made->handle_side = side;
  for (std::size_t c = 0; c < columns.size(); ++c)
    made->handle_evened.push_back(skin.rim[c] || skin.border[c] ? 0 : evened(columns[c].to_mouth));
  made->face_rest = face.vertices;
  made->face_side = region.face_side;
  for (std::size_t v = 0; v < made->face_rest.size(); ++v) {
    const CarriedPoint point =
        carry_face_point(mesh, *made, made->face_rest[v], made->face_side[v]);
    if (point.fade <= 0) continue;
    made->carried_vertex.push_back(static_cast<int>(v));
    made->carried.push_back(point);
  }
  return made;
}

}  // namespace condyle
