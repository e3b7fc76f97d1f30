// Depth maps: files, repaired samples, surfaces.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"
#include "engine/mesh_io/picture_files.h"
#include "sim/face_scan/depth_map_files.h"
#include "sim/face_scan/face_scan.h"
#include "tests/support/program.h"

namespace condyle::test {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using nlohmann::json;

/// A vertical cylinder of 80 mm radius, scanned all round.
FaceDepthMap cylinder_map(int width = 180, int height = 60) {
  FaceDepthMap map;
  map.width = map.colour_width = width;
  map.height = map.colour_height = height;
  map.height_mm = 120;
  map.depth_mm.assign(static_cast<std::size_t>(width * height), 80.f);
  map.rgb.assign(map.depth_mm.size() * 3, 100);
  for (std::size_t i = 0; i < map.depth_mm.size(); ++i)
    map.rgb[3 * i] = static_cast<std::uint8_t>(i % static_cast<std::size_t>(width));
  return map;
}

FaceDepthMap plane_map() {
  FaceDepthMap map;
  map.kind = FaceDepthMap::Kind::plane;
  map.width = 40;
  map.height = 30;
  map.pixel_mm = 2;
  for (int row = 0; row < map.height; ++row)
    for (int column = 0; column < map.width; ++column)
      map.depth_mm.push_back(20 + 0.5f * static_cast<float>(column));
  return map;
}

TEST(FaceDepthMap, AFullTurnIsAClosedBandThatFacesOutward) {
  DepthMapRepair repair;
  const TriMesh mesh = surface_of(cylinder_map(), repair);
  const Topology found = inspect(mesh);
  EXPECT_EQ(found.components, 1);
  EXPECT_EQ(found.boundary.size(), 2u) << "an upper and a lower rim";
  EXPECT_EQ(repair.spikes + repair.holes + repair.steep_triangles, 0);
  const auto normals = vertex_normals(mesh);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vector3d out(mesh.vertices[i].x(), mesh.vertices[i].y(), 0);
    EXPECT_NEAR(out.norm(), 80, 1e-4);
    ASSERT_GT(normals[i].dot(out.normalized()), 0.9);
  }
  EXPECT_NEAR(bounding_box(mesh).size().z(), 118, 1e-9);
}

TEST(FaceDepthMap, AngleZeroIsTheNoseAndAnglesRunToTheLeft) {
  const FaceDepthMap map = cylinder_map();
  const double middle = 0.5 * map.width - 0.5, quarter = 0.75 * map.width - 0.5;
  EXPECT_LT((map.place(middle, 0, 80) - Vector3d(0, -80, 59)).norm(), 1e-9);
  EXPECT_LT((map.place(quarter, 59, 80) - Vector3d(80, 0, -59)).norm(), 1e-9);
}

TEST(FaceDepthMap, AScannerThatTurnsTheOtherDirectionGivesTheSameSurface) {
  FaceDepthMap map = cylinder_map();
  std::swap(map.angle_from_deg, map.angle_to_deg);
  DepthMapRepair repair;
  const TriMesh mesh = surface_of(map, repair);
  EXPECT_EQ(repair.steep_triangles, 0);
  const auto normals = vertex_normals(mesh);
  EXPECT_GT(normals[0].dot(Vector3d(mesh.vertices[0].x(), mesh.vertices[0].y(), 0)), 70);
}

TEST(FaceDepthMap, SpikesAreDroppedAndSmallHolesFilled) {
  FaceDepthMap map = cylinder_map();
  const auto at = [&](int column, int row) -> float& {
    return map.depth_mm[static_cast<std::size_t>(row * map.width + column)];
  };
  at(40, 20) = 95;
  at(90, 30) = 60;
  for (int row = 10; row < 14; ++row)  // 4 x 4 samples, about 11 mm; crosses the seam
    for (int column = -2; column < 2; ++column)
      at((column + map.width) % map.width, row) = std::nanf("");
  for (int row = 25; row < 45; ++row)  // 40 mm high
    for (int column = 100; column < 110; ++column) at(column, row) = std::nanf("");
  DepthMapRepair repair;
  const TriMesh mesh = surface_of(map, repair);
  EXPECT_EQ(repair.spikes, 2);
  EXPECT_EQ(repair.holes, 3) << "two spikes and the small hole";
  EXPECT_EQ(repair.filled_samples, 18);
  EXPECT_EQ(inspect(mesh).boundary.size(), 3u) << "the large hole stays";
  for (const auto& v : mesh.vertices) EXPECT_NEAR(std::hypot(v.x(), v.y()), 80, 0.01);
}

