// `condyle occlude`: exit codes, files, and their use by other commands.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace condyle::test {
namespace {

namespace fs = std::filesystem;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST(Occlude, WritesAPageReportAndPosesThatOtherCommandsPlay) {
  const Folder folder;
  const std::string patient = box_case(folder), out = folder / "out";
  const auto outcome = condyle({"occlude", patient, "--out", out, "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(outcome.out, read_text(out + "/report.json"));
  EXPECT_TRUE(json["stable"]);
  EXPECT_EQ(json["overlap_mm"], 0);
  // Boxes 1 mm apart meet on paper of 0.1 mm.
  EXPECT_NEAR(json["gap_mm"].get<double>(), 0.1, 0.01);
  EXPECT_NEAR(json["X_CM"]["t_mm"][2].get<double>(), 0.9, 0.05);
  EXPECT_NEAR(json["load"]["left_share"].get<double>(), 0.5, 0.01);
  EXPECT_GE(json["contacts"].size(), 2u);
  const std::string page = read_text(out + "/report.html");
  EXPECT_TRUE(contains(page, "Stable bite"));
  EXPECT_TRUE(contains(page, "not for clinical use"));
  EXPECT_TRUE(contains(page, "arches.png"));
  EXPECT_GT(fs::file_size(out + "/arches.png"), 10000u);
  const auto check =
      condyle({"check", patient, "--motion", out + "/pose.csv", "--out", folder / "check"});
  EXPECT_EQ(check.code, 0) << check.err;
  const auto run = condyle(
      {"run", patient, "--motion", out + "/motion.csv", "--frames", "5", "--out", folder / "run"});
  EXPECT_EQ(run.code, 0) << run.err;
  // The pose is a start, too, and the bite's own.
  const auto again = condyle({"occlude", patient, "--start", out + "/pose.csv", "--json"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_LT(nlohmann::json::parse(again.out)["moved_from_start_mm"].get<double>(), 0.01);
}

TEST(Occlude, SameBytesForOneAndTwoThreads) {
  const Folder folder;
  const std::string patient = box_case(folder);
  const auto json = [&](const char* threads) {
    const auto outcome = condyle({"occlude", patient, "--start", "1,-1,-2,1,0,1", "--json",
                                  "--quiet", "--threads", threads});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    return outcome.out;
  };
  const auto one = json("1");
  EXPECT_EQ(one, json("2"));
  EXPECT_TRUE(contains(one, "\"stable\": true"));
}

TEST(Occlude, NoStableBiteIsAFailureThatReportsWhatWasReached) {
  const Folder folder;
  write_box_patient(folder.path());
  // The maxilla bears the right side's landmark only: everything lies left of the condyles' middle.
  write_text(folder / "marks.csv",
             "name,x_mm,y_mm,z_mm\nlowerincisor,0,-92,-41\nupperincisor,-28,-90,-40\n"
             "ltmj,-2,-5,-12\nrtmj,-98,-5,-12\n");
  const std::string patient = folder / "aside", out = folder / "out";
  ASSERT_EQ(
      condyle({"import", "meshes", "--maxilla", folder / "maxilla.stl", "--mandible",
               folder / "mandible.stl", "--landmarks", folder / "marks.csv", "--out", patient})
          .code,
      0);
  const auto outcome = condyle({"occlude", patient, "--out", out});
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  EXPECT_TRUE(contains(outcome.err, "NO stable bite")) << outcome.err;
  EXPECT_TRUE(contains(read_text(out + "/report.html"), "No stable bite"));
  EXPECT_FALSE(nlohmann::json::parse(read_text(out + "/report.json"))["stable"].get<bool>());
}

TEST(Occlude, BadInputIsRefusedWithWords) {
  const Folder folder;
  const std::string patient = box_case(folder);
  struct {
    std::vector<std::string> more;
    const char* word;
  } const cases[] = {{{"--start", "nan,0,0"}, "finite"},
                     {{"--start", "0,inf,0"}, "finite"},
                     {{"--start", "0,0,-80"}, "at most 25 mm"},
                     {{"--start", "1e300,0,0"}, "at most 25 mm"},
                     {{"--start", "1,2"}, "2 numbers"},
                     {{"--start", "absent.csv"}, "neither a pose file nor offsets"},
                     {{"--start", folder / "marks.csv"}, "time_s"},
                     {{"--paper", "0"}, "--paper"},
                     {{"--paper", "nan"}, "--paper"}};
  for (const auto& bad : cases) {
    std::vector<std::string> arguments = {"occlude", patient};
    arguments.insert(arguments.end(), bad.more.begin(), bad.more.end());
    const auto outcome = condyle(arguments);
    EXPECT_EQ(outcome.code, 2) << bad.more[1];
    EXPECT_TRUE(contains(outcome.err, bad.word)) << outcome.err;
  }
  // One arch alone.
  const std::string alone = folder / "alone";
  ASSERT_EQ(condyle({"import", "meshes", "--mandible", folder / "mandible.stl", "--landmarks",
                     folder / "marks.csv", "--out", alone})
                .code,
            0);
  const auto outcome = condyle({"occlude", alone});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_TRUE(contains(outcome.err, "no upper teeth")) << outcome.err;
}

}  // namespace condyle::test
