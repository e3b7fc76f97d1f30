#include "sim/simulator/live.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "sim/motion/motion.h"
#include "tests/sim/simulator/resting.h"
#include "tests/support/boxes.h"
#include "tests/support/builtin.h"

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

/// The frame at the requested time; the limit is for a hang, also under sanitizers. Intermediate
/// frames may come first.
FrameState wait_for(LiveSimulation& live, double time_s) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(20);
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

TEST(Live, AHeldOpeningIsIndependentOfTheMotion) {
  const Scene scene = make_scene(box_patient());
  LiveSimulation live(scene, resting(), {}, dropping());
  live.request({.time_s = 0.5, .opening_mm = 7.5});
  EXPECT_NEAR(wait_for(live, 0.5).measures.opening_mm, 7.5, 1e-6);
  live.request({.time_s = 0.4});
  EXPECT_NEAR(wait_for(live, 0.4).measures.opening_mm, 0, 1e-9);
}

TEST(Live, RunningTimeReproducesThePlayback) {
  const Scene scene = make_scene(box_patient());
  LiveSimulation live(scene, dropping(), {});
  Playback playback(scene, dropping(), {});
  for (int i = 1; i <= 40; ++i) {
    const double time = i / 60.0;
    live.request({.time_s = time, .face = false});
    const FrameState frame = wait_for(live, time);  // at the nearest step
    EXPECT_EQ(frame.state_hash, playback.at(frame.time_s).state_hash) << i;
  }
}

double distance_of_all_but_a_hundredth(const TissueState& a, const TissueState& b) {
  std::vector<double> distance;
  for (std::size_t i = 0; i < a.nodes.size(); ++i)
    distance.push_back((a.nodes[i] - b.nodes[i]).norm());
  const auto place = distance.begin() + static_cast<std::ptrdiff_t>(0.99 * distance.size());
  std::nth_element(distance.begin(), place, distance.end());
  return *place;
}

TEST(Live, APlayingFaceIsNearTheConvergedOneAndConvergesWhenIdle) {
  const Scene scene = make_scene(builtin());
  const Motion motion = make_motion("opening", scene.patient, scene.contacts);
  const SimulatorSettings settings = live_settings({});
  constexpr double until_s = 0.5;  // about half open, the lips apart
  Playback quick(scene, motion, settings), converged(scene, motion, {});
  int iterations = 0, steps = 0, cut_short = 0;
  TissueState goal;
  for (double t = settings.step_s; t <= until_s + 1e-9; t += settings.step_s, ++steps) {
    const TissueState state = quick.at(t).tissue;
    goal = converged.at(t).tissue;
    iterations += state.iterations;
    cut_short += !state.converged;
    EXPECT_FALSE(state.reused);
    EXPECT_LT(state.penetration_mm, 0.1 + 1e-9) << t;
    EXPECT_LT(distance_of_all_but_a_hundredth(state, goal), 0.5) << t;
  }
  EXPECT_LT(iterations, 6 * steps);
  EXPECT_GT(cut_short, steps / 2);  // it is reported

  LiveSimulation live(scene, motion, settings);
  for (const double t : {0.2, 0.4, until_s}) {  // each in many steps
    live.request({.time_s = t});
    TissueState last = wait_for(live, t).tissue;
    while (!last.converged) last = wait_for(live, t).tissue;
    if (t == until_s) {
      EXPECT_LT(distance_of_all_but_a_hundredth(last, goal), 0.05);
    }
  }
}

TEST(Live, AFaceReturnsWhenAJawThatWasPushedFarAsideIsReset) {
  const Scene scene = make_scene(builtin());
  constexpr BodyId jaw = mandible_body;
  LiveSimulation live(scene, resting(), live_settings({}));
  live.request({.time_s = 0.5});
  const TissueState before = wait_for(live, 0.5).tissue;
  live.drag(jaw, shift(40, 0, 0));
  FrameState frame = wait_for(live, 0.5);
  EXPECT_GT(frame.poses[mandible_body].t.norm(), 20);
  live.release(jaw);
  while (frame.poses[mandible_body].t.norm() > 1e-9) frame = wait_for(live, 0.5);
  double farthest = 0;
  for (std::size_t i = 0; i < before.nodes.size(); ++i)
    farthest = std::max(farthest, (frame.tissue.nodes[i] - before.nodes[i]).norm());
  EXPECT_TRUE(frame.tissue.converged);
  EXPECT_LT(farthest, 1e-3);
}

TEST(Live, TissueResumesWhereAHandReturnsToAPose) {
  const Scene scene = make_scene(builtin());
  constexpr BodyId jaw = mandible_body;
  LiveSimulation live(scene, resting(), live_settings({}));
  live.request({.time_s = 0.5});
  wait_for(live, 0.5);
  FrameState frame;
  for (const double z : {-3.0, -3.1, -3.2, -3.1, -3.0}) {
    live.drag(jaw, shift(0, 0, z));
    do {
      frame = wait_for(live, 0.5);
    } while (frame.poses[mandible_body].t.z() != z);
  }
  const TissueState first = frame.tissue;
  while (!frame.tissue.converged) frame = wait_for(live, 0.5);
  EXPECT_LT(distance_of_all_but_a_hundredth(first, frame.tissue), 0.3);
}

TEST(Live, AnUnansweredWorkerEndsWithItsOwner) {
  const Scene scene = make_scene(box_patient());
  for (int i = 0; i < 20; ++i) {
    LiveSimulation live(scene, dropping(), {});
    live.request({.time_s = 0.1 * i});
  }
}

}  // namespace condyle::test
