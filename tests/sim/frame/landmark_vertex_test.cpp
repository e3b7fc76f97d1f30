// The vertices that carry landmarks.
#include "sim/frame/landmark_vertex.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <vector>

namespace condyle::test {
namespace {

Part part_of(Role role, const Eigen::Vector3d& corner) {
  Part part;
  part.role = role;
  part.mesh.vertices = {corner, corner + Eigen::Vector3d::UnitX(),
                        corner + Eigen::Vector3d::UnitY()};
  part.mesh.triangles = {{0, 1, 2}};
  return part;
}

TEST(LandmarkVertex, IsTheNearestOfAllPartsButOfTheMandibleForACondyle) {
  const std::vector<Part> parts = {part_of(Role::skull, {0, 0, 0}),
                                   part_of(Role::mandible, {50, 0, 0})};
  const Eigen::Vector3d near_skull(0.1, 0.9, 0);
  const LandmarkVertex nearest = landmark_vertex("porion", near_skull, parts);
  EXPECT_EQ(nearest.part, 0u);
  EXPECT_EQ(nearest.vertex, 2);
  for (const char* name : {"left_condyle", "right_condylion"}) {
    const LandmarkVertex of_jaw = landmark_vertex(name, near_skull, parts);
    EXPECT_EQ(of_jaw.part, 1u) << name;
    EXPECT_EQ(of_jaw.vertex, 2) << name;
  }
  const LandmarkVertex without_jaw =
      landmark_vertex("left_condyle", near_skull, std::span(parts).first(1));
  EXPECT_EQ(without_jaw.part, 0u);
}

}  // namespace
}  // namespace condyle::test
