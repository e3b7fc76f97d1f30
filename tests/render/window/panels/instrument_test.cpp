// Plots, motions, recordings, landmarks, files and the content of the picture, through the panels.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <set>

#include "render/window/input/gizmos.h"
#include "render/window/panels/plot_drawing.h"
#include "render/window/settings/kept_arrangement.h"
#include "tests/render/window/panel_stage.h"

namespace condyle {
namespace {

bool lies_within(const ViewRect& inner, const ViewRect& outer) {
  return inner.x >= outer.x - 0.5 && inner.y >= outer.y - 0.5 &&
         inner.x + inner.width <= outer.x + outer.width + 0.5 &&
         inner.y + inner.height <= outer.y + outer.height + 0.5;
}

struct LitScreen {
  int width, height;
  float scale;
  bool light;
};

class Instrument : public testing::TestWithParam<LitScreen> {
 protected:
  Instrument() {
    stage.set_light(GetParam().light);
    stage.scene.motions = {"opening", "posselt", "chewing-left"};
    stage.scene.motion =
        stage.view.motion = {.spec = "opening", .parameters = {}, .excitations = {}};
    stage.scene.motion_settings = {{.name = "opening",
                                    .label = "Maximum opening",
                                    .unit = "mm",
                                    .help = "At the incisors",
                                    .low = 0,
                                    .high = 80,
                                    .default_low = 42,
                                    .default_high = 58,
                                    .value = 50},
                                   {.name = "bennett",
                                    .label = "Bennett angle",
                                    .unit = "\u00b0",
                                    .help = "Seen from above",
                                    .low = 0,
                                    .high = 40,
                                    .default_low = 5,
                                    .default_high = 15,
                                    .value = 7.5},
                                   {.name = "inclination_left",
                                    .label = "Condylar inclination, L",
                                    .unit = "\u00b0",
                                    .help = "Secant over 5 mm",
                                    .low = 0,
                                    .high = 80,
                                    .default_low = 26,
                                    .default_high = 62,
                                    .known = false,
                                    .patients = 36.25}};
    stage.scene.excitations = {{"lm", "Masseter, left", 1, 0.2}, {"rm", "Masseter, right", 1, 0.2}};
    stage.scene.landmarks = {landmark_at("lower_incisal_point", {0, -80, -39}, stage.parts),
                             landmark_at("left_condyle", {45, 0, -48}, stage.parts)};
    stage.view.landmarks = stage.scene.landmarks;
    Curve round{"lower incisal point", {}, {}};
    Curve over_time{"opening", {}, {}};
    PlotSet posselt{"Posselt", {}, {}}, opening{"Opening", {}, {}};
    for (int i = 0; i <= 60; ++i) {
      const double t = i / 15.0;
      posselt.time_s.push_back(t);
      round.x.push_back(-10 * std::sin(t * std::numbers::pi / 4));
      round.y.push_back(-45 * std::sin(t * std::numbers::pi / 4));
      over_time.x.push_back(t);
      over_time.y.push_back(45 * std::sin(t * std::numbers::pi / 4));
    }
    opening.time_s = posselt.time_s;
    posselt.panels = {
        {{round},
         {.title = "Posselt, sagittal",
          .x_label = "mm",
          .y_label = "mm",
          .equal_scale = true,
          .bands = {{"maximum opening", {-27, -19, -19, -27}, {-48, -48, -44, -44}}}}}};
    opening.panels = {{{over_time},
                       {.title = "Opening over time",
                        .x_label = "time, s",
                        .y_label = "mm",
                        .bands = {{"maximum opening 42 to 58", {}, {42, 58}}}}}};
    stage.plots = {posselt, opening};
    stage.rest();
  }
  void keep(const std::string& what) {
    const auto file = test::kept_pictures() / (what + "-" + std::to_string(GetParam().height) +
                                               (GetParam().light ? "-light" : "-dark") + ".png");
    test::Picture(stage.image()).save(file);
  }
  /// Expects everything drawn inside its panel, and panels that do not overlap.
  void expect_tidy() {
    for (const DrawnItem& a : stage.panels->items()) {
      if (!a.panel.empty()) {
        const auto holder =
            std::find_if(stage.panels->items().begin(), stage.panels->items().end(),
                         [&](const DrawnItem& b) { return b.panel.empty() && b.name == a.panel; });
        if (holder != stage.panels->items().end()) {
          EXPECT_LE(a.rect.x + a.rect.width, holder->rect.x + holder->rect.width + 0.5) << a.name;
          EXPECT_GE(a.rect.x, holder->rect.x - 0.5) << a.name;
        }
      }
      for (const DrawnItem& b : stage.panels->items()) {
        const auto floats = [](const DrawnItem& item) {
          return item.name == "open" || item.name == "import" ||  // above all panels
                 item.name.starts_with("edge:");                  // on their margins
        };
        if (&a == &b || a.panel != b.panel || floats(a) || floats(b)) continue;
        const bool apart = a.rect.x + a.rect.width <= b.rect.x + 0.5 ||
                           b.rect.x + b.rect.width <= a.rect.x + 0.5 ||
                           a.rect.y + a.rect.height <= b.rect.y + 0.5 ||
                           b.rect.y + b.rect.height <= a.rect.y + 0.5;
        EXPECT_TRUE(apart) << a.name << " and " << b.name << " in '" << a.panel << "'";
      }
    }
  }

