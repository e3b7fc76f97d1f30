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
  choose_body("chin");
  ASSERT_TRUE(wait_for_item("shift:S"));
  write_into("shift:S", "-1.5");  // upward the mandible stops it
  const auto is_lowered = [](const Json& s) {
    return std::any_of(s["body_mm"].begin(), s["body_mm"].end(),
                       [](const Json& at) { return double(at[2]) < -1.4; });
  };
  ASSERT_TRUE(wait_until(is_lowered, 120));
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

int count_pixels(const Picture& picture, const Region& region,
                 const std::function<bool(const std::uint8_t* rgba)>& counts) {
  int count = 0;
  for (int y = int(region.y); y < int(region.y + region.height); ++y)
    for (int x = int(region.x); x < int(region.x + region.width); ++x)
      count += counts(&picture.rgba[4 * (std::size_t(y) * picture.width + x)]);
  return count;
}

/// Pixels with much more green than red.
int green_pixels(const Picture& picture, const Region& region) {
  return count_pixels(picture, region, [](const std::uint8_t* p) { return p[1] > p[0] + 20; });
}

/// Pixels of gums.
int pink_pixels(const Picture& picture, const Region& region) {
  return count_pixels(picture, region,
                      [](const std::uint8_t* p) { return p[0] > p[1] + 60 && p[2] > 60; });
}

TEST_F(WindowSession, LeftOfTheWipeResectedBoneIsThereAndItsGraftIsNot) {
  const std::string plan = folder_ / "plan.json";
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"plan", "new", "--out", plan},
        {"plan", "resect", plan, "tumour", "--from", "44", "--to", "47", "--below-margins"},
        {"plan", "graft", plan, "tumour", "--pieces", "2"}}) {
    const Outcome made = condyle(arguments);
    ASSERT_EQ(made.code, 0) << made.err;
  }
  const auto seen_from_the_front = [&](const char* step) {
    ASSERT_TRUE(wait_until(idle, 180));
    EXPECT_TRUE(press("a"));
    const auto finished_from_the_front = [](const Json& s) {
      return double(s["camera_direction"][1]) < -0.9999 && s["picture_finished"] == true;
    };
    ASSERT_TRUE(wait_until(finished_from_the_front));
    // The face alone is hidden: with the skin off the gums would be, too.
    const std::array<double, 4> view = state()["view"];
    EXPECT_TRUE(xdotool(
        {"mousemove", px(view[0] + view[2] / 2), px(view[1] + 0.35 * view[3]), "click", "3"}));
    ASSERT_TRUE(wait_for_item("part-menu"));
    EXPECT_EQ(state()["words"]["part-menu"], "Face");
    click("menu:hide");
    ASSERT_TRUE(wait_for_item("part-menu", false));
    ASSERT_TRUE(wait_until(finished_from_the_front));
    see(step);
  };
  const std::string motion = "open 1 over 0.2";
  start({"--motion", motion, "--no-tissue"});
  seen_from_the_front("uncut");
  const Picture uncut = seen_;
  EXPECT_TRUE(press("ctrl+q"));
  ASSERT_EQ(wait_for_end(), 0);

  start({"--plan", plan, "--motion", motion, "--no-tissue"});
  seen_from_the_front("now");
  const Picture now = seen_;
  click("left-tab:Look");
  click("wipe");
  ASSERT_TRUE(wait_for_item("wipe:line"));
  see("wiped");
  Region right_side = view_region();  // of the patient, where the jaw was resected
  right_side.width *= 0.47;
  // Resected bone has the colour of a segment; the rest is as it was, the graft away.
  EXPECT_GT(difference(uncut, now, right_side), 0.005);
  EXPECT_GT(green_pixels(now, right_side), 200) << "the graft";
  EXPECT_EQ(green_pixels(seen_, right_side), 0);
  // The gums, which were resected with the bone, are there again.
  EXPECT_LT(pink_pixels(now, right_side), 0.8 * pink_pixels(uncut, right_side));
  EXPECT_GT(pink_pixels(seen_, right_side), 0.95 * pink_pixels(uncut, right_side));

  // So it is in a recording.
  click("tab:Record");
  click("record-height:720");
  click("record-rate:10");
  click("record-film");
  write_into("record-folder", folder_ / "film");
  click("record");
  ASSERT_TRUE(wait_until(
      [&](const Json& s) { return idle(s) && fs::exists(folder_ / "film/hashes.csv"); }));
  const Picture first(folder_ / "film/frames/000000.png");
  ASSERT_FALSE(first.empty());
  first.save(kept_pictures() / (test_name() + "-recorded.png"));
  EXPECT_EQ(green_pixels(first, {0, 0, 0.49 * first.width, double(first.height)}), 0);
  EXPECT_GT(difference(first, Picture(folder_ / "film/frames/000002.png")), 0);
}

