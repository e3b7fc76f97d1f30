// From the files of the virtual scanners to an opening mouth, compared with the truth beside them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "engine/mesh/triangle_tree.h"
#include "engine/mesh_io/mesh_files.h"
#include "tests/support/program.h"

namespace condyle::test {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using nlohmann::json;

/// The incisal path of a run, a point for each frame.
std::vector<Vector3d> incisal_path(const fs::path& trace) {
  std::istringstream lines(read_text(trace));
  std::string line;
  std::getline(lines, line);
  const auto cells = [](const std::string& row) {
    std::vector<std::string> found;
    std::istringstream text(row);
    for (std::string cell; std::getline(text, cell, ',');) found.push_back(cell);
    return found;
  };
  const auto names = cells(line);
  const auto first = static_cast<std::size_t>(
      std::find(names.begin(), names.end(), "incisor_x_mm") - names.begin());
  std::vector<Vector3d> path;
  while (std::getline(lines, line)) {
    const auto row = cells(line);
    path.emplace_back(std::stod(row.at(first)), std::stod(row.at(first + 1)),
                      std::stod(row.at(first + 2)));
  }
  return path;
}

double median_distance(const fs::path& found, const fs::path& truth, double least_z) {
  const TriangleTree tree(read_mesh(truth));
  const TriMesh mesh = read_mesh(found);
  std::vector<double> distances;
  for (std::size_t i = 0; i < mesh.vertices.size(); i += 20)
    if (mesh.vertices[i].z() > least_z && mesh.vertices[i].y() < -40)
      distances.push_back(tree.nearest(mesh.vertices[i]).distance);
  std::sort(distances.begin(), distances.end());
  return distances.at(distances.size() / 2);
}

TEST(ImportFace, ScansOfTheBuiltInPatientBecomeAPatientWhoOpensAlike) {
  const Folder folder;
  const std::string scans = folder / "scans";
  Outcome done = condyle({"phantom", "--scan", "all", "--out", scans});
  ASSERT_EQ(done.code, 0) << done.err;
  for (const char* name :
       {"ct.nrrd", "ct/slice-0001.dcm", "ct-landmarks.csv", "laser.json", "laser-depth.png",
        "laser-colour.png", "laser-landmarks.csv", "truth/case.json", "truth-laser-pose.csv"})
    EXPECT_TRUE(fs::exists(fs::path(scans) / name)) << name;
  done = condyle({"import", "ct", scans + "/ct", "--out", folder / "head"});
  ASSERT_EQ(done.code, 0) << done.err;
  done = condyle({"--json", "import", "face", scans + "/laser.json", "--case", folder / "head",
                  "--landmarks", scans + "/laser-landmarks.csv", "--residuals",
                  folder / "residuals.ply", "--out", folder / "patient"});
  ASSERT_EQ(done.code, 0) << done.err;
  const json found = json::parse(done.out)["registration"];
  EXPECT_LT(double(found["median_mm"]), 0.2);
  EXPECT_LT(double(found["p95_mm"]), 0.8);
  EXPECT_LT(double(found["target_rms_mm"]), 2);
  EXPECT_FALSE(read_mesh(folder / "residuals.ply").colors.empty());
  EXPECT_LT(median_distance(fs::path(folder / "patient") / "face.ply",
                            fs::path(scans) / "truth/face.ply", -60),
            0.3);
  const auto opened_by = [&](const std::string& patient, const std::string& out) {
    done = condyle({"run", patient, "--motion", "open 40", "--no-tissue", "--out", out});
    EXPECT_EQ(done.code, 0) << done.err;
    return incisal_path(fs::path(out) / "trace.csv");
  };
  const auto truth = opened_by(scans + "/truth", folder / "opened-truth");
  const auto opened = opened_by(folder / "patient", folder / "opened");
  ASSERT_EQ(truth.size(), opened.size());
  double most = 0;
  for (std::size_t i = 0; i < truth.size(); ++i)
    most = std::max(most, (truth[i] - opened[i]).norm());
  EXPECT_LT(most, 0.5);
}

TEST(ImportFace, AFaceAloneBecomesACase) {
  const Folder folder;
  Outcome done = condyle({"phantom", "--scan", "laser", "--out", folder / "scans"});
  ASSERT_EQ(done.code, 0) << done.err;
  done = condyle({"import", "face", folder / "scans/laser.json", "--out", folder / "face"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_NE(done.err.find("condyle view"), std::string::npos);
  done = condyle({"info", folder / "face"});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_NE(done.out.find("face"), std::string::npos) << done.out;
}

TEST(ImportFace, WrongInputIsRefused) {
  const Folder folder;
  const auto expect_refused = [&](const std::vector<std::string>& arguments, const char* words) {
    const Outcome done = condyle(arguments);
    EXPECT_EQ(done.code, 2) << done.err;
    EXPECT_NE(done.err.find(words), std::string::npos) << done.err;
    EXPECT_FALSE(fs::exists(folder / "out"));
  };
  write_text(folder / "empty.json", "");
  write_text(folder / "bytes.ply", "no surface");
  expect_refused({"import", "face", folder / "empty.json", "--out", folder / "out"}, "empty.json");
  expect_refused({"import", "face", folder / "bytes.ply", "--out", folder / "out"}, "bytes.ply");
  expect_refused({"import", "face", folder / "missing.json", "--out", folder / "out"},
                 "missing.json");
  expect_refused({"phantom", "--scan", "ct", "--voxel", "9", "--out", folder / "out"}, "--voxel");
  expect_refused({"phantom", "--scan", "mri", "--out", folder / "out"}, "--scan");
  fs::create_directory(folder / "full");
  write_text(folder / "full/file.txt", "mine");
  expect_refused({"phantom", "--scan", "laser", "--out", folder / "full"}, "new or an empty");
  EXPECT_TRUE(fs::exists(folder / "full/file.txt"));
}

}  // namespace
}  // namespace condyle::test
