// The commands splint and guide: files, reports, pictures and bad input.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
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
  /// The triangles of a binary STL for which keep(number, corner, corner of the first one) holds.
  static std::string some_triangles(const std::string& stl, const auto& keep) {
    std::string kept = stl.substr(0, 84);
    std::uint32_t count = 0;
    float first[3], corner[3];
    std::memcpy(first, &stl[84 + 12], sizeof first);
    for (long t = 0; 84 + 50 * (t + 1) <= static_cast<long>(stl.size()); ++t) {
      std::memcpy(corner, &stl[84 + 50 * t + 12], sizeof corner);
      if (!keep(t, corner, first)) continue;
      kept += stl.substr(84 + 50 * t, 50);
      ++count;
    }
    std::memcpy(&kept[80], &count, sizeof count);
    return kept;
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
  EXPECT_TRUE(mentions(guide.err, "bone: mandible\n")) << guide.err;
  EXPECT_TRUE(mentions(guide.err, "guided between two walls: ")) << guide.err;
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
  EXPECT_TRUE(mentions(refused(with(guide, {"--cut", "chin", "--on", "skull"})),
                       "it passes through mandible"));
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

TEST_F(Appliance, AnArchOfOneToothIsRefusedAndAnOpenOneIsClosedOrRefused) {
  done({"sample", "--out", folder / "sample"});
  const std::string upper = read_text(folder / "sample/upper.stl");
  const auto import = [&](const std::string& name) {
    const std::string patient = folder / name;
    done({"import", "meshes", "--skull", folder / "sample/skull.stl", "--mandible",
          folder / "sample/jaw.stl", "--upper-teeth", folder / (name + ".stl"), "--lower-teeth",
          folder / "sample/lower.stl", "--landmarks", folder / "sample/marks.csv", "--units", "mm",
          "--frame", "LPS", "--out", patient});
    const std::string file = folder / (name + ".json");
    done({"plan", "new", patient, "--out", file});
    done({"plan", "move", file, "mandible", "forward", "1", "--case", patient});
    return std::vector<std::string>{"splint",  file,  "--case", patient,
                                    "--voxel", "0.4", "--out",  out};
  };
  write_text(folder / "one.stl",
             some_triangles(upper, [](long, const float* p, const float* first) {
               return std::hypot(p[0] - first[0], p[1] - first[1], p[2] - first[2]) < 4;
             }));
  const std::string one = refused(import("one"));
  EXPECT_TRUE(mentions(one, "upper-teeth: no upper molars were found")) << one;
  EXPECT_FALSE(fs::exists(out));
  // Every fortieth triangle is missing.
  write_text(folder / "open.stl",
             some_triangles(upper, [](long t, const float*, const float*) { return t % 40 != 7; }));
  const Outcome open = condyle(import("open"));
  EXPECT_TRUE(open.code == 0 || open.code == 2) << open.code << open.err;
  EXPECT_EQ(fs::exists(out), open.code == 0);
  EXPECT_TRUE(mentions(open.err, "closed") || mentions(open.err, "open")) << open.err;
}

}  // namespace condyle::test
