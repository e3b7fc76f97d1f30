// Real bones as they are delivered: the skull of a CT scan that ends below, open upper jaws.
#include "sim/operation/closed_bone.h"

#include <gtest/gtest.h>

#include "engine/cut/cell_complex.h"
#include "engine/cut/cut.h"
#include "engine/mesh_io/mesh_files.h"
#include "tests/support/real_cases.h"

namespace condyle {
namespace {

Part delivered(const char* file) {
  Part part;
  part.name = "bone";
  part.mesh = read_mesh(test::real_data() / file);
  return part;
}

TEST(ClosedBone, TheScanEndOfARealSkullIsCappedAndTheRestStays) {
  if (!std::filesystem::exists(test::real_data())) GTEST_SKIP() << "no " << test::real_data();
  const Part skull = delivered("ct-cranium/skull_iso300.ply");
  EXPECT_GT(unbalanced_edges(skull.mesh), 400);
  const ClosedBone bone = closed_bone(skull);
  ASSERT_EQ(bone.notes.size(), 1u);
  EXPECT_NE(bone.notes[0].find("12 flat rims"), std::string::npos) << bone.notes[0];
  EXPECT_EQ(unbalanced_edges(bone.mesh), 0);
  int caps = 0;
  for (std::size_t i = 0; i < bone.source.size(); ++i)
    if (bone.source[i] < 0)
      for (const int v : bone.mesh.triangles[i]) caps += std::abs(bone.mesh.vertices[v].z()) < 0.5;
  EXPECT_GT(caps, 3 * 450) << "corners of caps, where the scan ends";
  const std::vector<Cut> cuts{{"vault", Region::above({Eigen::Vector3d::UnitZ(), 110}), {}, 1.2}};
  const CutResult cut = cut_bone(bone.mesh, cuts);
  EXPECT_TRUE(cut.outcomes[0].through);
}

TEST(ClosedBone, AnOpenUpperJawIsWrappedAndTraced) {
  if (!std::filesystem::exists(test::real_data())) GTEST_SKIP() << "no " << test::real_data();
  const Part maxilla = delivered("case-badin/maxilla.ply");
  const ClosedBone bone = closed_bone(maxilla);
  ASSERT_EQ(bone.notes.size(), 1u);
  EXPECT_NE(bone.notes[0].find("bone: its surface is open or turned at 160 edges; it was wrapped"),
            std::string::npos)
      << bone.notes[0];
  EXPECT_EQ(unbalanced_edges(bone.mesh), 0);
  std::size_t traced = 0;
  for (std::size_t i = 0; i < bone.source.size(); ++i) {
    if (bone.source[i] < 0) continue;
    ++traced;
    const auto &t = bone.mesh.triangles[i], &o = maxilla.mesh.triangles[bone.source[i]];
    // Edges of the original are at most 12 mm long.
    EXPECT_LT((bone.mesh.vertices[t[0]] - maxilla.mesh.vertices[o[0]]).norm(), 15);
  }
  EXPECT_GT(traced, bone.source.size() / 2);
  EXPECT_LT(traced, bone.source.size()) << "the lid has no origin";
  const ClosedBone again = closed_bone(maxilla);
  EXPECT_EQ(again.source, bone.source);
  EXPECT_EQ(again.mesh.vertices, bone.mesh.vertices);
}

}  // namespace
}  // namespace condyle
