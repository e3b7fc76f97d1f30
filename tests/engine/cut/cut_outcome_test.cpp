#include <gtest/gtest.h>

#include <numbers>

#include "tests/engine/cut/cut_checks.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using test::box;
using test::expect_whole;

Cut wall(const char* name, const Vector3d& normal, double offset, double kerf,
         std::vector<Plane> reach = {}) {
  return {name, Region::above({normal, offset}), std::move(reach), kerf};
}

TEST(CutOutcome, ASlitThatIsMeantToEndInTheBoneIsOpenOnPurpose) {
  const TriMesh bar = box({0, 0, 0}, {40, 10, 10});
  std::vector<Cut> cuts{
      wall("slit", Vector3d::UnitX(), 20, 2, box_planes({10, 4, -1}, {30, 11, 11}))};
  EXPECT_FALSE(cut_bone(bar, cuts).outcomes[0].open_on_purpose);
  cuts[0].ends_in_bone = true;
  const CutResult slit = cut_bone(bar, cuts);
  expect_whole(bar, slit);
  EXPECT_TRUE(slit.outcomes[0].open_on_purpose);
  EXPECT_FALSE(slit.outcomes[0].through);
  EXPECT_NEAR(slit.outcomes[0].left_mm, 4, 1e-9);
  // One that parts the bone all the same goes through.
  cuts[0].reach.clear();
  const CutResult parted = cut_bone(bar, cuts);
  EXPECT_TRUE(parted.outcomes[0].through);
  EXPECT_FALSE(parted.outcomes[0].open_on_purpose);
}

TEST(CutOutcome, ACutThatEndsAtAnotherCrossesNothing) {
  const TriMesh cube = box({0, 0, 0}, {10, 10, 10});
  for (const double kerf : {0.0, 0.5}) {
    const Cut across = wall("z", Vector3d::UnitZ(), 4, kerf);
    // Ends in the middle of the other's kerf: three pieces.
    std::vector<Cut> cuts{across, wall("x", Vector3d::UnitX(), 4, kerf, {{Vector3d::UnitZ(), 4}})};
    const CutResult ended = cut_bone(cube, cuts);
    expect_whole(cube, ended);
    EXPECT_EQ(ended.pieces.size(), 3U);
    EXPECT_TRUE(ended.crossings.empty()) << kerf;
    // A little beyond it.
    cuts[1].reach = {{Vector3d::UnitZ(), 5}};
    EXPECT_EQ(cut_bone(cube, cuts).crossings.size(), 1U) << kerf;
    // Obliquely, at 45 degrees, to its far wall.
    cuts[1] = wall("oblique", Vector3d(1, 0, 1).normalized(), 6, kerf,
                   {{Vector3d::UnitZ(), 4 + 0.5 * kerf}});
    EXPECT_TRUE(cut_bone(cube, cuts).crossings.empty()) << kerf;
  }
}

TEST(CutOutcome, KerfsThatRunIntoEachOtherAreReported) {
  const TriMesh cube = box({0, 0, 0}, {10, 10, 10});
  const std::vector<Plane> reach = box_planes({2, -1, 0}, {8, 11, 11});
  const std::vector<Cut> cuts{wall("a", Vector3d::UnitZ(), 4, 1),
                              wall("b", Vector3d::UnitZ(), 4.6, 1, reach)};
  const CutResult result = cut_bone(cube, cuts);
  expect_whole(cube, result);
  EXPECT_EQ(result.crossings.size(), 1U);
}

TEST(CutOutcome, WindowsAreTheHolesOfACutThatShouldStayInTheBone) {
  // A slab with a ball-shaped cavity that the split meets.
  TriMesh hollow = test::sphere(5, 5, {15, 20, 6});
  for (auto& t : hollow.triangles) std::swap(t[0], t[1]);
  const TriMesh slab = test::joined(box({0, 0, 0}, {30, 40, 12}), hollow);
  for (const double kerf : {0.0, 0.5}) {
    std::vector<Cut> cuts{wall("split", Vector3d::UnitZ(), 3, kerf)};
    EXPECT_TRUE(cut_bone(slab, cuts).outcomes[0].windows.empty()) << "not asked for";
    cuts[0].stays_in_bone = true;
    const CutResult split = cut_bone(slab, cuts);
    expect_whole(slab, split);
    ASSERT_EQ(split.outcomes[0].windows.size(), 1U) << kerf;
    const CutWindow& window = split.outcomes[0].windows[0];
    // The wall nearer to the ball's middle: h below it.
    const double h = 3 - 0.5 * kerf, expected = std::numbers::pi * (25 - h * h);
    EXPECT_NEAR(window.area_mm2, expected, 0.01 * expected);
    EXPECT_NEAR((window.at - Vector3d(15, 20, 3 + 0.5 * kerf)).norm(), 0, 0.05);
    cuts[0] = wall("low", Vector3d::UnitZ(), 0.5, kerf);
    cuts[0].stays_in_bone = true;
    EXPECT_TRUE(cut_bone(slab, cuts).outcomes[0].windows.empty());
  }
}

TEST(CutOutcome, ABentSheetHasOneRim) {
  const TriMesh bar = box({0, 0, 0}, {40, 10, 10});
  const std::vector<Vector3d> polyline{{15, 0, -5}, {15, 0, 5}, {25, 0, 5}, {25, 0, 15}};
  std::vector<Cut> cuts{
      {"step", beyond_sheet(polyline, Vector3d::UnitY(), Vector3d::UnitX()), {}, 1}};
  cuts[0].stays_in_bone = true;
  EXPECT_TRUE(cut_bone(bar, cuts).outcomes[0].windows.empty());
}

}  // namespace
}  // namespace condyle