  PanelStage stage{GetParam().width, GetParam().height, GetParam().scale};
};

TEST_P(Instrument, NumbersOfTheMotionCanBeTypedAndThePatientsOwnAreShown) {
  stage.scene.excitations.clear();
  stage.click("tab:Motion");
  EXPECT_EQ(stage.item("number:bennett").words, "7.5\u00b0");
  EXPECT_EQ(stage.item("number:inclination_left").words, "36.2\u00b0");
  const auto& given = stage.view.motion.parameters;
  stage.enter("parameter:bennett", "12.5", true);
  ASSERT_EQ(given.size(), 1u);
  EXPECT_DOUBLE_EQ(given.at("bennett"), 12.5);
  EXPECT_EQ(stage.item("number:bennett").words, "12.5\u00b0");
  stage.enter("parameter:bennett", "900", true);
  EXPECT_DOUBLE_EQ(given.at("bennett"), 40) << "within the slider's ends";
  // A text that is no number, or an unchanged number, is no edit.
  const MotionChoice before = stage.view.motion;
  for (const char* words : {"abc", "", "-", "40"}) {
    stage.enter("parameter:bennett", words, true);
    stage.enter("parameter:inclination_left", words == std::string("40") ? "36.25" : words, true);
    EXPECT_TRUE(stage.view.motion == before) << words;
  }
  stage.panels->run(Command::undo, stage.scene, stage.view);
  EXPECT_DOUBLE_EQ(given.at("bennett"), 12.5);
  stage.click("left-tab:Parts");
  stage.enter("skin", "70", true);
  EXPECT_DOUBLE_EQ(stage.view.skin_opacity, 0.7) << "typed in %";
  expect_tidy();
  keep("typed");
}

TEST_P(Instrument, SlidersThatCutAndCompareSayHowFar) {
  stage.click("left-tab:Look");
  stage.view.look.clip = stage.view.look.cut_away = stage.view.look.wipe = true;
  stage.view.look.clip_from = 'S';
  stage.view.look.clip_fraction = 0.25;
  stage.rest();
  EXPECT_EQ(stage.item("number:clip-depth").words, "55 mm, 25 %");  // of 220 mm
  EXPECT_EQ(stage.item("number:cut-radius").words, "35 mm");
  EXPECT_EQ(stage.item("number:wipe-at").words, "50 %");
  stage.view.look.clip_from = 'L';
  stage.rest();
  EXPECT_EQ(stage.item("number:clip-depth").words, "40 mm, 25 %");  // of 160 mm
  expect_tidy();
  keep("cut");
}

TEST_P(Instrument, MusclesInTheTreeDifferWithinTheWidthTheyHave) {
  std::vector<std::string> kinds;
  for (const char* kind : {"Ant. Temporal", "Post. Temporal", "Superf. Masseter", "Med. Pterygoid",
                           "Sup. Lat. Pterygoid", "Inf. Lat. Pterygoid", "Post. Mylohyoid"})
    kinds.emplace_back(kind);
  for (std::size_t i = 0; i < kinds.size(); ++i)
    for (const char* side : {"L ", "R "})
      stage.scene.muscles.push_back(
          {side + std::to_string(i), kinds[i] + ", in full", side + kinds[i]});
  stage.click("group:bones");
  stage.click("group:teeth");
  stage.click("group:muscles");
  std::set<std::string> seen;
  int count = 0;
  for (const DrawnItem& item : stage.panels->items())
    if (item.name.starts_with("show:muscle:")) {
      EXPECT_EQ(item.words.substr(0, 2), item.name.substr(12, 2));
      seen.insert(item.words);
      ++count;
    }
  EXPECT_GT(count, 3);
  EXPECT_EQ(static_cast<int>(seen.size()), count);
  keep("muscles");
}

TEST_P(Instrument, PlotsStandBelowThePictureAndFollowTheClock) {
  stage.click("plots-tool");
  stage.rest();
  const ViewRect plots = stage.item("plots").rect;
  EXPECT_TRUE(lies_within(stage.item("plot:Posselt, sagittal").rect, plots));
  expect_tidy();
  keep("plots");
  stage.click("plot-tab:Opening");
  stage.rest();
  const ViewRect plot = stage.item("plot:Opening over time").rect;
  const Image early = stage.image();
  stage.frame.time_s = 3.4;
  stage.rest();
  const Image late = stage.image();
  std::size_t changed = 0;
  for (int y = static_cast<int>(plot.y); y < plot.y + plot.height; ++y)
    for (int x = static_cast<int>(plot.x); x < plot.x + plot.width; ++x) {
      const auto at = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(early.width) +
                           static_cast<std::size_t>(x));
      changed += early.rgba[at] != late.rgba[at];
    }
  EXPECT_GT(changed, 50u) << "the clock's line moves";
  stage.click("plot-tab:Stage times");
  stage.rest();
  EXPECT_TRUE(stage.has("plot:Stage times of the last steps"));
  stage.click("plots-close");
  stage.rest();
  EXPECT_FALSE(stage.has("plots"));
}

TEST_P(Instrument, CurvesThatCoincideAreBothSeen) {
  Curve left{"left", {}, {}};
  for (int i = 0; i <= 60; ++i) {
    left.x.push_back(i);
    left.y.push_back(20 * std::sin(0.1 * i));
  }
  Curve right = left;
  right.name = "right";
  stage.plots = {
      {"Condyles",
       {PlotPanel{{left, right},
                  {.title = "path", .x_label = "mm", .y_label = "mm", .legend = false}}}}};
  stage.click("plots-tool");
  stage.rest();
  const Image image = stage.image();
  const ViewRect& plot = stage.item("plot:path").rect;
  int blue = 0, orange = 0;  // the first two colours of curves
  for (int y = static_cast<int>(plot.y); y < plot.y + plot.height; ++y)
    for (int x = static_cast<int>(plot.x); x < plot.x + plot.width; ++x) {
      const auto* p = &image.rgba[4 * (static_cast<std::size_t>(y) * image.width + x)];
      blue += p[2] > p[0] + 60 && p[2] > p[1] + 25;
      orange += p[0] > p[2] + 60 && p[0] > p[1] + 25;
    }
  EXPECT_GT(blue, 300);
  EXPECT_GT(orange, 300);
}

TEST_P(Instrument, PlotsHaveAScaleAndTheirNamesStandClearOfTheCurves) {
  const auto box = [](const char* name, double x0, double x1, double y0, double y1) {
    return PlotBand{name, {x0, x1, x1, x0}, {y0, y0, y1, y1}};
  };
  Curve sagittal{"way", {}, {}}, frontal = sagittal, above = sagittal;
  for (int i = 0; i <= 60; ++i) {
    const double s = i / 60.0;
    sagittal.x.push_back(-24 * s - 2 * std::sin(6 * s));
    frontal.x.push_back(0);
    above.x.push_back(0);
    sagittal.y.push_back(-45 * s);
    frontal.y.push_back(-45 * s);
    above.y.push_back(-24 * s);
  }
  const auto panel = [](const char* title, const Curve& curve, std::vector<PlotBand> bands) {
    return PlotPanel{{curve},
                     {.title = title,
                      .x_label = "mm",
                      .y_label = "mm",
                      .equal_scale = true,
                      .bands = std::move(bands)}};
  };
  stage.plots = {
      {"Posselt",
       {panel("sagittal", sagittal,
              {box("end of hinge", -15, -9, -21, -16), box("maximum opening", -27, -19, -48, -44),
               box("protrusion", 6, 11, -3, 3)}),
        panel("frontal", frontal,
              {box("right", -12, -7, -12, 0), box("left", 7, 12, -12, 0),
               box("maximum opening", -2, 2, -48, -44)}),
        panel("horizontal", above,
              {box("right", -12, -7, -6, 2), box("left", 7, 12, -6, 2),
               box("protrusion", -1, 1, 6, 11)})}}};
  stage.click("plots-tool");
  stage.rest();
  keep("plots-named");
  expect_tidy();
  const Image image = stage.image();
  const auto is_ink = [&](int x, int y) {  // of the first curve: blue without red
    const auto* p = &image.rgba[4 * (static_cast<std::size_t>(y) * image.width + x)];
    return p[2] > p[0] + 60 && p[2] > p[1] + 25;
  };
  std::map<std::string, int> ticks;
  int words = 0, ink = 0;
  for (const DrawnItem& item : stage.panels->items()) {
    const ViewRect& r = item.rect;
    if (item.name.starts_with("x-tick:") || item.name.starts_with("y-tick:"))
      ++ticks[item.name[0] + item.panel];
    if (item.panel.starts_with("plot:")) {
      EXPECT_TRUE(lies_within(r, stage.item(item.panel).rect)) << item.name;
    }
    const bool named = item.name.starts_with("plot-word:");
    words += named;
    if (!named && !item.name.starts_with("plot:")) continue;
    for (int y = static_cast<int>(r.y); y < r.y + r.height; ++y)
      for (int x = static_cast<int>(r.x); x < r.x + r.width; ++x) {
        if (named) {
          ASSERT_FALSE(is_ink(x, y)) << item.name << " at " << x << ", " << y;
        } else {
          ink += is_ink(x, y);
        }
      }
  }
  EXPECT_EQ(words, 9);
  EXPECT_GT(ink, 300);  // curves are distinguished from text by their colour
  ASSERT_EQ(ticks.size(), 6u);
  for (const auto& [axis, count] : ticks) EXPECT_GE(count, 3) << axis;
}

TEST_P(Instrument, ReadingsSayWhatRests) {
  stage.view.playing = true;
  stage.rest();
  EXPECT_EQ(stage.item("rates").words, "60 steps/s, 24 pictures/s");
  stage.view.playing = false;
  stage.drawing.pictures_per_second = 0;
  stage.rest();
  EXPECT_EQ(stage.item("rates").words, "at rest");
  EXPECT_TRUE(stage.view.simulates_tissue(stage.scene));
  const double below = stage.item("heading:Performance").rect.y;
  stage.click("skin:off");
  EXPECT_FALSE(stage.view.simulates_tissue(stage.scene));
  EXPECT_EQ(stage.item("beside-heading:Tissue").words, "waits");
  EXPECT_NEAR(stage.item("heading:Performance").rect.y, below, 2);
  keep("tissue-waits");
}

TEST_P(Instrument, TimesOfStagesAreHiddenUntilPerformanceIsUnfolded) {
  EXPECT_TRUE(stage.has("rates"));
  EXPECT_FALSE(stage.has("curve"));
  stage.click("group:performance");
  EXPECT_TRUE(stage.has("curve"));
  keep("performance");
  stage.click("group:performance");
  EXPECT_FALSE(stage.has("curve"));
}

TEST_P(Instrument, TheLabelOfAMeasureStandsBesideItsLine) {
  stage.view.tool = Tool::measure;
  for (const int corner : {0, 1, 5, 4})  // of the mandible's box
    for (const auto& t : stage.parts[4].mesh.triangles)
      if (t[0] == corner) {
        stage.view.measured.push_back({4, t, {1, 0, 0}});
        break;
      }
  ASSERT_EQ(stage.view.measured.size(), 4u);
  stage.rest();
  const ViewRect label = stage.item("measure-label").rect;
  const Layout layout = stage.panels->layout(GetParam().width, GetParam().height, stage.view);
  EXPECT_TRUE(lies_within(label, layout.view));
  std::vector<Eigen::Vector2d> line;
  for (const auto& point : stage.view.measured)
    line.push_back(
        screen_place(stage.camera, layout.view, place_of(point, stage.parts, stage.frame)));
  for (std::size_t i = 0; i + 1 < line.size(); ++i)
    for (int k = 0; k <= 400; ++k) {
      const Eigen::Vector2d p = line[i] + k / 400.0 * (line[i + 1] - line[i]);
      ASSERT_FALSE(label.contains(p.x(), p.y())) << i;
    }
  EXPECT_LT((line.back() - Eigen::Vector2d(label.x + label.width / 2, label.y)).norm(),
            label.width + 40 * GetParam().scale);
  keep("measured");
}

TEST_P(Instrument, ASinglePointHasALabelAndNumbersAreCopied) {
  stage.view.tool = Tool::measure;
  const Eigen::Vector3i t = stage.parts[4].mesh.triangles[0];
  stage.view.measured.push_back({4, t, {1, 0, 0}});
  stage.rest();
  EXPECT_EQ(stage.item("measure-label").words, "to a second point");
  stage.view.measured.push_back({4, t, {0, 1, 0}});
  stage.rest();
  const double length = (stage.parts[4].mesh.vertices[static_cast<std::size_t>(t[0])] -
                         stage.parts[4].mesh.vertices[static_cast<std::size_t>(t[1])])
                            .norm();
  EXPECT_EQ(stage.item("measure-label").words, fmt::format("{:.1f} mm", length));
  stage.click("measure-copy");
  const std::string copied = ImGui::GetClipboardText();
  EXPECT_TRUE(copied.starts_with(fmt::format("length_mm\t{:.3f}\n", length))) << copied;
  EXPECT_EQ(std::count(copied.begin(), copied.end(), '\n'), 4) << copied;
  EXPECT_FALSE(stage.panels->said().empty());
  keep("measure-two");
}

TEST_P(Instrument, TheKeyNamesTheGhost) {
  EXPECT_FALSE(stage.has("key"));
  stage.view.look.ghost = true;
  stage.rest();
  EXPECT_TRUE(stage.has("key"));
}

TEST_P(Instrument, AnUnfoldedGroupScrollsIntoView) {
  for (int i = 0; i < 24; ++i)
    stage.scene.muscles.push_back({"m" + std::to_string(i), "Muscle " + std::to_string(i)});
  stage.rest();
  stage.click("group:muscles");
  stage.rest();
  EXPECT_NEAR(stage.item("group:muscles").rect.y, stage.item("heading:Parts").rect.y,
              30 * GetParam().scale);
  keep("muscles-unfolded");
}

TEST_P(Instrument, SlidersChangeTheMotionOnMouseRelease) {
  stage.click("tab:Motion");
  stage.rest();
  expect_tidy();
  keep("motion");
  stage.slide("parameter:bennett", 0.2, 0.5);
  ASSERT_TRUE(stage.view.motion.parameters.count("bennett"));
  EXPECT_NEAR(stage.view.motion.parameters["bennett"], 20, 1);
  EXPECT_FALSE(stage.view.motion.parameters.count("opening"));
  stage.slide("excitation:lm", 0.2, 0.75);
  EXPECT_NEAR(stage.view.motion.excitations["lm"], 0.75, 0.03);
  const std::string shown = stage.item("number:lm").words;
  EXPECT_TRUE(shown.ends_with(" %") && shown.size() <= 6) << shown << ", to a tenth at most";
  EXPECT_EQ(fmt::format("{:g} %", 100 * stage.view.motion.excitations["lm"]), shown);
  stage.panels->run(Command::undo, stage.scene, stage.view);
  EXPECT_TRUE(stage.view.motion.excitations.empty());
  stage.panels->run(Command::redo, stage.scene, stage.view);
  EXPECT_EQ(stage.view.motion.excitations.size(), 1u);
  stage.click("parameters-reset");
  EXPECT_TRUE(stage.view.motion.parameters.empty());
  // A motion by its name.
  stage.click("motion");
  stage.rest();
  stage.click("motion:posselt");
  EXPECT_EQ(stage.view.motion.spec, "posselt");
}

TEST_P(Instrument, SlidersMoveTheFaceOnBothSidesOrOne) {
  stage.click("tab:Face");
  stage.rest();
  EXPECT_FALSE(stage.has("both-sides")) << "no muscles";
  stage.scene.expressions = {{"smile", "Smile"}, {"AU16", "AU16, lower lip depressor"}};
  stage.rest();
  expect_tidy();
  keep("face");
  const auto& levels = stage.view.expression;
  stage.slide("expression:smile:right", 0.02, 0.8);
  ASSERT_EQ(levels.size(), 1u);
  EXPECT_NEAR(levels[0].right, 0.8, 0.05);
  EXPECT_EQ(levels[0].left, levels[0].right);
  EXPECT_EQ(stage.item("number:smile").words,
            fmt::format("{0} %  {0} %", std::lround(100 * levels[0].left)));
  stage.click("both-sides");
  stage.enter("expression:smile:left", "25", true);
  EXPECT_DOUBLE_EQ(levels[0].left, 0.25);
  EXPECT_NEAR(levels[0].right, 0.8, 0.05);
  stage.slide("expression:AU16:left", 0.02, 0.5);
  ASSERT_EQ(levels.size(), 2u);
  EXPECT_EQ(levels[1].name, "AU16");
  EXPECT_EQ(levels[1].right, 0);
  EXPECT_LT(stage.item("expression:smile:right").rect.x, stage.item("expression:smile:left").rect.x)
      << "as in a view from the front";
  stage.enter("expression:AU16:left", "0", true);
  EXPECT_EQ(levels.size(), 1u) << "nothing is kept of what is not excited";
  stage.click("expression-relax");
  EXPECT_TRUE(levels.empty());
  stage.panels->run(Command::undo, stage.scene, stage.view);
  EXPECT_EQ(levels.size(), 1u);
}

TEST_P(Instrument, TheMotionIsNamedAsInItsList) {
  for (const auto& [name, words] : {std::pair{"chewing-left", "Chewing left"},
                                    {"chewing left", "Chewing left"},
                                    {"open-wide.csv", "open-wide.csv"}}) {
    stage.scene.motion_name = name;
    stage.rest();
    EXPECT_EQ(stage.item("motion-title").words, words);
  }
}

TEST_P(Instrument, ALongMotionInWordsIsCutBesideItsHeading) {
  stage.scene.motion_name = "open 50; close; left 8; right 8; protrude 6; retrude 1; rest; hold 2";
  stage.click("tab:Motion");
  stage.rest();
  expect_tidy();
  const ViewRect heading = stage.item("heading:Motion").rect,
                 beside = stage.item("beside-heading:Motion").rect;
  EXPECT_GT(beside.width, heading.width);
  EXPECT_GE(beside.x, heading.x + heading.width);
}

TEST_P(Instrument, AnotherPatientsRecordingHasNothingOfThisOnesCaption) {
  stage.click("tab:Record");
  stage.rest();
  stage.enter("record-caption", "Anna");
  stage.click("record-height:720");
  const auto recorded = [&] {
    stage.click("record");
    return std::get<request::Record>(stage.panels->take_requests().at(0));
  };
  EXPECT_EQ(recorded().caption, "Anna");
  stage.panels->forget_patient();
  stage.rest();
  EXPECT_EQ(recorded().caption, "");
  EXPECT_EQ(recorded().height, 720);
}

TEST_P(Instrument, EveryDoubtAboutAProposedRoleIsReported) {
  stage.panels->ask_roles({.files = {{"a/mandible.ply", "mandible"},
                                     {"a/mandible_8k.ply", "", "mandible"},
                                     {"a/maxilla_left.ply", "maxilla"},
                                     {"a/maxilla_right.ply", "maxilla"},
                                     {"a/maxilla_wrap.ply", "", "maxilla"},
                                     {"a/skull.ply", "skull"},
                                     {"a/skull_of_another.ply", "skull"}}});
  stage.rest();
  keep("roles");
  const std::string remark = stage.item("import-remark").words;
  for (const char* doubt : {"mandible_8k.ply (mandible)", "maxilla_wrap.ply (maxilla)",
                            "2 surfaces are said to be the skull",
                            "2 surfaces are said to be the "
                            "maxilla"})
    EXPECT_NE(remark.find(doubt), std::string::npos) << remark;
  EXPECT_EQ(remark.find("to be the mandible"), std::string::npos) << remark;
  stage.click("import-go");
  EXPECT_EQ(std::get<request::Import>(stage.panels->take_requests().at(0)).files[1].role, "");
}

TEST_P(Instrument, AStoppedRecordingIsResumedAndAQuestionAnsweredByButtonOrKey) {
  stage.click("tab:Record");
  stage.rest();
  EXPECT_FALSE(stage.has("record-resume"));
  stage.unfinished = "9 of 91 pictures are in /home/somebody/recordings/condyle-20240131-140509.";
  stage.rest();
  keep("record-unfinished");
  EXPECT_TRUE(stage.has("record")) << "another one can be made";
  stage.click("record-resume");
  EXPECT_TRUE(
      std::holds_alternative<request::ResumeRecording>(stage.panels->take_requests().at(0)));
  stage.recording = "picture 10 of 91";
  stage.rest();
  EXPECT_FALSE(stage.has("record-resume"));
  stage.recording.clear();

  const Question question = {
      .title = "A recording is running",
      .words = stage.unfinished,
      .answers = {{"question:keep", "Keep recording"},
                  {"question:when-done", "Quit when done", request::Quit{true}},
                  {"question:quit", "Stop and quit", request::Quit{}}}};
  const auto asked = [&] {
    stage.panels->ask(question);
    stage.rest();
  };
  asked();
  keep("question");
  EXPECT_TRUE(stage.panels->dialog_open());
  EXPECT_FALSE(stage.panels->takes(Command::toggle_play));
  stage.click("question:when-done");
  EXPECT_TRUE(std::get<request::Quit>(stage.panels->take_requests().at(0)).when_recorded);
  EXPECT_FALSE(stage.panels->dialog_open());
  for (const Command key : {Command::accept, Command::close_dialog}) {
    asked();
    EXPECT_TRUE(stage.panels->run(key, stage.scene, stage.view));
    EXPECT_FALSE(stage.panels->question());
    EXPECT_TRUE(stage.panels->take_requests().empty()) << "neither key quits";
  }
  stage.rest();
  EXPECT_FALSE(stage.has("question"));
}

TEST_P(Instrument, ARecordingHasAnySizeWithinBounds) {
  stage.click("tab:Record");
  stage.rest();
  const auto sized = [&] {
    stage.click("record");
    return std::get<request::Record>(stage.panels->take_requests().at(0));
  };
  stage.enter("record-width", "1000");
  stage.enter("record-tall", "1300.4");
  EXPECT_EQ(sized().width, 1000);
  EXPECT_EQ(sized().height, 1300);
  stage.enter("record-width", "1e9");
  stage.enter("record-tall", "-5");
  EXPECT_EQ(sized().width, 8192);
  EXPECT_EQ(sized().height, 16);
  stage.click("record-height:1440");
  EXPECT_EQ(sized().width, 2560);
  EXPECT_EQ(sized().height, 1440);
  EXPECT_EQ(stage.panels->record_choice().width, 2560) << "what is kept for the next run";
}

TEST_P(Instrument, ARecordingIsRequestedAsConfigured) {
  stage.click("tab:Record");
  stage.rest();
  expect_tidy();
  keep("record");
  stage.click("record-height:720");
  stage.click("record-rate:24");
  stage.click("record-finer:2");
  stage.click("record-edges:1");
  stage.click("record-film");
  stage.click("record");
  const auto requests = stage.panels->take_requests();
  ASSERT_EQ(requests.size(), 1u);
  const auto* record = std::get_if<request::Record>(&requests.front());
  ASSERT_TRUE(record);
  EXPECT_EQ(record->width, 1280);
  EXPECT_EQ(record->height, 720);
  EXPECT_EQ(record->frames_per_second, 24);
  EXPECT_EQ(record->supersampling, 2);
  EXPECT_EQ(record->edges, RecordEdges::fxaa);
  EXPECT_FALSE(record->film);
  EXPECT_FALSE(record->folder.empty());
  stage.recording = "picture 3 of 97";
  stage.rest();
  EXPECT_TRUE(stage.has("record-progress"));
  EXPECT_FALSE(stage.has("record"));
  stage.click("record-cancel");
  const auto stopped = stage.panels->take_requests();
  ASSERT_EQ(stopped.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<request::StopRecording>(stopped.front()));
}

TEST_P(Instrument, LandmarksAreChosenDeletedAndSaved) {
  stage.click("landmarks-tool");
  stage.rest();
  ASSERT_TRUE(stage.has("landmarks"));
  expect_tidy();
  keep("landmarks");
  stage.click("landmark:left_condyle");
  EXPECT_EQ(stage.view.landmark, 1u);
  stage.click("landmark-delete");
  ASSERT_EQ(stage.view.landmarks.size(), 1u);
  EXPECT_EQ(stage.view.landmarks[0].name, "lower_incisal_point");
  stage.panels->run(Command::undo, stage.scene, stage.view);
  EXPECT_EQ(stage.view.landmarks.size(), 2u);
  EXPECT_FALSE(stage.view.landmark.has_value());
}

TEST_P(Instrument, FilesAreOpenedFromAListAndSurfacesPromptForTheirRoles) {
  stage.scene.recent = {"/data/patient-a", "/data/patient-b"};
  stage.click("open-files");
  stage.rest(4);
  ASSERT_TRUE(stage.panels->dialog_open());
  keep("open");
  expect_tidy();
  stage.click("recent:1");
  auto requests = stage.panels->take_requests();
  ASSERT_EQ(requests.size(), 1u);
  EXPECT_EQ(std::get<request::Open>(requests.front()).files.at(0), "/data/patient-b");
  EXPECT_FALSE(stage.panels->dialog_open());

  stage.panels->ask_roles({.files = {{"/data/lower.stl", "mandible"}, {"/data/what.stl", ""}}});
  stage.rest(4);
  keep("import");
  expect_tidy();
  stage.click("import-go");
  requests = stage.panels->take_requests();
  ASSERT_EQ(requests.size(), 1u);
  const auto& import = std::get<request::Import>(requests.front());
  EXPECT_EQ(import.files.at(0).role, "mandible");
  EXPECT_EQ(import.files.at(1).role, "");
  EXPECT_FALSE(stage.panels->dialog_open());
}

TEST_P(Instrument, SeveralFilesAreChosenAndOpenedAtOnce) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("condyle-open-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  for (const char* name :
       {"a.stl", "b.stl", "c.ply", "d.obj", "marks.csv", "points.mrk.json", "other.json", "x.doc"})
    std::ofstream(folder / name) << "of no matter";
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder);
  const auto open = [&] {
    stage.click("open-files");
    stage.rest(40);  // so that the next click makes no double one
  };
  const auto click = [&](const std::string& name, bool ctrl, bool shift) {
    stage.hold(ctrl, shift);
    stage.click("file:" + name);
    stage.hold(false, false);
    stage.rest(40);
  };
  const auto chosen = [&] {
    std::set<std::string> names;
    for (const DrawnItem& item : stage.panels->items())
      if (item.words == "chosen") names.insert(item.name.substr(5));
    return names;
  };
  const auto opened = [&] {
    std::vector<std::string> names;
    for (const Request& one : stage.panels->take_requests())
      for (const auto& file : std::get<request::Open>(one).files)
        names.push_back(file.filename().string());
    return names;
  };
  using Names = std::vector<std::string>;
  using NameSet = std::set<std::string>;
  open();
  EXPECT_TRUE(stage.has("file:points.mrk.json"));
  EXPECT_FALSE(stage.has("file:other.json"));
  EXPECT_FALSE(stage.has("file:x.doc"));
  click("d.obj", false, false);
  EXPECT_EQ(chosen(), NameSet{"d.obj"});
  click("b.stl", false, true);
  EXPECT_EQ(chosen(), (NameSet{"b.stl", "c.ply", "d.obj"}));
  click("c.ply", true, false);
  click("marks.csv", true, false);
  EXPECT_EQ(chosen(), (NameSet{"b.stl", "d.obj", "marks.csv"}));
  expect_tidy();
  keep("open-several");
  stage.click("open-go");
  EXPECT_EQ(opened(), (Names{"b.stl", "d.obj", "marks.csv"}));
  EXPECT_FALSE(stage.panels->dialog_open());

  // Enter does the same; a double click opens one file; a single click deselects the others.
  open();
  EXPECT_EQ(chosen(), NameSet{});
  click("a.stl", false, false);
  click("c.ply", true, false);
  stage.panels->run(Command::accept, stage.scene, stage.view);
  stage.rest();
  EXPECT_EQ(opened(), (Names{"a.stl", "c.ply"}));
  open();
  click("a.stl", true, false);
  click("b.stl", false, false);
  EXPECT_EQ(chosen(), NameSet{"b.stl"});
  EXPECT_TRUE(opened().empty());
  const ViewRect row = stage.item("file:b.stl").rect;
  for (const bool down : {false, true, false, true, false})
    stage.step(row.x + 20, row.y + row.height / 2, down);
  EXPECT_EQ(opened(), Names{"b.stl"});
  // A typed path takes precedence.
  open();
  click("a.stl", false, false);
  stage.enter("open-path", "/data/case");
  EXPECT_EQ(opened(), Names{"case"});
  std::filesystem::current_path(before);
  std::filesystem::remove_all(folder);
}

