#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/render/window/panel_stage.h"

namespace condyle {
namespace {

struct Screen {
  int width, height;
  float scale;
};

class PanelsOn : public testing::TestWithParam<Screen> {
 protected:
  PanelStage stage{GetParam().width, GetParam().height,
                   fitting_scale(GetParam().scale, GetParam().width, GetParam().height)};

  /// Expects that panels do not overlap, nor items, each within its panel. Returns the number of
  /// panels.
  int expect_apart(const std::string& state);

  void keep(const std::string& what) {
    const auto file =
        test::kept_pictures() / ("panels-" + what + "-" + std::to_string(GetParam().width) + "x" +
                                 std::to_string(GetParam().height) + "-" +
                                 std::to_string(static_cast<int>(GetParam().scale * 100)) + ".png");
    test::Picture(stage.image()).save(file);
  }
};

bool overlap(const ViewRect& a, const ViewRect& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

bool within(const ViewRect& a, const ViewRect& b) {
  return a.x >= b.x && a.y >= b.y && a.x + a.width <= b.x + b.width + 0.5 &&
         a.y + a.height <= b.y + b.height + 0.5;
}

int PanelsOn::expect_apart(const std::string& state) {
  const auto& items = stage.panels->items();
  const ViewRect screen{0, 0, static_cast<double>(GetParam().width),
                        static_cast<double>(GetParam().height)};
  int panels = 0, pairs = 0;
  for (const DrawnItem& a : items) {
    if (a.panel == "handles") continue;  // of one body, across each other
    const bool on_view = a.panel == "view", in_plot = a.panel.starts_with("plot:");
    EXPECT_TRUE(within(a.rect, screen)) << a.name;
    if (a.panel.empty()) {
      ++panels;
    } else if (!on_view) {
      EXPECT_TRUE(within(a.rect, stage.item(a.panel).rect)) << state << ": " << a.name;
    }
    for (const DrawnItem& b : items) {
      // Panels are compared with panels and with text on the view, items with items.
      if (&a == &b || b.panel == "handles" || (on_view && b.panel == a.panel && &a > &b)) continue;
      if (!on_view && (a.panel.empty() != b.panel.empty() || b.panel == "view")) continue;
      if (on_view && !b.panel.empty() && !(b.panel == "view")) continue;
      if (a.name.starts_with("edge:") != b.name.starts_with("edge:")) continue;  // lie on margins
      if (in_plot && b.name == a.panel) continue;
      if (b.panel == a.name) continue;
      EXPECT_FALSE(overlap(a.rect, b.rect)) << state << ": " << a.name << " and " << b.name;
      ++pairs;
    }
  }
  EXPECT_GT(pairs, 500);
  return panels;
}

TEST_P(PanelsOn, NothingOverlapsOrLeavesTheScreen) {
  stage.view.opening_mm = 20;  // the fullest state: with the button to release
  stage.rest();
  const int panels = 7;  // top, left, right, bottom, cube, two edges to grip
  EXPECT_EQ(expect_apart("held"), panels);
  for (const char* name : {"play", "scrub", "speed", "loop", "opening", "release", "skin",
                           "show:mandible", "opacity:mandible", "obey-contact", "tab:Motion",
                           "view:A", "view:I", "picture", "help-button", "pair:0", "pair:2"})
    EXPECT_TRUE(stage.has(name)) << name;
  keep("held");

  // Each tool stands beside the picture, with plots below and the wipe over it, too.
  stage.scene.bodies = movable_bodies(stage.parts, native_bodies());
  stage.view.landmarks = {landmark_at("left_condyle", {45, 0, -48}, stage.parts)};
  stage.view.look.wipe = true;
  stage.view.distances = stage.view.look.axes = true;
  stage.scene.distance_colours = distance_colours();
  for (const bool plots : {false, true})
    for (const auto& [tool, name] : {std::pair{Tool::move, "move"},
                                     {Tool::measure, "measure"},
                                     {Tool::landmarks, "landmarks"}}) {
      stage.view.tool = tool;
      stage.view.plots = plots;
      stage.rest();
      ASSERT_TRUE(stage.has(name));
      const int legend = stage.has("legend");
      EXPECT_EQ(expect_apart(name), panels + 1 + 2 * plots + legend) << name;
      const ViewRect view =
          stage.panels->layout(GetParam().width, GetParam().height, stage.view).view;
      EXPECT_FALSE(overlap(view, stage.item(name).rect)) << name;
      EXPECT_GT(view.width, 400 * stage.panels->theme().scale);
      for (const char* side : {"left", "right", "up", "down"}) {
        const ViewRect letter = stage.item(std::string("side:") + side).rect;
        EXPECT_TRUE(within(letter, view)) << side;
      }
      keep(std::string(name) + (plots ? "-plots" : ""));
    }
}

TEST_P(PanelsOn, TheWipeStandsClearOfLettersAndSaysWhatIsAtItsSides) {
  stage.view.look.wipe = true;
  for (const double at : {0.02, 0.25, 0.5, 0.97}) {
    stage.view.look.wipe_at = at;
    stage.rest();
    const ViewRect line = stage.item("wipe:line").rect;
    EXPECT_EQ(line.height, stage.panels->layout(GetParam().width, GetParam().height).view.height);
    for (const char* side : {"left", "right", "up", "down"})
      EXPECT_FALSE(overlap(stage.item(std::string("side:") + side).rect, line)) << side << at;
  }
  stage.view.look.wipe_at = 0.5;
  stage.rest();
  EXPECT_EQ(stage.item("wipe:before").words, "at rest");
  EXPECT_EQ(stage.item("wipe:now").words, "now");
  stage.kept = true;
  stage.rest();
  EXPECT_EQ(stage.item("wipe:before").words, "kept");
}

TEST_P(PanelsOn, ItemNamesAreUnique) {
  std::set<std::string> names;
  for (const DrawnItem& item : stage.panels->items())
    EXPECT_TRUE(names.insert(item.name).second) << item.name;
  EXPECT_GT(names.size(), 30u);
  keep("rest");
}

TEST_P(PanelsOn, AreDrawnIntoTheFramebuffer) {
  const auto pixel = [](const Image& image, double x, double y) {
    const auto at = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                         static_cast<std::size_t>(x));
    return Eigen::Vector3i(image.rgba[at], image.rgba[at + 1], image.rgba[at + 2]);
  };
  const Image paused = stage.image();
  const ViewRect left = stage.item("left").rect, play = stage.item("play").rect;
  EXPECT_EQ(pixel(paused, left.x + 2, left.y + 2), Eigen::Vector3i(0x19, 0x1d, 0x22));
  // The sign for play has its middle filled, the one for pause has a gap there.
  const double x = play.x + play.width / 2, y = play.y + play.height / 2;
  EXPECT_GT(pixel(paused, x, y).minCoeff(), 200);
  stage.view.playing = true;
  stage.rest();
  EXPECT_LT(pixel(stage.image(), x, y).minCoeff(), 100);
}

TEST_P(PanelsOn, PlayTogglesPlaying) {
  ASSERT_FALSE(stage.view.playing);
  stage.click("play");
  EXPECT_TRUE(stage.view.playing);
  stage.click("play");
  EXPECT_FALSE(stage.view.playing);
}

TEST_P(PanelsOn, DraggingTheScrubBarMovesTime) {
  stage.view.playing = true;
  stage.slide("scrub", 0.1, 0.5);
  EXPECT_NEAR(stage.view.time_s, 0.5 * stage.scene.duration_s, 0.02);
  EXPECT_FALSE(stage.view.playing);
  stage.slide("scrub", 0.5, 1.6);  // beyond the end of the bar
  EXPECT_DOUBLE_EQ(stage.view.time_s, stage.scene.duration_s);
  stage.click("to-start");
  EXPECT_EQ(stage.view.time_s, 0);
  stage.click("step-forward");
  EXPECT_DOUBLE_EQ(stage.view.time_s, stage.scene.step_s);
}

TEST_P(PanelsOn, TickBoxHidesAPart) {
  stage.click("show:mandible");
  EXPECT_FALSE(stage.view.parts[4].shown);
  EXPECT_EQ(part_opacities(stage.scene, stage.view).at("mandible"), 0);
  EXPECT_EQ(part_opacities(stage.scene, stage.view).at("maxilla"), 1);
  stage.click("show:mandible");
  EXPECT_TRUE(stage.view.parts[4].shown);
  stage.slide("opacity:skull", 0.9, 0.5);
  EXPECT_NEAR(stage.view.parts[0].opacity, 0.5, 0.02);
}

TEST_P(PanelsOn, TheKeyToOverlaysStandsClearOfLegendAndPanels) {
  stage.scene.distance_colours = distance_colours();
  stage.view.distances = true;
  stage.rest();
  EXPECT_FALSE(stage.has("key"));
  for (int i = 0; i < 17; ++i)
    stage.key.push_back({"Path of the left condyle",
                         {{0.94f, 0.89f, 0.26f}},
                         i % 2 ? KeyEntry::Mark::path : KeyEntry::Mark::arrow});
  stage.rest();
  ASSERT_TRUE(stage.has("key"));
  const ViewRect key = stage.item("key").rect;
  EXPECT_TRUE(within(key, stage.panels->layout(GetParam().width, GetParam().height).view));
  for (const DrawnItem& item : stage.panels->items())
    if (item.panel.empty() && item.name != "key") {
      EXPECT_FALSE(overlap(key, item.rect)) << item.name;
    }
  const Image image = stage.image();
  int yellow = 0;
  for (int y = static_cast<int>(key.y); y < key.y + key.height; ++y)
    for (int x = static_cast<int>(key.x); x < key.x + key.width; ++x) {
      const auto* p = &image.rgba[4 * (static_cast<std::size_t>(y) * image.width + x)];
      yellow += p[0] > p[2] + 100 && p[1] > p[2] + 100;
    }
  EXPECT_GT(yellow, 17 * 20);
  keep("key");
}

TEST_P(PanelsOn, WhatACutWouldDoIsShownWhileItsHandleIsDragged) {
  stage.scene.plan.steps = {{1, "Cut: genioplasty", "", {"chin: 7.6 cm³"}, false, true, {}}};
  stage.click("tab:Plan");
  stage.click("plan-step:1");
  stage.scene.plan.preview = CutPreviewView{.findings = {"mental foramen: 2.1 mm"}, .warns = true};
  stage.rest();
  EXPECT_FALSE(stage.has("cut-findings")) << "no handle is held";
  stage.view.held_handle = HeldHandle{};
  stage.rest();
  EXPECT_EQ(stage.item("cut-findings").words, "mental foramen: 2.1 mm");
  stage.scene.plan.preview = CutPreviewView{.problem = "the cut meets no bone"};
  stage.rest();
  EXPECT_EQ(stage.item("cut-problem").words, "the cut meets no bone");
}

TEST_P(PanelsOn, DistancesShowTheirLegendAndHideTheSkin) {
  stage.click("left-tab:Look");
  EXPECT_FALSE(stage.has("distances"));  // this loop cannot compute them
  stage.scene.distance_colours = distance_colours();
  stage.scene.distance_remarks = {"to the opposing jaw",
                                  "open surfaces have no inside:", "no sign near them"};
  stage.rest();
  EXPECT_FALSE(stage.has("legend"));
  stage.click("distances");
  EXPECT_TRUE(stage.view.distances);
  EXPECT_EQ(stage.view.skin_opacity, 0);
  stage.rest();
  const ViewRect legend = stage.item("legend").rect;
  EXPECT_TRUE(within(legend, stage.panels->layout(GetParam().width, GetParam().height).view));
  for (const DrawnItem& item : stage.panels->items())
    if (item.panel.empty() && item.name != "legend") {
      EXPECT_FALSE(overlap(legend, item.rect)) << item.name;
    }
  // The bar runs from red over white to blue.
  const Image image = stage.image();
  int red = 0, white = 0, blue = 0;
  for (int y = static_cast<int>(legend.y); y < legend.y + legend.height; ++y)
    for (int x = static_cast<int>(legend.x); x < legend.x + legend.width; ++x) {
      const auto* p = &image.rgba[4 * (static_cast<std::size_t>(y) * image.width + x)];
      red += p[0] > p[2] + 60;
      blue += p[2] > p[0] + 60;
      white += p[0] > 250 && p[1] > 250 && p[2] > 250;
    }
  EXPECT_GT(red, 200);
  EXPECT_GT(blue, 200);
  EXPECT_GT(white, 40);
  keep("distances");
  stage.panels->run(Command::toggle_skin, stage.scene, stage.view);
  EXPECT_EQ(stage.view.skin_opacity, 1);  // comes back where it was
  stage.click("distances");
  EXPECT_FALSE(stage.view.distances);
  stage.rest();
  EXPECT_FALSE(stage.has("legend"));
}

TEST_P(PanelsOn, TheSkinIsRestoredWhenDistancesAreTurnedOff) {
  stage.scene.distance_colours = distance_colours();
  const auto run = [&](Command command) { stage.panels->run(command, stage.scene, stage.view); };
  stage.view.skin_opacity = 0.8;
  for (int i = 0; i < 2; ++i) {
    run(Command::toggle_distances);
    EXPECT_EQ(stage.view.skin_opacity, 0);
    run(Command::toggle_distances);
    EXPECT_EQ(stage.view.skin_opacity, 0.8);
    run(Command::undo);
    EXPECT_TRUE(stage.view.distances);
    EXPECT_EQ(stage.view.skin_opacity, 0);
    run(Command::toggle_distances);
    EXPECT_EQ(stage.view.skin_opacity, 0.8);
  }
  // The user's settings made meanwhile stay: thin, or none.
  run(Command::toggle_distances);
  stage.view.skin_opacity = 0.3;
  run(Command::toggle_distances);
  EXPECT_EQ(stage.view.skin_opacity, 0.3);
  run(Command::toggle_skin);
  run(Command::toggle_distances);
  run(Command::toggle_distances);
  EXPECT_EQ(stage.view.skin_opacity, 0);
}

TEST_P(PanelsOn, SkinIsSetBySliderAndButtons) {
  ASSERT_TRUE(stage.view.shows_face(stage.scene));
  stage.slide("skin", 0.9, 0.25);
  EXPECT_NEAR(stage.view.skin_opacity, 0.25, 0.02);
  stage.click("skin:off");
  EXPECT_EQ(stage.view.skin_opacity, 0);
  EXPECT_FALSE(stage.view.shows_face(stage.scene));
  stage.click("skin:full");
  EXPECT_EQ(stage.view.skin_opacity, 1);
}

TEST_P(PanelsOn, OpeningSliderHoldsTheJawAndReleasesIt) {
  stage.view.playing = true;
  stage.slide("opening", 0.2, 0.5);
  ASSERT_TRUE(stage.view.opening_mm.has_value());
  EXPECT_NEAR(*stage.view.opening_mm, 0.5 * stage.scene.max_opening_mm, 0.3);
  EXPECT_FALSE(stage.view.playing);
  stage.click("release");
  EXPECT_FALSE(stage.view.opening_mm.has_value());
}

TEST_P(PanelsOn, SpeedStaysWithinItsBounds) {
  stage.slide("speed", 0.5, -3);
  EXPECT_NEAR(stage.view.speed, 0.1, 1e-9);
  stage.slide("speed", 0.05, 4);
  EXPECT_NEAR(stage.view.speed, 2, 1e-9);
}

TEST_P(PanelsOn, ButtonsAndCubeAskForViews) {
  stage.click("view:L");
  ASSERT_EQ(stage.commands, std::vector{Command::view_left});
  stage.camera = standard_camera("front", {-80, -95, -90}, {80, 100, 130}, 1.3);
  stage.rest();
  stage.click("cube");
  EXPECT_EQ(stage.commands, (std::vector{Command::view_left, Command::view_front}));
}

TEST_P(PanelsOn, HelpOpensInsideTheScreenAndCloses) {
  stage.click("help-button");
  ASSERT_TRUE(stage.panels->dialog_open());
  stage.rest(4);
  const ViewRect screen{0, 0, static_cast<double>(GetParam().width),
                        static_cast<double>(GetParam().height)};
  EXPECT_TRUE(within(stage.item("help").rect, screen));
  EXPECT_TRUE(within(stage.item("close-help").rect, stage.item("help").rect));
  keep("help");
  const bool before = stage.view.playing;
  stage.click("play");  // the dialog is in front
  EXPECT_EQ(stage.view.playing, before);
  stage.click("close-help");
  EXPECT_FALSE(stage.panels->dialog_open());
  EXPECT_FALSE(stage.has("help"));
  stage.click("play");
  EXPECT_NE(stage.view.playing, before);
}

TEST_P(PanelsOn, NotesHaveTheLinesThatAllPartsLeave) {
  stage.scene.notes = std::vector<std::string>(
      4, "Upper and lower teeth overlap by 0.12 mm at rest; deeper contact counts as penetration.");
  stage.rest();
  const int lines = GetParam().height > 1000 ? 6 : 2;
  EXPECT_GE(stage.item("notes").rect.height, lines * stage.panels->theme().small->FontSize - 1);
  EXPECT_TRUE(stage.has("obey-contact"));
  keep("notes");
}

TEST_P(PanelsOn, ErrorsWaitInARowAndCloseByButtonOrKey) {
  const std::string sentence =
      "The picture could not be saved: /media/stick/condyle.png: no space left on the device. Free "
      "some space or start the window in another folder.";
  stage.panels->report_error({"Cannot save the picture", sentence});
  stage.panels->report_error({"Cannot save the picture", sentence});  // the same again: one dialog
  stage.panels->report_error({"Cannot record the motion", "The second sentence."});
  stage.rest(4);
  EXPECT_TRUE(stage.has("error"));
  EXPECT_EQ(stage.item("error-title").words, "Cannot save the picture");
  EXPECT_FALSE(stage.has("key-hint"));
  stage.panels->refuse_key();
  stage.rest(1);
  EXPECT_TRUE(stage.has("key-hint")) << "a key without effect is answered";
  keep("error");
  stage.click("close-error");
  EXPECT_TRUE(stage.panels->dialog_open());
  stage.panels->run(Command::close_dialog, stage.scene, stage.view);
  EXPECT_FALSE(stage.panels->dialog_open());
  stage.rest(3);
  EXPECT_FALSE(stage.has("error"));
  stage.click("play");
  EXPECT_TRUE(stage.view.playing);
}

TEST_P(PanelsOn, ColumnsAndPlotsCanBeResizedAndReset) {
  stage.view.plots = true;
  stage.rest();
  const auto pull = [&](const std::string& edge, double dx, double dy) {
    const ViewRect r = stage.item(edge).rect;
    const double x = r.x + r.width / 2, y = r.y + r.height / 2;
    stage.step(x, y, false);
    for (int i = 0; i <= 4; ++i) stage.step(x + dx * i / 4, y + dy * i / 4, true);
    stage.step(x + dx, y + dy, false);
    stage.rest(30);  // so that the next click makes no double one
  };
  const auto size = [&](const std::string& panel) { return stage.item(panel).rect; };
  const double scale = GetParam().scale, by = std::round(40 * scale);
  const ViewRect left = size("left"), right = size("right"), plots = size("plots");
  pull("edge:left", by, 0);
  pull("edge:right", -by, 0);
  pull("edge:plots", 0, -by / 2);
  EXPECT_NEAR(size("left").width, left.width + by, 1.01);
  EXPECT_NEAR(size("right").width, right.width + by, 1.01);
  EXPECT_NEAR(size("plots").height, plots.height + by / 2, 1.01);
  EXPECT_NEAR(size("plots").width, plots.width - 2 * by, 2.01);
  EXPECT_NEAR(stage.panels->sizes().left, left.width / scale + 40, 1);
  // Texts keep their space, and so does the picture.
  pull("edge:left", -5 * by, 0);
  EXPECT_NEAR(size("left").width, left.width, 1);
  pull("edge:left", 1e4, 0);
  pull("edge:plots", 0, -1e4);
  const Layout drawn = stage.panels->layout(GetParam().width, GetParam().height, stage.view);
  EXPECT_GE(drawn.view.width, std::floor(300 * scale));
  EXPECT_GE(drawn.view.height, std::floor(150 * scale));
  EXPECT_NEAR(size("right").x + size("right").width, GetParam().width, 0.5);
  EXPECT_LE(size("left").x + size("left").width, size("right").x);
  // A double click restores each.
  for (const char* edge : {"edge:left", "edge:right", "edge:plots"}) {
    const ViewRect r = stage.item(edge).rect;
    for (const bool down : {false, true, false, true, false})
      stage.step(r.x + r.width / 2, r.y + r.height / 2, down);
    stage.rest(30);
  }
  EXPECT_EQ(stage.panels->sizes(), PanelSizes{});
  EXPECT_NEAR(size("plots").height, plots.height, 0.01);
}

TEST_P(PanelsOn, MessagesDuringLoadingRemainVisible) {
  stage.scene.parts = {};
  stage.panels->say("Panels at 100 %: 200 % do not fit into this window");
  stage.rest(8 * 60);
  EXPECT_FALSE(stage.panels->said().empty());
  stage.scene.parts = stage.parts;
  stage.rest(5 * 60);
  EXPECT_FALSE(stage.panels->said().empty());
  stage.rest(2 * 60);
  EXPECT_TRUE(stage.panels->said().empty());
}

TEST_P(PanelsOn, PanelsCanBeHidden) {
  stage.panels->run(Command::toggle_panels, stage.scene, stage.view);
  stage.rest();
  EXPECT_FALSE(stage.has("left"));
  const Layout layout = stage.panels->layout(GetParam().width, GetParam().height);
  EXPECT_EQ(layout.view.width, GetParam().width);
  EXPECT_EQ(layout.view.height, GetParam().height);
}

TEST_P(PanelsOn, AnEmptySceneAndLongNamesAreDrawn) {
  stage.parts.clear();
  stage.scene = {};
  stage.frame = {};
  stage.progress = "Building the patient";
  stage.rest();
  EXPECT_FALSE(stage.has("bottom"));  // nothing to set yet
  keep("progress");

  const std::string name = "a_very_long_part_name_that_a_user_gave_to_the_left_fibula_transplant";
  for (int i = 0; i < 40; ++i)
    stage.parts.push_back(box_part(name + std::to_string(i), Role::skull, {0, 0, 0}, {1, 1, 1}));
  stage.scene.parts = stage.parts;
  stage.scene.case_name = name + name + name + name + name;
  stage.scene.notes = std::vector<std::string>(30, name);
  stage.progress.clear();
  stage.rest();
  for (const DrawnItem& a : stage.panels->items()) {
    for (const DrawnItem& b : stage.panels->items()) {
      if (&a == &b || a.panel.empty() != b.panel.empty()) continue;
      if (a.name.starts_with("edge:") != b.name.starts_with("edge:")) continue;  // lie on margins
      EXPECT_FALSE(overlap(a.rect, b.rect)) << a.name << " and " << b.name;
    }
  }
  EXPECT_TRUE(stage.has("obey-contact"));  // the long list leaves room for what stands below it
  keep("long");
}

INSTANTIATE_TEST_SUITE_P(Screens, PanelsOn,
                         testing::Values(Screen{1280, 720, 1}, Screen{3840, 2160, 1},
                                         Screen{3840, 2160, 2.5f}),
                         [](const auto& screen) {
                           return std::to_string(screen.param.width) + "x" +
                                  std::to_string(screen.param.height) + "scale" +
                                  std::to_string(static_cast<int>(screen.param.scale * 100));
                         });

TEST(Theme, PanelsAreLargerOnDenseScreensOfUnknownScale) {
  EXPECT_EQ(default_scale(1, 3840), 1.5);
  EXPECT_EQ(default_scale(1, 5120), 1.5);
  EXPECT_EQ(default_scale(1, 2560), 1);
  EXPECT_EQ(default_scale(2, 3840), 1);
}

TEST(Theme, ScaleIsLoweredWherePanelsWouldNotFit) {
  EXPECT_FLOAT_EQ(fitting_scale(1, 1280, 720), 1);
  EXPECT_FLOAT_EQ(fitting_scale(2, 3840, 2160), 2);
  EXPECT_LT(fitting_scale(3, 1280, 720), 1.1f);
  EXPECT_GE(fitting_scale(1, 10, 10), 0.5f);
}

}  // namespace
}  // namespace condyle
