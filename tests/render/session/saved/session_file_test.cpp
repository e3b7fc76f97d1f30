// A session as a file: each field comes back, and what is wrong is refused with file, item, value.
#include "render/session/saved/session_file.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "sim/plan/plan_file.h"
#include "tests/support/boxes.h"
#include "tests/support/program.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

Part part(const std::string& name, Role role, double z, BodyId body) {
  Part made;
  made.name = name;
  made.role = role;
  made.mesh = test::box({-10, -10, z}, {10, 10, z + 5});
  made.body = body;
  return made;
}

/// A scene of a skull, a mandible and a free segment.
struct SavedScene : testing::Test {
  std::vector<Part> parts = {part("skull", Role::skull, 10, cranium_body),
                             part("mandible", Role::mandible, 0, mandible_body),
                             part("chin", Role::segment, -10, BodyId{2}),
                             part("face", Role::face, 20, cranium_body)};
  WindowScene scene = {
      .parts = parts,
      .bodies = {{.part = 1, .body = mandible_body},
                 {.part = 0, .body = cranium_body, .follows_motion = false},
                 {.part = 2, .body = BodyId{2}, .parent = mandible_body, .follows_motion = false}},
      .expressions = {{"smile", "Smile"}, {"AU16", "AU16"}},
      .muscles = {{"left_masseter", "Masseter"}, {"right_masseter", "Masseter"}},
      .layers = {{"skin", "Skin"}}};
  test::Folder folder;
  const fs::path file = folder / "a.condyle-session";

  static Pose turned(double angle, const Eigen::Vector3d& t) {
    return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, 2) / 3)), t};
  }

  /// A view in which no field has its default.
  ViewState changed_view() const {
    ViewState view;
    // Complete: a new field does not compile until it is changed here.
    auto& [clip, clip_skin, clip_from, clip_fraction, cut_away, cut_at, cut_radius_mm, ghost,
           wireframe, patches, paths, axes, springs, prisms, bone_springs, displacement,
           facial_muscles, muscle_labels, scale_bar, side_letters, folds, life, wipe, wipe_at,
           mirrored] = view.look;
    for (bool* flag : {&clip, &clip_skin, &cut_away, &ghost, &wireframe, &patches, &paths, &axes,
                       &springs, &prisms, &bone_springs, &displacement, &facial_muscles,
                       &muscle_labels, &scale_bar, &side_letters, &folds, &life, &wipe})
      *flag = !*flag;
    clip_from = 'S';
    clip_fraction = 1.0 / 3;
    cut_at = Look::Window::mouth;
    cut_radius_mm = 12.5;
    wipe_at = 0.1;
    mirrored = "mandible";
    auto& [obey_contact, mark_contacts, shadows, distances, measured_points, opening_mm, hands,
           landmarks, drawn_cut, motion, expression, look, skin_opacity, skin_to_return,
           shown_parts, muscles, layers] = static_cast<Edits&>(view);
    for (bool* flag : {&obey_contact, &mark_contacts, &shadows, &distances}) *flag = !*flag;
    measured_points = {{1, {0, 2, 1}, {0.2, 0.3, 0.5}}, {2, {4, 5, 6}, {1, 0, 0}}};
    opening_mm = 1.0 / 7;
    hands.X_PB = {turned(0.1, {1, 2, 3}), std::nullopt, turned(-0.2, {0.1, 0.2, 0.3})};
    hands.X_RM = turned(0.3, {-1, 0, 1.0 / 3});
    hands.jaw = BodyId{2};
    landmarks = {{"pogonion", {1, 2, 1.0 / 3}, 1, 5}, {"nasion", {0, 0, 12}, 0, 1}};
    drawn_cut = {.part = 1,
                 .points = {{1, 2, 1.0 / 3}, {4, 5, 6}},
                 .direction = {0.6, 0, 0.8},
                 .depth_mm = 7.5,
                 .kerf_mm = 0.6};
    motion = {"chewing", {{"bolus_mm", 8.25}}, {{"masseter", 0.4}}};
    expression = {{"smile", 0.75, 0.5}, {"AU16", 0, 1.0 / 3}};
    skin_opacity = 0.35;
    skin_to_return = 0.9;
    shown_parts = {{false, 1}, {true, 0.25}, {true, 0.75}, {false, 0.5}};
    muscles = {{true, 0.125}, {false, 1}};
    layers = {{true, 0.5}};
    auto& [tab, left_tab, plots, plot_set] = static_cast<PanelChoice&>(view);
    tab = SideTab::plan;
    left_tab = LeftTab::look;
    plots = true;
    plot_set = 2;
    view.playing = true;
    view.loop = false;
    view.speed = 0.3;
    view.time_s = 1.0 / 9;
    view.tool = Tool::measure;
    view.chosen = 2;
    view.landmark = 1;
    view.selected = 2;
    return view;
  }

  SavedSession session() const {
    SavedSession saved = saved_view(changed_view(), scene,
                                    {.target = {1, 2, 3},
                                     .direction = {0.6, 0, 0.8},
                                     .up = {0, 1, 0},
                                     .distance_mm = 321.5,
                                     .field_of_view_deg = 30,
                                     .near_mm = 2});
    saved.source = FolderSource{folder / "mycase"};
    saved.geometry = {.name = "A patient",
                      .parts = {{"mandible", 0x123456789abcdef0}, {"skull", 7}},
                      .landmarks = {{{"pogonion", {1, 2, 1.0 / 3}}}}};
    saved.landmarks_replaced = true;
    return saved;
  }
  SavedSession again(const SavedSession& saved) const {
    return parse_session(file, session_json(saved, file));
  }
  /// The message of what a changed file is refused with; empty if it is read.
  std::string refusal(const std::function<void(Json&)>& change) const {
    Json json = Json::parse(session_json(session(), file));
    change(json);
    try {
      parse_session(file, json.dump());
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }
};

