// The window as people use it: the program on a virtual screen, with real mouse and keyboard.
#include "window_session.h"

namespace condyle::test {
namespace {

TEST_F(WindowSession, OpenPlayScrubDragSlideUndoMeasureRecordQuit) {
  const std::string patient = box_case(folder_);
  write_text(folder_ / "down.csv",
             "time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n0.5,0,0,-10,1,0,0,0\n"
             "1,0,0,0,1,0,0,0\n");
  start({patient, "--motion", folder_ / "down.csv"});
  ASSERT_TRUE(wait_until(idle)) << "the patient is loaded";

  // Open the same patient by its path.
  EXPECT_TRUE(press("ctrl+o"));
  click("open-path");
  ASSERT_TRUE(wait_for_item("writing"));
  EXPECT_TRUE(xdotool({"type", patient}));
  EXPECT_TRUE(press("Return"));
  EXPECT_TRUE(wait_for_item("open", false)) << "the dialog closes";
  ASSERT_TRUE(wait_until([](const Json& s) { return idle(s) && s["motion"] == "opening"; }));
  EXPECT_EQ(read_text(folder_ / "config/condyle/recent"),
            fs::weakly_canonical(patient).string() + "\n");
  // A motion from a file.
  EXPECT_TRUE(press("ctrl+o"));
  click("open-path");
  ASSERT_TRUE(wait_for_item("writing"));
  EXPECT_TRUE(press("ctrl+a"));
  EXPECT_TRUE(xdotool({"type", folder_ / "down.csv"}));
  EXPECT_TRUE(press("Return"));
  ASSERT_TRUE(wait_until([&](const Json& s) { return idle(s) && s["motion"] != "opening"; }));

  // Play, pause, scrub.
  click("play");
  EXPECT_TRUE(wait_until([](const Json& s) { return s["playing"] == true && s["time_s"] > 0.1; }));
  click("play");
  EXPECT_TRUE(wait_until([](const Json& s) { return s["playing"] == false; }));
  const auto scrub = rect("scrub");
  drag(scrub[0] + 0.2 * scrub[2], scrub[1] + scrub[3] / 2, scrub[0] + 0.5 * scrub[2],
       scrub[1] + scrub[3] / 2);
  EXPECT_TRUE(wait_until([](const Json& s) {
    return std::abs(double(s["time_s"]) - 0.5) < 0.05 && double(s["frame"]["mandible_mm"][2]) < -8;
  }));
  click("to-start");

  // A recorded motion is played unaltered until contact is enabled.
  click("obey-contact");
  // Drag the mandible up by its handle until it meets the maxilla, 1 mm above.
  EXPECT_TRUE(press("a"));
  EXPECT_TRUE(press("m"));
  ASSERT_TRUE(wait_for_item("handle:S"));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  auto tip = rect("handle:S");
  drag(tip[0] + 3, tip[1] + 3, tip[0] + 3, tip[1] - 57);
  ASSERT_TRUE(wait_until([](const Json& s) {
    return s.contains("X_CM_wanted") && double(s["X_CM_wanted"]["mm"][2]) > 5 &&
           s["frame"]["stopped"] == true;
  }));
  ASSERT_TRUE(wait_until([](const Json& s) {
    return std::abs(double(s["frame"]["mandible_mm"][2]) - 1) < 0.2;
  })) << state()["frame"].dump();
  // Held there, it slides aside.
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const double before = double(state()["frame"]["mandible_mm"][0]);
  tip = rect("handle:L");
  drag(tip[0] + 3, tip[1] + 3, tip[0] + 53, tip[1] + 3);
  EXPECT_TRUE(wait_until([&](const Json& s) {
    return std::abs(double(s["frame"]["mandible_mm"][0]) - before) > 3 &&
           std::abs(double(s["frame"]["mandible_mm"][2]) - 1) < 0.2 &&
           double(s["frame"]["penetration_mm"]) < 0.1;
  })) << state()["frame"].dump();
  EXPECT_TRUE(press("ctrl+z"));
  EXPECT_TRUE(press("ctrl+z"));
  EXPECT_TRUE(wait_until([](const Json& s) {
    return !s.contains("X_CM_wanted") && std::abs(double(s["frame"]["mandible_mm"][2])) < 1e-6;
  }));

  // Measure between two places of the bone in front.
  EXPECT_TRUE(press("n"));
  EXPECT_TRUE(wait_for_item("measure"));
  const std::array<double, 4> view = state()["view"];
  for (const double x : {0.48, 0.54})
    EXPECT_TRUE(xdotool({"mousemove", px(view[0] + x * view[2]), px(view[1] + 0.40 * view[3]),
                         "click", "1", "sleep", "0.2"}));
  EXPECT_TRUE(wait_until([](const Json& s) { return s["measured"] == 2; })) << state()["measured"];
  EXPECT_TRUE(press("n"));

  // Record; the window stays usable meanwhile.
  click("tab:Record");
  click("record-height:720");
  click("record-rate:10");
  click("record-folder");
  ASSERT_TRUE(wait_for_item("writing"));
  EXPECT_TRUE(press("ctrl+a"));
  ASSERT_TRUE(wait_for_item("record-where"));
  const auto button = rect("record");
  EXPECT_TRUE(xdotool({"type", folder_ / "film"}));
  EXPECT_TRUE(press("Return"));
  ASSERT_TRUE(wait_for_item("record-where", false));
  EXPECT_EQ(rect("record"), button) << "the button moved when another folder was typed";
  click("record");
  EXPECT_TRUE(wait_until([](const Json& s) { return s["busy_with"] == "recording"; }));
  EXPECT_TRUE(press("l"));
  EXPECT_TRUE(wait_until([](const Json& s) { return double(s["camera_direction"][0]) > 0.99; }));
  ASSERT_TRUE(wait_until(idle, 60));
  EXPECT_TRUE(fs::exists(folder_ / "film/frames/000010.png"));
  EXPECT_TRUE(fs::exists(folder_ / "film/film.mp4"));
  EXPECT_GT(fs::file_size(folder_ / "film/film.mp4"), 2000u);

  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, ATooltipIsSeenThoughNothingElseMoves) {
  start({box_case(folder_), "--motion", "rest"});
  ASSERT_TRUE(wait_until(idle));
  see("without");
  for (const std::string item : {"play", "obey-contact", "picture"}) {
    const auto r = rect(item);
    EXPECT_TRUE(xdotool({"mousemove", px(r[0] + r[2] / 2), px(r[1] + r[3] / 2)}));
    ASSERT_TRUE(wait_for_item("tooltip"));
    const Region place = see_changed("tooltip-of-" + item, "tooltip", 0.1);
    EXPECT_TRUE(unlike(seen_, seen_before_, 0.1, place)) << item;
    EXPECT_TRUE(xdotool({"mousemove", "640", "690"}));
    ASSERT_TRUE(wait_for_item("tooltip", false));
    see("away");
  }
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, AFailureIsReportedAsASentenceAndTheWindowStays) {
  const std::string patient = box_case(folder_);
  write_text(folder_ / "bad.csv", "time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz\n0,nothing,0,0,1,0,0,0\n");
  start({patient, "--motion", "rest"});
  ASSERT_TRUE(wait_until(idle));
  // No such file; a motion that cannot be read; a folder that cannot be written.
  for (const std::string& path : {folder_ / "not-there", folder_ / "bad.csv"}) {
    EXPECT_TRUE(press("ctrl+o"));
    click("open-path");
    ASSERT_TRUE(wait_for_item("writing"));
    EXPECT_TRUE(press("ctrl+a"));
    EXPECT_TRUE(xdotool({"type", path}));
    EXPECT_TRUE(press("Return"));
    ASSERT_TRUE(wait_for_item("error")) << path;
    click("close-error");
    ASSERT_TRUE(wait_for_item("error", false));
  }
  EXPECT_TRUE(wait_until([](const Json& s) { return s["motion"] == "rest"; }))
      << "as it was before";
  click("tab:Record");
  click("record-folder");
  ASSERT_TRUE(wait_for_item("writing"));
  EXPECT_TRUE(press("ctrl+a"));
  EXPECT_TRUE(xdotool({"type", "/proc/film"}));
  EXPECT_TRUE(press("Return"));
  click("record");
  ASSERT_TRUE(wait_for_item("error"));
  click("close-error");
  // Resized to almost nothing.
  EXPECT_TRUE(xdotool({"search", "--name", "Condyle", "windowsize", "--sync", "800", "500"}));
  EXPECT_TRUE(wait_until([](const Json& s) { return double(s["view"][2]) < 500; }));
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, ThemeScaleSizesAndTabsAreKeptBetweenRunsAndTheCommandLineWins) {
  const std::string patient = box_case(folder_), kept = folder_ / "config/condyle/window.json";
  const auto brightness = [&] {
    const Picture picture = settled_picture();
    const auto left = rect("left");
    double sum = 0;
    int count = 0;
    for (int y = static_cast<int>(left[1]) + 250; y < left[1] + left[3]; ++y, ++count)
      sum += picture.rgba[4 * (static_cast<std::size_t>(y) * picture.width + 3)];
    return sum / count;
  };
  const auto quit = [&] {
    EXPECT_TRUE(press("ctrl+q"));
    EXPECT_EQ(wait_for_end(), 0);
  };
  start({patient, "--motion", "rest"});
  ASSERT_TRUE(wait_until(idle));
  EXPECT_LT(brightness(), 80);
  const auto corner_of_view = [&] {
    const Picture screen = settled_picture();
    const Region view = view_region();
    return int{screen.at((view.x + 6) / screen.width, (view.y + 6) / screen.height)[1]};
  };
  EXPECT_LT(corner_of_view(), 80);
  EXPECT_FALSE(fs::exists(kept)) << "nothing was changed";
  EXPECT_TRUE(press("t"));
  EXPECT_GT(corner_of_view(), 170) << "the view changes with its panels";
  const auto wide = [](const Json& s, const char* panel) { return double(s["items"][panel][2]); };
  const auto edge = rect("edge:left");
  drag(edge[0] + 2, edge[1] + 90, edge[0] + 62, edge[1] + 90);
  ASSERT_TRUE(wait_until([&](const Json& s) { return std::abs(wide(s, "left") - 304) < 2; }));
  click("tab:Motion");
  EXPECT_TRUE(press("g"));
  ASSERT_TRUE(wait_for_item("plots"));
  // A window of another size.
  EXPECT_TRUE(xdotool({"search", "--name", "Condyle", "windowsize", "--sync", "1200", "700"}));
  ASSERT_TRUE(wait_until([&](const Json& s) { return std::abs(wide(s, "bottom") - 1200) < 2; }));
  EXPECT_TRUE(press("ctrl+minus"));
  ASSERT_TRUE(wait_until([&](const Json& s) { return std::abs(wide(s, "left") - 274) < 2; }));
  see("arranged");
  // Settings are stored while the window runs, too.
  for (int i = 0; i < 100 && !fs::exists(kept); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_TRUE(fs::exists(kept));
  quit();

  start({patient, "--motion", "rest"});
  ASSERT_TRUE(wait_until(idle));
  const auto as_left = [&](const Json& s) {
    return std::abs(wide(s, "bottom") - 1200) < 2 && std::abs(wide(s, "left") - 274) < 2 &&
           s["items"].contains("plots") && s["items"].contains("motion-words");
  };
  EXPECT_TRUE(wait_until(as_left)) << state().dump();
  EXPECT_GT(brightness(), 190);
  see("as-it-was-left");
  // Another patient leaves the panels as they are.
  EXPECT_TRUE(press("ctrl+o"));
  click("open:builtin");
  ASSERT_TRUE(wait_until(
      [&](const Json& s) { return idle(s) && s["case"]["folder"] == "" && as_left(s); }, 120));
  quit();

  // The command line applies to its own run.
  const std::string before = read_text(kept);
  start({patient, "--motion", "rest", "--dark", "--size", "1280x720", "--ui-scale", "1"});
  ASSERT_TRUE(wait_until(idle));
  EXPECT_TRUE(wait_until([&](const Json& s) {
    return std::abs(wide(s, "bottom") - 1280) < 2 && std::abs(wide(s, "left") - 304) < 2;
  }));
  EXPECT_LT(brightness(), 80);
  quit();
  EXPECT_EQ(read_text(kept), before);
  start({patient, "--motion", "rest", "--size", "1280x720", "--ui-scale", "4"});
  EXPECT_TRUE(wait_until([](const Json& s) {
    return s.value("said", "").find("400 % do not fit into this window") != std::string::npos;
  })) << state().value("said", "nothing");
  ASSERT_TRUE(wait_until(idle));
  quit();
  EXPECT_EQ(read_text(kept), before);

  // A damaged file: a sentence, and the default window.
  write_text(kept, before.substr(0, before.size() / 2));
  start({patient, "--motion", "rest"});
  ASSERT_TRUE(wait_for_item("error"));
  EXPECT_TRUE(wait_until([&](const Json& s) {
    return s.value("trouble", "").find(kept) != std::string::npos;
  })) << state().value("trouble", "nothing was said");
  see("broken-settings");
  EXPECT_TRUE(press("Return"));
  ASSERT_TRUE(wait_until([&](const Json& s) {
    return idle(s) && !s["items"].contains("error") && std::abs(wide(s, "left") - 244) < 2;
  }));
  quit();
}

TEST(OldOpenGl, IsReportedWithARemedy) {
  ASSERT_TRUE(has_program("Xvfb")) << "install xvfb";
  const TestDisplay display;
  ASSERT_TRUE(display.running());
  setenv("MESA_GL_VERSION_OVERRIDE", "2.1", 1);
  const Outcome outcome = condyle({"view"});
  unsetenv("MESA_GL_VERSION_OVERRIDE");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("OpenGL 3.3"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("condyle record"), std::string::npos) << outcome.err;
}

TEST(NoDisplay, IsReportedWithARemedy) {
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  const Outcome outcome = condyle({"view"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("no display"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("condyle record"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace condyle::test
