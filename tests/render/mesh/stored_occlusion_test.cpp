#include <gtest/gtest.h>

#include "engine/core/files.h"
#include "render/mesh/ambient_occlusion.h"
#include "render/mesh/vertex_normals.h"
#include "tests/support/program.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

TEST(StoredOcclusion, IsTheSameAndMadeAgainWhereDamaged) {
  const TriMesh mesh = test::sphere(3, 5);
  std::vector<Eigen::Vector3f> vertices, normals;
  for (const auto& v : mesh.vertices) vertices.push_back(v.cast<float>());
  vertex_normals(vertices, mesh.triangles, normals);
  // A second sphere shades the first.
  std::vector<Eigen::Vector3f> beside = vertices;
  for (auto& v : beside) v.x() += 11;
  const std::vector<OcclusionSurface> surfaces{
      {.vertices = vertices, .normals = normals, .triangles = mesh.triangles, .together = 3},
      {.vertices = beside, .normals = normals, .triangles = mesh.triangles, .layer = 1}};
  const auto expected = bake_occlusion(surfaces, 16, 2);
  EXPECT_NE(expected[0].alone, expected[0].together);
  const test::Folder cache;
  const auto expect_same = [&] {
    const auto stored = stored_occlusion(cache.path(), surfaces, 16, 2);
    ASSERT_EQ(stored.size(), expected.size());
    for (std::size_t s = 0; s < stored.size(); ++s) {
      EXPECT_EQ(stored[s].alone, expected[s].alone);
      EXPECT_EQ(stored[s].together, expected[s].together);
    }
  };
  expect_same();
  const fs::path file = fs::directory_iterator(cache.path())->path();
  const std::string whole = read_file(file);
  const test::Folder links;
  fs::create_hard_link(file, links.path() / "link");
  expect_same();
  EXPECT_EQ(fs::hard_link_count(file), 2u) << "read; a file that is made again replaces it";
  std::string damaged = whole;
  damaged[100] ^= 1;
  write_file(file, damaged);
  expect_same();
  EXPECT_EQ(read_file(file), whole);
  stored_occlusion(cache.path(), surfaces, 12, 2);
  EXPECT_EQ(std::distance(fs::directory_iterator(cache.path()), fs::directory_iterator()), 2);
}

}  // namespace
}  // namespace condyle