void expect_same(const SavedSession& a, const SavedSession& b) {
  EXPECT_TRUE(same_session(a, b));
  // Each of them, so that a difference has a name.
  EXPECT_EQ(a.view.look, b.view.look);
  EXPECT_EQ(a.view.measured, b.view.measured);
  EXPECT_EQ(a.view.hands, b.view.hands);
  EXPECT_EQ(a.view.hands.jaw, b.view.hands.jaw);
  EXPECT_EQ(a.view.landmarks, b.view.landmarks);
  EXPECT_EQ(a.view.motion, b.view.motion);
  EXPECT_EQ(a.view.parts, b.view.parts);
  EXPECT_TRUE(a.view.edits() == b.view.edits());
  EXPECT_TRUE(static_cast<const PanelChoice&>(a.view) == static_cast<const PanelChoice&>(b.view));
  EXPECT_EQ(a.view.playing, b.view.playing);
  EXPECT_EQ(a.view.loop, b.view.loop);
  EXPECT_EQ(a.view.speed, b.view.speed);
  EXPECT_EQ(a.view.time_s, b.view.time_s);
  EXPECT_EQ(a.view.tool, b.view.tool);
  EXPECT_EQ(a.view.landmark, b.view.landmark);
  EXPECT_EQ(a.view.selected, b.view.selected);
  EXPECT_EQ(a.view.drawn_cut, b.view.drawn_cut);
  EXPECT_EQ(a.names, b.names);
  EXPECT_EQ(a.measured_at_rest, b.measured_at_rest);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.geometry, b.geometry);
  EXPECT_EQ(a.landmarks_replaced, b.landmarks_replaced);
  EXPECT_EQ(a.plan, b.plan);
  EXPECT_EQ(a.draft, b.draft);
  EXPECT_EQ(a.saved_as, b.saved_as);
  EXPECT_EQ(a.camera.target, b.camera.target);
  EXPECT_EQ(a.camera.direction, b.camera.direction);
  EXPECT_EQ(a.camera.up, b.camera.up);
  EXPECT_EQ(a.camera.distance_mm, b.camera.distance_mm);
  EXPECT_EQ(a.camera.field_of_view_deg, b.camera.field_of_view_deg);
  EXPECT_EQ(a.camera.near_mm, b.camera.near_mm);
}

TEST_F(SavedScene, EveryFieldComesBackToTheBit) {
  SavedSession saved = session();
  ASSERT_EQ(saved.view.measured.size(), 2u);
  ASSERT_EQ(saved.names.chosen, "chin");
  saved.saved_as = folder / "elsewhere.condyle-session";
  expect_same(again(saved), saved);
  // In the same scene the view is the one that was saved.
  std::vector<std::string> left_out;
  ViewState fitted = fitted_view(again(saved), scene, left_out);
  const ViewState view = changed_view();
  EXPECT_TRUE(left_out.empty()) << testing::PrintToString(left_out);
  EXPECT_TRUE(fitted.edits() == view.edits());
  EXPECT_EQ(fitted.chosen, 2u);
  EXPECT_EQ(fitted.selected, 2u);
  EXPECT_EQ(fitted.hands.jaw, BodyId{2});
}

TEST_F(SavedScene, ADefaultViewComesBackAndAMissingFieldHasItsDefault) {
  ViewState view;
  view.fit(scene);
  const SavedSession saved = saved_view(view, scene, {});
  expect_same(again(saved), saved);
  Json json = Json::parse(session_json(session(), file));
  json["view"] = Json::object();
  json["panels"] = Json::object();
  const SavedSession read = parse_session(file, json.dump());
  EXPECT_TRUE(read.view.edits() == Edits{});
  EXPECT_TRUE(static_cast<const PanelChoice&>(read.view) == PanelChoice{});
}

