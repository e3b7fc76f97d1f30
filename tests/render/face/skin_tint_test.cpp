// A face whose colours are not known has red lips about its mouth's rim, and skin elsewhere.
#include "render/face/skin_tint.h"

#include "render/face/drawn_face.h"
#include "render/face/mouth_lining.h"
#include "tests/render/face/slit_head.h"

namespace condyle {
namespace {

const Eigen::Vector3f skin = {.83f, .65f, .55f};

float redness(const Eigen::Vector3f& color) { return (color.x() - color.y()) / color.x(); }

TEST(SkinTint, IsTheRedOfLipsAboutTheMouthAndOfSkinElsewhere) {
  const auto parts = head_with_slit(ball({0, 0, 0}, 60, 90));
  const TriMesh& face = parts[0].mesh;
  const auto lining = line_mouth(parts);
  ASSERT_TRUE(lining);
  std::vector<Eigen::Vector3f> colors(face.vertices.size(), skin);
  tint_skin(face, lining->rim, colors);
  int lips = 0, others = 0;
  for (std::size_t v = 0; v < colors.size(); ++v) {
    const auto& p = face.vertices[v];
    if (p.y() > 40) {
      EXPECT_EQ(colors[v], skin) << p.transpose();
    } else if (std::abs(p.x()) < 8 && std::abs(p.z()) > 3 && std::abs(p.z()) < 7) {
      EXPECT_GT(redness(colors[v]), 0.38f) << p.transpose();
      ++lips;
    } else if (std::abs(p.z()) > 14 || std::abs(p.x()) > 28) {
      EXPECT_LT(redness(colors[v]), redness(skin) + 0.08f) << p.transpose();
      ++others;
    }
  }
  for (const int v : lining->rim)
    EXPECT_GT(redness(colors[static_cast<std::size_t>(v)]), 0.38f)
        << face.vertices[static_cast<std::size_t>(v)].transpose();
  EXPECT_GT(lips, 20);
  EXPECT_GT(others, 1000);
}

TEST(SkinTint, IsNotGivenToAFaceThatHasColoursOfItsOwn) {
  auto parts = head_with_slit(ball({0, 0, 0}, 60, 90));
  const auto reddest = [&] {
    const PreparedParts prepared(parts);
    float most = 0;
    for (const auto& color : prepared.drawn(parts[0]).mesh.colors)
      most = std::max(most, redness(color));
    return most;
  };
  EXPECT_GT(reddest(), 0.38f);
  parts[0].mesh.colors.assign(parts[0].mesh.vertices.size(), skin);
  EXPECT_NEAR(reddest(), redness(skin), 1e-4f);
}

}  // namespace
}  // namespace condyle
