#pragma once

#include "sim/tissue/columns.h"
#include "sim/tissue/model.h"

namespace condyle {

/// How the columns carry the face's vertices. `side` of each column: +1 above the lip line.
std::shared_ptr<const FaceDisplay> make_face_display(
    const TissueMesh& mesh, const SkinRegion& region, const CoarseSkin& skin,
    const std::vector<Column>& columns, const std::vector<signed char>& side, const TriMesh& face);

}  // namespace condyle
