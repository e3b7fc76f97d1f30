#include "render/camera/arch_view.h"

#include <gtest/gtest.h>

#include "tests/render/scene_parts.h"
#include "tests/support/bodies.h"

namespace condyle {
namespace {

std::vector<Part> jaws() {
  std::vector<Part> parts = {make_part("maxilla", Role::maxilla, ball({0, -40, 12}, 12, 8)),
                             make_part("upper_teeth", Role::upper_teeth, ball({6, -60, 3}, 3, 8)),
                             make_part("lower_teeth", Role::lower_teeth, ball({6, -60, -3}, 3, 8)),
                             make_part("mandible", Role::mandible, ball({0, -40, -12}, 12, 8)),
                             make_part("graft", Role::transplant, ball({0, -40, -14}, 3, 8)),
                             make_part("face", Role::face, ball({0, -40, 0}, 40, 8)),
                             make_part("eyes", Role::eyes, ball({0, -60, 30}, 5, 8))};
  return parts;
}

TEST(ArchView, ShowsOneJawFromTheBitePlane) {
  auto parts = jaws();
  const BodyTree bodies = test::bodies_for(parts, {{"graft", mandible_body}});
  const ArchView upper(ArchView::upper, parts, bodies, {}, 1.5),
      lower(ArchView::lower, parts, bodies, {}, 1.5);
  EXPECT_EQ(upper.at_rest().direction, -Eigen::Vector3d::UnitZ());
  EXPECT_EQ(lower.at_rest().direction, Eigen::Vector3d::UnitZ());
  const auto hides = [](const ArchView& view, const std::string& part) {
    return view.hidden().contains(part);
  };
  for (const char* part : {"maxilla", "upper_teeth"}) {
    EXPECT_FALSE(hides(upper, part)) << part;
    EXPECT_TRUE(hides(lower, part)) << part;
  }
  for (const char* part : {"mandible", "lower_teeth", "graft"}) {
    EXPECT_TRUE(hides(upper, part)) << part;
    EXPECT_FALSE(hides(lower, part)) << part;
  }
  for (const char* part : {"face", "eyes"}) EXPECT_TRUE(hides(upper, part) && hides(lower, part));
  // The patient's right is on the left of both; front teeth are up, then down.
  for (const auto* view : {&upper, &lower}) {
    const Camera& camera = view->at_rest();
    EXPECT_GT(camera.up.cross(camera.direction).x(), 0.9);
    EXPECT_NEAR(camera.target.x(), 6, 1e-9);
  }
  EXPECT_LT(upper.at_rest().up.y(), 0);
  EXPECT_GT(lower.at_rest().up.y(), 0);
}

TEST(ArchView, FollowsTheMandible) {
  auto parts = jaws();
  const BodyTree bodies = test::bodies_for(parts, {{"graft", mandible_body}});
  FrameState frame;
  frame.poses[mandible_body].R = Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX());
  frame.poses[mandible_body].t = {1, -5, -20};
  const ArchView upper(ArchView::upper, parts, bodies, {}, 1),
      lower(ArchView::lower, parts, bodies, {}, 1);
  EXPECT_EQ(upper.at(frame).target, upper.at_rest().target);
  const Camera moved = lower.at(frame);
  EXPECT_LT((moved.target - frame.poses[mandible_body] * lower.at_rest().target).norm(), 1e-12);
  EXPECT_LT((moved.direction - frame.poses[mandible_body].R * lower.at_rest().direction).norm(),
            1e-12);
  EXPECT_EQ(moved.distance_mm, lower.at_rest().distance_mm);
}

}  // namespace
}  // namespace condyle
