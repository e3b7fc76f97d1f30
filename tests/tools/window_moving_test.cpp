// Bones that a hand moves and releases in the window.
#include <sstream>

#include "tests/support/shapes.h"
#include "window_session.h"

namespace condyle::test {
namespace {

double opening_mm(const Json& s) { return s["frame"]["opening_mm"]; }

/// A line of an OBJ file.
template <class Three>
std::string obj_line(const char* kind, const Three& v) {
  std::ostringstream line;
  line << kind << ' ' << v[0] << ' ' << v[1] << ' ' << v[2] << '\n';
  return line.str();
}

TEST_F(WindowSession, AReleasedJawFallsBackToWhereItsMusclesHoldIt) {
  start({"--motion", "open 20 over 0.3; close"});
  ASSERT_TRUE(wait_until(idle, 120));
  click("skin:off");
  EXPECT_TRUE(press("m"));
  write_into("shift:S", "-30");
  ASSERT_TRUE(wait_until([](const Json& s) { return opening_mm(s) > 29.9; }));
  write_into("shift:L", "6");
  ASSERT_TRUE(wait_until([](const Json& s) { return double(s["frame"]["mandible_mm"][0]) > 5.9; }));
  see("in-the-hand");
  const double held_mm = opening_mm(state());
  click("release-body");
  EXPECT_TRUE(wait_until([&](const Json& s) {
    return opening_mm(s) < held_mm - 4 && opening_mm(s) > 3;
  })) << "its motion is shown";
  EXPECT_TRUE(press("k"));  // an edit meanwhile
  // The rest position: 2.5 mm of freeway space, in the middle.
  const auto hangs = [](const Json& s) {
    return idle(s) && std::abs(opening_mm(s) - 2.5) < 0.3 &&
           std::abs(double(s["frame"]["mandible_mm"][0])) < 0.3;
  };
  ASSERT_TRUE(wait_until(hangs)) << state()["frame"].dump();
  EXPECT_GT(see("hangs"), 0.02);
  EXPECT_TRUE(press("ctrl+z"));
  ASSERT_TRUE(wait_until([](const Json& s) { return s["skin_opacity"] == 0; }));
  std::this_thread::sleep_for(std::chrono::seconds(1));
  EXPECT_TRUE(hangs(state())) << "the edit alone is undone: " << state()["frame"].dump();
  EXPECT_TRUE(press("ctrl+z"));
  EXPECT_TRUE(wait_until([&](const Json& s) { return std::abs(opening_mm(s) - held_mm) < 1e-6; }));
  EXPECT_TRUE(press("ctrl+y"));
  EXPECT_TRUE(wait_until(hangs)) << state()["frame"].dump();

  // A hand that grips it in motion holds it from there on.
  EXPECT_TRUE(press("ctrl+z"));
  ASSERT_TRUE(wait_until([&](const Json& s) { return std::abs(opening_mm(s) - held_mm) < 1e-6; }));
  click("release-body");
  ASSERT_TRUE(wait_until([&](const Json& s) { return opening_mm(s) < held_mm - 2; }));
  write_into("shift:S", "-25");
  std::this_thread::sleep_for(std::chrono::seconds(2));
  EXPECT_GT(opening_mm(state()), 15);

  // So does the timeline.
  click("release-body");
  ASSERT_TRUE(wait_until([&](const Json& s) { return opening_mm(s) < 23; }));
  const auto scrub = rect("scrub");
  drag(scrub[0] + 0.02 * scrub[2], scrub[1] + scrub[3] / 2, scrub[0] + 0.6 * scrub[2],
       scrub[1] + scrub[3] / 2);
  EXPECT_TRUE(wait_until([](const Json& s) {
    return !s.contains("X_CM_wanted") &&
           s.value("said", "") ==
               "The mandible moves no further by itself: the motion was moved to another time";
  })) << state().value("said", "nothing was said");

  write_into("shift:S", "-30");
  ASSERT_TRUE(wait_until([](const Json& s) { return opening_mm(s) > 29.9; }));
  // So far from its joints nothing holds it.
  write_into("shift:P", "-60");
  ASSERT_TRUE(wait_until([](const Json& s) { return double(s["frame"]["mandible_mm"][1]) < -50; }));
  write_into("shift:S", "45");
  ASSERT_TRUE(wait_until([](const Json& s) { return s["frame"]["stopped"] == true; }));
  const Json requested = state()["X_CM_wanted"];
  double away_mm = 0;
  for (int k = 0; k < 3; ++k)
    away_mm = std::hypot(away_mm,
                         double(requested["mm"][k]) - double(state()["frame"]["mandible_mm"][k]));
  EXPECT_GT(away_mm, 1) << "bone stops it before its target";
  click("release-body");
  ASSERT_TRUE(wait_for_item("error"));
  EXPECT_TRUE(wait_until([](const Json& s) {
    return s.value("trouble", "").find("out of its joint") != std::string::npos;
  })) << state().value("trouble", "nothing was said");
  click("close-error");
  EXPECT_LT(double(state()["frame"]["mandible_mm"][1]), -50) << "it stays in the hand";
  EXPECT_EQ(state()["X_CM_wanted"], requested) << "and its target is unchanged";
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, AnEditDuringAReleaseTakesPrecedenceAndIsReported) {
  start({"--motion", "open 20 over 0.3; close"});
  ASSERT_TRUE(wait_until(idle, 120));
  EXPECT_TRUE(press("m"));
  write_into("shift:S", "-30");
  ASSERT_TRUE(wait_until([](const Json& s) { return opening_mm(s) > 29.9; }));
  const auto computes = [](const Json& s) { return s["busy_with"] == "Releasing"; };
  const auto reported = [](const Json& s) {
    return s["busy_with"] == "" &&
           s.value("said", "").find("it was moved before it had come to rest") != std::string::npos;
  };
  // An entered number.
  click("shift:S");
  ASSERT_TRUE(wait_for_item("writing"));
  EXPECT_TRUE(press("Escape"));
  click("release-body");
  ASSERT_TRUE(wait_until(computes));
  write_into("shift:S", "-12");
  EXPECT_TRUE(wait_until(reported)) << state().value("said", "nothing was said");
  std::this_thread::sleep_for(std::chrono::seconds(3));
  EXPECT_NEAR(opening_mm(state()), 12, 0.1) << "where the number has it";
  see("entered-meanwhile");

  // An undone edit.
  click("release-body");
  ASSERT_TRUE(wait_until(computes));
  EXPECT_TRUE(press("ctrl+z"));
  EXPECT_TRUE(wait_until([](const Json& s) { return s["busy_with"] == ""; }));
  std::this_thread::sleep_for(std::chrono::seconds(3));
  EXPECT_NEAR(opening_mm(state()), 30, 0.1) << "as it was before the number";

  // And a cancelled release.
  click("release-body");
  click("cancel");
  EXPECT_TRUE(wait_until([](const Json& s) {
    return s["busy_with"] == "" &&
           s.value("said", "").find("it stays where it is") != std::string::npos;
  }));
  EXPECT_NEAR(opening_mm(state()), 30, 0.1);

  // The timeline releases the jaw.
  const auto scrub = rect("scrub");
  click("release-body");
  ASSERT_TRUE(wait_until(computes));
  drag(scrub[0] + 0.1 * scrub[2], scrub[1] + scrub[3] / 2, scrub[0] + 0.5 * scrub[2],
       scrub[1] + scrub[3] / 2);
  EXPECT_TRUE(wait_until([](const Json& s) {
    return s["busy_with"] == "" && !s.contains("X_CM_wanted") &&
           s.value("said", "") ==
               "The mandible is not released: the motion was moved to another time before it had "
               "come to rest";
  })) << state().value("said", "nothing was said");

  // Another motion has other muscles.
  click("tab:Motion");
  click("motion");
  ASSERT_TRUE(wait_for_item("motion:protrusion"));
  EXPECT_TRUE(press("Escape"));
  click("release-body");
  ASSERT_TRUE(wait_until(computes));
  click("motion");
  click("motion:protrusion");
  EXPECT_TRUE(wait_until([](const Json& s) {
    return s.value("said", "").find("another motion was chosen before it had come to rest") !=
           std::string::npos;
  })) << state().value("said", "nothing was said");
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, MovingThePatientEndsTheReleaseOfAPartAndIsReported) {
  write_box_patient(folder_.path());
  // So fine that a release takes seconds.
  const TriMesh ball = sphere(6, 14, {0, -60, 16});
  std::string obj;
  for (const auto& v : ball.vertices) obj += obj_line("v", v);
  for (const auto& t : ball.triangles) obj += obj_line("f", t.array() + 1);
  write_text(folder_ / "ball.obj", obj);
  std::vector<std::string> import = {"import", "meshes"};
  for (const std::string file : {"maxilla.stl", "mandible.stl"})
    import.insert(import.end(), {"--" + file.substr(0, file.find('.')), folder_ / file});
  import.insert(import.end(), {"--landmarks", folder_ / "marks.csv", "--transplant",
                               folder_ / "ball.obj", "--out", folder_ / "case"});
  ASSERT_EQ(condyle(import).code, 0);
  // Names of parts have characters that are replaced in texts.
  std::string text = read_text(folder_ / "case/case.json");
  // The part and its body, not the role.
  const std::string role = "\"role\": ";
  for (auto at = text.find("\"transplant\""); at != std::string::npos;
       at = text.find("\"transplant\"", at + 1))
    if (text.compare(at - role.size(), role.size(), role) != 0)
      text.replace(at, 12, "\"left_cheek_ball\"");
  write_text(folder_ / "case/case.json", text);
  start({folder_ / "case", "--motion", "open 5 over 0.5; close over 0.5"});
  ASSERT_TRUE(wait_until(idle)) << state().value("trouble", "nothing was said");
  EXPECT_TRUE(press("m"));
  choose_body("left_cheek_ball");
  see("a-fine-ball");
  const auto begin = [&] {
    click("release-body");
    ASSERT_TRUE(wait_until([](const Json& s) { return s["busy_with"] == "Releasing"; }));
  };
  const auto ended = [&](const std::string& why) {
    const std::string words =
        "The left cheek ball is not released: " + why + " before it had come to rest";
    EXPECT_TRUE(wait_until([&](const Json& s) {
      return s["busy_with"] == "" && s.value("said", "") == words;
    })) << state().value("said", "nothing was said");
  };
  begin();
  const auto scrub = rect("scrub");
  drag(scrub[0] + 0.02 * scrub[2], scrub[1] + scrub[3] / 2, scrub[0] + 0.4 * scrub[2],
       scrub[1] + scrub[3] / 2);
  ended("the motion was moved to another time");
  begin();
  const auto opening = rect("opening");
  drag(opening[0] + 0.1 * opening[2], opening[1] + opening[3] / 2, opening[0] + 0.8 * opening[2],
       opening[1] + opening[3] / 2);
  ended("the mouth was opened or closed");
  begin();
  EXPECT_TRUE(press("space"));
  ended("the motion was played");
  // Released during the motion, it stops the motion and comes to rest.
  begin();
  EXPECT_TRUE(wait_until([](const Json& s) {
    return s["playing"] == false && s["busy_with"] == "" &&
           s.value("said", "").find("The left cheek ball lies still after") == 0 &&
           std::abs(double(s["body_mm"][2][2]) + 2) < 0.1;
  })) << state().value("said", "nothing was said")
      << state()["body_mm"];
  // Nothing within reach: the sentence has the readable name.
  write_into("shift:S", "40");
  ASSERT_TRUE(wait_until([](const Json& s) { return double(s["body_mm"][2][2]) > 39; }));
  click("release-body");
  EXPECT_TRUE(wait_until([](const Json& s) {
    return s.value("trouble", "").find("left cheek ball: nothing lies within 15 mm") !=
           std::string::npos;
  })) << state().value("trouble", "nothing was said");
  see("reported-by-its-name");
  EXPECT_TRUE(press("Return"));
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, TheSkullIsMovedAgainstTheJawSlidesOnItAndIsReleased) {
  start({"--motion", "open 20 over 0.3; hold 0.2"});
  ASSERT_TRUE(wait_until(idle, 120));
  click("skin:off");
  const auto scrub = rect("scrub");
  drag(scrub[0] + 0.1 * scrub[2], scrub[1] + scrub[3] / 2, scrub[0] + 0.99 * scrub[2],
       scrub[1] + scrub[3] / 2);
  ASSERT_TRUE(wait_until([](const Json& s) { return opening_mm(s) > 19; }));
  EXPECT_TRUE(press("a"));
  EXPECT_TRUE(press("m"));
  choose_body("skull");
  see("opened");
  const double opened_mm = opening_mm(state());
  // Up by its number: the jaw stays in the picture, and its distance grows by that amount.
  write_into("shift:S", "10");
  ASSERT_TRUE(wait_until([&](const Json& s) {
    return std::abs(opening_mm(s) - opened_mm - 10) < 1e-6 &&
           double(s["X_RC_wanted"]["mm"][2]) == 10;
  })) << state()["frame"].dump();
  EXPECT_GT(see("skull-up"), 0.02);
  const Region view = view_region();
  const Region chin{view.x + 0.45 * view.width, view.y + 0.72 * view.height, 0.1 * view.width,
                    0.1 * view.height};
  EXPECT_TRUE(alike(seen_, seen_before_, 0.01, chin)) << "the jaw has not moved in the room";
  // By its handle, and back.
  const auto tip = rect("handle:L");
  drag(tip[0] + 3, tip[1] + 3, tip[0] + 43, tip[1] + 3);
  ASSERT_TRUE(wait_until([](const Json& s) { return double(s["X_RC_wanted"]["mm"][0]) > 5; }));
  EXPECT_TRUE(press("ctrl+z"));
  ASSERT_TRUE(wait_until([](const Json& s) { return double(s["X_RC_wanted"]["mm"][0]) == 0; }));
  // Down onto the jaw: contact stops it.
  write_into("shift:S", "-60");
  ASSERT_TRUE(wait_until([](const Json& s) {
    return s["frame"]["stopped"] == true && double(s["frame"]["penetration_mm"]) < 0.1 &&
           double(s["X_RC_wanted"]["mm"][2]) == -60;
  })) << state()["frame"].dump();
  see("skull-on-the-jaw");
  // Play moves the jaw alone: the skull stays where contact stopped it.
  const double stopped_mm = state()["X_RC"]["mm"][2];
  EXPECT_GT(stopped_mm, -55);
  EXPECT_TRUE(press("space"));
  ASSERT_TRUE(wait_until([](const Json& s) { return s["playing"] == true; }));
  EXPECT_NEAR(double(state()["X_RC"]["mm"][2]), stopped_mm, 0.05);
  see_now("plays");
  EXPECT_TRUE(press("space"));
  ASSERT_TRUE(wait_until([](const Json& s) { return s["playing"] == false; }));
  settled_picture();
  EXPECT_NEAR(double(state()["X_RC"]["mm"][2]), stopped_mm, 0.05);
  const double motion_mm = opening_mm(state());
  EXPECT_TRUE(press("ctrl+z"));
  ASSERT_TRUE(wait_until([](const Json& s) { return double(s["X_RC_wanted"]["mm"][2]) == -60; }));
  // Once released, joints and muscles bring both together; the motion drives the jaw when it plays.
  click("release-body");
  EXPECT_TRUE(wait_until([](const Json& s) {
    return idle(s) && std::abs(opening_mm(s) - 2.5) < 0.3;
  })) << state()["frame"].dump();
  see("release-body");
  click("reset-position");
  EXPECT_TRUE(wait_until([](const Json& s) { return !s.contains("X_RC_wanted"); }));
  EXPECT_TRUE(wait_until([&](const Json& s) { return std::abs(opening_mm(s) - motion_mm) < 0.01; }))
      << state()["frame"].dump();
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

}  // namespace
}  // namespace condyle::test
