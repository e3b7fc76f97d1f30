#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/topology.h"
#include "engine/mesh_io/mesh_files.h"
#include "tests/support/places.h"

namespace condyle {
namespace {

std::filesystem::path data() { return test::source_folder() / "../shared/data"; }

/// The figures are those of the data's own notes, determined by other programs.
TEST(RealMesh, TopologyIsAsDescribed) {
  if (!std::filesystem::exists(data())) GTEST_SKIP() << "real anatomy absent";
  struct Known {
    const char* file;
    std::size_t triangles;
    int components, boundary, nonmanifold;
    double volume_cm3;  // 0 = open
  };
  for (const auto& known : {Known{"case-ubc/mandible.ply", 41760, 1, 0, 0, 57.6},
                            Known{"case-ubc/upper_teeth.ply", 5552, 16, 0, 0, 5.9},
                            Known{"case-ubc/lower_teeth.ply", 16070, 16, 0, 0, 5.1},
                            Known{"case-ubc/maxilla.ply", 12292, 3, 2230, 14, 0},
                            Known{"case-ubc/maxilla_with_teeth_wrap_30k.ply", 29998, 1, 0, 0, 15.6},
                            Known{"case-badin/maxilla_capped.ply", 5966, 1, 0, 0, 98.5},
                            Known{"case-badin/face_skin.ply", 4122, 1, 246, 0, 0},
                            Known{"ct-cranium/skull_iso300.ply", 119831, 1, 501, 0, 0},
                            Known{"scan-leeperrysmith/head_lps_mm.ply", 17672, 1, 0, 0, 9667.3}}) {
    SCOPED_TRACE(known.file);
    const TriMesh mesh = read_mesh(data() / known.file);
    const Topology found = inspect(mesh);
    EXPECT_EQ(mesh.triangles.size(), known.triangles);
    EXPECT_EQ(found.components, known.components);
    EXPECT_EQ(found.boundary_edges, known.boundary);
    EXPECT_EQ(found.nonmanifold_edges, known.nonmanifold);
    if (known.volume_cm3 > 0) {
      EXPECT_NEAR(found.volume_mm3 / 1000, known.volume_cm3, 0.051);
    }
  }
}

TEST(RealMesh, OneHeadInThreeFormatsIsOneSurface) {
  const auto folder = data() / "scan-leeperrysmith";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "real anatomy absent";
  const TriMesh ply = read_mesh(folder / "head_lps_mm.ply");
  const TriMesh obj = read_mesh(folder / "head_lps_mm.obj");
  TriMesh glb = read_mesh(folder / "LeePerrySmith.glb");
  weld(glb);  // split along the seams of its texture
  EXPECT_EQ(obj.triangles.size(), ply.triangles.size());
  EXPECT_EQ(glb.triangles.size(), ply.triangles.size());
  EXPECT_EQ(obj.vertices.size(), ply.vertices.size());
  EXPECT_TRUE(inspect(glb).closed());
  for (std::size_t i = 0; i < ply.vertices.size(); ++i)
    ASSERT_LT((obj.vertices[i] - ply.vertices[i]).norm(), 1e-4);
  // The GLB is in metres with y up, facing z.
  for (auto& v : glb.vertices) v = 1000 * Eigen::Vector3d(v.x(), -v.z(), v.y());
  EXPECT_LT((bounding_box(glb).low - bounding_box(ply).low).norm(), 1e-2);
  EXPECT_NEAR(signed_volume(glb), signed_volume(ply), 1e-5 * signed_volume(ply));
}

TEST(RealMesh, DracoIsRefusedInWords) {
  const auto file = data() / "scan-leeperrysmith" / "LeePerrySmith_draco.glb";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "real anatomy absent";
  try {
    read_mesh(file);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("compressed with Draco"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace condyle
