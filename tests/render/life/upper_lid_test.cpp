// An upper lid slides on the eyeball down to the lower lid, and never enters it.
#include "render/life/upper_lid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/mesh/triangle_tree.h"
#include "render/life/living_eyes.h"
#include "tests/render/life/eye_parts.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

const Vector3d centre = eye_centre;
const Vector3f ahead(0, -1, 0);

struct Eye {
  TriMesh skin = open_lids();
  LivingEyes eyes{eyeball()};
  std::vector<Vector3f> rest = {};
  std::optional<UpperLid> lid = {};

  Eye() {
    for (const auto& p : skin.vertices) rest.push_back(p.cast<float>());
    if (!eyes.eyeballs().empty())
      lid = UpperLid::find(rest, skin.triangles, eyes.eyeballs().front(), FaceSide::left);
  }
  std::vector<Vector3f> moved(double lowered, const Vector3f& gaze = ahead) const {
    auto places = rest;
    lid->move(lowered, gaze, places);
    return places;
  }
};

/// Fraction of the directions within 50 degrees of straight ahead in which the eyeball shows.
double showing(const Eye& eye, const std::vector<Vector3f>& places) {
  TriMesh skin = eye.skin;
  for (std::size_t v = 0; v < places.size(); ++v) skin.vertices[v] = places[v].cast<double>();
  const TriangleTree tree(skin);
  int shown = 0, all = 0;
  for (double across = -50; across <= 50; across += 1)
    for (double up = -50; up <= 50; up += 1) {
      const double a = across * M_PI / 180, b = up * M_PI / 180;
      const Vector3d direction(std::sin(a) * std::cos(b), -std::cos(a) * std::cos(b), std::sin(b));
      shown += !tree.ray_cast(centre, direction);
      ++all;
    }
  return static_cast<double>(shown) / all;
}

TEST(UpperLidTest, AnOpenLidThatDoesNotMoveStaysBitForBit) {
  const Eye eye;
  ASSERT_TRUE(eye.lid);
  EXPECT_EQ(eye.moved(0), eye.rest);
}

TEST(UpperLidTest, TheEyeballIsHiddenByAClosedLidAndShowsLessTheMoreItIsClosed) {
  const Eye eye;
  ASSERT_TRUE(eye.lid);
  double before = showing(eye, eye.rest);
  EXPECT_GT(before, 0.05);
  for (const double lowered : {0.2, 0.4, 0.6, 0.8}) {
    const double now = showing(eye, eye.moved(lowered));
    EXPECT_LT(now, before - 0.005) << lowered;
    EXPECT_GT(now, 0);
    before = now;
  }
  EXPECT_EQ(showing(eye, eye.moved(1)), 0);
}

TEST(UpperLidTest, AClosedLidHidesTheEyeballOfAFaceThatRaisesIt) {
  const Eye eye;
  ASSERT_TRUE(eye.lid);
  // Skin above the middle of the opening is raised by 7 degrees about the eyeball's centre.
  const Eigen::AngleAxisf up(-0.12f, Vector3f(1, 0, 0));
  auto raised = eye.rest;
  for (Vector3f& p : raised)
    if (const Vector3f from = p - centre.cast<float>(); from.y() < 0) {
      const float above = std::clamp((from.z() - 0.1f * from.x()) / 2, 0.f, 1.f);
      p += above * (up * from - from);
    }
  const double before = showing(eye, eye.rest), open = showing(eye, raised);
  EXPECT_GT(open, 1.1 * before);
  auto places = raised;
  eye.lid->move(1, ahead, places);
  EXPECT_EQ(showing(eye, places), 0);
}

TEST(UpperLidTest, TheLowerLidAndTheSkinAboveTheFoldStay) {
  const Eye eye;
  ASSERT_TRUE(eye.lid);
  const auto closed = eye.moved(1);
  int moved = 0;
  for (std::size_t v = 0; v < closed.size(); ++v) {
    if (closed[v] == eye.rest[v]) continue;
    ++moved;
    const Vector3f from = eye.rest[v] - centre.cast<float>();
    EXPECT_GT(from.z(), 0.1f * from.x() - 1.f);
    EXPECT_LT(from.y(), 0);
    EXPECT_LT(closed[v].z(), eye.rest[v].z() + 0.3f) << "down";
  }
  EXPECT_GT(moved, 100);
}

TEST(UpperLidTest, NoSkinEntersTheEyeballWhereverItLooks) {
  const Eye eye;
  ASSERT_TRUE(eye.lid);
  const Eyeball& ball = eye.lid->eyeball();
  for (const double turn : {-0.2, 0.0, 0.2}) {
    const Vector3f gaze(std::sin(turn), -std::cos(turn), 0);
    for (double lowered = -0.2; lowered <= 1; lowered += 0.1) {
      if (std::abs(lowered) < 0.01) continue;
      const auto places = eye.moved(lowered, gaze);
      for (std::size_t v = 0; v < places.size(); ++v) {
        if (places[v] == eye.rest[v]) continue;
        const Vector3f from = places[v] - ball.centre;
        EXPECT_GE(from.norm(), ball.reach(from.normalized(), gaze)) << lowered << " " << turn;
      }
    }
  }
}