TEST_F(SavedScene, SourcesAndPlansComeBack) {
  SavedSession saved = session();
  saved.source = BuiltInSource{"built-in:class-iii:seed=7"};
  expect_same(again(saved), saved);
  saved.source =
      SurfaceSource{{{folder / "jaw.stl", "mandible"}, {"/else/where.stl", "skull"}}, "m", "RAS"};
  saved.plan = folder / "plans/one.json";
  expect_same(again(saved), saved);
  const Json json = Json::parse(session_json(saved, file));
  EXPECT_EQ(json["patient"]["surfaces"][0]["file"], "jaw.stl") << "relative below the session";
  EXPECT_EQ(json["patient"]["surfaces"][1]["file"], "/else/where.stl");
  EXPECT_EQ(json["plan"]["file"], "plans/one.json");
  saved.plan.clear();
  Plan draft;
  draft.name = "plan";
  draft.geometry = saved.geometry;
  draft = with_step(draft, CutStep{.osteotomy = "genioplasty", .pieces = {"chin"}});
  draft = with_move(draft, {.segment = "chin", .move = ClinicalMove{.forward_mm = 1.0 / 3}});
  saved.draft = draft;
  expect_same(again(saved), saved);
  saved.draft->geometry.landmarks.points["pogonion"].x() = 4;  // of another case than the view's
  expect_same(again(saved), saved);
}

TEST_F(SavedScene, AMotionOfAFileIsNamedRelativeToTheSession) {
  test::write_text(folder / "chew.csv", "time_s,tx_mm\n");
  for (const std::string kind : {"", "muscles:", "inverse:"}) {
    SavedSession saved = session();
    saved.view.motion.spec = kind + (folder / "chew.csv");
    EXPECT_EQ(Json::parse(session_json(saved, file))["view"]["motion"]["file"], "chew.csv");
    EXPECT_EQ(again(saved).view.motion, saved.view.motion);
  }
}

TEST_F(SavedScene, TheFolderOfASessionCanBeMoved) {
  const std::string text = session_json(session(), file);
  const SavedSession moved = parse_session("/other/place/a.condyle-session", text);
  EXPECT_EQ(std::get<FolderSource>(moved.source).folder, "/other/place/mycase");
}

TEST_F(SavedScene, AnotherSceneKeepsWhatFitsAndSaysWhatDoesNot) {
  const SavedSession saved = session();
  // The parts in another order, without the chin; the mandible has another shape.
  std::vector<Part> others = {parts[3], parts[1], parts[0]};
  others[1].mesh = test::box({-9, -10, 0}, {10, 10, 5});
  const WindowScene other = {
      .parts = others,
      .bodies = {{.part = 1, .body = mandible_body}, {.part = 2, .body = cranium_body}}};
  std::vector<std::string> left_out;
  const ViewState view = fitted_view(saved, other, left_out);
  ASSERT_EQ(view.parts.size(), 3u);
  EXPECT_EQ(view.parts[0], saved.view.parts[3]);
  EXPECT_EQ(view.parts[1], saved.view.parts[1]);
  EXPECT_EQ(view.parts[2], saved.view.parts[0]);
  EXPECT_TRUE(view.measured.empty());
  EXPECT_TRUE(view.muscles.empty());
  EXPECT_TRUE(view.hands.at(cranium_body));
  EXPECT_FALSE(view.hands.at(BodyId{2}));
  EXPECT_EQ(view.hands.jaw, mandible_body);
  EXPECT_EQ(view.landmarks[0].part, 1u);
  EXPECT_EQ(view.landmarks[1].part, 2u);
  const std::string words = testing::PrintToString(left_out);
  EXPECT_NE(words.find("2 measured points lie on a surface that has changed"), std::string::npos)
      << words;
  EXPECT_TRUE(view.expression.empty());
  EXPECT_NE(words.find("the expression AU16"), std::string::npos) << words;
  EXPECT_NE(words.find("chin was moved by hand"), std::string::npos) << words;
}

