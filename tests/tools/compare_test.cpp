// The commands `compare` and `plan compare`.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace fs = std::filesystem;

namespace condyle::test {
namespace {

bool says(const Outcome& outcome, const std::string& words) {
  return (outcome.out + outcome.err).find(words) != std::string::npos;
}

}  // namespace

TEST(CompareCommand, MeasuresAFaceAndWritesItsMaps) {
  const Folder folder;
  const std::string sample = folder / "sample", out = folder / "out";
  ASSERT_EQ(condyle({"sample", "--out", sample}).code, 0);
  const std::string skin = sample + "/skin.ply";
  const Outcome outcome =
      condyle({"compare", skin, skin, "--case", "built-in", "--out", out, "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  ASSERT_EQ(json["regions"].size(), 8u);
  for (const auto& region : json["regions"]) EXPECT_LT(region["max_mm"].get<double>(), 0.01);
  for (const char* file : {"deviation_front.png", "distances.csv", "report.json"})
    EXPECT_TRUE(fs::exists(out + "/" + file)) << file;
}

TEST(CompareCommand, WrongInputHasExitCode2) {
  const Folder folder;
  const std::string sample = folder / "sample";
  ASSERT_EQ(condyle({"sample", "--out", sample}).code, 0);
  const std::string skin = sample + "/skin.ply";
  const Outcome metres = condyle({"compare", skin, skin, "--case", "built-in", "--units", "m"});
  EXPECT_EQ(metres.code, 2);
  const Outcome unmarked = condyle({"compare", skin, skin});
  EXPECT_EQ(unmarked.code, 2);
  EXPECT_TRUE(says(unmarked, "--landmarks")) << unmarked.err;
  const Outcome folder_without = condyle({"compare", folder / "", skin});
  EXPECT_EQ(folder_without.code, 2);
  EXPECT_TRUE(says(folder_without, "face_after.ply")) << folder_without.err;
  EXPECT_EQ(condyle({"compare", skin, folder / "absent.ply"}).code, 2);
}

TEST(ComparePlansCommand, PrintsSegmentsAndLandmarks) {
  const Folder folder;
  const std::string one = folder / "one.json", two = folder / "two.json";
  for (const auto& [file, mm] : {std::pair{one, "4"}, {two, "7"}}) {
    ASSERT_EQ(condyle({"plan", "new", "--out", file}).code, 0);
    ASSERT_EQ(condyle({"plan", "cut", file, "genioplasty"}).code, 0);
    ASSERT_EQ(condyle({"plan", "move", file, "chin", "forward", mm}).code, 0);
  }
  const Outcome outcome = condyle({"plan", "compare", one, two});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(says(outcome, "3.0 forward")) << outcome.out;
  EXPECT_TRUE(says(outcome, "Pog")) << outcome.out;
  EXPECT_EQ(condyle({"plan", "compare", one, folder / "absent.json"}).code, 2);
}

}  // namespace condyle::test
