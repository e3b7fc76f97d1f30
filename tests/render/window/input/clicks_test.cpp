#include "render/window/input/clicks.h"

#include <gtest/gtest.h>

namespace condyle {
namespace {

TEST(ClickDetector, DistinguishesClicksFromDrags) {
  ClickDetector clicks;
  clicks.press(0, {100, 100});
  const auto click = clicks.release(0, {102, 101}, 1.0);
  ASSERT_TRUE(click);
  EXPECT_FALSE(click->is_double);
  clicks.press(0, {100, 100});
  clicks.moved({160, 100});
  clicks.moved({100, 100});
  EXPECT_FALSE(clicks.release(0, {100, 100}, 1.1)) << "it came back from a drag";
  EXPECT_FALSE(clicks.release(0, {100, 100}, 1.2)) << "it was not pressed";
  clicks.press(1, {10, 10});
  EXPECT_FALSE(clicks.release(0, {10, 10}, 1.3)) << "another button";
}

TEST(ClickDetector, TwoNearClicksAreADoubleClick) {
  ClickDetector clicks;
  const auto click = [&](double x, double time_s) {
    clicks.press(0, {x, 0});
    return clicks.release(0, {x, 0}, time_s)->is_double;
  };
  EXPECT_FALSE(click(0, 0));
  EXPECT_TRUE(click(1, 0.3));
  EXPECT_FALSE(click(1, 0.5)) << "a third one begins anew";
  EXPECT_FALSE(click(1, 2));
  EXPECT_FALSE(click(30, 2.2)) << "elsewhere";
}

}  // namespace
}  // namespace condyle
