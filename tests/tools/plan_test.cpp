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

}  // namespace condyle::test