TEST_P(Instrument, VerticalOpeningAndInterincisalDistanceAreDistinguished) {
  stage.scene.landmarks.push_back(landmark_at("upper_incisal_point", {0, -80, -38}, stage.parts));
  stage.frame = box_frame(1.2, 50);
  stage.frame.measures.interincisal_mm = 61.7;
  stage.rest();
  EXPECT_EQ(stage.item("opening-number").words, "50.0");
  EXPECT_EQ(stage.item("reading:Interincisal distance").words, "61.7 mm");
  const auto explained = [&](const std::string& item) {
    const ViewRect r = stage.item(item).rect;
    stage.rest();
    for (int i = 0; i < 32; ++i) stage.step(r.x + r.width / 2, r.y + r.height / 2, false);
    return stage.item("tooltip").words;
  };
  EXPECT_NE(explained("opening-number").find("Vertical displacement"), std::string::npos);
  EXPECT_NE(explained("reading:Interincisal distance").find("42 to 58 mm"), std::string::npos);
  EXPECT_NE(explained("opening").find("drop of the lower incisal point"), std::string::npos);
  stage.rest();
  expect_tidy();
  keep("openings");
}

TEST_P(Instrument, AnImpossibleOpeningIsDisabledWithItsReason) {
  stage.slide("opening", 0.2, 0.5);
  ASSERT_TRUE(stage.view.opening_mm);
  stage.click("release");
  const auto [x, y, width, height] = stage.item("opening").rect;
  const auto coloured = [&] {
    const ImU32 c = palette().accent;
    return colour_fraction(test::Picture(stage.image()),
                           (c & 0xff) << 16 | (c & 0xff00) | (c >> 16 & 0xff),
                           {x, y, width, height});
  };
  EXPECT_GT(coloured(), 0.02);
  stage.scene.max_opening_mm = 0.3;
  stage.rest();
  EXPECT_EQ(coloured(), 0);
  stage.slide("opening", 0.2, 0.5);
  EXPECT_FALSE(stage.view.opening_mm);
  for (int i = 0; i < 32; ++i) stage.step(x + width / 2, y + height / 2, false);
  EXPECT_TRUE(stage.item("tooltip").words.starts_with("Nothing to open along"));
  keep("no-opening");
}

