// The face's expression by the sliders of the window, and by a motion in words.
#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "engine/mesh_io/mesh_files.h"
#include "render/life/life_signs.h"
#include "window_session.h"

namespace condyle::test {
namespace {

/// A case of the built-in patient's surfaces whose face ends below the eyes, which nothing marks.
void write_patient_without_eyes(const Folder& folder) {
  ASSERT_EQ(condyle({"sample", "--out", folder / "sample"}).code, 0);
  constexpr double below_eyes_mm = 6;
  const TriMesh skin = read_mesh(folder / "sample/skin.ply");
  TriMesh lower{skin.vertices, {}, {}};
  std::copy_if(skin.triangles.begin(), skin.triangles.end(), std::back_inserter(lower.triangles),
               [&](const Eigen::Vector3i& t) {
                 return std::all_of(t.begin(), t.end(), [&](int v) {
                   return skin.vertices[static_cast<std::size_t>(v)].z() < below_eyes_mm;
                 });
               });
  ASSERT_LT(lower.triangles.size(), skin.triangles.size());
  write_stl(lower, folder / "lower.stl");
  std::istringstream marks(read_text(folder / "sample/marks.csv"));
  std::string kept;
  for (std::string line; std::getline(marks, line);)
    if (line.find("canthion") == std::string::npos && line.find("eyeball") == std::string::npos)
      kept += line + "\n";
  write_text(folder / "marks.csv", kept);
  const Outcome made =
      condyle({"import", "meshes", "--skull", folder / "sample/skull.stl", "--mandible",
               folder / "sample/jaw.stl", "--upper-teeth", folder / "sample/upper.stl",
               "--lower-teeth", folder / "sample/lower.stl", "--face", folder / "lower.stl",
               "--landmarks", folder / "marks.csv", "--out", folder / "case"});
  ASSERT_EQ(made.code, 0) << made.err;
}

int notes_with(const Json& state, const std::string& words) {
  int count = 0;
  for (const std::string note : state["notes"]) count += note.find(words) != std::string::npos;
  return count;
}

TEST_F(WindowSession, SlidersMoveTheLiveFaceAndAreSavedWithTheSession) {
  start({"--motion", "smile 0.5 over 0.3; hold 1"});
  ASSERT_TRUE(wait_until(idle, 120));
  const auto excitation = [](const Json& s) { return double(s["frame"]["excitation"]); };
  EXPECT_TRUE(press("space"));
  EXPECT_TRUE(wait_until([&](const Json& s) { return excitation(s) > 0.5; }, 30))
      << "the motion's own expression";
  EXPECT_TRUE(press("space"));
  ASSERT_TRUE(wait_until([](const Json& s) { return s["playing"] == false; }));
  click("to-start");
  ASSERT_TRUE(wait_until([&](const Json& s) { return excitation(s) == 0; })) << "rest";
  click("tab:Face");
  ASSERT_TRUE(wait_for_item("expression:smile:right"));
  see("at-rest");
  const auto slide = [&](const std::string& item, double from, double to) {
    const auto r = rect(item);
    drag(r[0] + from * r[2], r[1] + r[3] / 2, r[0] + to * r[2], r[1] + r[3] / 2);
  };
  slide("expression:smile:right", 0.03, 0.97);
  ASSERT_TRUE(wait_until([&](const Json& s) { return excitation(s) > 3; }));
  EXPECT_EQ(double(state()["edits"]["expression"]["smile"][0]),
            double(state()["edits"]["expression"]["smile"][1]));
  EXPECT_GT(see("smile"), 0.005);
  click("both-sides");
  slide("expression:smile:left", 0.97, 0.03);
  EXPECT_TRUE(wait_until([](const Json& s) {
    const Json& smile = s["edits"]["expression"]["smile"];
    return double(smile[0]) < 0.05 && double(smile[1]) > 0.9;
  })) << state()["edits"]["expression"].dump();
  EXPECT_GT(see("right-side-only"), 0.003);

  const fs::path session = folder_ / "smile.condyle-session";
  EXPECT_TRUE(press("ctrl+s"));
  ASSERT_TRUE(wait_for_item("session-path"));
  write_into("session-path", session);
  ASSERT_TRUE(wait_until([&](const Json& s) { return s["session"] == session.string(); }));
  const Json kept = state()["edits"]["expression"];
  click("expression-relax");
  EXPECT_TRUE(wait_until([&](const Json& s) { return excitation(s) == 0; }));
  EXPECT_TRUE(press("ctrl+z"));
  EXPECT_TRUE(wait_until([&](const Json& s) { return s["edits"]["expression"] == kept; }));
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);

