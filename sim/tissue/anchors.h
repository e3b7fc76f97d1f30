#pragma once

#include <vector>

#include "sim/tissue/columns.h"
#include "sim/tissue/model.h"

namespace condyle {

/// Properties of the columns that are known when they are anchored.
struct AnchorSource {
  const CoarseSkin& skin;
  const std::vector<Column>& columns;
  const Bones& bones;
  double finer = 1;           // columns over the default number
  double depth_fraction = 1;  // layers requested over layers of the mesh
  double firmness = 1;        // of all anchors, over the default
};

/// Adds the anchors to the mesh's springs: tissue grown on bone, the rim, free borders of the face,
/// and weak anchors of loose tissue. Fills `anchor`, `kind` and `node` of the support and the
/// counts of the summary. Returns for each node whether it is attached and cannot slide. throws:
/// InputError when nothing holds the tissue.
std::vector<char> add_anchors(const AnchorSource& from, TissueMesh& mesh, TissueSupport& support,
                              TissueSummary& summary);

}  // namespace condyle