TEST_P(Instrument, AFinalPictureIsDistinguishedFromAPreview) {
  stage.drawing.samples = 1;
  stage.rest();
  EXPECT_EQ(stage.item("quality").words, "preview");
  stage.drawing.finished = true;
  stage.rest();
  EXPECT_EQ(stage.item("quality").words, "limited by the driver");
  expect_tidy();
  stage.drawing.samples = 4;
  stage.rest();
  EXPECT_FALSE(stage.has("quality"));
}

TEST_P(Instrument, MeasurementsStayInThePictureUntilCleared) {
  constexpr unsigned yellow = 0xf0e442;
  const auto drawn = [&] {
    stage.rest();
    return colour_fraction(test::Picture(stage.image()), yellow) > 0;
  };
  EXPECT_FALSE(drawn());
  stage.view.tool = Tool::measure;
  for (const int corner : {0, 1})  // of the face's front
    stage.view.measured.push_back(
        {.part = 5, .triangle = {0, 1, 4}, .barycentric = Eigen::Vector3d::Unit(corner)});
  EXPECT_TRUE(drawn());
  EXPECT_TRUE(stage.has("measure-clear"));
  stage.view.tool = Tool::look;
  EXPECT_TRUE(drawn());
  EXPECT_FALSE(stage.has("measure-clear"));
  keep("measured");
  stage.view.tool = Tool::measure;
  stage.rest();
  stage.click("measure-clear");
  EXPECT_FALSE(drawn());
}

