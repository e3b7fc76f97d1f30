// A plan made by hand in the window: osteotomy, move, drag, undo, file.
#include <algorithm>

#include "window_session.h"

namespace condyle::test {
namespace {

TEST_F(WindowSession, AGenioplastyIsPlannedByHand) {
  const std::string file = folder_ / "plan.json";
  start({"--motion", "rest", "--no-tissue"});
  ASSERT_TRUE(wait_until(idle, 180));
  const auto parts = [](const Json& s) { return s["edits"]["parts"].size(); };
  const std::size_t uncut = parts(state());
  click("tab:Plan");
  click("plan-osteotomy");
  click("plan-osteotomy:genioplasty");
  ASSERT_TRUE(wait_until(
      [&](const Json& s) { return idle(s) && s["items"].contains("plan-step:1"); }, 120));
  EXPECT_EQ(parts(state()), uncut + 1) << "the chin is a part of its own";
  click("plan-move");
  click("plan-move:chin");
  ASSERT_TRUE(wait_until(
      [&](const Json& s) { return idle(s) && s["items"].contains("plan-step:2"); }, 120));
  write_into("plan-file", file);
  click("plan-save");
  ASSERT_TRUE(wait_until([&](const Json&) { return fs::exists(file); }));

  click("plan-step:2");
  ASSERT_TRUE(wait_for_item("plan-number:forward_mm"));
  write_into("plan-number:forward_mm", "6");
  const auto move = [&](const char* number) -> double {
    const Json steps = Json::parse(read_text(file))["steps"];
    return steps.size() < 2 ? -1.0 : double(steps[1]["move"][number]);
  };
  const auto chin_forward = [&] { return move("forward_mm"); };
  ASSERT_TRUE(wait_until([&](const Json& s) { return idle(s) && chin_forward() == 6; }, 120));
  see("forward");

  click("plan-undo");
  ASSERT_TRUE(wait_until([&](const Json& s) { return idle(s) && chin_forward() == 0; }, 120));
  click("plan-redo");
  ASSERT_TRUE(wait_until([&](const Json& s) { return idle(s) && chin_forward() == 6; }, 120));

  // A drag of the chin is added to its move.
  EXPECT_TRUE(press("m"));
  click("body");
  click("body:chin");
  ASSERT_TRUE(wait_for_item("shift:S"));
  write_into("shift:S", "-1.5");  // upward the mandible stops it
  ASSERT_TRUE(wait_until([](const Json& s) {
    return std::any_of(s["body_mm"].begin(), s["body_mm"].end(),
                       [](const Json& at) { return double(at[2]) < -1.4; });
  }));
  click("plan-take");
  ASSERT_TRUE(wait_until([&](const Json& s) { return idle(s) && move("up_mm") < -1; }, 120));
  EXPECT_NEAR(move("forward_mm"), 6, 0.2);

  // A move that collides is not made: the window asks, and can leave the plan as it is.
  const std::string before = read_text(file);
  write_into("plan-number:up_mm", "40");
  ASSERT_TRUE(wait_for_item("plan-leave")) << state().value("trouble", "");
  EXPECT_TRUE(state()["items"].contains("plan-free-part"));
  click("plan-leave");
  ASSERT_TRUE(wait_for_item("plan-leave", false));
  EXPECT_EQ(read_text(file), before);
}

}  // namespace
}  // namespace condyle::test