TEST_F(SavedScene, WhatIsWrongIsRefusedWithFileItemAndValue) {
  const std::vector<std::pair<std::function<void(Json&)>, std::string>> cases = {
      {[](Json& j) { j["version"] = 2; }, "version: is 2; this program reads sessions up to"},
      {[](Json& j) { j["format"] = "condyle plan"; }, "format: is \"condyle plan\""},
      {[](Json& j) { j.erase("camera"); }, "\"camera\" is missing"},
      {[](Json& j) { j["colour"] = 1; }, "unknown key \"colour\""},
      {[](Json& j) { j["view"]["colour"] = 1; }, "view: unknown key \"colour\""},
      {[](Json& j) { j["view"]["look"]["colour"] = 1; }, "view.look: unknown key \"colour\""},
      {[](Json& j) { j["view"]["look"]["wipe_at"] = 1.5; }, "view.look.wipe_at: is 1.5"},
      {[](Json& j) { j["view"]["look"]["clip_from"] = "X"; }, "view.look.clip_from: is \"X\""},
      {[](Json& j) { j["view"]["look"]["ghost"] = 1; }, "view.look.ghost: is 1"},
      {[](Json& j) { j["view"]["expression"][0]["left"] = 1.5; },
       "view.expression[0].left: is 1.5"},
      {[](Json& j) { j["view"]["tool"] = "saw"; },
       "view.tool: is \"saw\"; it must be one of: look"},
      {[](Json& j) { j["view"]["speed"] = 20; }, "view.speed: is 20"},
      {[](Json& j) { j["view"]["parts"][1]["opacity"] = -1; }, "view.parts[1].opacity: is -1"},
      {[](Json& j) { j["view"]["measured"][0]["part"] = "hip"; },
       "view.measured[0].part: is \"hip\""},
      {[](Json& j) {
         j["view"]["measured"][0]["triangle"] = {1, 2};
       },
       "view.measured[0].triangle: must have 3"},
      {[](Json& j) { j["view"]["hands"]["targets"][0]["body"] = "hip"; },
       "view.hands.targets[0].body: is \"hip\""},
      {[](Json& j) { j["view"]["hands"]["targets"][0]["pose"]["rotation"][0] = 0; },
       "view.hands.targets[0].pose.rotation: has length"},
      {[](Json& j) {
         j["camera"]["direction"] = {0, 0, 2};
       },
       "camera.direction: has length 2"},
      {[](Json& j) { j["camera"]["up"] = j["camera"]["direction"]; }, "camera.up: is parallel"},
      {[](Json& j) {
         j["patient"] = {{"built_in", "built-in:elf"}};
       },
       "patient.built_in:"},
      {[](Json& j) { j["patient"]["folder"] = 5; }, "patient.folder: is 5"},
      {[](Json& j) { j["case"]["parts"][0]["shape"] = "zz"; }, "case.parts[0].shape: is \"zz\""},
      {[](Json& j) {
         j["plan"] = {{"draft", {{"format", "condyle plan"}}}};
       },
       "is missing"},
      {[](Json& j) {
         j = {1, 2};
       },
       "expected an object"}};
  for (const auto& [change, words] : cases) {
    const std::string message = refusal(change);
    EXPECT_NE(message.find(words), std::string::npos) << words << "\n" << message;
    EXPECT_EQ(message.find(file.string()), 0u) << message;
  }
}

TEST_F(SavedScene, AHalfWrittenFileIsRefused) {
  const std::string text = session_json(session(), file);
  for (std::size_t length = 0; length + 2 < text.size(); length += 1 + text.size() / 97) {
    try {
      parse_session(file, text.substr(0, length));
      ADD_FAILURE() << length << " of " << text.size() << " bytes were read as a session";
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find(file.string()), 0u);
    }
  }
}

TEST_F(SavedScene, MissingFilesOfPatientAndPlanAreNamed) {
  const auto problem = [&](const SavedSession& saved) -> std::string {
    try {
      check_session_files(saved, file);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  };
  SavedSession saved = session();
  EXPECT_NE(problem(saved).find("patient.folder: is " + (folder / "mycase")), std::string::npos);
  fs::create_directories(folder / "mycase");
  EXPECT_EQ(problem(saved), "");
  saved.plan = folder / "plan.json";
  EXPECT_NE(problem(saved).find("plan.file: is " + (folder / "plan.json")), std::string::npos);
}

TEST_F(SavedScene, OnlyAChangeMakesAnotherSession) {
  const SavedSession saved = session();
  EXPECT_TRUE(same_session(saved, saved));
  SavedSession other = saved;
  other.view.time_s += 1;
  EXPECT_TRUE(same_session(saved, other)) << "it plays";
  other.view.playing = false;
  EXPECT_FALSE(same_session(saved, other));
  const std::vector<std::function<void(SavedSession&)>> changes = {
      [](SavedSession& s) { s.view.look.ghost = !s.view.look.ghost; },
      [](SavedSession& s) { s.view.speed = 1.5; },
      [](SavedSession& s) { s.view.tab = SideTab::record; },
      [](SavedSession& s) { s.view.parts[0].opacity = 0.9; },
      [](SavedSession& s) { s.camera.distance_mm += 1; },
      [](SavedSession& s) { s.names.chosen = "skull"; },
      [](SavedSession& s) { s.source = BuiltInSource{}; },
      [](SavedSession& s) { s.plan = "/a/plan.json"; },
      [](SavedSession& s) { s.draft = Plan{}; }};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    other = saved;
    changes[i](other);
    EXPECT_FALSE(same_session(saved, other)) << i;
  }
}

}  // namespace
}  // namespace condyle
