// A segment that is picked and dragged with the mouse.
#include <algorithm>

#include "window_session.h"

namespace condyle::test {
namespace {

/// A window with a chin that was cut off and not moved.
class ChinWindow : public WindowSession {
 protected:
  void open_plan() {
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"plan", "new", "--out", plan_},
          {"plan", "cut", plan_, "genioplasty", "--pieces", "chin"}})
      ASSERT_EQ(condyle(words).code, 0);
    start({"--plan", plan_, "--motion", "rest", "--no-tissue"});
    ASSERT_TRUE(wait_until(idle, 180));
    EXPECT_TRUE(press("k"));
    EXPECT_TRUE(press("a"));
    ASSERT_TRUE(wait_until([](const Json& s) {  // the camera has turned to the front
      return double(s["camera_direction"][1]) < -0.9999 && s["picture_finished"] == true;
    }));
  }
  /// A place of the view, by the height of the view from its middle.
  std::pair<double, double> place(double right, double down) {
    const std::array<double, 4> view = state()["view"];
    return {view[0] + view[2] / 2 + right * view[3], view[1] + (0.5 + down) * view[3]};
  }
  void click_at(double right, double down, const char* button) {
    const auto [x, y] = place(right, down);
    EXPECT_TRUE(xdotool({"mousemove", px(x), px(y), "click", button}));
  }
  /// The chin's menu, and a line of it.
  void choose(const std::string& line) {
    click_at(0, chin_, "3");
    ASSERT_TRUE(wait_for_item("part-menu"));
    EXPECT_EQ(state()["words"]["part-menu"], "Chin");
    click("menu:" + line);
    ASSERT_TRUE(wait_for_item("part-menu", false));
  }
  /// Presses the mouse on the chin, beside the handles in its middle, and moves it by pixels,
  /// without releasing it.
  void grip(double right_px, double down_px) {
    const auto [x, y] = place(0.042, 0.161);
    EXPECT_TRUE(xdotool({"mousemove", px(x), px(y), "mousedown", "1", "sleep", "0.2", "mousemove",
                         px(x + right_px / 2), px(y + down_px / 2), "sleep", "0.1", "mousemove",
                         px(x + right_px), px(y + down_px)}));
  }
  void let_go() { EXPECT_TRUE(xdotool({"mouseup", "1"})); }
  static std::array<double, 3> chin_mm(const Json& s) { return s["body_mm"].back(); }
  bool wait_for_chin(const std::function<bool(const std::array<double, 3>&)>& law) {
    return wait_until([&](const Json& s) { return s.contains("body_mm") && law(chin_mm(s)); }, 30);
  }

  const std::string plan_ = folder_ / "plan.json";
  double chin_ = 0.165;  // below the middle of the view
};

