#include "render/window/view/playback.h"

#include <gtest/gtest.h>

#include <set>

#include "render/window/input/mouse_queue.h"
#include "render/window/input/shortcuts.h"
#include "render/window/picture/quality.h"

namespace condyle {
namespace {

TEST(Playback, ClockRunsAtTheRequestedSpeed) {
  ViewState view;
  view.playing = true;
  view.speed = 0.5;
  for (int i = 0; i < 60; ++i) advance_clock(view, 1.0 / 60, 4, view.time_s);
  EXPECT_NEAR(view.time_s, 0.5, 1e-9);
}

TEST(Playback, ClockWaitsForASlowSimulation) {
  ViewState view;
  view.playing = true;
  view.time_s = 1.0;
  for (int i = 0; i < 60; ++i) advance_clock(view, 1.0 / 60, 4, 1.0);
  EXPECT_NEAR(view.time_s, 1.0 + allowed_lead_s(1.0 / 60), 1e-9);
  // Also when the clock has wrapped and the frame is still at the end.
  view.time_s = 0.02;
  advance_clock(view, 1, 4, 3.95);
  EXPECT_NEAR(view.time_s, 3.95 + allowed_lead_s(1) - 4, 1e-9);
}

TEST(Playback, ClockRunsOnWhenTheFrameIsAStepAhead) {
  for (const bool loop : {true, false}) {
    ViewState view;
    view.playing = true;
    view.loop = loop;
    view.time_s = 1.0;
    advance_clock(view, 0.02, 4, 1.0 + 1.0 / 120);
    EXPECT_NEAR(view.time_s, 1.02, 1e-9);
  }
}

TEST(Playback, LoopsOrStopsAtTheEnd) {
  ViewState view;
  view.playing = true;
  view.time_s = 3.99;
  advance_clock(view, 0.05, 4, 3.99);
  EXPECT_TRUE(view.playing);
  EXPECT_NEAR(view.time_s, 0.04, 1e-9);
  view.playing = true;
  view.loop = false;
  view.time_s = 3.99;
  advance_clock(view, 0.05, 4, 3.99);
  EXPECT_FALSE(view.playing);
  EXPECT_EQ(view.time_s, 4);
  toggle_playing(view, 4, {});  // from the end it begins anew
  EXPECT_TRUE(view.playing);
  EXPECT_EQ(view.time_s, 0);
}

TEST(Playback, TimeStaysInTheMotionAndTheHandIsReleased) {
  ViewState view;
  view.opening_mm = 12;
  step_clock(view, -1, 4, {});
  EXPECT_EQ(view.time_s, 0);
  EXPECT_FALSE(view.opening_mm.has_value());
  seek(view, 99, 4, {});
  EXPECT_EQ(view.time_s, 4);
  view.opening_mm = 3;
  view.time_s = 1;
  toggle_playing(view, 4, {});
  EXPECT_FALSE(view.opening_mm.has_value());
  ViewState still;
  toggle_playing(still, 0, {});  // no motion: nothing to play
  EXPECT_FALSE(still.playing);
}

TEST(Quality, FallsWhileMovingOnASlowDriverAndIsFullAtRest) {
  QualityGovernor governor;
  const Quality best = governor.choose(false);
  EXPECT_EQ(best.render_scale, 1);
  EXPECT_EQ(best.samples, 4);
  double cost_before = 1e9;
  for (int i = 0; i < 30; ++i) {
    const Quality now = governor.choose(true);
    const double cost =
        now.render_scale * now.render_scale * (now.samples > 1 ? 4 : 1) + (now.shadows ? 0.5 : 0);
    EXPECT_LE(cost, cost_before);
    cost_before = cost;
    governor.measured(true, 60);
  }
  const Quality slow = governor.choose(true);
  EXPECT_NEAR(slow.render_scale, 0.66, 1e-9);
  EXPECT_EQ(slow.samples, 1);
  EXPECT_FALSE(slow.shadows);
  EXPECT_EQ(governor.choose(false), best);
  for (int i = 0; i < 400; ++i) governor.measured(true, 2);  // a fast machine gets it all back
  EXPECT_EQ(governor.choose(true), best);
}

TEST(Quality, LosesMostPixelsOnlyWhereThePictureWouldStandStill) {
  QualityGovernor governor;
  for (int i = 0; i < 100; ++i) governor.measured(true, 70);  // 14 a second
  EXPECT_LT(governor.choose(true).render_scale, 0.5);
  EXPECT_EQ(governor.choose(false), Quality{});
}

TEST(Quality, PicturesLeaveTheirTimeToASimulationThatNeedsIt) {
  QualityGovernor governor;
  EXPECT_EQ(governor.min_interval_s(), 0);
  governor.simulated(0);  // not a step yet
  EXPECT_EQ(governor.min_interval_s(), 0);
  governor.simulated(45);
  EXPECT_GT(governor.min_interval_s(), 0.05);
  EXPECT_LT(governor.min_interval_s(), 1.0 / 15);  // still 15 a second
  governor.simulated(70);                          // it would fall behind again
  EXPECT_GT(governor.min_interval_s(), 0.05);
  governor.simulated(200);
  EXPECT_EQ(governor.min_interval_s(), 0);
}

TEST(Quality, OneSlowPictureIsForgiven) {
  QualityGovernor governor;
  const Quality before = governor.choose(true);
  governor.measured(true, 50);
  governor.measured(true, 10);
  EXPECT_EQ(governor.choose(true), before);
}

TEST(MouseQueue, KeepsEveryPressWithItsPosition) {
  MouseQueue queue;
  queue.moved(10, 10);
  queue.moved(20, 20);
  queue.pressed(0, true);
  queue.pressed(0, false);
  queue.moved(30, 30);
  queue.moved(40, 40);
  const MouseMoment arrived = queue.take();
  EXPECT_EQ(arrived.x, 20);  // of moves in a row only the last
  EXPECT_FALSE(arrived.down[0]);
  const MouseMoment down = queue.take();
  EXPECT_EQ(down.x, 20);
  EXPECT_TRUE(down.down[0]);
  const MouseMoment up = queue.take();
  EXPECT_EQ(up.x, 20);
  EXPECT_FALSE(up.down[0]);
  EXPECT_EQ(queue.take().x, 40);
  EXPECT_FALSE(queue.waiting());
  EXPECT_EQ(queue.take().x, 40);
}

TEST(Shortcuts, ShiftGivesTheOppositeViewAndTheHelpListsEveryShortcut) {
  for (int key : {'A', 'P', 'L', 'R', 'S', 'I'}) {
    const auto plain = command_of({.key = key}), shifted = command_of({.key = key, .shift = true});
    ASSERT_TRUE(plain && shifted);
    const std::set<std::string_view> pair = {camera_of(*plain), camera_of(*shifted)};
    EXPECT_TRUE((pair == std::set<std::string_view>{"front", "back"}) ||
                (pair == std::set<std::string_view>{"left", "right"}) ||
                (pair == std::set<std::string_view>{"above", "below"}));
  }
  EXPECT_EQ(command_of({.key = 'Q', .ctrl = true}), Command::quit);
  EXPECT_FALSE(command_of({.key = 'Q'}).has_value());
  int lines = 0;
  for (const HelpGroup& group : help_groups())
    for (const HelpLine& line : group.lines) {
      EXPECT_FALSE(line.keys.empty() || line.meaning.empty());
      ++lines;
    }
  EXPECT_GT(lines, 12);
}

}  // namespace
}  // namespace condyle
