// In a real smile of the built-in patient the cheeks raise the lower lids, in pictures alone; at
// rest and as the jaw opens the lids stay as the tissue has them, bit for bit.
#include "render/life/lower_lid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "engine/mesh/triangle_tree.h"
#include "render/life/living_face.h"
#include "tests/render/face/opened_patient.h"

namespace condyle {
namespace {

using Eigen::Vector3f;

class LowerLidTest : public testing::Test {
 protected:
  const OpenedPatient& patient_ = opened_patient();
  LivingFace living_{patient_.scene.patient.parts, patient_.rest, patient_.face->mesh.triangles,
                     std::nullopt};
  const LifeSigns still_{.alive = false};

  std::vector<Vector3f> drawn(const std::string& words) const {
    return opened_patient().drawn(opened_patient().frame(words));
  }
  std::size_t eyes_part() const {
    std::size_t part = 0;
    while (!living_.has_eyes(part)) ++part;
    return part;
  }
};

TEST_F(LowerLidTest, RestAndAnOpenedMouthLeaveThemBitForBit) {
  for (const auto& places : {patient_.rest, drawn("open 30")}) {
    auto now = places;
    for (const float angle : living_.raise_lids(still_, now)) EXPECT_EQ(angle, 0);
    EXPECT_EQ(now, places);
  }
}

TEST_F(LowerLidTest, ASmileRaisesThemAndNothingAboveTheOpening) {
  float before = 0;
  for (const char* words : {"smile 0.5", "smile 1"}) {
    const auto smooth = drawn(words);
    auto places = smooth;
    const auto raised = living_.raise_lids(still_, places);
    ASSERT_EQ(raised.size(), 2u);
    EXPECT_NEAR(raised[0], raised[1], 0.02f) << words;
    float highest = 0;
    for (std::size_t v = 0; v < places.size(); ++v) {
      if (places[v] == smooth[v]) continue;
      highest = std::max(highest, places[v].z() - smooth[v].z());
      EXPECT_LT(patient_.rest[v].z(), 16) << patient_.rest[v].transpose();
    }
    RecordProperty(words, std::to_string(highest));
    EXPECT_GT(highest, before);
    before = highest;
  }
  EXPECT_GT(before, 0.5f);
  EXPECT_LT(before, 3);
}

TEST_F(LowerLidTest, ASmileOfOneSideRaisesThatLidAlone) {
  auto places = drawn("smile 1 left");
  const auto smooth = places;
  living_.raise_lids(still_, places);
  int left = 0;
  for (std::size_t v = 0; v < places.size(); ++v) {
    if (places[v] == smooth[v]) continue;
    EXPECT_GT(patient_.rest[v].x(), 0);
    ++left;
  }
  EXPECT_GT(left, 50);
}

TEST_F(LowerLidTest, NoRaisedSkinIsInsideAnEyeballAndClosedLidsMeet) {
  auto places = drawn("AU6 1");
  const auto smooth = places;
  const LifeSigns closed{.lids = {1, 1}, .alive = false};
  living_.raise_lids(closed, places);
  const LivingEyes eyes(patient_.scene.patient.parts[eyes_part()].mesh);
  int checked = 0;
  for (std::size_t v = 0; v < places.size(); ++v) {
    if (places[v] == smooth[v]) continue;
    for (const Eyeball& ball : eyes.eyeballs()) {
      const Vector3f from = places[v] - ball.centre;
      EXPECT_GT(from.norm(), ball.reach(from.normalized(), -Vector3f::UnitY()));
    }
    ++checked;
  }
  EXPECT_GT(checked, 100);
  living_.move_lids(closed, places);
  // Lines of sight to the middle of each eyeball meet skin.
  TriMesh skin = patient_.face->mesh;
  for (std::size_t v = 0; v < places.size(); ++v) skin.vertices[v] = places[v].cast<double>();
  const TriangleTree tree(skin);
  for (const Eyeball& ball : eyes.eyeballs())
    for (float up = -5; up <= 5; up += 0.5f) {
      const Eigen::Vector3d to = ball.centre.cast<double>() + Eigen::Vector3d(0, -5, up);
      EXPECT_TRUE(tree.ray_cast(to - 60 * Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitY(), 58))
          << up;
    }
}

TEST_F(LowerLidTest, TheirLashesGoWithThem) {
  auto places = drawn("smile 1");
  const auto raised = living_.raise_lids(still_, places);
  const TriMesh& mesh = patient_.scene.patient.parts[eyes_part()].mesh;
  const auto at_rest = floats(mesh);
  auto with = at_rest, without = at_rest;
  std::vector<Vector3f> normals(at_rest.size(), Vector3f::UnitZ());
  living_.move_eyes(eyes_part(), still_, raised, with, normals);
  living_.move_eyes(eyes_part(), still_, {}, without, normals);
  EXPECT_EQ(without, at_rest);
  int moved = 0;
  for (std::size_t v = 0; v < with.size(); ++v) {
    if (with[v] == at_rest[v]) continue;
    EXPECT_GT(with[v].z(), at_rest[v].z());
    ++moved;
  }
  EXPECT_GT(moved, 100);
}

}  // namespace
}  // namespace condyle