TEST_P(Instrument, TooltipsWaitAndCoverNothingThatAClickReveals) {
  stage.click("tab:Record");
  const auto rest_on = [&](const std::string& item, int pictures) {
    const ViewRect r = stage.item(item).rect;
    for (int i = 0; i < pictures; ++i) stage.step(r.x + r.width / 2, r.y + r.height / 2, false);
  };
  constexpr int half_a_second = 32;
  rest_on("record-cameras", 10);
  EXPECT_FALSE(stage.has("tooltip"));
  EXPECT_TRUE(stage.panels->talking()) << "one is to come, so the window draws on";
  rest_on("record-cameras", half_a_second);
  ASSERT_TRUE(stage.has("tooltip"));
  EXPECT_FALSE(stage.panels->talking());
  // Another item restarts the wait.
  rest_on("record-caption", 10);
  EXPECT_FALSE(stage.has("tooltip"));
  rest_on("record-caption", half_a_second);
  ASSERT_TRUE(stage.has("tooltip"));
  EXPECT_NE(stage.item("tooltip").words.find("{interincisal}"), std::string::npos);
  keep("tooltip");
  EXPECT_TRUE(lies_within(stage.item("tooltip").rect,
                          {0, 0, double(GetParam().width), double(GetParam().height)}));
  // A click opens the list: no tooltip covers it, however long the mouse rests.
  const ViewRect list = stage.item("record-cameras").rect;
  for (const bool down : {false, true, false})
    stage.step(list.x + list.width / 2, list.y + list.height / 2, down);
  rest_on("record-cameras", 2 * half_a_second);
  ASSERT_TRUE(stage.has("camera:front"));
  EXPECT_FALSE(stage.has("tooltip"));
  keep("record-cameras");
  stage.panels->run(Command::close_dialog, stage.scene, stage.view);
  stage.rest();
  // A clicked button shows no tooltip until the mouse has left it.
  rest_on("record-transparent", half_a_second);
  EXPECT_TRUE(stage.has("tooltip"));
  const ViewRect box = stage.item("record-transparent").rect;
  stage.step(box.x + box.width / 2, box.y + box.height / 2, true);
  rest_on("record-transparent", 2 * half_a_second);
  EXPECT_FALSE(stage.has("tooltip"));
  stage.rest();
  rest_on("record-transparent", half_a_second);
  EXPECT_TRUE(stage.has("tooltip"));
}