  start({session});
  ASSERT_TRUE(wait_until(idle, 120));
  EXPECT_TRUE(wait_until([&](const Json& s) {
    return s["edits"]["expression"] == kept && excitation(s) > 1;
  })) << state()["edits"]["expression"].dump();
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, TheLifeSwitchClosesTheEyesOfABlinkAndOpensThemAgain) {
  double blink_s = 0;
  while (life_signs(blink_s).lids.left < 1) blink_s += 0.001;
  start({"--motion", fmt::format("hold {:.3f}", blink_s + 0.01)});
  ASSERT_TRUE(wait_until(idle, 120));
  EXPECT_TRUE(press("a"));
  const auto scrub = rect("scrub");
  drag(scrub[0] + 0.1 * scrub[2], scrub[1] + scrub[3] / 2, scrub[0] + 1.1 * scrub[2],
       scrub[1] + scrub[3] / 2);
  click("left-tab:Look");
  ASSERT_TRUE(wait_for_item("clip"));
  const auto tab = rect("left-tab:Look");
  EXPECT_TRUE(xdotool({"mousemove", px(tab[0]), px(tab[1] + 300), "click", "--repeat", "30",
                       "--delay", "40", "5"}));
  ASSERT_TRUE(wait_for_item("life"));
  see("without");
  const Json measured = state()["frame"];
  const auto is_on = [](const Json& s) { return s["edits"]["life"] == true; };
  EXPECT_FALSE(is_on(state()));
  click("life");
  EXPECT_TRUE(wait_until(is_on, 20));
  EXPECT_GT(see("eyes-closed"), 0.001);
  EXPECT_EQ(state()["frame"], measured) << "look only";
  EXPECT_TRUE(press("ctrl+z"));
  EXPECT_TRUE(wait_until([&](const Json& s) { return !is_on(s); }, 20));
  EXPECT_GT(see("undone"), 0.001);
  EXPECT_TRUE(press("ctrl+y"));
  EXPECT_TRUE(wait_until(is_on, 20));
  EXPECT_GT(see("redone"), 0.001);
  click("life");
  EXPECT_TRUE(wait_until([&](const Json& s) { return !is_on(s); }, 20));
  EXPECT_GT(see("off"), 0.001);
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, ASliderClosesTheEyesInPicturesAlone) {
  start({"--motion", "rest"});
  ASSERT_TRUE(wait_until(idle, 120));
  EXPECT_TRUE(press("a"));
  click("tab:Face");
  ASSERT_TRUE(wait_for_item("expression:surprise:right"));
  const auto list = rect("expression:surprise:right");
  EXPECT_TRUE(xdotool({"mousemove", px(list[0] + 20), px(list[1] + 40), "click", "--repeat", "60",
                       "--delay", "20", "5"}));
  ASSERT_TRUE(wait_for_item("expression:AU43:right"));
  ASSERT_TRUE(wait_until([](const Json& s) { return s["picture_finished"] == true; }));
  see("eyes-open");
  const Json measured = state()["frame"];
  const auto r = rect("expression:AU43:right");
  drag(r[0] + 0.03 * r[2], r[1] + r[3] / 2, r[0] + 0.97 * r[2], r[1] + r[3] / 2);
  EXPECT_TRUE(wait_until([](const Json& s) {
    return s["edits"]["expression"].contains("AU43") && s["picture_finished"] == true;
  }));
  EXPECT_GT(see("eyes-closed"), 0.001);
  EXPECT_EQ(state()["frame"], measured);
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, ABrowSliderAddsTheUpperFaceToTheSoftTissue) {
  start({"--motion", "rest"});
  ASSERT_TRUE(wait_until(idle, 120));
  EXPECT_TRUE(press("a"));
  click("tab:Face");
  ASSERT_TRUE(wait_for_item("expression:surprise:right"));
  ASSERT_TRUE(wait_until([](const Json& s) {
    return double(s["camera_direction"][1]) < -0.9999 && s["picture_finished"] == true;
  }));
  see("at-rest");
  const auto slide = [&](double from, double to) {
    const auto r = rect("expression:surprise:right");
    drag(r[0] + from * r[2], r[1] + r[3] / 2, r[0] + to * r[2], r[1] + r[3] / 2);
  };
  slide(0.03, 0.3);  // the soft tissue is built again
  ASSERT_TRUE(wait_until(
      [](const Json& s) { return idle(s) && double(s["frame"]["excitation"]) > 0; }, 120))
      << state().value("trouble", "");
  const double reached = state()["edits"]["expression"]["surprise"][0];
  slide(0.03 + 0.94 * reached, 0.97);
  ASSERT_TRUE(wait_until([](const Json& s) { return double(s["frame"]["excitation"]) > 3; }, 60))
      << state()["edits"]["expression"].dump();
  ASSERT_TRUE(wait_until([](const Json& s) { return s["picture_finished"] == true; }, 60));
  EXPECT_GT(see("surprise"), 0.003);
  EXPECT_EQ(state().value("trouble", ""), "");
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, NotesSayWhyBrowsDoNotMoveAndWhichMusclesAreMissing) {
  write_patient_without_eyes(folder_);
  start({folder_ / "case", "--motion", "rest"});
  ASSERT_TRUE(wait_until(idle, 120)) << state().value("trouble", "");
  const std::string still = "brows and forehead do not move",
                    lacking = "surprise: the patient lacks muscles of the kinds frontalis",
                    open = "expressions do not move the lids: no eyeballs were found";
  for (const std::string& note : {still, lacking, open}) EXPECT_EQ(notes_with(state(), note), 0);
  click("tab:Face");
  ASSERT_TRUE(wait_for_item("expression:surprise:right"));
  const auto r = rect("expression:surprise:right");
  drag(r[0] + 0.03 * r[2], r[1] + r[3] / 2, r[0] + 0.6 * r[2], r[1] + r[3] / 2);
  EXPECT_TRUE(wait_until([&](const Json& s) {
    return idle(s) && notes_with(s, still) == 1 && notes_with(s, lacking) == 1 &&
           notes_with(s, open) == 1;
  })) << state()["notes"].dump();
  EXPECT_EQ(state()["notes"][0].get<std::string>().find(lacking), 0u) << "the last change is first";
  see("notes");
  click("expression-relax");
  EXPECT_TRUE(wait_until([&](const Json& s) {
    return notes_with(s, lacking) == 0 && notes_with(s, open) == 0;
  })) << "the face is relaxed: "
      << state()["notes"].dump();
  EXPECT_TRUE(press("ctrl+z"));
  EXPECT_TRUE(wait_until([&](const Json& s) { return notes_with(s, lacking) == 1; }));
  EXPECT_EQ(notes_with(state(), still), 1);
  EXPECT_EQ(state().value("trouble", ""), "");
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, ANoteSaysThatABlinkOfTheMotionLeavesTheLidsOpen) {
  write_patient_without_eyes(folder_);
  start({folder_ / "case", "--motion", "blink; hold 1"});
  const std::string open = "expressions do not move the lids: no eyeballs were found";
  EXPECT_TRUE(wait_until([&](const Json& s) { return idle(s) && notes_with(s, open) == 1; }, 120))
      << state()["notes"].dump();
  EXPECT_EQ(state().value("trouble", ""), "");
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

}  // namespace
}  // namespace condyle::test
