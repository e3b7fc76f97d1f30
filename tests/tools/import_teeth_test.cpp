// `import teeth`: scans in a case and alone, and what refuses them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "engine/mesh_io/mesh_files.h"
#include "tests/support/exact_distance.h"
#include "tests/support/program.h"

namespace condyle::test {
namespace {

namespace fs = std::filesystem;

void expect_refusal(const Outcome& outcome, const std::string& words) {
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
}

/// The property distance_mm of a PLY file as the program writes it, with colours.
std::vector<float> distances_in(const fs::path& file, std::size_t count) {
  const std::string text = read_text(file);
  EXPECT_LT(text.find("property float blue"),
            text.find("property float distance_mm\nelement face"));
  constexpr std::size_t stride = 3 * sizeof(double) + 4 * sizeof(float);
  std::vector<float> found(count);
  const std::size_t first = text.find("end_header\n") + 11;
  for (std::size_t i = 0; i < count; ++i)
    std::memcpy(&found[i], &text[first + (i + 1) * stride - sizeof(float)], sizeof(float));
  return found;
}

}  // namespace

TEST(ImportTeeth, ScansReplaceTheCrownsOrMakeACaseAlone) {
  const Folder folder;
  ASSERT_EQ(condyle({"sample", "--out", folder / "sample"}).code, 0);
  const std::string upper = folder / "sample/upper.stl", lower = folder / "sample/lower.stl";
  const auto in_case = condyle({"import", "teeth", "built-in:class-iii", "--upper", upper, "--out",
                                folder / "teeth", "--json"});
  ASSERT_EQ(in_case.code, 0) << in_case.err;
  const auto json = nlohmann::json::parse(in_case.out);
  EXPECT_LT(json["upper"]["mean_mm"].get<double>(), 0.05);
  EXPECT_LT(json["upper"]["halves_mm"].get<double>(), 0.1);
  EXPECT_FALSE(json.contains("bite"));
  EXPECT_FALSE(json.contains("lower"));

  const auto alone =
      condyle({"import", "teeth", "--upper", upper, "--lower", lower, "--out", folder / "arches"});
  ASSERT_EQ(alone.code, 0) << alone.err;
  EXPECT_NE(alone.err.find("the scans lie in occlusion"), std::string::npos) << alone.err;
  EXPECT_NE(alone.err.find("Bonwill"), std::string::npos);
  const auto stored = nlohmann::json::parse(read_text(folder / "arches/case.json"));
  EXPECT_EQ(stored["bite"]["rotation"], nlohmann::json({1.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(stored["parts"].size(), 2u);
  const auto bite = condyle({"occlude", folder / "arches", "--json", "--quiet"});
  ASSERT_EQ(bite.code, 0) << bite.err;
  const auto found = nlohmann::json::parse(bite.out);
  EXPECT_EQ(found["start"], "the scanned bite of the case");
  EXPECT_LT(found["moved_from_start_mm"].get<double>(), 0.3);
}

TEST(ImportTeeth, TheMapOfResidualsHoldsExactDistances) {
  const Folder folder;
  ASSERT_EQ(condyle({"phantom", "--variant", "class-iii", "--out", folder / "case"}).code, 0);
  ASSERT_EQ(condyle({"sample", "--out", folder / "sample"}).code, 0);
  const auto done = condyle({"import", "teeth", folder / "case", "--upper",
                             folder / "sample/upper.stl", "--lower", folder / "sample/lower.stl",
                             "--residuals", folder / "map.ply", "--out", folder / "out", "--json"});
  ASSERT_EQ(done.code, 0) << done.err;
  const auto json = nlohmann::json::parse(done.out);
  const TriMesh map = read_mesh(folder / "map.ply");
  EXPECT_EQ(map.colors.size(), map.vertices.size());
  const std::vector<float> distance = distances_in(folder / "map.ply", map.vertices.size());
  const auto vertices_of = [&](const char* arch) {
    return json[arch]["residuals"]["vertices"].get<std::size_t>();
  };
  ASSERT_EQ(vertices_of("upper") + vertices_of("lower"), map.vertices.size());
  const TriMesh upper = read_mesh(folder / "case/upper_teeth.ply"),
                lower = read_mesh(folder / "case/lower_teeth.ply");
  int checked = 0;
  for (std::size_t i = 0; i < distance.size(); i += 397) {
    if (std::isnan(distance[i])) continue;
    ++checked;
    const TriMesh& teeth = i < vertices_of("upper") ? upper : lower;
    EXPECT_NEAR(std::abs(distance[i]), exact_distance(map.vertices[i], teeth), 1e-6);
  }
  EXPECT_GT(checked, 60);
  expect_refusal(condyle({"import", "teeth", "--upper", folder / "sample/upper.stl", "--residuals",
                          folder / "map.ply", "--out", folder / "alone"}),
                 "--residuals needs CASE");
  // What is read, and cases, are safe from the map.
  fs::copy_file(folder / "sample/upper.stl", folder / "upper.stl");
  const std::string scan = read_text(folder / "upper.stl");
  for (const auto& [map_file, words] :
       {std::pair("map.stl", "PLY"), std::pair("absent/map.ply", "no such folder"),
        std::pair("case/face.ply", "folder of a case"), std::pair("new/map.ply", "folder"),
        std::pair("upper.ply", "is read")}) {
    const std::string input = std::string(map_file) == "upper.ply" ? "upper.ply" : "upper.stl";
    if (input == "upper.ply") write_text(folder / input, scan);
    expect_refusal(condyle({"import", "teeth", folder / "case", "--upper", folder / input,
                            "--residuals", folder / map_file, "--out", folder / "new"}),
                   words);
    EXPECT_EQ(read_text(folder / input), scan);
    EXPECT_FALSE(fs::exists(folder / "new"));
  }
}

TEST(ImportTeeth, ASegmentIsPlacedByTheScannedBite) {
  const Folder folder;
  const auto done = [](const std::vector<std::string>& arguments) {
    const Outcome outcome = condyle(arguments);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  };
  const std::string plan = folder / "plan.json", teeth = folder / "teeth";
  done({"sample", "--out", folder / "sample"});
  done({"import", "teeth", "built-in:class-iii", "--upper", folder / "sample/upper.stl", "--lower",
        folder / "sample/lower.stl", "--out", teeth});
  done({"plan", "new", teeth, "--out", plan});
  done({"plan", "cut", plan, "sagittal_split", "--case", teeth, "--below-margins"});
  done({"plan", "occlude", plan, "distal", "--case", teeth, "--scanned-bite"});
  const auto scanned = nlohmann::json::parse(read_text(folder / "teeth/case.json"))["bite"];
  const auto placed = nlohmann::json::parse(read_text(plan))["steps"][1]["move"];
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(placed["translation_mm"][k], scanned["translation_mm"][k].get<double>(), 0.3);
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_NEAR(placed["rotation"][k], scanned["rotation"][k].get<double>(), 0.003);
  EXPECT_GT(placed["translation_mm"][1].get<double>(), 4) << "the lower jaw is set back";

  // Without scans there is none.
  const std::string other = folder / "other.json";
  done({"plan", "new", "built-in:class-iii", "--out", other});
  done({"plan", "cut", other, "sagittal_split", "--below-margins"});
  expect_refusal(condyle({"plan", "occlude", other, "distal", "--scanned-bite"}),
                 "holds no scanned bite");
}

TEST(ImportTeeth, WrongFilesAreRefusedAndNothingIsWritten) {
  const Folder folder;
  write_text(folder / "empty.stl", "");
  write_text(folder / "bytes.ply", "no surface at all");
  const std::string out = folder / "out";
  for (const char* file : {"empty.stl", "bytes.ply", "absent.obj"})
    expect_refusal(condyle({"import", "teeth", "--upper", folder / file, "--out", out}), file);
  expect_refusal(condyle({"import", "teeth", "--out", out}), "--upper or --lower");
  write_box_patient(folder.path());
  expect_refusal(condyle({"import", "teeth", "--upper", folder / "maxilla.stl", "--out", out}),
                 "maxilla.stl");
  expect_refusal(condyle({"import", "teeth", "--lower", folder / "empty.stl", "--upper-points",
                          folder / "marks.csv", "--out", out}),
                 "--upper-points needs --upper");
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace condyle::test
