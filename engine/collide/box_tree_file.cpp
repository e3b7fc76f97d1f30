#include <cstdint>

#include "engine/collide/box_tree.h"
#include "engine/core/archive.h"
#include "engine/core/user_cache.h"
#include "engine/mesh/shape_key.h"

namespace condyle {

template <>
struct IsFlat<BoxPair> : std::true_type {
  static_assert(sizeof(BoxPair) == 30 * sizeof(float) + 2 * sizeof(int), "no padding");
};

BoxTree BoxTree::stored(const TriMesh& mesh, const std::filesystem::path& cache) {
  constexpr std::size_t few = 2000;  // built as fast as a file is opened and checked
  const std::size_t count = mesh.triangles.size();
  if (cache.empty() || count < few) return BoxTree(mesh);
  const ResultCache results(cache, "boxes");
  const std::uint64_t inputs = shape_key(mesh);
  if (const auto bytes = results.read(inputs)) {
    BoxTree tree;
    ArchiveReader reader(*bytes);
    reader(tree.boxes, tree.region, tree.reach_mm);
    if (reader.complete() && tree.boxes.size() == count && tree.region.size() == count) return tree;
  }
  BoxTree tree(mesh);
  ArchiveWriter writer;
  writer(tree.boxes, tree.region, tree.reach_mm);
  results.write(inputs, writer.take());
  return tree;
}

}  // namespace condyle
