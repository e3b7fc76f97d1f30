// `import ct` and `info` on folders of DICOM files and on volumes.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>

#include "engine/core/files.h"
#include "engine/dicom/write_ct_series.h"
#include "engine/volume/volume_files.h"
#include "tests/support/program.h"
#include "tests/support/real_cases.h"

namespace condyle::test {
namespace {

namespace fs = std::filesystem;

Volume scanned_block() {
  Volume volume;
  volume.size = {40, 30, 12};
  volume.spacing_mm = {0.4, 0.5, 1.25};
  volume.origin = {-8, -7.5, 3};
  for (int i = 0; i < 40 * 30 * 12; ++i)
    volume.values.push_back(static_cast<std::int16_t>((i * 37) % 3000 - 1000));
  return volume;
}

void expect_one_line(const Outcome& outcome, const std::string& words) {
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
}

TEST(ImportCt, SeriesAreListedAndReadIntoAVolume) {
  const Folder folder;
  const Volume block = scanned_block();
  write_ct_series(block, folder.path() / "scan" / "one", {.kernel = "BONE"});
  Volume thick = block;
  thick.spacing_mm.z() = 5;
  write_ct_series(thick, folder.path() / "scan" / "two", {.series_number = 2});
  const std::string scan = folder / "scan", out = folder / "volume.nrrd";

  const auto list = condyle({"import", "ct", scan, "--list", "--json"});
  ASSERT_EQ(list.code, 0) << list.err;
  const auto json = nlohmann::json::parse(list.out);
  ASSERT_EQ(json["series"].size(), 2u);
  EXPECT_EQ(json["default"], 1);
  EXPECT_EQ(json["series"][0]["kernel"], "BONE");
  EXPECT_EQ(json["series"][1]["spacing_mm"], nlohmann::json({0.4, 0.5, 5.0}));
  EXPECT_EQ(condyle({"info", scan, "--json"}).out, list.out);
  const auto text = condyle({"import", "ct", scan, "--list"});
  EXPECT_NE(text.out.find("*  1  CT, 12 slices of 40 x 30"), std::string::npos) << text.out;
  EXPECT_EQ(text.out.find("slice-0001"), std::string::npos) << text.out;

  const auto read = condyle({"import", "ct", scan, "--volume-out", out});
  ASSERT_EQ(read.code, 0) << read.err;
  const Volume volume = read_volume(out);
  EXPECT_EQ(volume.values, block.values);
  EXPECT_LT((volume.spacing_mm - block.spacing_mm).norm(), 1e-9);
  EXPECT_LT((volume.origin - block.origin).norm(), 1e-9);
  // A volume is read, too.
  ASSERT_EQ(condyle({"import", "ct", out, "--volume-out", folder / "again.nrrd"}).code, 0);
  EXPECT_EQ(read_text(folder / "again.nrrd"), read_text(out));
  ASSERT_EQ(condyle({"import", "ct", scan, "--series", "2", "--volume-out", out}).code, 0);
  EXPECT_NEAR(read_volume(out).spacing_mm.z(), 5, 1e-9);
}

TEST(ImportCt, GapsAreRefusedAndResampledWhenAsked) {
  const Folder folder;
  write_ct_series(scanned_block(), folder.path() / "scan");
  fs::remove(folder.path() / "scan" / "slice-0005.dcm");
  const std::string scan = folder / "scan", out = folder / "volume.nrrd";
  expect_one_line(condyle({"import", "ct", scan, "--volume-out", out}),
                  "a slice is missing between slices 4 and 5, at 3.75 and 6.25 mm");
  EXPECT_FALSE(fs::exists(out));
  const auto resampled = condyle({"import", "ct", scan, "--resample", "--volume-out", out});
  EXPECT_EQ(resampled.code, 0) << resampled.err;
  EXPECT_NE(resampled.err.find("resampled at a step of 1.25 mm"), std::string::npos);
  EXPECT_EQ(read_volume(out).size[2], 12);
}

TEST(ImportCt, BadInputIsRefusedInOneLine) {
  const Folder folder;
  write_ct_series(scanned_block(), folder.path() / "scan");
  const std::string scan = folder / "scan", out = folder / "volume.nrrd";
  expect_one_line(condyle({"import", "ct", scan}), "needs --out FOLDER");
  expect_one_line(condyle({"import", "ct", scan, "--out", folder / "case"}), scan + ": ");
  expect_one_line(condyle({"import", "ct", scan, "--volume-out", folder / "a.txt"}), ".nrrd");
  expect_one_line(condyle({"import", "ct", folder / "absent", "--volume-out", out}),
                  "no such file");
  expect_one_line(condyle({"import", "ct", scan, "--series", "2", "--volume-out", out}),
                  "series 2: does not exist; there are 1");
  expect_one_line(condyle({"import", "ct", scan + "/slice-0003.dcm", "--volume-out", out}),
                  "name its folder");
  fs::resize_file(folder.path() / "scan" / "slice-0003.dcm", 1500);
  const auto cut = condyle({"import", "ct", scan, "--volume-out", out});
  expect_one_line(cut, "file 3 of 12 states 40 x 30 pixels");
  EXPECT_EQ(cut.err.find("slice-0003"), std::string::npos) << cut.err;
  fs::create_directory(folder.path() / "empty");
  expect_one_line(condyle({"import", "ct", folder / "empty", "--volume-out", out}),
                  "holds no DICOM image");
  EXPECT_FALSE(fs::exists(out));
  EXPECT_FALSE(fs::exists(folder.path() / "case"));
}

TEST(ImportCt, ARealHeadWithFillingsOpensItsMouth) {
  const fs::path scan = real_data() / "ct-head" / "head_ct.nrrd";
  if (!fs::exists(scan)) GTEST_SKIP() << "real anatomy absent";
  const Folder folder;
  const std::string patient = folder / "head";
  const auto made = condyle({"import", "ct", scan.string(), "--out", patient});
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_NE(made.err.find("metal artifacts were reduced"), std::string::npos) << made.err;
  // Read off the slices in which the lower incisors are seen apart, 2 mm thick.
  const std::string marks = read_file(patient + "/landmarks.csv");
  std::smatch edge;
  ASSERT_TRUE(std::regex_search(
      marks, edge, std::regex("lower_incisal_point,([-0-9.]+),([-0-9.]+),([-0-9.]+)")));
  EXPECT_NEAR(std::stod(edge[2]), -101, 4);
  EXPECT_NEAR(std::stod(edge[3]), -21, 4);
  const auto checked = condyle({"check", patient, "--motion", "open"});
  ASSERT_EQ(checked.code, 0) << checked.err;  // bones never overlap
  std::smatch opening;
  ASSERT_TRUE(std::regex_search(checked.err, opening, std::regex("maximum opening ([0-9.]+) mm")))
      << checked.err;
  EXPECT_GT(std::stod(opening[1]), 40);
  // Under its own skin, which is rough and marked by a bandage.
  const auto opened =
      condyle({"run", patient, "--motion", "open 40", "--frames", "4", "--out", folder / "opened"});
  ASSERT_EQ(opened.code, 0) << opened.err;
  EXPECT_TRUE(fs::exists(folder / "opened/trace.csv"));
  // With a Le Fort I on it.
  const std::string plan = folder / "plan.json";
  for (const std::vector<std::string>& step :
       {std::vector<std::string>{"plan", "new", patient, "--out", plan},
        {"plan", "cut", plan, "le_fort_1", "--case", patient},
        {"plan", "move", plan, "maxilla", "forward", "4", "--case", patient},
        {"run", patient, "--plan", plan, "--motion", "open 20", "--frames", "2", "--out",
         folder / "planned"}}) {
    const auto done = condyle(step);
    ASSERT_EQ(done.code, 0) << done.err;
  }
}

TEST(ImportCt, ARealHeadWithoutALowerJawIsReportedAndViewed) {
  const fs::path scan = real_data() / "ct-cranium" / "cranium_ct.nrrd";
  if (!fs::exists(scan)) GTEST_SKIP() << "real anatomy absent";
  const Folder folder;
  const std::string patient = folder / "cranium";
  const auto made = condyle({"import", "ct", scan.string(), "--out", patient});
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_NE(made.err.find("no lower jaw"), std::string::npos) << made.err;
  EXPECT_TRUE(fs::exists(patient + "/skull.ply"));
  EXPECT_FALSE(fs::exists(patient + "/mandible.ply"));
  EXPECT_EQ(condyle({"info", patient}).code, 0);
  const auto moved =
      condyle({"run", patient, "--motion", "open", "--out", folder / "moved", "--no-tissue"});
  EXPECT_EQ(moved.code, 2);
  EXPECT_NE(moved.err.find("mandible"), std::string::npos) << moved.err;
}

}  // namespace
}  // namespace condyle::test
