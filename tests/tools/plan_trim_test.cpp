// Commands of a plan: bone that is trimmed, and danger zones of the user's own.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace fs = std::filesystem;

namespace condyle::test {
namespace {

struct PlanTrim : testing::Test {
  const Folder folder;
  const std::string file = folder / "plan.json", out = folder / "out";

  static std::string done(std::vector<std::string> words) {
    words.insert(words.begin(), "plan");
    const Outcome outcome = condyle(words);
    EXPECT_EQ(outcome.code, 0) << words[1] << ": " << outcome.err;
    return outcome.out + outcome.err;
  }
  /// The message of a command that leaves the plan as it is.
  std::string refused(std::vector<std::string> words) const {
    const std::string before = read_text(file);
    words.insert(words.begin(), "plan");
    const Outcome outcome = condyle(words);
    EXPECT_EQ(outcome.code, 2) << words[1] << ": " << outcome.err;
    EXPECT_EQ(read_text(file), before);
    return outcome.err;
  }
  static bool mentions(const std::string& text, const std::string& words) {
    return text.find(words) != std::string::npos;
  }
  nlohmann::json plan() const { return nlohmann::json::parse(read_text(file)); }
  nlohmann::json apply() const {
    done({"apply", file, "--out", out, "--case", "built-in:class-iii"});
    return nlohmann::json::parse(read_text(out + "/report.json"));
  }
  static int to_be_trimmed(const nlohmann::json& report) {
    int count = 0;
    for (const auto& overlap : report["overlaps"]) count += overlap["kind"] == "trimmed";
    return count;
  }
};

}  // namespace

TEST_F(PlanTrim, TheOverlapOfASetbackIsTrimmedReportedAndUndone) {
  done({"new", "built-in:class-iii", "--out", file});
  done({"cut", file, "sagittal_split", "--case", "built-in:class-iii"});
  EXPECT_TRUE(mentions(refused({"trim", file, "distal"}), "there is nothing to trim"));
  done({"move", file, "distal", "back", "5"});
  const std::string untrimmed = read_text(file);
  ASSERT_EQ(to_be_trimmed(apply()), 2);
  EXPECT_TRUE(mentions(refused({"trim", file, "distl"}), "did you mean \"distal\""));
  EXPECT_TRUE(mentions(refused({"trim", file, "proximal_left", "--of", "proximal_right"}),
                       "do not overlap"));

  const std::string text = done({"trim", file, "distal"});
  EXPECT_TRUE(mentions(text, "mm³ removed beyond the cut faces of proximal_left")) << text;
  EXPECT_TRUE(mentions(text, "no overlapping bone of distal is left")) << text;
  EXPECT_EQ(plan()["version"], 2);
  const auto report = apply();
  EXPECT_EQ(to_be_trimmed(report), 0);
  ASSERT_EQ(report["trims"].size(), 1u);
  EXPECT_GT(report["trims"][0]["removed_volume_mm3"].get<double>(), 1000);
  EXPECT_LT(report["volume_error_percent"].get<double>(), 1e-6);
  for (const auto& segment : report["segments"]) {
    EXPECT_TRUE(segment["closed"].get<bool>()) << segment;
    EXPECT_EQ(segment.contains("trimmed_mm3"), segment["name"] == "distal");
  }
  const Outcome shown = condyle({"plan", "show", file, "--case", "built-in:class-iii"});
  EXPECT_TRUE(mentions(shown.out, "trim distal: bone that overlaps")) << shown.out;

  // A move afterwards is trimmed as well; the same trim again replaces the first.
  done({"move", file, "distal", "back", "3"});
  const auto less = apply();
  EXPECT_EQ(to_be_trimmed(less), 0);
  EXPECT_LT(less["trims"][0]["removed_volume_mm3"], report["trims"][0]["removed_volume_mm3"]);
  done({"trim", file, "distal", "--of", "proximal_left"});
  EXPECT_EQ(plan()["steps"].size(), 3u);
  EXPECT_EQ(to_be_trimmed(apply()), 1);
  for (int i = 0; i < 3; ++i) done({"undo", file});
  EXPECT_EQ(read_text(file), untrimmed);
}

TEST_F(PlanTrim, OwnZonesAreStoredCheckedListedAndRemoved) {
  done({"new", "--out", file});
  const std::string empty = read_text(file);
  write_text(folder / "line.csv", "x_mm,y_mm,z_mm\n-10,-88,-81\n0,-88,-81\n10,-88,-81\n");
  done({"zone", file, "vessel", folder / "line.csv", "--radius", "1"});
  fs::remove(folder / "line.csv");  // the plan holds it
  EXPECT_TRUE(
      mentions(done({"zone", file}), "zone vessel: other, a line of 3 points, radius 1 mm"));
  const std::string text = refused({"cut", file, "genioplasty"});
  EXPECT_TRUE(mentions(text, "vessel: ")) << text;
  EXPECT_TRUE(mentions(text, "mm are needed") || mentions(text, "enters it")) << text;
  done({"cut", file, "genioplasty", "--below-margins"});
  done({"zone", file, "vessel", "--remove"});
  EXPECT_EQ(plan()["version"], 1);
  done({"undo", file});
  EXPECT_EQ(plan()["zones"].size(), 1u);
  // The cuts that the plan has already are checked against a new surface.
  EXPECT_EQ(condyle({"sample", "--out", folder / "sample"}).code, 0);
  const std::string added = done({"zone", file, "jaw", folder / "sample/jaw.stl", "--stop", "8"});
  EXPECT_TRUE(mentions(added, "step 1 (cut genioplasty): jaw: the cut enters it")) << added;
}

TEST_F(PlanTrim, FilesThatAreNoZoneAreRefused) {
  done({"new", "--out", file});
  const auto zone = [&](const std::string& name, const std::string& content,
                        std::vector<std::string> more = {}) {
    write_text(folder / name, content);
    more.insert(more.begin(), {"zone", file, "z", folder / name});
    return refused(more);
  };
  EXPECT_TRUE(mentions(refused({"zone", file, "z", folder / "absent.stl"}), "no such file"));
  EXPECT_TRUE(mentions(zone("a.csv", "x_mm,y_mm\n1,2\n"), "\"z_mm\" is missing"));
  EXPECT_TRUE(mentions(zone("b.csv", "x_mm,y_mm,z_mm\n1,2,nan\n"), "finite number"));
  EXPECT_TRUE(mentions(zone("c.csv", "x_mm,y_mm,z_mm\n"), "contains no points"));
  EXPECT_TRUE(mentions(zone("d.ply", "ply\nformat"), "d.ply"));
  EXPECT_TRUE(mentions(zone("e.csv", "x_mm,y_mm,z_mm\n0,-9,-10\n", {"--units", "m"}), "--units"));
  EXPECT_TRUE(
      mentions(zone("f.csv", "x_mm,y_mm,z_mm\n0,-90,-100\n", {"--warn", "1", "--stop", "2"}),
               "below stop_mm"));
  EXPECT_TRUE(mentions(refused({"zone", file, "z"}), "needs the file"));
  EXPECT_TRUE(mentions(refused({"zone", file, "z", "--remove"}), "no zone \"z\""));
}

TEST(PlanCutCommand, OsteotomiesBetweenTeethStateTheirRoom) {
  const Folder folder;
  const std::string file = folder / "plan.json";
  for (const std::vector<std::string>& words : {std::vector<std::string>{"body_osteotomy"},
                                                {"le_fort_1", "--set", "pieces=2"},
                                                {"le_fort_1", "--set", "pieces=3"}}) {
    EXPECT_EQ(condyle({"plan", "new", "--out", file}).code, 0);
    std::vector<std::string> all{"plan", "cut", file};
    all.insert(all.end(), words.begin(), words.end());
    const Outcome outcome = condyle(all);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("their roots leave"), std::string::npos) << outcome.err;
    // Too wide a saw leaves too little bone.
    EXPECT_EQ(condyle({"plan", "new", "--out", file}).code, 0);
    all.insert(all.end(), {"--kerf", "2"});
    const Outcome refused = condyle(all);
    EXPECT_EQ(refused.code, 2) << refused.err;
    EXPECT_NE(refused.err.find("require 4.0 mm"), std::string::npos) << refused.err;
  }
}

}  // namespace condyle::test
