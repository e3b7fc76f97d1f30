// Expressions of the face on the command line.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/support/picture.h"
#include "tests/support/program.h"
#include "tests/support/real_cases.h"

namespace condyle::test {
namespace {

namespace fs = std::filesystem;

TEST(Expression, ASmileIsRecordedAndMeasured) {
  const Folder folder;
  const std::string out = folder / "out";
  const std::vector<std::string> smile = {"record",  "--expression", "smile", "--frames",
                                          "2",       "--camera",     "front", "--size",
                                          "200x200", "--out",        out};
  Outcome done = condyle(smile);
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_NE(read_text(fs::path(out) / "frames/000000.png"),
            read_text(fs::path(out) / "frames/000001.png"));
  const auto report = nlohmann::json::parse(read_text(fs::path(out) / "report.json"));
  int corners = 0;
  for (const auto& finding : report["findings"]) {
    const std::string quantity = finding["quantity"];
    if (!quantity.ends_with("corner of the mouth: displacement")) continue;
    ++corners;
    EXPECT_GT(double(finding["value"]), 5);
    EXPECT_EQ(finding["emergent"], false) << "forces were chosen for it";
  }
  EXPECT_EQ(corners, 2);
  // The pictures of another expression are not mixed with these.
  std::vector<std::string> other = smile;
  other[2] = "sad";
  other.emplace_back("--resume");
  done = condyle(other);
  EXPECT_EQ(done.code, 2);
  EXPECT_NE(done.err.find("motion"), std::string::npos) << done.err;
}

/// Of the built-in patient (an empty folder) or of a case.
void expect_smile_within_published_ranges(const std::string& patient) {
  const Folder folder;
  const fs::path out = folder / "out";
  std::vector<std::string> smile = {"run", "--expression", "smile", "--frames", "2", "--out", out};
  if (!patient.empty()) smile.insert(smile.begin() + 1, patient);
  const Outcome done = condyle(smile);
  ASSERT_EQ(done.code, 0) << done.err;
  const auto report = nlohmann::json::parse(read_text(out / "report.json"));
  std::set<std::string> within;
  for (const auto& finding : report["findings"]) {
    if (!finding.contains("band")) continue;
    EXPECT_EQ(finding["within"], true) << finding;
    within.insert(finding["quantity"]);
  }
  for (const char* quantity :
       {"left corner of the mouth: displacement", "right corner of the mouth: displacement",
        "left corner of the mouth: direction above the horizontal, frontal",
        "right corner of the mouth: direction above the horizontal, frontal",
        "change of the mouth's width", "change of the upper lip's length",
        "left_zygomaticus_major: length over that at rest",
        "right_zygomaticus_major: length over that at rest"})
    EXPECT_TRUE(within.contains(quantity)) << quantity;
}

TEST(Expression, ASmileIsWithinPublishedRanges) { expect_smile_within_published_ranges(""); }

TEST(Expression, ASmileOfAMeasuredPatientIsWithinPublishedRanges) {
  const fs::path files = real_data() / "case-badin";
  if (!fs::exists(files)) GTEST_SKIP() << "real anatomy absent";
  const Folder folder;
  const std::string patient = folder / "case";
  const Outcome done = condyle({"import", "meshes", "--maxilla", files / "maxilla_capped.ply",
                                "--mandible", files / "mandible.ply", "--face",
                                files / "face_skin.ply", "--landmarks", files / "markers.csv",
                                "--face-muscles", files / "face_muscles.csv", "--out", patient});
  ASSERT_EQ(done.code, 0) << done.err;
  expect_smile_within_published_ranges(patient);
}

std::string notes_of(const fs::path& folder) {
  return nlohmann::json::parse(read_text(folder / "report.json"))["motion"]["notes"].dump();
}

TEST(Expression, WordsOfAMotionMoveTheFaceAndTheJaw) {
  const Folder folder;
  const std::string file = folder / "smile.motion";
  write_text(file, "smile 0.5 left over 0.3 and open 6 over 0.3  # both at the same time\n");
  const fs::path out = folder / "out";
  const Outcome done = condyle({"run", "--motion", file, "--frames", "2", "--out", out});
  ASSERT_EQ(done.code, 0) << done.err;
  const auto report = nlohmann::json::parse(read_text(out / "report.json"));
  EXPECT_NEAR(double(report["opening"]["max_opening_mm"]), 6, 0.5);
  double left = 0, right = 0;
  for (const auto& finding : report["findings"]) {
    const std::string quantity = finding["quantity"];
    if (quantity == "left corner of the mouth: direction above the horizontal, frontal") {
      EXPECT_FALSE(finding.contains("band")) << "it is no full smile";
    }
    if (quantity == "left_zygomaticus_major: length over that at rest") left = finding["value"];
    if (quantity == "right_zygomaticus_major: length over that at rest") right = finding["value"];
  }
  EXPECT_LT(left, right - 0.03) << "only the left one pulls";
}

TEST(Expression, FoldsOfTheSkinAreInPicturesAlone) {
  const Folder folder;
  const auto record = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> smile = {"record",  "--expression", "smile",      "--frames",
                                      "2",       "--camera",     "front",      "--size",
                                      "400x400", "--out",        folder / name};
    smile.insert(smile.end(), more.begin(), more.end());
    const Outcome done = condyle(smile);
    EXPECT_EQ(done.code, 0) << done.err;
    return fs::path(folder / name);
  };
  const fs::path with = record("with", {}), without = record("without", {"--no-folds"});
  const auto frame = [](const fs::path& out, const char* number) {
    return Picture((out / "frames" / number).string());
  };
  EXPECT_TRUE(same_bytes(frame(with, "000000.png"), frame(without, "000000.png"))) << "at rest";
  EXPECT_TRUE(unlike(frame(with, "000001.png"), frame(without, "000001.png"), 0.0005));
  // Brows and skull are above the lower lids, which rise, the neck below.
  for (const Region& away : {Region{0, 0, 400, 125}, Region{0, 290, 400, 110}})
    EXPECT_TRUE(alike(frame(with, "000001.png"), frame(without, "000001.png"), 0, away));
  EXPECT_EQ(read_text(with / "expression.csv"), read_text(without / "expression.csv"));
  const auto findings = [](const fs::path& out) {
    return nlohmann::json::parse(read_text(out / "report.json"))["findings"];
  };
  EXPECT_EQ(findings(with), findings(without));
}

TEST(Expression, APalsiedFaceIsComparedBeforeAndAfterAPlan) {
  const Folder folder;
  const std::string plan = folder / "plan.json";
  const fs::path out = folder / "out";
  ASSERT_EQ(condyle({"plan", "new", "--out", plan}).code, 0);
  ASSERT_EQ(condyle({"plan", "cut", plan, "genioplasty"}).code, 0);
  ASSERT_EQ(condyle({"plan", "move", plan, "chin", "forward", "4"}).code, 0);
  const Outcome done = condyle({"run", "--expression", "smile", "--weakness", "right:0", "--plan",
                                plan, "--frames", "2", "--out", out});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_NE(done.err.find("before"), std::string::npos) << done.err;
  const auto report = nlohmann::json::parse(read_text(out / "report.json"));
  const auto value = [](const nlohmann::json& findings, const std::string& quantity) {
    for (const auto& finding : findings)
      if (finding["quantity"] == quantity) return double(finding["value"]);
    ADD_FAILURE() << quantity;
    return 0.0;
  };
  for (const auto& findings : {report["findings"], report["expression"]["before"]["findings"]}) {
    EXPECT_GT(value(findings, "left corner of the mouth: displacement"), 8);
    EXPECT_LT(value(findings, "right corner of the mouth: displacement"), 2);
    EXPECT_GT(value(findings, "upper incisor show"), value(findings, "upper incisor show at rest"));
  }
  EXPECT_EQ(report["expression"]["teeth"].size(), 10u);
  EXPECT_EQ(report["expression"]["before"]["teeth"].size(), 10u);
  const std::string csv = read_text(out / "expression.csv");
  EXPECT_TRUE(csv.starts_with("quantity,unit,value,low,high,published,before\n")) << csv;
  EXPECT_NE(csv.find("\"tooth 11: show\",mm,"), std::string::npos) << csv;
}

TEST(Expression, WordsAreLeftOutWithANoteWhereThereIsNoTissue) {
  const Folder folder;
  const fs::path out = folder / "out";
  const Outcome done = condyle({"check", "--motion", "smile; open 5", "--frames", "2"});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_NE(done.err.find("expressions are left out"), std::string::npos) << done.err;
  ASSERT_EQ(
      condyle({"run", "--motion", "smile; hold 0.2", "--no-tissue", "--frames", "2", "--out", out})
          .code,
      0);
  EXPECT_NE(notes_of(out).find("expressions are left out"), std::string::npos);
}

TEST(Expression, WrongOnesAreRefused) {
  const Folder folder;
  const auto expect_refused = [&](const std::vector<std::string>& of_expression,
                                  const char* words) {
    std::vector<std::string> arguments = {"run", "--out", folder / "out"};
    arguments.insert(arguments.end(), of_expression.begin(), of_expression.end());
    const Outcome done = condyle(arguments);
    EXPECT_EQ(done.code, 2) << done.err;
    EXPECT_NE(done.err.find(words), std::string::npos) << done.err;
  };
  expect_refused({}, "--motion is required");
  expect_refused({"--expression", "smirk"}, "there is no such expression");
  expect_refused({"--expression", "smile:2"}, "0 to 1, not 2");
  expect_refused({"--expression", "smile:1:up"}, "left|right");
  expect_refused({"--expression", "AU99"}, "AU12");
  expect_refused({"--expression", "smile", "--weakness", "left:2"}, "1 (healthy), not 2");
  expect_refused({"--expression", "smile", "--weakness", "masseter:0"}, "masseter");
  expect_refused({"--motion", "rest", "--weakness", "left:0"}, "needs an expression");
  expect_refused({"--motion", "smile 1.2"}, "strength must be 0 to 1");
  expect_refused({"--motion", "smirk; close"}, "\"smirk\"");
  expect_refused({"--motion", "smile", "--expression", "sad"}, "expressions of its own");
  expect_refused({"--expression", "smile", "--no-tissue"}, "needs the soft tissue");
  expect_refused({"--expression", folder / "none.csv"}, "no such file");
  write_text(folder / "high.csv", "time_s,zygomaticus_major\n0,0\n1,1.5\n");
  expect_refused({"--expression", folder / "high.csv"}, "line 3, zygomaticus_major");
  write_text(folder / "other.csv", "time_s,masseter\n0,0\n1,1\n");
  expect_refused({"--expression", folder / "other.csv"}, "is not a muscle of the face");
  write_text(folder / "empty.csv", "");
  expect_refused({"--expression", folder / "empty.csv"}, "is empty");
}

}  // namespace
}  // namespace condyle::test
