#include "sim/simulator/live.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "tests/support/boxes.h"

namespace condyle::test {
namespace {

Motion dropping() {
  return {"dropping",
          2.0,
          false,
          [](double t) {
            Pose pose;
            pose.t = {0, 0, -20 * std::clamp(t, 0.0, 2.0)};
            return pose;
          },
          {}};
}

/// The frame at the time that was asked for; a minute at most. Frames on the way may come first.
FrameState wait_for(LiveSimulation& live, double time_s) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (std::chrono::steady_clock::now() < end)
    if (auto frame = live.take(); frame && std::abs(frame->time_s - time_s) < 1e-9) return *frame;
  throw std::runtime_error("no frame came");
}

}  // namespace

TEST(Live, AnswersJumpsAndRunningTimeAndHeldOpenings) {
  const Scene scene = make_scene(box_patient());
  LiveSimulation live(scene, dropping(), {});
  live.request({.time_s = 1.0});
  EXPECT_NEAR(wait_for(live, 1.0).measures.opening_mm, 20, 1e-9);
  live.request({.time_s = 1.1});
  EXPECT_NEAR(wait_for(live, 1.1).measures.opening_mm, 22, 1e-9);
  live.request({.time_s = 1.1, .opening_mm = 7.5});
  EXPECT_NEAR(wait_for(live, 1.1).measures.opening_mm, 7.5, 1e-6);
  EXPECT_GT(live.steps_per_second(), 0);
}

TEST(Live, RunningTimeGivesTheStatesOfThePlayback) {
  const Scene scene = make_scene(box_patient());
  LiveSimulation live(scene, dropping(), {});
  Playback playback(scene, dropping(), {});
  for (int i = 1; i <= 40; ++i) {
    const double time = i / 60.0;
    live.request({.time_s = time, .face = false});
    EXPECT_EQ(wait_for(live, time).state_hash, playback.at(time).state_hash) << i;
  }
}

TEST(Live, AnUnansweredWorkerEndsWithItsOwner) {
  const Scene scene = make_scene(box_patient());
  for (int i = 0; i < 20; ++i) {
    LiveSimulation live(scene, dropping(), {});
    live.request({.time_s = 0.1 * i});
  }
}

}  // namespace condyle::test
