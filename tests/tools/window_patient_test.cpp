// A whole session on a patient from files, with a picture of the screen at every step. Pictures are
// kept in build/test-results/pictures; `difference` (tests/support/picture.h) is their measure.
#include "window_session.h"

namespace condyle::test {
namespace {

TEST_F(WindowSession, ThePatientIsUsedFromOpeningToQuitting) {
  const std::string boxes = box_case(folder_), patient = folder_ / "phantom";
  const auto written = condyle({"phantom", "--out", patient});
  ASSERT_EQ(written.code, 0) << written.err;
  start({boxes, "--motion", "rest"});
  ASSERT_TRUE(wait_until(idle, 120));
  const auto shown_parts = [](const Json& s) { return s["edits"]["parts"].size(); };
  EXPECT_EQ(shown_parts(state()), 2u);
  see("boxes");
  const Picture the_boxes = seen_;

  // Open: the dialog, the folder, the patient in it.
  click("open-files");
  ASSERT_TRUE(wait_for_item("open-path"));
  write_into("open-path", folder_.path());
  ASSERT_TRUE(wait_for_item("file:phantom"));
  EXPECT_GT(see("dialog"), 0.3);
  click("file:phantom");
  ASSERT_TRUE(wait_until(
      [&](const Json& s) {
        return idle(s) && s["case"]["folder"] == fs::weakly_canonical(patient).string() &&
               s["motion"] == "opening" && shown_parts(s) > 4;
      },
      120))
      << state()["case"].dump() << state().value("trouble", "");
  EXPECT_FALSE(state()["items"].contains("open-path")) << "the dialog closes";
  see("opened");
  EXPECT_TRUE(unlike(seen_, the_boxes, 0.15, view_region())) << "another patient";
  click("tab:Motion");
  write_into("motion-words", "open 12 over 0.4; close over 0.4");
  ASSERT_TRUE(wait_until(
      [](const Json& s) { return idle(s) && s["motion"] == "open 12 over 0.4; close over 0.4"; },
      60));
  click("tab:Readings");
  EXPECT_LT(see("motion"), 0.003) << "the patient stays as he is";
  EXPECT_TRUE(press("k"));
  EXPECT_TRUE(press("a"));
  ASSERT_TRUE(wait_until([](const Json& s) { return s["skin_opacity"] == 0; }));
  EXPECT_GT(see("skull"), 0.03);

  // Play, pause, scrub, back to the start.
  EXPECT_TRUE(press("space"));
  EXPECT_TRUE(wait_until([](const Json& s) { return s["playing"] == true && s["time_s"] > 0.1; }));
  EXPECT_TRUE(press("space"));
  EXPECT_TRUE(wait_until([](const Json& s) {
    return s["playing"] == false && double(s["frame"]["opening_mm"]) > 0.5;
  })) << state()["frame"].dump();
  const Picture skull = seen_;
  EXPECT_GT(see("played"), 0.001);
  click("to-start");
  ASSERT_TRUE(wait_until([](const Json& s) { return s["frame"]["time_s"] == 0; }));
  see("back");
  EXPECT_TRUE(alike(seen_, skull, 0.003, view_region()));
  const auto scrub = rect("scrub");
  drag(scrub[0] + 0.1 * scrub[2], scrub[1] + scrub[3] / 2, scrub[0] + 0.5 * scrub[2],
       scrub[1] + scrub[3] / 2);
  EXPECT_TRUE(wait_until([](const Json& s) { return double(s["frame"]["opening_mm"]) > 9; }));
  EXPECT_GT(see("scrubbed"), 0.005);
  click("to-start");
  ASSERT_TRUE(wait_until([](const Json& s) { return s["frame"]["time_s"] == 0; }));

  // The mandible by its handles: down, up until the teeth meet, and aside along them.
  EXPECT_TRUE(press("m"));
  ASSERT_TRUE(wait_for_item("handle:S"));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  constexpr unsigned blue = 0x56b4e9, yellow = 0xf0e442;  // upward handle; points and lines
  see("handles");
  const Region up = region_of("handle:S");
  EXPECT_GT(colour_fraction(seen_, blue, up), 0.3);
  EXPECT_EQ(colour_fraction(seen_before_, blue, up), 0);
  const Picture at_rest = seen_;
  const auto pull = [&](const std::string& handle, double dx, double dy) {
    const auto tip = rect(handle);
    drag(tip[0] + 3, tip[1] + 3, tip[0] + 3 + dx, tip[1] + 3 + dy);
  };
  pull("handle:S", 0, 50);
  ASSERT_TRUE(wait_until([](const Json& s) {
    return double(s["frame"]["mandible_mm"][2]) < -8 && s["frame"]["stopped"] == false;
  })) << state()["frame"].dump();
  EXPECT_GT(see("pulled-down"), 0.005);
  pull("handle:S", 0, -110);
  ASSERT_TRUE(wait_until([](const Json& s) {
    return s["frame"]["stopped"] == true && double(s["X_CM_wanted"]["mm"][2]) > 5 &&
           std::abs(double(s["frame"]["mandible_mm"][2])) < 2 &&
           double(s["frame"]["penetration_mm"]) < 0.1;
  })) << state()["frame"].dump();
  EXPECT_GT(see("teeth-meet"), 0.005);
  const double before = double(state()["frame"]["mandible_mm"][0]);
  pull("handle:L", 15, 0);
  EXPECT_TRUE(wait_until([&](const Json& s) {
    return std::abs(double(s["frame"]["mandible_mm"][0]) - before) > 1 &&
           s["frame"]["stopped"] == true && double(s["frame"]["penetration_mm"]) < 0.1;
  })) << state()["frame"].dump();
  EXPECT_GT(see("teeth-slide"), 0.002);

  // Every step is undone.
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(press("ctrl+z"));
  ASSERT_TRUE(wait_until([](const Json& s) {
    // Home as far as contact permits: the teeth touch there.
    return !s.contains("X_CM_wanted") && std::abs(double(s["frame"]["mandible_mm"][2])) < 1e-3;
  }));
  see("undone");
  EXPECT_TRUE(alike(seen_, at_rest, 0.003, view_region()));
  EXPECT_TRUE(press("m"));

  // Muscles and layers of the tree; undone, too.
  click("show-all:muscles");
  EXPECT_TRUE(wait_until([](const Json& s) { return s["muscles_shown"] > 10; }));
  EXPECT_GT(see("muscles"), 0.002);
  click("show-all:layers");
  EXPECT_TRUE(wait_until([](const Json& s) { return s["layers_shown"] == 4; }));
  EXPECT_GT(see("layers"), 0.05);
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(press("ctrl+z"));
  EXPECT_TRUE(
      wait_until([](const Json& s) { return s["layers_shown"] == 0 && s["muscles_shown"] == 0; }));

  // Measure between two places of the forehead.
  EXPECT_TRUE(press("n"));
  EXPECT_TRUE(wait_for_item("measure"));
  const Region view = view_region();
  see("measuring");
  EXPECT_TRUE(unlike(seen_, seen_before_, 0.3, region_of("measure"))) << "its panel is there";
  EXPECT_EQ(colour_fraction(seen_, yellow, view), 0);
  for (const double x : {0.47, 0.54})
    EXPECT_TRUE(xdotool({"mousemove", px(view.x + x * view.width), px(view.y + 0.25 * view.height),
                         "click", "1", "sleep", "0.2"}));
  EXPECT_TRUE(wait_until([](const Json& s) { return s["measured"] == 2; }));
  EXPECT_GT(see("measured"), 2e-4);
  EXPECT_GT(colour_fraction(seen_, yellow, view), 2e-4);
  EXPECT_TRUE(press("n"));
  ASSERT_TRUE(wait_for_item("measure", false));
  see("measured-still");
  EXPECT_GT(colour_fraction(seen_, yellow, view), 2e-4) << "until it is cleared";

  // Record; the film shows the skull as the window does.
  click("tab:Record");
  click("record-height:720");
  click("record-rate:10");
  write_into("record-folder", folder_ / "film");
  see("record-panel");
  click("record");
  ASSERT_TRUE(wait_until([](const Json& s) {
    return s["busy_with"] == "recording" && s["items"].contains("record-cancel");
  }));
  const Region stop = region_of("record-cancel");
  see_now("recording");
  EXPECT_TRUE(unlike(seen_, seen_before_, 0.05, stop)) << "it can be stopped";
  ASSERT_TRUE(wait_until(idle, 120));
  const auto frame = [&](const char* number) {
    return Picture(folder_ / (std::string("film/frames/00000") + number + ".png"));
  };
  EXPECT_TRUE(fs::exists(folder_ / "film/film.mp4"));
  EXPECT_TRUE(unlike(frame("4"), frame("0"), 0.005)) << "the mouth opens";
  EXPECT_TRUE(alike(frame("8"), frame("0"), 0.005)) << "and closes";
  frame("4").save(kept_pictures() / "ThePatientIsUsedFromOpeningToQuitting-film.png");
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

}  // namespace
}  // namespace condyle::test
