// The demonstrations, as a user runs them.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace fs = std::filesystem;

namespace condyle::test {
namespace {

/// Runs a demonstration and returns its report.json.
nlohmann::json demo(const std::string& name, const std::string& out) {
  const Outcome outcome = condyle({"demo", name, "--out", out});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  for (const char* file : {"plan.json", "report.html", "segments.png", "case/case.json"})
    EXPECT_TRUE(fs::exists(fs::path(out) / file)) << file;
  return nlohmann::json::parse(read_text(out + "/report.json"));
}

void expect_closed(const nlohmann::json& report, std::size_t segments) {
  ASSERT_EQ(report["segments"].size(), segments);
  for (const auto& segment : report["segments"]) {
    EXPECT_TRUE(segment["closed"].get<bool>()) << segment["name"];
    EXPECT_GT(segment["volume_mm3"].get<double>(), 1000);
    EXPECT_FALSE(segment["parent"].get<std::string>().empty());
  }
  EXPECT_LT(report["volume_error_percent"].get<double>(), 1e-4);
}

}  // namespace

TEST(DemoCommand, ClassThreeEndsInANormalBite) {
  const Folder folder;
  const std::string out = folder / "out";
  const auto report = demo("class-iii", out);
  expect_closed(report, 4);
  const auto& bite = report["bite"];
  EXPECT_TRUE(bite["stable"].get<bool>());
  EXPECT_GE(bite["contacts"].get<int>(), 6);
  EXPECT_NEAR(bite["overjet_mm"].get<double>(), 2.5, 1);
  EXPECT_NEAR(bite["overbite_mm"].get<double>(), 2.5, 1);
  EXPECT_NEAR(bite["lower_arch_setback_mm"].get<double>(), 5, 2);
  const auto& face = report["prediction"];
  EXPECT_LT(face["unsettled_mm"].get<double>(), 0.1);
  EXPECT_EQ(face["inverted_prisms"].get<int>(), 0);
  // No part of the face moves farther than the bone that moves most.
  EXPECT_LT(face["max_displacement_mm"].get<double>(), 12);
  for (const char* file : {"arches.png", "face.png", "face_after.ply"})
    EXPECT_TRUE(fs::exists(fs::path(out) / file)) << file;
}

TEST(DemoCommand, TheVaultBecomesBroader) {
  const Folder folder;
  const auto report = demo("vault", folder / "out");
  expect_closed(report, 5);
  const auto& vault = report["vault"];
  EXPECT_LT(vault["before"]["cephalic_index"].get<double>(), 70);
  EXPECT_GT(vault["after"]["cephalic_index"].get<double>(),
            vault["before"]["cephalic_index"].get<double>() + 5);
  const double whole = vault["bone_volume_before_mm3"].get<double>();
  EXPECT_NEAR(vault["bone_volume_after_mm3"].get<double>() + vault["kerf_volume_mm3"].get<double>(),
              whole, 1e-6 * whole);
}

TEST(DemoCommand, AFibulaTakesThePlaceOfAResectedJaw) {
  const Folder folder;
  const std::string out = folder / "out";
  const auto report = demo("fibula", out);
  const auto& graft = report["grafts"].at(0);
  ASSERT_EQ(graft["pieces"].size(), 3u);
  for (const auto& piece : graft["pieces"]) {
    EXPECT_TRUE(piece["closed"].get<bool>());
    EXPECT_GE(piece["length_mm"].get<double>(), 20);  // shorter ones may lose their blood supply
  }
  EXPECT_TRUE(graft["warnings"].empty()) << graft["warnings"];
  for (const auto& face : graft["faces"]) EXPECT_EQ(face["level"], "good") << face;
  EXPECT_EQ(graft["insertion_path"]["state"], "free");
  EXPECT_GT(report["opening"]["widest_mm"].get<double>(), 40);
  const std::string page = read_text(out + "/report.html");
  for (const char* words : {"Resected: tumour", "Insertion path", "Mouth opening", "fibula_3"})
    EXPECT_NE(page.find(words), std::string::npos) << words;
  EXPECT_EQ(page.find("<td>L1</td>"), std::string::npos);
  for (const char* file : {"insertion_path.png", "opening.png"})
    EXPECT_TRUE(fs::exists(fs::path(out) / file)) << file;
}

TEST(DemoCommand, AnUnknownNameAndAForeignOptionHaveExitCode2) {
  const Folder folder;
  const Outcome unknown = condyle({"demo", "class-ii", "--out", folder / "out"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_NE(unknown.err.find("class-iii"), std::string::npos) << unknown.err;
  const Outcome foreign =
      condyle({"demo", "genioplasty", "--skull", "x.ply", "--out", folder / "out"});
  EXPECT_EQ(foreign.code, 2);
  EXPECT_NE(foreign.err.find("--skull"), std::string::npos) << foreign.err;
  EXPECT_FALSE(fs::exists(folder / "out"));
}

}  // namespace condyle::test
