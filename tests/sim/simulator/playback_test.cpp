#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "sim/simulator/simulator.h"
#include "tests/support/allocated.h"
#include "tests/support/boxes.h"

namespace condyle::test {
namespace {

/// Descends by 20 mm and returns within two seconds, rotating slightly.
Motion nodding(bool recorded = false) {
  return {"nodding",
          2.0,
          recorded,
          [](double t) {
            const double s = std::sin(std::numbers::pi * std::clamp(t, 0.0, 2.0) / 2.0);
            Pose pose;
            pose.R = Eigen::AngleAxisd(0.1 * s, Eigen::Vector3d::UnitX());
            pose.t = {0, 0, -20 * s};
            return pose;
          },
          {}};
}

/// Pushes the mandible 5 mm up, into the maxilla.
Motion biting(bool recorded) {
  return {"biting",
          0.5,
          recorded,
          [](double t) {
            Pose pose;
            pose.t = {0, 0, 10 * std::clamp(t, 0.0, 0.5)};
            return pose;
          },
          {}};
}

std::vector<std::uint64_t> hashes(const Scene& scene, int threads,
                                  const std::vector<double>& times) {
  SimulatorSettings settings;
  settings.threads = threads;
  Playback playback(scene, nodding(), settings);
  std::vector<std::uint64_t> all;
  for (const double t : times) all.push_back(playback.at(t).state_hash);
  return all;
}

std::vector<double> every(double interval, double end) {
  std::vector<double> times;
  for (int i = 0; i * interval <= end + 1e-9; ++i) times.push_back(i * interval);
  return times;
}

/// Memory in use: under sanitizers without what they keep of freed memory.
long used_kb() {
#if defined(CONDYLE_ADDRESS_SANITIZER) || defined(CONDYLE_THREAD_SANITIZER)
  return static_cast<long>(allocated_bytes() / 1024);
#else
  std::ifstream statm("/proc/self/statm");
  long size = 0, resident = 0;
  statm >> size >> resident;
  return resident * (::sysconf(_SC_PAGESIZE) / 1024);
#endif
}

}  // namespace

TEST(Playback, SameHashInEveryFrameForOneAndTwoThreadsAndTwice) {
  const Scene scene = make_scene(box_patient());
  const auto times = every(0.05, 2.0);
  const auto once = hashes(scene, 1, times);
  EXPECT_EQ(once, hashes(scene, 1, times));
  EXPECT_EQ(once, hashes(scene, 2, times));
  EXPECT_NE(once[5], once[6]);
}

TEST(Playback, QueriesDoNotChangeTheState) {
  const Scene scene = make_scene(box_patient());
  const auto sparse = every(0.25, 2.0);
  std::vector<double> dense;
  for (const double t : sparse) {
    if (!dense.empty()) dense.insert(dense.end(), {t - 0.111, t - 0.05});
    dense.push_back(t);
  }
  const auto few = hashes(scene, 1, sparse), many = hashes(scene, 1, dense);
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_EQ(few[i], many[3 * i]) << i;
}

TEST(Playback, BuiltInMotionReachesContactAndRecordedMotionIsPlayedUnaltered) {
  const Scene scene = make_scene(box_patient());
  Playback stopped(scene, biting(false), {}), recorded(scene, biting(true), {}),
      respectful(scene, biting(true), {}, true);
  const auto a = stopped.at(0.5), b = recorded.at(0.5), c = respectful.at(0.5);
  EXPECT_TRUE(a.stopped);
  EXPECT_NEAR(a.poses[mandible_body].t.z(), 1.0, 0.02);
  EXPECT_LE(a.contacts.max_penetration_mm(), 0.02);
  EXPECT_FALSE(b.stopped);
  EXPECT_EQ(b.poses[mandible_body].t.z(), 5.0);
  EXPECT_NEAR(b.contacts.max_penetration_mm(), 4.0, 1e-6);
  EXPECT_EQ(c.poses[mandible_body].t, a.poses[mandible_body].t);
}

TEST(Playback, LidsAreInTheFrameAndNotInItsHash) {
  const Scene scene = make_scene(box_patient());
  Motion winking = nodding();
  winking.expression = [](double t) { return FaceExcitation{.lids = {0.4 * t, 0.5}}; };
  Playback plain(scene, nodding(), {}), winks(scene, winking, {});
  for (const double t : {0.5, 1.2345}) {  // on a step and between two
    const FrameState with = winks.at(t), without = plain.at(t);
    EXPECT_NEAR(with.lids.left, 0.4 * t, 1e-12);
    EXPECT_EQ(with.lids.right, 0.5);
    EXPECT_FALSE(without.lids.any());
    EXPECT_EQ(with.state_hash, without.state_hash);
  }
}

TEST(Playback, MemoryDoesNotGrowOverTwoThousandFrames) {
  const Scene scene = make_scene(box_patient());
  Motion motion = nodding();
  motion.duration_s = 1e9;
  Playback playback(scene, motion, {});
  for (int i = 0; i < 200; ++i) playback.at(i / 120.0);
  const long before = used_kb();
  ASSERT_GT(before, 0);
  for (int i = 200; i < 2200; ++i) playback.at(i / 120.0);
  EXPECT_LT(used_kb() - before, 1024);
}

}  // namespace condyle::test
