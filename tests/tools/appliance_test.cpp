// The commands splint and guide: files, reports, pictures and bad input.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/picture.h"
#include "tests/support/program.h"

namespace fs = std::filesystem;

namespace condyle::test {
namespace {

struct Appliance : testing::Test {
  const Folder folder;
  const std::string plan = folder / "plan.json", out = folder / "out.stl";

  static Outcome done(const std::vector<std::string>& words) {
    Outcome outcome = condyle(words);
    EXPECT_EQ(outcome.code, 0) << words[0] << ": " << outcome.err;
    return outcome;
  }
  std::string refused(const std::vector<std::string>& words, int code = 2,
                      const Limits& limits = {}) const {
    const Outcome outcome = condyle(words, limits);
    EXPECT_EQ(outcome.code, code) << outcome.err;
    return outcome.err;
  }
  static bool mentions(const std::string& text, const std::string& words) {
    return text.find(words) != std::string::npos;
  }
  void make_plan() const {
    done({"plan", "new", "--out", plan});
    done({"plan", "cut", plan, "genioplasty"});
    done({"plan", "cut", plan, "le_fort_1"});
    done({"plan", "move", plan, "maxilla", "forward", "3"});
  }
  /// Triangles that a binary STL states, which its size confirms.
  static long triangles_of(const std::string& file) {
    const std::string text = read_text(file);
    if (text.size() < 84) return 0;
    const auto byte = [&](int i) { return static_cast<unsigned char>(text[i]); };
    const long count = byte(80) + 256L * byte(81) + 65536L * byte(82) + 16777216L * byte(83);
    return 84 + 50 * count == static_cast<long>(text.size()) ? count : -1;
  }
};

}  // namespace

TEST_F(Appliance, ASplintAndAGuideAreWrittenMeasuredAndDrawn) {
  make_plan();
  const std::string picture = folder / "splint.png";
  const auto splint = nlohmann::json::parse(
      done({"splint", plan, "--voxel", "0.4", "--out", out, "--picture", picture, "--json"}).out);
  EXPECT_EQ(splint["kind"], "final");
  EXPECT_TRUE(splint["closed"]);
  EXPECT_EQ(splint["pieces"], 1);
  EXPECT_GE(splint["thickness_mm"], 1.5);
  ASSERT_EQ(splint["prints"].size(), 2u);
  for (const auto& print : splint["prints"]) EXPECT_LE(print["undercut_mm"], 0.42);
  EXPECT_EQ(triangles_of(out), splint["triangles"].get<long>());
  EXPECT_GT(fs::file_size(picture), 50000u);

  const std::string ply = folder / "guide.ply";
  const Outcome guide =
      done({"guide", plan, "--cut", "chin", "--saw", "piezo", "--voxel", "0.4", "--out", ply});
  EXPECT_TRUE(mentions(guide.err, "saw: piezo, blade 0.55 mm")) << guide.err;
  EXPECT_TRUE(mentions(guide.err, "closed, 1 piece")) << guide.err;
  EXPECT_TRUE(read_text(ply).starts_with("ply"));
}

TEST_F(Appliance, BadInputIsRefusedAndNothingIsLost) {
  make_plan();
  write_text(out, "kept");
  const std::vector<std::string> splint = {"splint", plan, "--out", out},
                                 guide = {"guide", plan, "--out", out};
  const auto with = [](std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  for (const char* voxel : {"0", "5", "nan"}) {
    EXPECT_TRUE(mentions(refused(with(splint, {"--voxel", voxel})), "--voxel")) << voxel;
    EXPECT_TRUE(mentions(refused(with(guide, {"--cut", "chin", "--voxel", voxel})), "--voxel"));
  }
  EXPECT_TRUE(
      mentions(refused(with(splint, {"--kind", "intermediate"})), "moves the upper jaw alone"));
  EXPECT_TRUE(mentions(refused(with(splint, {"--opening", "0"})), "at the incisors gives it"));
  EXPECT_TRUE(mentions(refused({"splint", plan, "--out", folder / "x.obj"}), "as .stl or .ply"));
  EXPECT_TRUE(mentions(refused(with(guide, {"--cut", "le_fort_2"})), "it has 1 (genioplasty)"));
  EXPECT_TRUE(mentions(refused(with(guide, {"--cut", "chin", "--saw", "sagital"})),
                       "did you mean \"sagittal\""));
  EXPECT_TRUE(mentions(refused(with(guide, {"--cut", "chin", "--saw", "9"})), "blades are"));
  EXPECT_EQ(read_text(out), "kept");
  // A full disk.
  Limits full;
  full.file_mb = 1;
  EXPECT_TRUE(mentions(refused(with(splint, {"--voxel", "0.4"}), 1, full), "out.stl"));
  EXPECT_EQ(read_text(out), "kept");
}

TEST_F(Appliance, APlanThatMovesNothingNeedsNoSplint) {
  done({"plan", "new", "--out", plan});
  EXPECT_TRUE(mentions(refused({"splint", plan, "--out", out}), "moves no dental arch"));
  EXPECT_TRUE(mentions(refused({"guide", plan, "--cut", "chin", "--out", out}), "has no cut"));
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace condyle::test
