#include "sim/muscles/expression.h"

#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "sim/muscles/face_weakness.h"

namespace condyle {
namespace {

std::vector<FaceMuscle> pair_of_muscles() {
  return {{.name = "left_zygomaticus_major", .kind = "zygomaticus_major", .lines = {}},
          {.name = "right_zygomaticus_major", .kind = "zygomaticus_major", .lines = {}}};
}

std::string refusal(const std::string& spec) {
  try {
    make_expression(spec, pair_of_muscles());
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(Expression, ABuiltinOneGrowsToItsStrengthOnItsSide) {
  const Expression smile = make_expression("smile:0.8:left", pair_of_muscles());
  EXPECT_EQ(smile.at(0).muscles, (std::vector<double>{0, 0}));
  EXPECT_NEAR(smile.at(0.25).muscles[0], 0.4, 1e-12);
  EXPECT_NEAR(smile.at(3).muscles[0], 0.8, 1e-12);
  EXPECT_EQ(smile.at(3).muscles[1], 0);
}

TEST(Expression, ActionUnitsAddUpOnTheirSides) {
  const Expression both = make_expression("au12:0.25+smile:0.5:left", pair_of_muscles());
  EXPECT_NEAR(both.at(1).muscles[0], 0.75, 1e-12);
  EXPECT_NEAR(both.at(1).muscles[1], 0.25, 1e-12);
  EXPECT_EQ(make_expression("AU12+smile", pair_of_muscles()).at(1).muscles[0], 1);
}

TEST(Expression, ASideExcitesMusclesInTheMiddle) {
  const std::vector<FaceMuscle> ring = {
      {.name = "orbicularis_oris_marginal", .kind = "orbicularis_oris_marginal", .lines = {}}};
  EXPECT_NEAR(make_expression("AU23:0.5:left+AU23:0.2:right", ring).at(1).muscles[0], 0.7, 1e-12);
  const ExpressionLevel level{.name = "AU23", .left = 0.2, .right = 0.6};
  EXPECT_EQ(excitation_of({&level, 1}, ring).muscles[0], 0.6);
}

TEST(Expression, NotesKindsThatThePatientLacks) {
  EXPECT_TRUE(make_expression("AU12", pair_of_muscles()).notes.empty());
  const Expression lacking = make_expression("AU12+AU17", pair_of_muscles());
  ASSERT_EQ(lacking.notes.size(), 1u);
  EXPECT_NE(lacking.notes[0].find("AU17"), std::string::npos) << lacking.notes[0];
  EXPECT_NE(lacking.notes[0].find("mentalis"), std::string::npos) << lacking.notes[0];
}

TEST(Expression, ActionUnit5RaisesTheLidsThatOthersLeaveOpen) {
  const auto closure = [](const std::string& levels) {
    return make_expression(levels, pair_of_muscles()).at(1).closure();
  };
  EXPECT_EQ(closure("AU5:0.5:left"), (LidClosure{-0.5, 0}));
  EXPECT_EQ(closure("AU5+AU45"), (LidClosure{1, 1})) << "a blink closes raised lids";
  EXPECT_EQ(closure("AU45:0.5+AU5"), (LidClosure{0, 0}));
  EXPECT_LT(closure("surprise").left, -0.5);
  EXPECT_EQ(with_blink({-1, -0.5}, {0.5, 1}), (LidClosure{0, 1})) << "and so do those of life";
  EXPECT_EQ(with_blink({-1, 0.6}, {0, 0.3}), (LidClosure{-1, 0.6}));
  EXPECT_EQ(make_expression("AU5", pair_of_muscles()).notes.size(), 1u) << "drawn only";
  const std::string kind(lid_raiser);
  const auto file = std::filesystem::temp_directory_path() / "condyle-test-raised-lids.csv";
  write_file(file, "time_s,left_" + kind + ",AU45\n0,0,0\n1,1,0\n2,1,1\n");
  const Expression lids = make_expression(file.string(), pair_of_muscles());
  EXPECT_EQ(lids.at(1).closure(), (LidClosure{-1, 0}));
  EXPECT_EQ(lids.at(2).closure(), (LidClosure{1, 1}));
  std::filesystem::remove(file);
}

TEST(Expression, ActionUnits43And45CloseTheLidsOfTheirSides) {
  for (const char* unit : {"AU43", "au45"}) {
    const Expression wink = make_expression(std::string(unit) + ":0.8:left", pair_of_muscles());
    EXPECT_FALSE(wink.at(0).lids.any());
    EXPECT_NEAR(wink.at(0.25).lids.left, 0.4, 1e-12);
    EXPECT_NEAR(wink.at(3).lids.left, 0.8, 1e-12);
    EXPECT_EQ(wink.at(3).lids.right, 0);
    EXPECT_EQ(wink.at(3).muscles, (std::vector<double>{0, 0}));
    ASSERT_EQ(wink.notes.size(), 1u) << "no muscle is missing";
    EXPECT_EQ(wink.notes[0],
              "the motion of the upper lids is drawn only; no measurement depends on it");
    EXPECT_FALSE(expression_moves_upper_face(unit));
  }
  const Expression both = make_expression("AU43:0.7+AU45:0.7:right+smile", pair_of_muscles());
  EXPECT_EQ(both.at(1).lids, (LidClosure{0.7, 1}));
  EXPECT_EQ(both.at(1).muscles[0], 1);
  EXPECT_FALSE(make_expression("smile", pair_of_muscles()).at(1).lids.any());
  EXPECT_NE(refusal("AU45:1.2").find("0 to 1, not 1.2"), std::string::npos);
  EXPECT_EQ(refusal("AU45:half"), "--expression AU45:half: \"half\" is no number");
}

TEST(Expression, LeavesAMuscleOfTheLidsThatTheCaseBringsRelaxed) {
  std::vector<FaceMuscle> muscles = pair_of_muscles();
  const std::string kind(lid_closer);
  for (const std::string side : {"left_", "right_"})
    muscles.push_back({.name = side + kind, .kind = kind, .lines = {}});
  const Expression blink = make_expression("AU45", muscles);
  EXPECT_EQ(blink.at(1).muscles, (std::vector<double>{0, 0, 0, 0}));
  EXPECT_EQ(blink.at(1).lids, (LidClosure{1, 1}));
  const auto file = std::filesystem::temp_directory_path() / "condyle-test-lid-muscle.csv";
  write_file(file, "time_s,left_" + kind + ",right_AU45\n0,0,0\n1,0.6,1\n");
  const Expression lids = make_expression(file.string(), muscles);
  EXPECT_EQ(lids.at(1).muscles, (std::vector<double>{0, 0, 0, 0}));
  EXPECT_EQ(lids.at(1).lids, (LidClosure{0.6, 1}));
}

TEST(Expression, AFileNotesKindsThatThePatientLacks) {
  const auto file = std::filesystem::temp_directory_path() / "condyle-test-lacking.csv";
  write_file(file, "time_s,AU12,left_AU17,right_AU17,AU20\n0,0,0,0,0\n1,1,0.5,1,0\n");
  const std::vector<std::string> notes = make_expression(file.string(), pair_of_muscles()).notes;
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_TRUE(notes[0].starts_with("AU17: ")) << notes[0];
  EXPECT_NE(notes[0].find("mentalis"), std::string::npos) << notes[0];
  EXPECT_EQ(notes[0].find("risorius"), std::string::npos) << "AU20 is 0 throughout: " << notes[0];
  write_file(file, "time_s,AU12,left_zygomaticus_major\n0,0,0\n1,1,0.5\n");
  EXPECT_TRUE(make_expression(file.string(), pair_of_muscles()).notes.empty());
}

TEST(Expression, TellsWhetherItMovesTheUpperFace) {
  for (const char* spec : {"surprise", "AU1:0.2:right", "smile+AU4:0.5", "sad", "disgust"})
    EXPECT_TRUE(expression_moves_upper_face(spec)) << spec;
  for (const char* spec : {"smile", "kiss", "AU4:0", "AU5", "AU12+AU9:0.5"})
    EXPECT_FALSE(expression_moves_upper_face(spec)) << spec;
}

TEST(FaceWeakness, IsOfASideAMuscleOrBothSides) {
  std::vector<FaceMuscle> muscles = pair_of_muscles();
  muscles.push_back({.name = "ring", .kind = "ring", .lines = {}});
  using Strengths = std::vector<double>;
  const auto of = [&](std::vector<std::string> specs) {
    return muscle_strengths(specs, muscles).muscles;
  };
  EXPECT_EQ(of({}), (Strengths{1, 1, 1}));
  EXPECT_EQ(of({"left:0.5"}), (Strengths{0.5, 1, 0.75}));
  EXPECT_EQ(of({"left:0.5", "right:0.5"}), (Strengths{0.5, 0.5, 0.5}));
  EXPECT_EQ(of({"right:0.5", "zygomaticus_major:0.5"}), (Strengths{0.5, 0.25, 0.75}));
  EXPECT_EQ(of({"left_zygomaticus_major:0"}), (Strengths{0, 1, 1}));
  for (const char* wrong : {"left", "left:1.5", "left:-1", "left:x", "masseter:0.5", ":1", "a:1:2"})
    EXPECT_THROW(of({wrong}), InputError) << wrong;
}

TEST(FaceWeakness, LeavesTheLidsOfItsSideOpen) {
  const auto closed = [&](std::vector<std::string> specs) {
    return weakened({.muscles = {1, 1}, .lids = {1, 0.5}},
                    muscle_strengths(specs, pair_of_muscles()));
  };
  EXPECT_EQ(closed({}).lids, (LidClosure{1, 0.5}));
  EXPECT_EQ(closed({"right:0.2"}).lids, (LidClosure{1, 0.1}));
  EXPECT_EQ(closed({"right:0.2"}).muscles, (std::vector<double>{1, 0.2}));
  EXPECT_EQ(closed({"left_orbicularis_oculi_palpebral:0"}).lids, (LidClosure{0, 0.5}));
  EXPECT_EQ(closed({"orbicularis_oculi_palpebral:0.5", "left:0.5"}).lids, (LidClosure{0.25, 0.25}));
  EXPECT_EQ(closed({"zygomaticus_major:0"}).lids, (LidClosure{1, 0.5}));
  const auto raised =
      weakened({.muscles = {1, 1}, .raise = {1, 1}},
               muscle_strengths(std::vector<std::string>{"left:0"}, pair_of_muscles()));
  EXPECT_EQ(raised.raise, (LidClosure{1, 1})) << "by another nerve";
}

TEST(Expression, RisesAndFallsBetweenItsTimesWithoutOvershoot) {
  const std::vector<ExpressionLevel> smile = {{.name = "smile", .left = 1, .right = 0.5}};
  const std::vector<ExpressionKey> keys = {{0, {}}, {1, smile}, {2, smile}, {4, {}}};
  const Expression made = expression_through("smile", keys, pair_of_muscles());
  EXPECT_EQ(made.duration_s, 4);
  EXPECT_NEAR(made.at(0.25).muscles[0], 3 * 0.0625 - 2 * 0.015625, 1e-12);
  EXPECT_NEAR(made.at(1.5).muscles[0], 1, 1e-12);
  EXPECT_NEAR(made.at(3).muscles[1], 0.25, 1e-12);
  EXPECT_EQ(made.at(9).muscles[0], 0);
  EXPECT_EQ(made.at(-1).muscles[0], 0);
}

TEST(Expression, BadOnesAreRefusedByNameAndValue) {
  EXPECT_NE(refusal("smirk").find("smirk"), std::string::npos);
  EXPECT_NE(refusal("smirk").find("open-mouth-smile"), std::string::npos);
  EXPECT_NE(refusal("smile:1.5").find("0 to 1, not 1.5"), std::string::npos);
  EXPECT_NE(refusal("smile:nan"), "none");
  EXPECT_NE(refusal("smile:1:up").find("left|right"), std::string::npos);
  EXPECT_NE(refusal("smile+AU99").find("AU99"), std::string::npos);
  EXPECT_NE(refusal("smile+"), "none");
  EXPECT_NE(refusal(""), "none");
  EXPECT_THROW(check_expression("no-such-file.csv"), InputError);
}

TEST(Expression, AFileGivesMusclesOrBothSides) {
  const auto file = std::filesystem::temp_directory_path() / "condyle-test-expression.csv";
  write_file(file, "time_s,zygomaticus_major\n2,0\n3,1\n");
  const Expression both = make_expression(file.string(), pair_of_muscles());
  EXPECT_EQ(both.duration_s, 1);
  EXPECT_NEAR(both.at(0.5).muscles[0], 0.5, 1e-12);
  EXPECT_EQ(both.at(0.5).muscles[0], both.at(0.5).muscles[1]);
  write_file(file, "time_s,left_zygomaticus_major\n0,0\n1,1.2\n");
  EXPECT_NE(refusal(file.string()).find("1.2"), std::string::npos);
  EXPECT_NE(refusal(file.string()).find("line 3"), std::string::npos);
  write_file(file, "time_s,AU12,left_AU45,right_orbicularis_oculi_palpebral\n0,0,0,0\n1,1,0.8,1\n");
  const Expression units = make_expression(file.string(), pair_of_muscles());
  EXPECT_EQ(units.at(1).muscles, (std::vector<double>{1, 1}));
  EXPECT_EQ(units.at(1).lids, (LidClosure{0.8, 1}));
  EXPECT_EQ(units.notes.size(), 1u);
  EXPECT_FALSE(expression_moves_upper_face(file.string()));
  write_file(file, "time_s,left_AU1\n0,0\n1,1\n");
  EXPECT_TRUE(expression_moves_upper_face(file.string()));
  write_file(file, "time_s,AU45\n0,0\n1,1.2\n");
  EXPECT_NE(refusal(file.string()).find("line 3"), std::string::npos);
  EXPECT_NE(refusal(file.string()).find("0 to 1, not 1.2"), std::string::npos);
  write_file(file, "time_s,masseter\n0,0\n1,1\n");
  EXPECT_NE(refusal(file.string()).find("masseter"), std::string::npos);
  EXPECT_NE(refusal(file.string()).find("expressions, also with left_ or right_: smile"),
            std::string::npos)
      << refusal(file.string());
}

}  // namespace
}  // namespace condyle