TEST_F(WindowSession, APartIsPickedAndCutWithTheMouse) {
  const std::string file = folder_ / "plan.json";
  start({"--motion", "rest", "--no-tissue"});
  ASSERT_TRUE(wait_until(idle, 180));
  EXPECT_TRUE(press("k"));
  EXPECT_TRUE(press("a"));
  const auto place = [&](double right, double down) {  // of the height of the view, from its middle
    const std::array<double, 4> view = state()["view"];
    return std::pair(view[0] + view[2] / 2 + right * view[3], view[1] + (0.5 + down) * view[3]);
  };
  const auto press_at = [&](double right, double down, const char* button) {
    const auto [x, y] = place(right, down);
    EXPECT_TRUE(xdotool({"mousemove", px(x), px(y), "click", button}));
  };
  constexpr double chin = 0.14;
  ASSERT_TRUE(wait_until([](const Json& s) {  // the camera has turned to the front
    return double(s["camera_direction"][1]) < -0.9999 && s["picture_finished"] == true;
  }));
  // Movement, press and release arrive together, as they do while a picture takes long.
  ASSERT_EQ(kill(program(), SIGSTOP), 0);
  press_at(0, chin, "3");
  ASSERT_EQ(kill(program(), SIGCONT), 0);
  ASSERT_TRUE(wait_for_item("part-menu"));
  see("menu");
  click("menu:hide");
  const auto shown = [](const Json& s) {
    return std::count_if(s["edits"]["parts"].begin(), s["edits"]["parts"].end(),
                         [](const Json& opacity) { return double(opacity) > 0; });
  };
  const auto all = std::ptrdiff_t(state()["edits"]["parts"].size());
  ASSERT_TRUE(wait_until([&](const Json& s) { return shown(s) == all - 1; }));
  EXPECT_TRUE(press("ctrl+z"));
  ASSERT_TRUE(wait_until([&](const Json& s) { return shown(s) == all; }));

  // Its mirror image lies over it as glass.
  see("whole");
  press_at(0, chin, "3");
  click("menu:mirror");
  ASSERT_TRUE(wait_until([](const Json& s) { return s["edits"]["mirrored"] == "mandible"; }));
  EXPECT_GT(see("mirrored"), 0.01);
  press_at(0, chin, "3");
  click("menu:mirror");
  ASSERT_TRUE(wait_until([](const Json& s) { return s["edits"]["mirrored"] == ""; }));

  press_at(0, chin, "3");
  click("menu:cut");
  ASSERT_TRUE(wait_for_item("cut-add"));
  // From beside the bone across the chin to beside the bone.
  for (const auto& [right, down] : {std::pair{-0.19, 0.10}, {0.0, chin}, {0.19, 0.10}}) {
    const std::size_t before = state()["drawn_points"];
    press_at(right, down, "1");
    ASSERT_TRUE(wait_until([&](const Json& s) { return s["drawn_points"] == before + 1; }));
  }
  ASSERT_TRUE(wait_for_item("cut-findings"));
  see("drawn");
  const std::size_t uncut = state()["edits"]["parts"].size();
  click("tab:Plan");
  EXPECT_TRUE(press("Return"));
  const auto is_made = [](const Json& s) { return s["items"].contains("plan-step:1"); };
  ASSERT_TRUE(wait_until(
      [&](const Json& s) { return is_made(s) || s["items"].contains("plan-agree"); }, 120));
  if (!is_made(state())) click("plan-agree");  // near the canals
  ASSERT_TRUE(wait_until([&](const Json& s) { return idle(s) && is_made(s); }, 120));
  EXPECT_EQ(state()["edits"]["parts"].size(), uncut + 1);
  write_into("plan-file", file);
  click("plan-save");
  ASSERT_TRUE(wait_until([&](const Json&) { return fs::exists(file); }));

  // A point of the cut is dragged by its handle.
  click("plan-step:1");
  ASSERT_TRUE(wait_for_item("handle:point-2"));
  const auto polyline = [&] {
    return Json::parse(read_text(file))["steps"][0]["cut"]["surfaces"][0]["polyline"];
  };
  const Json before = polyline();
  const auto handle = rect("handle:point-2");
  drag(handle[0] + 4, handle[1] + 4, handle[0] + 4, handle[1] + 10);
  ASSERT_TRUE(wait_until(
      [&](const Json& s) {
        return s["items"].contains("plan-agree") || (idle(s) && polyline() != before);
      },
      120));
  if (state()["items"].contains("plan-agree")) click("plan-agree");
  ASSERT_TRUE(wait_until([&](const Json& s) { return idle(s) && polyline() != before; }, 120));
  EXPECT_LT(double(polyline()[1][2]), double(before[1][2])) << "downward";
  see("dragged");

  // Ctrl+Z takes the last edit of the plan back, and says so.
  EXPECT_TRUE(press("ctrl+z"));
  ASSERT_TRUE(wait_until([&](const Json& s) { return idle(s) && polyline() == before; }, 120));
}

}  // namespace
}  // namespace condyle::test