TEST_F(ChinWindow, TheMenuOfAPartShowsItAsGlassAloneMeasuredAndMoved) {
  open_plan();
  const auto opacities = [](const Json& s) {
    return s["edits"]["parts"].get<std::vector<double>>();
  };
  const auto before = opacities(state());
  const auto count = [&](const Json& s, const std::function<bool(double)>& law) {
    const auto now = opacities(s);
    return std::count_if(now.begin(), now.end(), law);
  };
  see("opaque");
  choose("glass");
  EXPECT_TRUE(wait_until(
      [&](const Json& s) { return count(s, [](double o) { return o > 0.1 && o < 0.5; }) == 1; }));
  EXPECT_GT(see("glass"), 0.002);
  choose("glass");
  EXPECT_TRUE(wait_until([&](const Json& s) { return opacities(s) == before; }));
  choose("alone");
  EXPECT_TRUE(
      wait_until([&](const Json& s) { return count(s, [](double o) { return o > 0; }) == 1; }));
  EXPECT_GT(see("alone"), 0.05);
  choose("show-all");
  EXPECT_TRUE(wait_until([&](const Json& s) { return opacities(s) == before; }));
  choose("measure");
  EXPECT_TRUE(wait_until([](const Json& s) { return s["measured"] == 1; }));
  EXPECT_TRUE(press("ctrl+z"));
  EXPECT_TRUE(wait_until([](const Json& s) { return s["measured"] == 0; }));
  choose("move");
  EXPECT_TRUE(wait_until([](const Json& s) { return s["chosen"] == "chin"; }));
  EXPECT_TRUE(wait_for_item("shift:S"));
  // A double click focuses: the camera turns about the chin, nearer to it.
  EXPECT_TRUE(press("Escape"));
  const Json camera = state()["camera"];
  const auto [x, y] = place(0, chin_);
  EXPECT_TRUE(xdotool({"mousemove", px(x), px(y), "click", "--repeat", "2", "--delay", "60", "1"}));
  EXPECT_TRUE(wait_until([&](const Json& s) {
    return double(s["camera"]["distance_mm"]) < 0.7 * double(camera["distance_mm"]) &&
           double(s["camera"]["target_mm"][2]) < double(camera["target_mm"][2]) - 20;
  }));
  EXPECT_EQ(state()["selected"], "chin");
  EXPECT_GT(see("focused"), 0.1);
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(ChinWindow, ADragKeepsToItsAxisSnapsIsStoppedByBoneAndFillsTheTable) {
  open_plan();
  choose("move");
  ASSERT_TRUE(wait_until([](const Json& s) { return s["chosen"] == "chin"; }));
  click("tab:Plan");
  click("plan-cephalometry");
  const auto angle = [](const Json& s) {
    return s["words"].value("plan-measure:facial angle (Frankfort to N-Pog)", "");
  };
  ASSERT_TRUE(wait_until([&](const Json& s) { return !angle(s).empty(); }));
  const std::string uncut_angle = angle(state());

  see("handles");
  grip(24, 36);
  ASSERT_TRUE(wait_for_chin([](const auto& mm) { return mm[0] > 1 && mm[2] < -2; }));
  EXPECT_TRUE(press("z"));
  ASSERT_TRUE(wait_for_chin([](const auto& mm) { return std::abs(mm[0]) < 0.01 && mm[2] < -2; }));
  // The tables follow while the chin is in the hand.
  ASSERT_TRUE(wait_for_item("plan-displacements"));
  EXPECT_TRUE(wait_until([&](const Json& s) { return angle(s) != uncut_angle; }, 30));
  EXPECT_TRUE(press("x"));  // along the cut face, on which it slides
  ASSERT_TRUE(wait_for_chin([](const auto& mm) { return mm[0] > 1 && std::abs(mm[2]) < 0.6; }));
  EXPECT_TRUE(press("x"));
  ASSERT_TRUE(wait_for_chin([](const auto& mm) { return mm[0] > 1 && mm[2] < -2; }));
  EXPECT_TRUE(xdotool({"keydown", "ctrl", "sleep", "0.1", "mousemove_relative", "--", "1", "1"}));
  EXPECT_TRUE(wait_until(
      [](const Json& s) {  // to half millimetres along the patient's axes
        for (const char* axis : {"L", "P", "S"}) {
          const std::string mm = s["words"].value(std::string("reached:shift:") + axis, "");
          if (!mm.ends_with(".00 mm") && !mm.ends_with(".50 mm")) return false;
        }
        return chin_mm(s)[2] < -2;
      },
      30))
      << state()["words"].dump();
  EXPECT_TRUE(xdotool({"keyup", "ctrl"}));
  let_go();
  click("plan-displacements");
  EXPECT_TRUE(wait_until([](const Json& s) {
    return s["words"].value("plan-displacement:Pog", "").find("down") != std::string::npos;
  }));
  see("table-of-the-hand");
  EXPECT_TRUE(press("ctrl+z"));
  ASSERT_TRUE(wait_for_chin([](const auto& mm) { return std::abs(mm[2]) < 1e-6; }));
  EXPECT_TRUE(wait_for_item("plan-displacement:Pog", false));
  EXPECT_TRUE(wait_until([&](const Json& s) { return angle(s) == uncut_angle; }, 30));

  // Upward the mandible stops it.
  grip(0, -60);
  EXPECT_TRUE(wait_until([](const Json& s) { return s["frame"]["stopped"] == true; }, 30));
  EXPECT_LT(chin_mm(state())[2], 1);
  EXPECT_LT(double(state()["frame"]["penetration_mm"]), 0.3);
  let_go();
  EXPECT_TRUE(press("ctrl+z"));
  ASSERT_TRUE(wait_for_chin([](const auto& mm) { return std::abs(mm[2]) < 1e-6; }));

  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(ChinWindow, StepsAreReorderedRemovedAndUndoneByNameAndADragMeanwhileIsSafe) {
  open_plan();
  const auto steps = [&] { return Json::parse(read_text(plan_))["steps"]; };
  click("tab:Plan");
  click("plan-move");
  click("plan-move:chin");
  ASSERT_TRUE(wait_until([&](const Json& s) { return idle(s) && steps().size() == 2; }));
  click("plan-step:2");
  ASSERT_TRUE(wait_for_item("plan-number:forward_mm"));

  // A drag while the plan is being applied: the edit is made, and the window goes on.
  EXPECT_TRUE(press("m"));
  choose_body("chin");
  click("tab:Plan");
  write_into("plan-number:forward_mm", "5");
  ASSERT_TRUE(wait_until([](const Json& s) { return s["busy_with"] != ""; }));
  grip(0, 30);
  let_go();
  ASSERT_TRUE(
      wait_until([&](const Json& s) { return idle(s) && steps()[1]["move"]["forward_mm"] == 5; }));
  EXPECT_FALSE(state().contains("trouble")) << state()["trouble"];
  EXPECT_TRUE(press("m"));
  const auto says = [&](const std::string& words) {
    return wait_until([&](const Json& s) { return s.value("said", "") == words; });
  };
  click("plan-undo");
  EXPECT_TRUE(says("Undone: move chin"));
  ASSERT_TRUE(
      wait_until([&](const Json& s) { return idle(s) && steps()[1]["move"]["forward_mm"] == 0; }));
  click("plan-redo");
  EXPECT_TRUE(says("Redone: move chin"));
  ASSERT_TRUE(
      wait_until([&](const Json& s) { return idle(s) && steps()[1]["move"]["forward_mm"] == 5; }));

  // A move cannot come before the cut that makes its segment: nothing changes.
  const std::string before = read_text(plan_);
  click("plan-earlier");
  ASSERT_TRUE(wait_for_item("error"));
  EXPECT_NE(state().value("trouble", "").find("chin"), std::string::npos);
  click("close-error");
  EXPECT_EQ(read_text(plan_), before);
  click("plan-remove");
  ASSERT_TRUE(wait_until([&](const Json& s) { return idle(s) && steps().size() == 1; }));
  click("plan-undo");
  EXPECT_TRUE(says("Undone: remove step 2 (move chin)"));
  ASSERT_TRUE(wait_until([&](const Json& s) { return idle(s) && steps().size() == 2; }));
  EXPECT_EQ(steps(), Json::parse(before)["steps"]);
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

}  // namespace
}  // namespace condyle::test