TEST(UpperLidTest, FollowsTheGazeDownAndUp) {
  const Eye eye;
  ASSERT_TRUE(eye.lid);
  const double ahead_at = eye.lid->lowered({});
  EXPECT_GT(eye.lid->lowered({.gaze_up = -0.1}), ahead_at);
  EXPECT_LT(eye.lid->lowered({.gaze_up = 0.05}), ahead_at);
  for (const double up : {-0.1, 0.0, 0.1})
    EXPECT_EQ(eye.lid->lowered({.lids = {1, 1}, .gaze_up = up}), 1);
}

TEST(UpperLidTest, ARaisedLidShowsMoreOfTheEyeballThanAtRest) {
  const Eye eye;
  ASSERT_TRUE(eye.lid);
  const double raised = eye.lid->lowered({.lids = {-1, 0}, .alive = false});
  EXPECT_LT(raised, -0.1);
  EXPECT_NEAR(eye.lid->lowered({.lids = {-0.5, 0}, .alive = false}), raised / 2, 1e-12);
  EXPECT_LT(eye.lid->lowered({.lids = {-1, 0}}), eye.lid->lowered({})) << "with life";
  EXPECT_GT(showing(eye, eye.moved(raised)), showing(eye, eye.rest) + 0.01);
}

TEST(UpperLidTest, ClosesByTheClosureOfItsSideWhereverItLies) {
  const Eye eye;
  ASSERT_TRUE(eye.lid);
  const auto right =
      UpperLid::find(eye.rest, eye.skin.triangles, eye.lid->eyeball(), FaceSide::right);
  ASSERT_TRUE(right);
  const LifeSigns signs{.lids = {0.3, 0.8}, .alive = false};
  EXPECT_NEAR(eye.lid->lowered(signs), 0.3, 1e-12);
  EXPECT_NEAR(right->lowered(signs), 0.8, 1e-12);
}

TEST(UpperLidTest, ThereIsNoneWhereTheSkinIsClosedOrFarFromTheEye) {
  const Eye eye;
  ASSERT_TRUE(eye.lid);
  const TriMesh closed = ball(centre, 12.2, 60);
  std::vector<Vector3f> places;
  for (const auto& p : closed.vertices) places.push_back(p.cast<float>());
  EXPECT_FALSE(UpperLid::find(places, closed.triangles, eye.lid->eyeball(), FaceSide::left));
  Eyeball elsewhere = eye.lid->eyeball();
  elsewhere.centre.x() -= 62;
  EXPECT_FALSE(UpperLid::find(eye.rest, eye.skin.triangles, elsewhere, FaceSide::left));
}

TEST(LivingEyesTest, BothEyesLookAtOnePoint) {
  const TriMesh both = about_both_eyes(eyeball(), eyeball());
  const std::size_t first = both.vertices.size() / 2;
  const LivingEyes eyes(both);
  ASSERT_EQ(eyes.eyeballs().size(), 2u);
  const LifeSigns signs{.gaze_left = 0.1, .gaze_up = -0.05};
  const Vector3f l = eyes.eyeballs()[0].centre, r = eyes.eyeballs()[1].centre;
  const Vector3f to_l = eyes.gaze_of(0, signs), to_r = eyes.gaze_of(1, signs);
  // The lines of sight meet between 0.5 and 1 m ahead, to the left and below.
  const Vector3f between = r - l, across = to_l.cross(to_r);
  EXPECT_LT(std::abs(between.dot(across.normalized())), 0.05f);
  const float far = between.cross(to_r).dot(across) / across.squaredNorm();
  const Vector3f met = l + far * to_l - (l + r) / 2;
  EXPECT_GT(far, 500);
  EXPECT_LT(far, 1000);
  EXPECT_GT(met.x(), 20);
  EXPECT_LT(met.z(), -10);
  // They turn about their centres and keep their shape.
  std::vector<Vector3f> places, normals(both.vertices.size(), ahead);
  for (const auto& p : both.vertices) places.push_back(p.cast<float>());
  const auto rest = places;
  eyes.move(signs, places, normals);
  for (std::size_t v = 0; v < places.size(); ++v) {
    const Vector3f c = v < first ? l : r;
    EXPECT_NEAR((places[v] - c).norm(), (rest[v] - c).norm(), 1e-3f);
  }
  EXPECT_LT((normals[0] - to_l).norm(), 1e-4f);
}

}  // namespace
}  // namespace condyle