TEST_P(Instrument, DisplayTabSetsWhatThePictureShows) {
  stage.scene.distance_colours = distance_colours();
  stage.click("left-tab:Look");
  stage.rest();
  stage.click("clip");
  stage.rest();
  stage.click("clip-from:S");
  stage.slide("clip-depth", 0.5, 0.25);
  stage.click("cut-away");
  stage.rest();
  stage.click("cut-at:Mouth");
  stage.click("ghost");
  stage.click("wipe");
  stage.rest();
  stage.slide("wipe-at", 0.5, 0.75);
  expect_tidy();
  keep("look");
  EXPECT_TRUE(stage.view.look.clip && stage.view.look.cut_away && stage.view.look.ghost);
  EXPECT_EQ(stage.view.look.clip_from, 'S');
  EXPECT_NEAR(stage.view.look.clip_fraction, 0.25, 0.03);
  EXPECT_NEAR(stage.view.look.wipe_at, 0.75, 0.03);
  EXPECT_EQ(stage.view.look.cut_at, Look::Window::mouth);
}

TEST_P(Instrument, WhatIsPreparedShowsAboveThePictureAndCanBeEnded) {
  stage.progress = "Building the soft tissue";
  stage.can_cancel = true;
  stage.rest();
  EXPECT_TRUE(lies_within(stage.item("progress").rect,
                          stage.panels->layout(GetParam().width, GetParam().height).view));
  EXPECT_TRUE(stage.has("play")) << "the window stays usable";
  stage.click("cancel");
  const auto requests = stage.panels->take_requests();
  ASSERT_EQ(requests.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<request::Cancel>(requests.front()));
}

