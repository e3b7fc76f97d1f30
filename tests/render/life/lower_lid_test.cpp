// In a real smile of the built-in patient the cheeks raise the lower lids, in pictures alone; at
// rest and as the jaw opens the lids stay as the tissue has them, bit for bit.
#include "render/life/lower_lid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "engine/mesh/triangle_tree.h"
#include "render/face/cheek_thickness.h"
#include "render/face/lashes.h"
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
  const CheekThickness cheeks_{patient_.rest, patient_.normals, patient_.prepared.lining()->rim,
                               patient_.parts};
  const LifeSigns still_{.alive = false};

  /// With the bulges of the cheeks, as pictures have them.
  std::vector<Vector3f> drawn(const std::string& words) const {
    auto places = opened_patient().drawn(opened_patient().frame(words));
    cheeks_.apply(places);
    return places;
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
    for (const LidPose& lids : living_.move_lids(still_, true, now)) EXPECT_EQ(lids.raised, 0);
    EXPECT_EQ(now, places);
  }
}

TEST_F(LowerLidTest, ASmileRaisesThemAndNothingAboveTheOpening) {
  float before = 0;
  for (const char* words : {"smile 0.5", "smile 1"}) {
    const auto smooth = drawn(words);
    auto places = smooth;
    const auto lids = living_.move_lids(still_, true, places);
    ASSERT_EQ(lids.size(), 2u);
    EXPECT_NEAR(lids[0].raised, lids[1].raised, 0.02f) << words;
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
  EXPECT_GT(before, 1);
  EXPECT_LT(before, 3);
}

TEST_F(LowerLidTest, ASmileOfOneSideRaisesThatLidAlone) {
  auto places = drawn("smile 1 left");
  const auto smooth = places;
  living_.move_lids(still_, true, places);
  int left = 0;
  for (std::size_t v = 0; v < places.size(); ++v) {
    if (places[v] == smooth[v]) continue;
    EXPECT_GT(patient_.rest[v].x(), 0);
    ++left;
  }
  EXPECT_GT(left, 50);
}

TEST_F(LowerLidTest, AnEdgeThatMovesDownAloneRaisesNothing) {
  auto places = patient_.rest;
  for (auto& p : places)
    if (p.z() > -2) p.z() -= 1.5f;
  for (const LidPose& lids : living_.move_lids(still_, true, places)) EXPECT_EQ(lids.raised, 0);
}

TEST_F(LowerLidTest, NoRaisedSkinIsInsideAnEyeballAndClosedLidsMeet) {
  const auto smooth = drawn("AU6 1");
  auto places = smooth;
  living_.move_lids(still_, true, places);
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
  auto closed = smooth;
  living_.move_lids({.lids = {1, 1}, .alive = false}, true, closed);
  // Lines of sight to the middle of each eyeball meet skin.
  TriMesh skin = patient_.face->mesh;
  for (std::size_t v = 0; v < closed.size(); ++v) skin.vertices[v] = closed[v].cast<double>();
  const TriangleTree tree(skin);
  for (const Eyeball& ball : eyes.eyeballs())
    for (float up = -5; up <= 5; up += 0.5f) {
      const Eigen::Vector3d to = ball.centre.cast<double>() + Eigen::Vector3d(0, -5, up);
      EXPECT_TRUE(tree.ray_cast(to - 60 * Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitY(), 58))
          << up;
    }
}

TEST_F(LowerLidTest, LashesStayOnTheEdgesOfRaisedAndClosedLids) {
  const TriMesh& mesh = patient_.scene.patient.parts[eyes_part()].mesh;
  const auto at_rest = floats(mesh);
  const auto radii = lash_radii(mesh);
  struct Off {
    double most, mean;
  };
  float turned = 1;  // least cosine between a lash's direction and that at rest
  /// Distances of the roots of the lashes from the skin.
  const auto roots_off = [&](const std::vector<Vector3f>& places,
                             const std::vector<Vector3f>& shifts, const LifeSigns& signs) {
    auto eyes = at_rest;
    std::vector<Vector3f> normals(eyes.size(), Vector3f::UnitZ());
    living_.move_eyes(eyes_part(), signs, shifts, eyes, normals);
    turned = 1;
    for (std::size_t v = 0; v < eyes.size(); ++v)
      if (radii[v] > 0) turned = std::min(turned, normals[v].z());
    TriMesh skin = patient_.face->mesh;
    for (std::size_t v = 0; v < places.size(); ++v) skin.vertices[v] = places[v].cast<double>();
    const TriangleTree skin_tree(skin), at_rest_tree(patient_.face->mesh);
    double most = 0, sum = 0;
    int count = 0;
    for (std::size_t v = 0; v < eyes.size(); ++v) {
      if (radii[v] == 0 || at_rest_tree.nearest(at_rest[v].cast<double>()).distance >= 0.3)
        continue;
      const double off = skin_tree.nearest(eyes[v].cast<double>()).distance;
      most = std::max(most, off);
      sum += off;
      ++count;
    }
    return Off{most, sum / count};
  };
  EXPECT_TRUE(living_.lash_shifts(patient_.rest)[eyes_part()].empty());
  const auto smile = drawn("smile 1");
  auto raised_brows = patient_.rest;
  for (auto& p : raised_brows)
    if (p.z() > 16) p.z() += 1;
  for (const auto& face : {smile, raised_brows})
    for (const LidClosure& closure : {LidClosure{}, LidClosure{1, 1}, LidClosure{-1, -1}}) {
      const LifeSigns signs{.lids = closure, .alive = false};
      auto places = face;
      living_.move_lids(signs, true, places);
      const Off now = roots_off(places, living_.lash_shifts(places)[eyes_part()], signs);
      EXPECT_LT(turned, closure.left > 0 ? 0.9 : 1.0) << "with the lid";
      const Off stays = roots_off(places, {}, signs);
      EXPECT_EQ(turned, 1);
      RecordProperty((face == smile ? "smile " : "brows ") + std::to_string(closure.left),
                     std::to_string(now.most) + ", " + std::to_string(now.mean));
      EXPECT_LT(now.most, 0.5) << closure.left;
      EXPECT_LT(now.mean, 0.17) << closure.left;
      EXPECT_GT(stays.mean, now.mean + 0.02) << "lashes that stay are off the lids";
    }
}

}  // namespace
}  // namespace condyle
