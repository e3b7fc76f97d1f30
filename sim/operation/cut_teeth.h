#pragma once

#include <span>
#include <vector>

#include "engine/cut/cut.h"
#include "sim/frame/part.h"

namespace condyle {

/// A tooth of an arch, or a connected piece of an arch whose teeth are not separate.
struct ArchItem {
  int fdi = 0;  // 0: not known
  std::vector<int> triangles;
};
/// All triangles of the part, each in one item.
std::vector<ArchItem> arch_items(const Part& part);

/// Corners and centres of its triangles, at most about `most` of them.
std::vector<Eigen::Vector3d> sample_points(const TriMesh& mesh, std::span<const int> triangles,
                                           std::size_t most);

/// throws: InputError naming the first tooth of the part through which a cut runs, by its FDI
/// number or place. `removed`: numbers of those that may be divided.
void refuse_divided_teeth(const Part& teeth, std::span<const Cut> cuts,
                          std::span<const int> removed = {});

/// The items for which `of_item` has this value, as a part with its own vertices and ranges of
/// teeth; name, role and body are those of the whole.
Part items_of_part(const Part& whole, std::span<const ArchItem> items, std::span<const int> of_item,
                   int value);

}  // namespace condyle
