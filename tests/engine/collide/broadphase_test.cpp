#include "engine/collide/broadphase.h"

#include <gtest/gtest.h>

#include <random>
#include <thread>

#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

struct Scene {
  std::vector<TriMesh> meshes;
  std::vector<CollisionMesh> bodies;
  std::vector<const CollisionMesh*> all;

  /// `kinds` shapes, used again and again.
  Scene(int count, int kinds, std::mt19937_64& random) {
    std::uniform_real_distribution<double> size(2, 9);
    for (int i = 0; i < kinds; ++i) {
      meshes.push_back(i % 2 ? test::sphere(1, size(random), {1, -2, 0.5}, 0.2)
                             : test::box(-Eigen::Vector3d(size(random), size(random), 1),
                                         {size(random), 3, size(random)}));
      bodies.emplace_back(meshes.back());
    }
    for (int i = 0; i < count; ++i) all.push_back(&bodies[static_cast<std::size_t>(i % kinds)]);
  }
};

std::vector<Pose> any_poses(std::size_t count, double reach, std::mt19937_64& random) {
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < count; ++i) poses.push_back(test::any_pose(random, reach));
  return poses;
}

/// The definition, over all pairs: gap of the boxes around the eight moved corners.
std::vector<BodyPair> by_force(const Scene& scene, const std::vector<Pose>& poses, double reach) {
  std::vector<Box> boxes(scene.all.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Box& own = scene.all[i]->box();
    for (int k = 0; k < 8; ++k)
      boxes[i].add(poses[i] * Eigen::Vector3d((k & 1 ? own.low : own.high).x(),
                                              (k & 2 ? own.low : own.high).y(),
                                              (k & 4 ? own.low : own.high).z()));
  }
  std::vector<BodyPair> pairs;
  for (int a = 0; a < static_cast<int>(boxes.size()); ++a)
    for (int b = a + 1; b < static_cast<int>(boxes.size()); ++b) {
      Eigen::Vector3d apart = Eigen::Vector3d::Zero();
      for (int k = 0; k < 3; ++k)
        apart[k] =
            std::max({0.0, boxes[a].low[k] - boxes[b].high[k], boxes[b].low[k] - boxes[a].high[k]});
      if (apart.norm() <= reach) pairs.push_back({a, b});
    }
  return pairs;
}

TEST(Broadphase, FindsThePairsThatAllPairsFindInRandomScenesColdAndWarm) {
  std::mt19937_64 random(41);
  for (const int count : {2, 9, 60, 400}) {
    const Scene scene(count, std::min(count, 12), random);
    const Broadphase warm(scene.all);
    EXPECT_EQ(warm.body_count(), count);
    std::size_t near = 0;
    for (int frame = 0; frame < 8; ++frame) {
      const auto poses = any_poses(scene.all.size(), 8 * std::cbrt(count), random);
      for (const double reach : {0.0, 1.5, 10.0}) {
        const auto expected = by_force(scene, poses, reach);
        ASSERT_EQ(warm.near(poses, reach), expected) << count << " bodies, reach " << reach;
        ASSERT_EQ(Broadphase(scene.all).near(poses, reach), expected);
        near += expected.size();
      }
    }
    EXPECT_GT(near, 5u);
  }
}

TEST(Broadphase, NoSurfacesWithinReachAreMissed) {
  std::mt19937_64 random(42);
  const Scene scene(30, 6, random);
  const Broadphase broadphase(scene.all);
  int within = 0;
  for (int frame = 0; frame < 5; ++frame) {
    const auto poses = any_poses(scene.all.size(), 25, random);
    const auto pairs = broadphase.near(poses, 3);
    for (int a = 0; a < 30; ++a)
      for (int b = a + 1; b < 30; ++b) {
        if (distance(*scene.all[a], poses[a], *scene.all[b], poses[b]).distance_mm > 3) continue;
        ++within;
        EXPECT_TRUE(std::binary_search(pairs.begin(), pairs.end(), BodyPair{a, b}));
      }
  }
  EXPECT_GT(within, 100);
}

TEST(Broadphase, BodiesWhollyInsideOthersAreNear) {
  const CollisionMesh big(test::sphere(2, 20)), small(test::sphere(1, 1));
  const std::vector<const CollisionMesh*> bodies = {&big, &small};
  const Pose inside{Eigen::Quaterniond::Identity(), {3, 3, 3}};
  EXPECT_EQ(Broadphase(bodies).near(std::vector<Pose>{{}, inside}, 0),
            (std::vector<BodyPair>{{0, 1}}));
}

TEST(Broadphase, NoneAndOneHaveNoPairs) {
  const CollisionMesh one(test::sphere(1, 1));
  EXPECT_TRUE(Broadphase({}).near({}, 5).empty());
  const std::vector<const CollisionMesh*> bodies = {&one};
  EXPECT_TRUE(Broadphase(bodies).near(std::vector<Pose>(1), 5).empty());
}

TEST(Broadphase, ConcurrentQueriesGetTheAnswersOfOneThread) {
  std::mt19937_64 random(43);
  const Scene scene(80, 8, random);
  const Broadphase shared(scene.all);
  std::vector<std::vector<Pose>> frames;
  for (int k = 0; k < 60; ++k) frames.push_back(any_poses(scene.all.size(), 40, random));
  std::vector<std::vector<BodyPair>> alone, first(frames.size()), second(frames.size());
  for (const auto& poses : frames) alone.push_back(Broadphase(scene.all).near(poses, 2));
  std::thread other([&] {
    for (std::size_t k = frames.size(); k-- > 0;) second[k] = shared.near(frames[k], 2);
  });
  for (std::size_t k = 0; k < frames.size(); ++k) first[k] = shared.near(frames[k], 2);
  other.join();
  EXPECT_EQ(first, alone);
  EXPECT_EQ(second, alone);
}

}  // namespace
}  // namespace condyle
