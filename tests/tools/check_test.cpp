// `condyle check` as people use it.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/tools/pose_file.h"

namespace condyle::test {
namespace {

namespace fs = std::filesystem;

std::map<std::string, std::string> files_of(const fs::path& folder) {
  std::map<std::string, std::string> all;
  for (const auto& entry : fs::directory_iterator(folder))
    all[entry.path().filename().string()] = read_text(entry.path());
  return all;
}

/// Straight up within a second.
std::string bite(const Folder& folder, double height_mm) {
  const std::string motion = folder / ("bite" + std::to_string(height_mm) + ".csv");
  write_text(motion,
             pose_header + "0,0,0,0,1,0,0,0\n1,0,0," + std::to_string(height_mm) + ",1,0,0,0\n");
  return motion;
}

}  // namespace

TEST(Check, ExitCodeReportsAViolation) {
  const Folder folder;
  const std::string patient = box_case(folder), motion = folder / "bite.csv";
  write_text(motion, pose_header + "0,0,0,0,1,0,0,0\n1,0,0,6,1,0,0,0\n");
  EXPECT_EQ(
      condyle({"check", patient, "--motion", motion, "--frames", "7", "--out", folder / "out"})
          .code,
      3);
  const auto report = nlohmann::json::parse(read_text(folder / "out/report.json"));
  EXPECT_TRUE(report["violation"].get<bool>());
  EXPECT_TRUE(fs::exists(folder / "out/pairs.csv"));
  const std::string page = read_text(folder / "out/report.html");
  EXPECT_NE(page.find("Violation."), std::string::npos);
  EXPECT_NE(page.find("--pair maxilla,mandible,allowed lets them touch"), std::string::npos);
  EXPECT_NE(page.find(read_text(folder / "out/clearance.svg")), std::string::npos);
  const auto worst = report["pairs"][0]["worst"];
  EXPECT_NEAR(worst["penetration_volume_mm3"].get<double>(), 60 * 50 * 5, 150);
  EXPECT_EQ(worst["patches"], 1);
  write_text(motion, pose_header + "0,0,0,0,1,0,0,0\n1,0,0,-6,1,0,0,0\n");
  EXPECT_EQ(condyle({"check", patient, "--motion", motion}).code, 0);
  EXPECT_EQ(condyle({"check", patient, "--motion", motion, "--margin", "1.5"}).code, 3);
}

TEST(Check, DrawsTheWorstFrameAndWithoutEglSaysThatItCannot) {
  const Folder folder;
  const std::string patient = box_case(folder), motion = folder / "bite.csv";
  write_text(motion, pose_header + "0,0,0,0,1,0,0,0\n0.1,0,0,3,1,0,0,0\n");
  const auto picture = [&](const std::string& out) {
    return fs::exists(folder / (out + "/worst-maxilla-mandible.png"));
  };
  ASSERT_EQ(condyle({"check", patient, "--motion", motion, "--out", folder / "drawn"}).code, 3);
  const std::string page = read_text(folder / "drawn/report.html");
  if (picture("drawn"))
    EXPECT_NE(page.find("src=\"worst-maxilla-mandible.png\""), std::string::npos);
  else
    EXPECT_NE(page.find("pictures are left out"), std::string::npos);
  // Nonexistent vendors leave EGL without a driver.
  ::setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere.json", 1);
  const auto without_egl =
      condyle({"check", patient, "--motion", motion, "--out", folder / "blind"});
  ::unsetenv("__EGL_VENDOR_LIBRARY_FILENAMES");
  EXPECT_EQ(without_egl.code, 3);
  EXPECT_FALSE(picture("blind"));
  EXPECT_NE(without_egl.err.find("pictures are left out"), std::string::npos) << without_egl.err;
  EXPECT_NE(read_text(folder / "blind/report.html").find("pictures are left out"),
            std::string::npos);
}

TEST(Check, ChecksTheEndOfAMotionShorterThanAStep) {
  const Folder folder;
  const std::string patient = box_case(folder), motion = folder / "quick.csv";
  write_text(motion, pose_header + "0,0,0,0,1,0,0,0\n0.004,0,0,6,1,0,0,0\n");
  EXPECT_EQ(condyle({"check", patient, "--motion", motion}).code, 3);
}

TEST(Check, RulesOfPairsDecide) {
  const Folder folder;
  const std::string patient = box_case(folder);
  const auto code = [&](double height_mm, const std::string& rule) {
    return condyle({"check", patient, "--motion", bite(folder, height_mm), "--frames", "5",
                    "--margin", "0.8", "--pair", rule})
        .code;
  };
  EXPECT_EQ(code(1.01, "maxilla,mandible,allowed"), 0);
  EXPECT_EQ(code(1.5, "maxilla,mandible,allowed"), 3);
  EXPECT_EQ(code(0.5, "*,mandible,guided,gap=0.4"), 0);
  EXPECT_EQ(code(0.7, "*,mandible,guided,gap=0.4"), 3);
  EXPECT_EQ(code(0.5, "maxilla,*,forbidden,margin=0.4"), 0);
  EXPECT_EQ(code(0.5, "maxilla,*,forbidden"), 3);
}

TEST(Check, FramesAreThoseRequestedAndAJumpBetweenTwoIsDetected) {
  const Folder folder;
  const std::string patient = box_case(folder);
  const auto frames = [&](const std::vector<std::string>& options) {
    std::vector<std::string> command = {"check", patient, "--motion", bite(folder, -6), "--json"};
    command.insert(command.end(), options.begin(), options.end());
    return nlohmann::json::parse(condyle(command).out)["frames"].get<int>();
  };
  EXPECT_EQ(frames({}), 31);
  EXPECT_EQ(frames({"--fps", "10"}), 11);
  EXPECT_EQ(frames({"--frames", "7"}), 7);
  // Right through the maxilla and out above, in one frame.
  const auto through = condyle(
      {"check", patient, "--motion", bite(folder, 250), "--frames", "2", "--json", "--quiet"});
  EXPECT_EQ(through.code, 3);
  const auto pair = nlohmann::json::parse(through.out)["pairs"][0];
  EXPECT_EQ(pair["touching_frames"], 0);
  EXPECT_TRUE(pair["first_contact"]["between_frames"].get<bool>());
  EXPECT_NEAR(pair["first_contact"]["time_s"].get<double>(), 1.0 / 250, 0.03 / 250);
}

TEST(Check, ATransplantThatOverlapsItsBoneAtRestIsReportedAndDrawn) {
  const Folder folder;
  write_box_patient(folder.path());
  // A block that reaches 1 mm into the mandible's upper face.
  write_text(folder / "graft.obj",
             "v 35 -60 -42\nv 45 -60 -42\nv 35 -50 -42\nv 45 -50 -42\n"
             "v 35 -60 -32\nv 45 -60 -32\nv 35 -50 -32\nv 45 -50 -32\n"
             "f 1 3 2\nf 2 3 4\nf 5 6 7\nf 6 8 7\nf 1 2 5\nf 2 6 5\nf 3 7 4\nf 4 7 8\n"
             "f 1 5 3\nf 3 5 7\nf 2 4 6\nf 4 8 6\n");
  const std::string patient = folder / "grafted";
  const auto import =
      condyle({"import", "meshes", "--maxilla", folder / "maxilla.stl", "--mandible",
               folder / "mandible.stl", "--transplant", folder / "graft.obj", "--landmarks",
               folder / "marks.csv", "--out", patient});
  ASSERT_EQ(import.code, 0) << import.err;
  const auto outcome = condyle(
      {"check", patient, "--motion", bite(folder, -20), "--frames", "3", "--out", folder / "out"});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  const auto report = nlohmann::json::parse(read_text(folder / "out/report.json"));
  int expected = 0;
  for (const auto& pair : report["pairs"]) {
    const bool own = pair["a"] == "mandible";
    EXPECT_EQ(pair["violation_at_rest"].get<bool>(), own);
    EXPECT_FALSE(pair["penetrates"].get<bool>());
    if (!own) continue;
    ++expected;
    EXPECT_EQ(pair["policy"], "cut-face");
    EXPECT_NEAR(pair["overlap_at_rest_mm"].get<double>(), 1, 1e-6);
    EXPECT_NEAR(pair["worst"]["penetration_volume_mm3"].get<double>(), 100, 1);
    // A millimetre up separates them.
    EXPECT_NEAR(pair["push_out"][2].get<double>(), 1, 0.03);
    EXPECT_NEAR(pair["push_out"][0].get<double>(), 0, 0.1);
    EXPECT_NE(read_text(folder / "out/report.html").find("separates the two"), std::string::npos);
    const std::string page = read_text(folder / "out/report.html");
    const bool without_egl = page.find("pictures are left out") != std::string::npos;
    EXPECT_EQ(pair["worst"].contains("picture"), !without_egl);
    if (!without_egl) {
      EXPECT_TRUE(fs::exists(folder.path() / "out" / pair["worst"]["picture"].get<std::string>()));
    }
  }
  EXPECT_EQ(expected, 1);
}

TEST(Check, BadRulesAndNumbersAreRefusedBeforeAnythingIsWritten) {
  const Folder folder;
  const std::string patient = box_case(folder), out = folder / "out";
  const auto refused = [&](const std::string& option, const std::string& value,
                           const std::vector<std::string>& expected) {
    const auto outcome = condyle({"check", patient, "--out", out, option, value});
    EXPECT_EQ(outcome.code, 2) << option << " " << value << "\n" << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    for (const auto& word : expected)
      EXPECT_NE(outcome.err.find(word), std::string::npos) << word << "\n" << outcome.err;
    EXPECT_FALSE(fs::exists(out + "/report.json"));
    EXPECT_FALSE(fs::exists(out + "/.new.part"));
  };
  refused("--pair", "maxila,mandible,forbidden", {"maxila", "maxilla"});
  refused("--pair", "maxilla,mandible,perhaps", {"perhaps", "forbidden"});
  refused("--pair", "maxilla,mandible,guided,gap=-1", {"-1"});
  refused("--pair", "maxilla,mandible,forbidden,margin=nan", {"nan"});
  refused("--pair", "mandible,mandible,forbidden", {"two different parts"});
  refused("--pair", "maxilla,mandible,allowed,gap=1", {"only guided pairs"});
  refused("--pair", "maxilla,mandible,cut-face,margin=2", {"only forbidden pairs"});
  refused("--margin", "-0.5", {"--margin", "-0.5"});
  refused("--margin", "nan", {"--margin", "nan"});
  refused("--frames", "0", {"--frames", "0"});
  refused("--fps", "-3", {"--fps", "-3"});
  const std::string motion = folder / "nan.csv";
  write_text(motion, pose_header + "0,0,0,0,1,0,0,0\n1,0,nan,0,1,0,0,0\n");
  refused("--motion", motion, {"nan.csv", "line 3", "nan"});
}

TEST(Check, AFullDiskOrAFileInTheWayLeavesTheEarlierReportWhole) {
  const Folder folder;
  const std::string patient = box_case(folder), out = folder / "out";
  ASSERT_EQ(
      condyle({"check", patient, "--motion", bite(folder, 2), "--frames", "3", "--out", out}).code,
      3);
  const auto before = files_of(out);
  ASSERT_TRUE(before.contains("report.html"));
  const auto full =
      condyle({"check", patient, "--motion", bite(folder, 3), "--frames", "4", "--out", out},
              {.file_mb = 0});
  EXPECT_EQ(full.code, 1) << full.err;
  EXPECT_EQ(files_of(out), before);
  write_text(folder / "file", "in the way");
  for (const std::string& nowhere : {folder / "file", std::string("/proc/nowhere")}) {
    const auto outcome = condyle({"check", patient, "--motion", "rest", "--out", nowhere});
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find(nowhere), std::string::npos) << outcome.err;
  }
}