INSTANTIATE_TEST_SUITE_P(Screens, Instrument,
                         testing::Values(LitScreen{1280, 720, 1, false},
                                         LitScreen{1280, 720, 1, true},
                                         LitScreen{3840, 2160, 2.5f, false}),
                         [](const auto& screen) {
                           return std::to_string(screen.param.height) +
                                  (screen.param.light ? "light" : "dark");
                         });

TEST(Plots, ThePlaceOnACurveLiesBetweenItsSamples) {
  const Curve curve{"way", {0, 2, 4}, {0, 10, 0}};
  const std::vector<double> times = {0, 1, 3};
  EXPECT_EQ(*place_on(curve, times, 0.5), Eigen::Vector2d(1, 5));
  EXPECT_EQ(*place_on(curve, times, 2), Eigen::Vector2d(3, 5));
  EXPECT_EQ(*place_on(curve, times, -1), Eigen::Vector2d(0, 0));
  EXPECT_FALSE(place_on(curve, times, 4)) << "not walked through yet";
  EXPECT_FALSE(place_on(curve, {0, 1}, 0.5));
}

TEST(Landmarks, FollowTheNearestBone) {
  const auto parts = box_patient();
  const FrameState open = box_frame(1, 30);
  const Landmark lower = landmark_at("lower_incisal_point", {0, -80, -39}, parts);
  EXPECT_EQ(parts[lower.part].name, "lower_teeth");
  EXPECT_LT((place_of(lower, parts, open) - open.poses[mandible_body] * lower.at_rest).norm(),
            1e-9);
  // A condyle's centre may lie nearer to the skull.
  const Landmark condyle = landmark_at("left_condyle", {60, 50, 1}, parts);
  EXPECT_EQ(parts[condyle.part].role, Role::mandible);
  EXPECT_EQ(landmark_name("  Lower incisal-Point "), "lower_incisal_point");
  EXPECT_EQ(landmark_name("--"), "");
}

