// The command `plan`, from an empty plan to the patient after the operation.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace fs = std::filesystem;

namespace condyle::test {
namespace {

bool mentions(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

/// Runs `condyle plan` and expects success.
Outcome plan(std::vector<std::string> words) {
  words.insert(words.begin(), "plan");
  Outcome outcome = condyle(words);
  EXPECT_EQ(outcome.code, 0) << words[1] << ": " << outcome.err;
  return outcome;
}

}  // namespace

TEST(PlanCommand, AGenioplastyFromTheEmptyPlanToTheOperatedCase) {
  const Folder folder;
  const std::string file = folder / "plan.json", out = folder / "out";
  plan({"new", "--out", file, "--name", "chin"});
  const Outcome cut = plan({"cut", file, "genioplasty", "--kerf", "0.5"});
  EXPECT_TRUE(mentions(cut.err, "goes through")) << cut.err;
  plan({"move", file, "chin", "forward", "3", "pitch", "-2"});
  plan({"move", file, "chin", "forward", "6", "up", "1"});  // replaces the first
  EXPECT_TRUE(mentions(plan({"show", file}).out, "forward 6.0, up 1.0 mm"));
  const Outcome shown = plan({"show", file, "--case", "built-in"});
  for (const char* words : {"goes through", "6.0 forward", "1.0 up", "overjet", "chin"})
    EXPECT_TRUE(mentions(shown.out, words)) << words << "\n" << shown.out;
  plan({"apply", file, "--out", out});
  const auto report = nlohmann::json::parse(read_text(out + "/report.json"));
  ASSERT_EQ(report["segments"].size(), 1u);
  const auto& chin = report["segments"][0];
  EXPECT_EQ(chin["name"], "chin");
  EXPECT_EQ(chin["parent"], "mandible");
  EXPECT_TRUE(chin["closed"].get<bool>());
  EXPECT_GT(chin["volume_mm3"].get<double>(), 1000);
  EXPECT_LT(report["volume_error_percent"].get<double>(), 1e-4);
  EXPECT_TRUE(fs::exists(out + "/segments/chin.ply"));
  EXPECT_TRUE(mentions(condyle({"info", out + "/case"}).out, "body chin: on mandible"));
}

TEST(PlanCommand, AMoveThatCollidesIsRefusedOrSlides) {
  const Folder folder;
  const std::string file = folder / "plan.json";
  plan({"new", "--out", file});
  plan({"cut", file, "sagittal_split"});
  const std::string before = read_text(file);
  const Outcome refused = condyle({"plan", "move", file, "proximal_left", "up", "12"});
  EXPECT_EQ(refused.code, 2);
  for (const char* words :
       {"skull and proximal_left overlap", "a collision", "of the move is free"})
    EXPECT_TRUE(mentions(refused.err, words)) << words << "\n" << refused.err;
  EXPECT_EQ(read_text(file), before);
  plan({"move", file, "proximal_left", "up", "12", "--slide"});
  const auto slid = nlohmann::json::parse(read_text(file));
  const double up = slid["steps"].back()["move"]["up_mm"].get<double>();
  EXPECT_GT(up, 0.5);
  EXPECT_LT(up, 5);
  // Just free: a little more collides.
  EXPECT_EQ(condyle({"plan", "move", file, "proximal_left", "up", std::to_string(up)}).code, 0);
  EXPECT_EQ(condyle({"plan", "move", file, "proximal_left", "up", std::to_string(up + 0.1)}).code,
            2);
  plan({"move", file, "proximal_left", "up", "12", "--despite-collision"});
  // Pieces of one bone are trimmed: their overlap is reported, not refused.
  const Outcome setback = plan({"move", file, "distal", "back", "5"});
  EXPECT_TRUE(mentions(setback.err, "bone to be trimmed")) << setback.err;
  EXPECT_EQ(condyle({"plan", "occlude", file, "proximal_left"}).code, 2);
}

TEST(PlanCommand, WrongInputHasExitCode2AndLeavesThePlan) {
  const Folder folder;
  const std::string file = folder / "plan.json";
  plan({"new", "--out", file});
  const std::string before = read_text(file);
  struct Wrong {
    std::vector<std::string> words;
    const char* message;
  };
  const std::vector<Wrong> wrong = {
      {{"cut", file, "genioplasti"}, "genioplasty"},
      {{"cut", file, "genioplasty", "--kerf", "5"}, "0 to 2"},
      {{"cut", file, "genioplasty", "--set", "height"}, "NAME=VALUE"},
      {{"move", file, "chin", "forward", "6"}, "no step of the plan makes \"chin\""},
      {{"move", file, "mandible", "forwrad", "6"}, "did you mean \"forward\""},
      {{"move", file, "mandible", "forward", "200"}, "200"},
      {{"remove", file, "3"}, "no step 3"},
      {{"show", folder / "absent.json"}, "absent.json"}};
  for (const Wrong& each : wrong) {
    std::vector<std::string> words = {"plan"};
    words.insert(words.end(), each.words.begin(), each.words.end());
    const Outcome outcome = condyle(words);
    EXPECT_EQ(outcome.code, 2) << each.message;
    EXPECT_TRUE(mentions(outcome.err, each.message)) << outcome.err;
  }
  EXPECT_EQ(read_text(file), before);
  const Outcome other =
      condyle({"plan", "apply", file, "--case", box_case(folder), "--out", folder / "out"});
  EXPECT_EQ(other.code, 2);
  EXPECT_TRUE(mentions(other.err, "another case")) << other.err;
}

TEST(PlanCommand, ACutBelowTheMarginsIsRefusedUnlessItIsRequested) {
  const Folder folder;
  const std::string file = folder / "plan.json";
  plan({"new", "--out", file});
  const std::string before = read_text(file);
  const std::vector<std::string> words{"plan",      "cut",   file,
                                       "le_fort_2", "--set", "foramen_margin_mm=4"};
  const Outcome refused = condyle(words);
  EXPECT_EQ(refused.code, 2);
  EXPECT_TRUE(mentions(refused.err, "infraorbital foramen")) << refused.err;
  EXPECT_EQ(read_text(file), before);
  plan({"cut", file, "le_fort_2", "--set", "foramen_margin_mm=4", "--below-margins"});
  EXPECT_TRUE(mentions(plan({"show", file, "--case", "built-in"}).out, "infraorbital foramen"));
}

TEST(PlanCommand, TheJawMovesAfterTheOperation) {
  const Folder folder;
  const std::string file = folder / "plan.json", out = folder / "out";
  plan({"new", "--out", file, "--name", "chin"});
  plan({"cut", file, "genioplasty"});
  plan({"move", file, "chin", "forward", "5"});
  const Outcome run = condyle({"run", "--plan", file, "--motion", "open 20", "--frames", "3",
                               "--out", out, "--surface-nodes", "300"});
  EXPECT_EQ(run.code, 0) << run.err;
  const auto report = nlohmann::json::parse(read_text(out + "/report.json"));
  EXPECT_EQ(report["plan"]["name"], "chin");
  EXPECT_NEAR(report["opening"]["max_opening_mm"].get<double>(), 20, 0.5);
  EXPECT_TRUE(mentions(read_text(out + "/trace.csv"), "chin"));
  EXPECT_EQ(condyle({"occlude", "--plan", file}).code, 0);
  const Outcome wrong = condyle({"check", "--plan", out + "/trace.csv", "--motion", "rest"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_TRUE(mentions(wrong.err, "trace.csv")) << wrong.err;
}

TEST(PhantomCommand, WritesVariantsAndRefusesUnknownOnes) {
  const Folder folder;
  const std::string out = folder / "class-iii";
  EXPECT_EQ(condyle({"phantom", "--variant", "class-iii", "--out", out}).code, 0);
  EXPECT_TRUE(fs::exists(out + "/case.json"));
  const Outcome unknown = condyle({"phantom", "--variant", "class-9", "--out", folder / "x"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_TRUE(mentions(unknown.err, "scaphocephaly")) << unknown.err;
}

}  // namespace condyle::test