TEST(FaceDepthMap, AStepInDepthIsNoSurface) {
  FaceDepthMap map = plane_map();
  for (int row = 0; row < map.height; ++row)
    for (int column = 20; column < map.width; ++column)
      map.depth_mm[static_cast<std::size_t>(row * map.width + column)] += 60;
  DepthMapRepair repair;
  const TriMesh mesh = surface_of(map, repair);
  EXPECT_EQ(inspect(mesh).components, 2);
  EXPECT_EQ(repair.steep_triangles, 2 * (map.height - 1));
}

class DepthMapFiles : public testing::Test {
 protected:
  Folder folder_;
  fs::path file_ = folder_ / "laser.json";

  json description() { return json::parse(read_file(file_)); }
  void write(const json& text) { write_file(file_, text.dump()); }
  std::string refusal() {
    try {
      read_depth_map(file_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "was read";
  }
  void expect_refused(const char* key, const json& value, const char* words) {
    json changed = description();
    const json before = changed;
    changed[key] = value;
    write(changed);
    EXPECT_NE(refusal().find(words), std::string::npos) << key << ": " << refusal();
    EXPECT_NE(refusal().find(folder_.path().string()), std::string::npos);
    write(before);
  }
};

TEST_F(DepthMapFiles, WhatIsWrittenIsRead) {
  for (FaceDepthMap map : {cylinder_map(), plane_map()}) {
    map.depth_mm[7] = std::nanf("");
    write_depth_map(map, file_);
    const FaceDepthMap read = read_depth_map(file_);
    ASSERT_EQ(read.depth_mm.size(), map.depth_mm.size());
    for (std::size_t i = 0; i < map.depth_mm.size(); ++i) {
      EXPECT_EQ(std::isnan(read.depth_mm[i]), i == 7);
      if (i == 7) continue;
      ASSERT_NEAR(read.depth_mm[i], map.depth_mm[i], 0.0051);
    }
    EXPECT_EQ(read.rgb, map.rgb);
    EXPECT_EQ(read.kind, map.kind);
    EXPECT_LT((read.place(3, 4, 50) - map.place(3, 4, 50)).norm(), 1e-9);
  }
}

TEST_F(DepthMapFiles, DescriptionsThatAreWrongAreRefused) {
  write_depth_map(cylinder_map(), file_);
  expect_refused("kind", "sphere", "cylinder or plane");
  expect_refused("unit_mm", 0, "unit_mm");
  expect_refused("unit_mm", 100, "mm of the number");
  expect_refused("angle_to_deg", -180, "1 to 360");
  expect_refused("angle_to_deg", 300, "1 to 360");
  expect_refused("height_mm", "tall", "height_mm");
  expect_refused("pixel_mm", 1, "pixel_mm");
  expect_refused("depth", "../laser-depth.png", "file beside");
  expect_refused("depth", "missing.png", "missing.png");
  expect_refused("ofset_mm", 1, "ofset_mm");
  write_file(file_, "{");
  EXPECT_NE(refusal(), "was read");
  write_file(file_, "");
  EXPECT_NE(refusal(), "was read");
}

TEST_F(DepthMapFiles, PicturesThatDoNotFitAreRefused) {
  write_depth_map(cylinder_map(), file_);
  const fs::path depth = folder_ / "laser-depth.png", colour = folder_ / "laser-colour.png";
  const std::string bytes = read_file(depth);
  write_picture(ColourPicture{30, 20, std::vector<std::uint8_t>(1800, 9)}, colour);
  EXPECT_NE(refusal().find("30 x 20"), std::string::npos) << refusal();
  write_picture(ColourPicture{180, 60, std::vector<std::uint8_t>(32400, 9)}, depth);
  EXPECT_NE(refusal().find("16 bits"), std::string::npos) << refusal();
  write_file(depth, bytes.substr(0, bytes.size() / 2));
  EXPECT_NE(refusal().find("damaged"), std::string::npos) << refusal();
  write_file(depth, "no picture");
  EXPECT_NE(refusal().find("laser-depth.png"), std::string::npos) << refusal();
}

TEST_F(DepthMapFiles, ColoursMayBeFiner) {
  FaceDepthMap map = cylinder_map();
  map.colour_width *= 2;
  map.colour_height *= 2;
  map.rgb.assign(map.rgb.size() * 4, 200);
  write_depth_map(map, file_);
  DepthMapRepair repair;
  const TriMesh mesh = surface_of(read_depth_map(file_), repair);
  ASSERT_EQ(mesh.colors.size(), mesh.vertices.size());
  EXPECT_NEAR(mesh.colors[5].y(), 200 / 255.0, 1e-6);
}

TEST_F(DepthMapFiles, AMapWithoutADepthIsNoFace) {
  FaceDepthMap map = cylinder_map();
  for (float& depth : map.depth_mm) depth = std::nanf("");
  write_depth_map(map, file_);
  EXPECT_THROW(read_face_scan(file_), InputError);
}

}  // namespace
}  // namespace condyle::test
