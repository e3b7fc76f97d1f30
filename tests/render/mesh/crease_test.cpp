#include <gtest/gtest.h>

#include <cmath>

#include "render/mesh/creases.h"

namespace condyle {
namespace {

/// Two flat lips of 9 x 9 vertices, 1 mm apart, facing each other.
struct Lips {
  std::vector<Eigen::Vector3f> positions, normals;
  std::vector<float> sky;
  Lips() {
    for (const float z : {0.f, 1.f})
      for (int i = 0; i < 81; ++i) {
        positions.emplace_back(static_cast<float>(i % 9), static_cast<float>(i / 9), z);
        normals.emplace_back(0.f, 0.f, z == 0 ? 1.f : -1.f);
        sky.push_back(0.1f);
      }
  }
};

TEST(Creases, JoinEachVertexWithTheOneAcross) {
  const Lips lips;
  const auto creases = find_creases(lips.positions, lips.normals, lips.sky);
  ASSERT_EQ(creases.size(), lips.positions.size());
  for (const auto& crease : creases) {
    EXPECT_EQ(crease.across, (crease.vertex + 81) % 162);
    EXPECT_NEAR(crease.rest_mm, 1, 1e-6);
  }
}

TEST(Creases, StayDarkAtRestAndOpenSmoothlyAsTheSidesPart) {
  Lips lips;
  const auto creases = find_creases(lips.positions, lips.normals, lips.sky);
  ASSERT_FALSE(creases.empty());
  float before = 0.1f;
  for (int step = 0; step <= 60; ++step) {
    for (int i = 81; i < 162; ++i) lips.positions[i].z() = 1 + 0.25f * static_cast<float>(step);
    const float now = opened_sky(creases[0], 0.1f, lips.positions);
    if (step <= 4) {
      EXPECT_FLOAT_EQ(now, 0.1f);
    }
    EXPECT_GE(now, before);
    EXPECT_LT(now - before, 0.08f);
    before = now;
  }
  EXPECT_FLOAT_EQ(before, 0.85f);
}

TEST(Creases, AreNotSeenInTheOpenNorOnOneSide) {
  Lips lips;
  EXPECT_TRUE(find_creases(lips.positions, lips.normals, std::vector<float>(162, 0.9f)).empty());
  for (auto& normal : lips.normals) normal = Eigen::Vector3f::UnitZ();
  EXPECT_TRUE(find_creases(lips.positions, lips.normals, lips.sky).empty());
}

}  // namespace
}  // namespace condyle
