// Every edit in the window can be undone; two patients are not mixed up.
#include <sstream>

#include "tests/support/file_drop.h"
#include "window_session.h"

namespace condyle::test {
namespace {

TEST_F(WindowSession, EverySettingOfThePictureIsUndoneAndRedone) {
  start({"--motion", "open 20 over 0.3; hold 0.1"});
  ASSERT_TRUE(wait_until(idle, 120));
  const auto scrub = rect("scrub");
  drag(scrub[0] + 0.1 * scrub[2], scrub[1] + scrub[3] / 2, scrub[0] + 0.98 * scrub[2],
       scrub[1] + scrub[3] / 2);
  ASSERT_TRUE(wait_until([](const Json& s) { return double(s["frame"]["opening_mm"]) > 12; }));
  click("left-tab:Look");
  ASSERT_TRUE(wait_for_item("clip"));
  const auto edits = [&] { return state()["edits"]; };
  int settings = 0;
  // Makes an edit, undoes it, and makes it again.
  const auto set = [&](const std::string& what, const std::function<void()>& edit) {
    SCOPED_TRACE(what);
    const Json before = edits();
    edit();
    EXPECT_TRUE(wait_until([&](const Json& s) { return s["edits"] != before; }, 10));
    // The whole drag has arrived, and the mouse is up.
    Json after = edits();
    for (int calm = 0; calm < 4;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      Json now = edits();
      calm = now == after ? calm + 1 : 0;
      after = std::move(now);
    }
    EXPECT_TRUE(press("ctrl+z"));
    EXPECT_TRUE(wait_until([&](const Json& s) { return s["edits"] == before; }, 10))
        << Json::diff(before, edits()).dump();
    EXPECT_TRUE(press("ctrl+y"));
    EXPECT_TRUE(wait_until([&](const Json& s) { return s["edits"] == after; }, 10))
        << Json::diff(after, edits()).dump();
    ++settings;
  };
  const auto click_it = [&](const std::string& item) { set(item, [&] { click(item); }); };
  const auto slide = [&](const std::string& item, double from, double to) {
    set(item, [&] {
      ASSERT_TRUE(wait_for_item(item));
      const auto r = rect(item);
      drag(r[0] + from * r[2], r[1] + r[3] / 2, r[0] + to * r[2], r[1] + r[3] / 2);
    });
  };
  click_it("shadows");
  click_it("letters");
  click_it("scale-bar");
  click_it("axes");
  click_it("wireframe");
  EXPECT_GT(see("triangles"), 0.01);
  click_it("wireframe");
  click_it("displacement");
  EXPECT_GT(see("displacement"), 0.01);
  click_it("displacement");
  click_it("bone-springs");
  click_it("prisms");
  click_it("springs");
  click_it("paths");
  click_it("distances");  // with the skin that it takes away: one edit
  click_it("patches");
  click_it("distances");
  click_it("wipe");
  slide("wipe-at", 0.5, 0.7);
  click_it("ghost");
  EXPECT_GT(see("ghost-and-wipe"), 0.01);
  click_it("wipe");
  click_it("ghost");
  click_it("cut-away");
  click_it("cut-at:Mouth");
  slide("cut-radius", 0.3, 0.6);
  click_it("cut-away");
  click_it("clip");
  click_it("clip-from:A");
  click_it("clip-skin");
  slide("clip-depth", 0.5, 0.3);
  see("clipped");

  // All of it, back to the first picture and forth again.
  const Json all = edits();
  for (int i = 0; i < settings; ++i) EXPECT_TRUE(press("ctrl+z"));
  ASSERT_TRUE(wait_until([](const Json& s) {
    const Json& e = s["edits"];
    return e["shadows"] == true && e["clip"] == false && e["skin_opacity"] == 1;
  }));
  for (int i = 0; i < settings; ++i) EXPECT_TRUE(press("ctrl+y"));
  EXPECT_TRUE(wait_until([&](const Json& s) { return s["edits"] == all; }));
  for (int i = 0; i < settings; ++i) EXPECT_TRUE(press("ctrl+z"));

  // The tree, the skin, contact, a parameter of the motion.
  click("left-tab:Parts");
  ASSERT_TRUE(wait_for_item("skin:glass"));
  click_it("skin:glass");
  click_it("skin:off");
  slide("skin", 0.02, 0.6);
  click_it("show:mandible");
  slide("opacity:skull", 0.9, 0.4);
  click_it("show-all:layers");
  click_it("mark-contacts");
  click_it("obey-contact");
  set("key K", [&] { EXPECT_TRUE(press("k")); });

  // The mouth opened by hand and released, by its button or by the clock.
  slide("opening", 0.7, 0.4);
  ASSERT_TRUE(wait_until([](const Json& s) { return s["edits"]["opening_mm"].is_number(); }));
  const double held_mm = state()["edits"]["opening_mm"];
  EXPECT_TRUE(wait_until([&](const Json& s) {
    return std::abs(double(s["frame"]["opening_mm"]) - held_mm) < 0.2;
  })) << state()["frame"].dump();
  click_it("release");
  slide("opening", 0.5, 0.2);
  set("key Left", [&] { EXPECT_TRUE(press("Left")); });
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, NumbersThatShapeTheMotionAreUndoneAndRedoneAndQuittingWaitsForNone) {
  start({"--motion", "opening"});
  ASSERT_TRUE(wait_until(idle, 120));
  click("tab:Motion");
  const auto number = [&](const std::string& item, double from, double to) {
    SCOPED_TRACE(item);
    ASSERT_TRUE(wait_for_item(item));
    const Json before = state()["edits"];
    const auto r = rect(item);
    drag(r[0] + from * r[2], r[1] + r[3] / 2, r[0] + to * r[2], r[1] + r[3] / 2);
    ASSERT_TRUE(wait_until([&](const Json& s) { return s["edits"] != before; }));
    ASSERT_TRUE(wait_until(idle, 60));
    const Json after = state()["edits"];
    EXPECT_TRUE(press("ctrl+z"));
    EXPECT_TRUE(wait_until([&](const Json& s) { return s["edits"] == before; }))
        << Json::diff(before, state()["edits"]).dump();
    EXPECT_TRUE(press("ctrl+y"));
    EXPECT_TRUE(wait_until([&](const Json& s) { return s["edits"] == after; }))
        << Json::diff(after, state()["edits"]).dump();
  };
  number("parameter:opening", 0.5, 0.4);
  number("parameter:bennett", 0.2, 0.6);
  // A muscle-driven motion, and its excitations.
  click("motion");
  click("motion:by-muscles");
  ASSERT_TRUE(wait_until(
      [](const Json& s) {
        return idle(s) && s["edits"]["motion"] == "by-muscles" &&
               s["items"].contains("excitation:lt");
      },
      60));
  number("excitation:lt", 0.3, 0.6);
  EXPECT_NEAR(double(state()["edits"]["excitations"]["lt"]), 0.6, 0.03);
  EXPECT_TRUE(press("ctrl+q"));  // while the last motion is being made
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, TheMouthIsOpenedByHandThoughTheMotionRests) {
  start({box_case(folder_), "--motion", "rest"});
  ASSERT_TRUE(wait_until(idle));
  ASSERT_TRUE(wait_for_item("opening"));
  const auto r = rect("opening");
  const double y = r[1] + r[3] / 2;
  see("at-rest");
  drag(r[0] + 0.05 * r[2], y, r[0] + 0.7 * r[2], y);
  ASSERT_TRUE(wait_until([](const Json& s) {
    return s["edits"]["opening_mm"].is_number() && double(s["frame"]["opening_mm"]) > 20;
  })) << state()["frame"].dump();
  EXPECT_TRUE(wait_until([](const Json& s) {
    return std::abs(double(s["frame"]["opening_mm"]) - double(s["edits"]["opening_mm"])) < 0.2;
  })) << state()["frame"].dump();
  EXPECT_EQ(state()["motion"], "rest");
  EXPECT_GT(see("opened-by-hand"), 0.02);
  click("release");
  EXPECT_TRUE(wait_until([](const Json& s) { return double(s["frame"]["opening_mm"]) < 3; }));
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, AnImpossibleOpeningIsReportedBesideMusclesAndTheSliderOpensAsThePatientDoes) {
  start({"--motion", "by-muscles", "--opening", "75"});
  ASSERT_TRUE(wait_until(idle, 120));
  const std::string notes = state()["notes"].dump();
  EXPECT_NE(notes.find("the opening slider cannot open as requested: opening 75 mm"),
            std::string::npos)
      << notes;
  const auto r = rect("opening");
  drag(r[0] + 0.02 * r[2], r[1] + r[3] / 2, r[0] + 0.99 * r[2], r[1] + r[3] / 2);
  EXPECT_TRUE(wait_until([](const Json& s) {
    const double opened = s["frame"]["opening_mm"];
    return opened > 40 && opened < 50;
  })) << state()["frame"].dump();
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, APatientWhoseLoadingIsCancelledLeavesTheOtherAsHeWas) {
  const std::string boxes = box_case(folder_);
  start({boxes, "--motion", "rest"});
  ASSERT_TRUE(wait_until(idle));
  EXPECT_TRUE(press("a"));
  see("before");
  const Picture at_first = seen_;
  const Json before = state();
  const auto open_builtin = [&] {
    EXPECT_TRUE(press("ctrl+o"));
    click("open:builtin");
    ASSERT_TRUE(wait_for_item("cancel"));
  };
  open_builtin();
  see_changed("loading", "cancel", 0.1);
  EXPECT_TRUE(unlike(seen_, seen_before_, 0.1, region_of("cancel")))
      << "its progress is in the picture";
  click("cancel");
  ASSERT_TRUE(wait_until(idle, 10));
  EXPECT_TRUE(wait_for_item("cancel", false));
  std::this_thread::sleep_for(std::chrono::seconds(3));  // it does not come later, either
  EXPECT_EQ(state()["case"], before["case"]);
  EXPECT_EQ(state()["edits"], before["edits"]);
  EXPECT_FALSE(state()["items"].contains("error"));
  see("cancelled");
  EXPECT_TRUE(alike(seen_, at_first, 0.001, view_region()));
  EXPECT_TRUE(press("l"));
  EXPECT_TRUE(wait_until([](const Json& s) { return double(s["camera_direction"][0]) > 0.99; }));
  // Requested again, it appears.
  open_builtin();
  ASSERT_TRUE(wait_until([](const Json& s) { return idle(s) && s["case"]["folder"] == ""; }, 120));
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, LandmarksThatAreUsedMoveTheJawAsTheSavedCaseDoes) {
  const std::string motion = "open 10 over 0.3; hold 0.2", boxes = box_case(folder_);
  start({boxes, "--motion", motion});
  ASSERT_TRUE(wait_until(idle));
  const auto at_end = [](const Json& s) {
    return idle(s) && s["playing"] == false && double(s["time_s"]) > 0.45 &&
           double(s["frame"]["time_s"]) > 0.45;
  };
  const auto scrub = rect("scrub");
  drag(scrub[0] + 0.1 * scrub[2], scrub[1] + scrub[3] / 2, scrub[0] + 0.999 * scrub[2],
       scrub[1] + scrub[3] / 2);
  ASSERT_TRUE(wait_until(at_end));
  const auto place = [&] {
    const Json t = state()["frame"]["mandible_mm"];
    return std::array<double, 3>{t[0], t[1], t[2]};
  };
  const auto before = place();
  EXPECT_TRUE(press("l"));
  EXPECT_TRUE(press("b"));
  click("landmark:left_condyle");
  const Region view = view_region();
  const Json marked = state()["landmark_mm"]["left_condyle"];
  EXPECT_TRUE(xdotool(
      {"mousemove", px(view.x + 0.5 * view.width), px(view.y + 0.45 * view.height), "click", "1"}));
  ASSERT_TRUE(
      wait_until([&](const Json& s) { return s["landmark_mm"]["left_condyle"] != marked; }));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_EQ(place(), before) << "until they are asked for, the earlier ones hold";
  see("landmark-not-yet-used");

  click("landmarks-use");
  ASSERT_TRUE(wait_until([&](const Json& s) {
    return at_end(s) && std::abs(double(s["frame"]["mandible_mm"][1]) - before[1]) > 0.1;
  })) << state()["frame"].dump();
  see("landmark-used");
  const double time_s = state()["time_s"];
  const auto used = place();
  // The same case, saved and run.
  write_into("case-folder", folder_ / "saved");
  click("case-save");
  ASSERT_TRUE(wait_until(
      [&](const Json& s) { return idle(s) && fs::exists(folder_ / "saved/case.json"); }));
  const auto run = condyle(
      {"run", folder_ / "saved", "--motion", motion, "--frames", "2", "--out", folder_ / "run"});
  ASSERT_EQ(run.code, 0) << run.err;
  std::istringstream trace(read_text(folder_ / "run/trace.csv"));
  std::string last, cell;
  for (std::string line; std::getline(trace, line);)
    if (!line.empty()) last = line;
  std::istringstream cells(last);
  std::vector<double> row;
  while (row.size() < 5 && std::getline(cells, cell, ',')) row.push_back(std::stod(cell));
  ASSERT_EQ(row.size(), 5u) << last;
  EXPECT_GE(row[1], time_s - 1e-9);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(used[k], row[2 + k], 0.01) << last;

  // After undo it must be applied again; the jaw stays until then.
  EXPECT_TRUE(press("ctrl+z"));
  ASSERT_TRUE(
      wait_until([&](const Json& s) { return s["landmark_mm"]["left_condyle"] == marked; }));
  EXPECT_EQ(place(), used);
  click("landmarks-use");
  EXPECT_TRUE(wait_until([&](const Json& s) {
    return at_end(s) && std::abs(double(s["frame"]["mandible_mm"][1]) - before[1]) < 1e-6;
  })) << state()["frame"].dump();
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, APatientSavedWhileAnotherIsOpenedKeepsItsFolderToItself) {
  const std::string boxes = box_case(folder_);
  start({"--motion", "rest"});
  ASSERT_TRUE(wait_until(idle, 120));
  EXPECT_TRUE(press("b"));
  write_into("case-folder", folder_ / "first");
  const auto save = rect("case-save");
  // Saving the large patient takes longer than opening the small one.
  EXPECT_TRUE(
      xdotool({"mousemove", px(save[0] + save[2] / 2), px(save[1] + save[3] / 2), "click", "1"}));
  EXPECT_TRUE(drop_files("Condyle", {boxes}));
  ASSERT_TRUE(wait_until([&](const Json& s) {
    return idle(s) && s["case"]["folder"] == fs::weakly_canonical(boxes).string() &&
           fs::exists(folder_ / "first/case.json");
  })) << state()["case"].dump();
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const Json now = state();
  EXPECT_EQ(now["case"]["folder"], fs::weakly_canonical(boxes).string());
  ASSERT_EQ(now["recent"].size(), 2u) << now["recent"].dump();
  EXPECT_EQ(now["recent"][0], fs::weakly_canonical(boxes).string());
  // Saving now writes to this patient's folder, not to the other one's.
  EXPECT_TRUE(press("b"));
  click("case-save");
  ASSERT_TRUE(wait_until([&](const Json& s) { return idle(s); }));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const auto info = condyle({"info", folder_ / "first", "--json"});
  EXPECT_NE(info.out.find("face"), std::string::npos) << info.out;
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, ATextureThatIsTooLargeIsReportedAndTheWindowStays) {
  const std::string boxes = box_case(folder_);
  // The head of a PNG says 24,576 x 2 pixels.
  std::string picture("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x60\0\0\0\0\x02\x08\x02\0\0\0", 29);
  write_text(folder_ / "face.png", picture + std::string(64, 'x'));
  write_text(folder_ / "face.mtl", "newmtl skin\nKd 1 1 1\nmap_Kd face.png\n");
  write_text(folder_ / "face.obj",
             "mtllib face.mtl\nv -50 -90 -50\nv 50 -90 -50\nv 50 -90 50\nv -50 -90 50\n"
             "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
  start({boxes, "--motion", "rest"});
  ASSERT_TRUE(wait_until(idle));
  EXPECT_TRUE(drop_files("Condyle", {folder_ / "face.obj", folder_ / "mandible.stl"}));
  click("import-go");
  ASSERT_TRUE(wait_for_item("error"));
  EXPECT_TRUE(wait_until([](const Json& s) {
    const std::string words = s.value("trouble", "");
    return words.find("24576x2") != std::string::npos && words.find("face") != std::string::npos;
  })) << state().value("trouble", "nothing was said");
  see("texture-too-large");
  click("close-error");
  ASSERT_TRUE(wait_for_item("error", false));
  EXPECT_EQ(state()["case"]["folder"], fs::weakly_canonical(boxes).string()) << "as it was";
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, WithoutEglThePictureIsDrawnWithTheDisplaysOwnOpenGl) {
  const std::string boxes = box_case(folder_);
  setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere.json", 1);
  start({boxes, "--motion", "rest"});
  unsetenv("__EGL_VENDOR_LIBRARY_FILENAMES");
  ASSERT_TRUE(wait_until(idle));
  ASSERT_TRUE(wait_until([](const Json& s) { return s["picture_finished"] == true; }))
      << state().value("trouble", "nothing was said");
  EXPECT_FALSE(state()["items"].contains("error"));
  see("without-egl");
  EXPECT_TRUE(press("l"));
  EXPECT_GT(see("without-egl-from-the-left"), 0.05);
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

}  // namespace
}  // namespace condyle::test
