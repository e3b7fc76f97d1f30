// The demonstration bimaxillary-by-hand, its list of steps performed with real mouse and key
// events.
#include "render/window/input/input_steps.h"
#include "tools/demo/by_hand_steps.h"
#include "window_session.h"

namespace condyle::test {
namespace {

class PlannedByHand : public WindowSession {
 protected:
  /// Waits until no background work runs, nor begins.
  void settle() {
    auto busy_at = std::chrono::steady_clock::now();
    ASSERT_TRUE(wait_until(
        [&](const Json& s) {
          const auto now = std::chrono::steady_clock::now();
          if (!idle(s)) busy_at = now;
          return now - busy_at > std::chrono::milliseconds(600);
        },
        300));
  }
  void perform(const InputStep& step) {
    SCOPED_TRACE("line " + std::to_string(step.line) +
                 ", trouble: " + state().value("trouble", ""));
    settle();
    using Kind = InputStep::Kind;
    switch (step.kind) {
      case Kind::say:
        break;
      case Kind::click:
        click(step.item);
        break;
      case Kind::choose:
        click(step.item);
        click(step.item + ":" + step.words);
        break;
      case Kind::enter:
        write_into(step.item, step.words);
        break;
      case Kind::drag: {
        ASSERT_TRUE(wait_for_item(step.item));
        const auto r = rect(step.item);
        const double x = r[0] + r[2] / 2, y = r[1] + r[3] / 2;
        drag(x, y, x + step.right, y + step.down);
        break;
      }
      case Kind::wheel: {
        ASSERT_TRUE(wait_for_item(step.item));
        const auto r = rect(step.item);
        EXPECT_TRUE(xdotool({"mousemove", px(r[0] + r[2] / 2), px(r[1] + r[3] / 2), "click",
                             "--repeat", px(std::abs(step.down)), step.down > 0 ? "5" : "4"}));
        break;
      }
      case Kind::key:
        EXPECT_TRUE(press(step.words));
        break;
      case Kind::wait:
        ASSERT_TRUE(wait_for_item(step.item)) << state().value("trouble", "");
        settle();
        break;
      case Kind::picture:
        see(step.words);
        break;
    }
  }
};

TEST_F(PlannedByHand, BothJawsFromAnEmptyPlanToSplints) {
  std::string list = by_hand_steps;
  const std::string variable = "{out}";
  const auto at = list.find(variable);
  ASSERT_NE(at, std::string::npos);
  list.replace(at, variable.size(), fs::path(folder_ / "plan.json").parent_path());
  start({by_hand_patient, "--motion", "rest"});
  ASSERT_TRUE(wait_until(idle, 300));
  for (const InputStep& step : parse_input_steps(list, "the demonstration's list")) {
    perform(step);
    if (HasFatalFailure()) return;
  }
  settle();
  const Json steps = Json::parse(read_text(folder_ / "plan.json"))["steps"];
  ASSERT_EQ(steps.size(), 6u);
  EXPECT_EQ(double(steps[1]["move"]["forward_mm"]), 4);
  EXPECT_EQ(double(steps[1]["move"]["up_mm"]), 3);
  EXPECT_TRUE(steps[3]["move"].contains("rotation")) << "the lower arch is placed by the bite";
  EXPECT_EQ(steps[5]["move"]["segment"], "chin");
  for (const char* splint : {"intermediate-upper-splint.stl", "final-splint.stl"}) {
    const fs::path file = folder_ / splint;
    ASSERT_TRUE(fs::exists(file)) << splint;
    EXPECT_GT(fs::file_size(file), 100000u) << splint;
  }
  EXPECT_EQ(state().value("trouble", ""), "");
}

}  // namespace
}  // namespace condyle::test