TEST(Check, KilledWhileItWritesTheEarlierReportStaysWhole) {
  const Folder folder;
  const std::string patient = box_case(folder), out = folder / "out";
  const std::vector<std::string> command = {"check",    patient, "--motion", bite(folder, 3),
                                            "--frames", "21",    "--out",    out};
  ASSERT_EQ(
      condyle({"check", patient, "--motion", bite(folder, 2), "--frames", "3", "--out", out}).code,
      3);
  const auto before = files_of(out);
  // As soon as the folder for the new files exists: long before they are complete.
  const auto killed =
      condyle(command, {.kill_when = [&] { return fs::exists(out + "/.new.part"); }});
  EXPECT_NE(killed.code, 3);
  auto after = files_of(out);
  after.erase(".new.part");
  EXPECT_EQ(after, before);
  EXPECT_EQ(condyle(command).code, 3);
  EXPECT_FALSE(fs::exists(out + "/.new.part"));
  EXPECT_NE(files_of(out).at("report.json"), before.at("report.json"));
}

TEST(Check, PicturesOfAnEarlierCheckGoWithIt) {
  const Folder folder;
  const std::string patient = box_case(folder), out = folder / "out";
  fs::create_directory(out);
  write_text(out + "/worst-skull-mandible.png", "of another patient");
  write_text(out + "/notes.txt", "somebody's own");
  EXPECT_EQ(condyle({"check", patient, "--motion", "rest", "--out", out}).code, 0);
  EXPECT_FALSE(fs::exists(out + "/worst-skull-mandible.png"));
  EXPECT_EQ(read_text(out + "/notes.txt"), "somebody's own");
}

}  // namespace condyle::test