class ArrangementFile : public testing::Test {
 protected:
  ~ArrangementFile() override { std::filesystem::remove_all(folder_); }
  /// Another run of the program, in which the window opens as `opened` and ends as `left`.
  void run(const Arrangement& opened, const Arrangement& left) {
    KeptArrangement kept(file_);
    kept.begin(opened);
    kept.update(left, true);
  }
  Arrangement kept() { return KeptArrangement(file_).arrangement(); }
  void write(const std::string& text) {
    std::filesystem::create_directories(file_.parent_path());
    std::ofstream(file_) << text;
  }
  const std::filesystem::path folder_ = std::filesystem::temp_directory_path() /
                                        ("condyle-arrangement-" + std::to_string(::getpid()));
  const std::filesystem::path file_ = folder_ / "deep" / "window.json";
};

TEST_F(ArrangementFile, OnlyThePersonsChangesAreRestored) {
  EXPECT_TRUE(KeptArrangement(file_).trouble().empty()) << "none yet";
  run({}, {});
  EXPECT_FALSE(std::filesystem::exists(file_)) << "nothing was changed";
  // Every setting differs from its default.
  const Arrangement all{
      .light = true,
      .ui_scale = 1.25,
      .width = 1600,
      .height = 901,
      .maximized = true,
      .sizes = {.left = 300.5, .right = 333, .plots = 210},
      .panels = {.tab = SideTab::record, .left_tab = LeftTab::look, .plots = true, .plot_set = 3},
      .open_groups = {"muscles"},
      .record = {.width = 1000,
                 .height = 1300,
                 .frames_per_second = 24,
                 .supersampling = 3,
                 .edges = RecordEdges::fxaa,
                 .film = false,
                 .transparent = true,
                 .cameras = {"front", "left"}}};
  // Settings of one patient are not stored.
  Arrangement of_a_patient = all;
  of_a_patient.record.camera_from_file = true;
  of_a_patient.record.camera_file = "path.json";
  of_a_patient.record.caption = "Anna, opening {opening} mm";
  run({}, of_a_patient);
  EXPECT_EQ(kept(), all);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(file_.parent_path()), {}), 1);
  // A command line asked for dark panels and another size: it stays with its run, whatever else is
  // changed in it.
  Arrangement asked = all;
  asked.light = false;
  asked.width = 800;
  Arrangement left = asked;
  left.panels.tab = SideTab::motion;
  run(asked, left);
  Arrangement expected = all;
  expected.panels.tab = SideTab::motion;
  EXPECT_EQ(kept(), expected);
  // A window as small as a screen with small pixels, or one that tiles windows, may make it.
  left = expected;
  left.width = 256;
  left.height = 160;
  run(expected, left);
  EXPECT_EQ(kept(), left);
  // Back to the default scale.
  left = expected;
  left.ui_scale.reset();
  run(expected, left);
  EXPECT_EQ(kept().ui_scale, std::nullopt);
  KeptArrangement nowhere("/proc/condyle/window.json");
  nowhere.begin({});
  nowhere.update(all, true);  // no error
}

TEST_F(ArrangementFile, ABrokenOrForeignFileIsOneSentenceAndAllIsAsAtFirst) {
  for (const char* text :
       {"", "{", "[1, 2]", "light = yes", "\xff\xfe{}", "{\"light\": 3}", "{\"width\": \"wide\"}",
        "{\"light\": true, \"ui_scale\": 1e9}", "{\"height\": -5}", "{\"right_tab\": \"tab\"}",
        "{\"recording\": 1}", "{\"recording\": {\"width\": 9}}", "{\"left_tab\": 1}",
        "{\"open_groups\": [1]}", "{\"open_groups\": \"bones\"}", "{\"plot_set\": 1e300}"}) {
    SCOPED_TRACE(text);
    write(text);
    KeptArrangement kept(file_);
    EXPECT_EQ(kept.arrangement(), Arrangement{});
    EXPECT_NE(kept.trouble().find(file_.string()), std::string::npos) << kept.trouble();
    // It is reported once: a readable file then replaces it.
    kept.begin({});
    kept.update({}, true);
    EXPECT_TRUE(KeptArrangement(file_).trouble().empty()) << KeptArrangement(file_).trouble();
  }
  // An inaccessible file is not changed.
  std::filesystem::remove(file_);
  std::filesystem::create_directory(file_);
  KeptArrangement out_of_reach(file_);
  EXPECT_NE(out_of_reach.trouble(), "");
  out_of_reach.begin({});
  out_of_reach.update({.light = true}, true);
  EXPECT_TRUE(std::filesystem::is_directory(file_));
  std::filesystem::remove(file_);
  // A later version's file has more in it.
  write("{\"light\": true, \"of_a_later_version\": {\"a\": [1]}}");
  EXPECT_TRUE(KeptArrangement(file_).trouble().empty());
  EXPECT_TRUE(kept().light);
}

}  // namespace
}  // namespace condyle
