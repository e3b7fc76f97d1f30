#include "render/window/measuring.h"

#include <gtest/gtest.h>

#include <cmath>

#include "panel_stage.h"
#include "sim/frame/body_poses.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

TEST(Measuring, DistanceAngleAndArea) {
  const std::vector<Vector3d> two = {{0, 0, 0}, {3, 4, 12}};
  EXPECT_DOUBLE_EQ(measured(two).length_mm, 13);
  EXPECT_FALSE(measured(two).angle_deg);
  EXPECT_FALSE(measured(two).area_mm2);
  const std::vector<Vector3d> three = {{5, 0, 1}, {0, 0, 1}, {0, 0, 8}};
  EXPECT_DOUBLE_EQ(*measured(three).angle_deg, 90);
  EXPECT_DOUBLE_EQ(*measured(three).area_mm2, 17.5);
  const std::vector<Vector3d> square = {{0, 0, 0}, {0, 10, 0}, {0, 10, 10}, {0, 0, 10}};
  EXPECT_DOUBLE_EQ(*measured(square).area_mm2, 100);
  EXPECT_DOUBLE_EQ(measured(square).length_mm, 30);
  EXPECT_FALSE(measured(square).angle_deg);
  EXPECT_EQ(words_of(measured(three)),
            (std::vector<std::string>{"12.0 mm", "90.0\u00b0", "18 mm\u00b2"}));
  EXPECT_EQ(measured({}).length_mm, 0);
}

TEST(Measuring, PointsGoAlongWithTheirBoneAndTheDeformingFace) {
  const std::vector<Part> parts = box_patient();
  FrameState frame = box_frame(1, 20);
  const PinnedPoint on_jaw{4, parts[4].mesh.triangles[3], {0.2, 0.3, 0.5}};
  Vector3d at_rest = Vector3d::Zero();
  for (int k = 0; k < 3; ++k)
    at_rest += on_jaw.shares[k] * parts[4].mesh.vertices[on_jaw.triangle[k]];
  EXPECT_LT((place_of(on_jaw, parts, frame) - frame.X_CM * at_rest).norm(), 1e-12);
  const PinnedPoint on_face{5, parts[5].mesh.triangles[0], {1, 0, 0}};
  frame.face.clear();
  for (const auto& v : parts[5].mesh.vertices)
    frame.face.push_back((v + Vector3d(0, 0, -7)).cast<float>());
  EXPECT_LT((place_of(on_face, parts, frame) - parts[5].mesh.vertices[on_face.triangle[0]] -
             Vector3d(0, 0, -7))
                .norm(),
            1e-5);
}

}  // namespace
}  // namespace condyle
