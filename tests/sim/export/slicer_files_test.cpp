#include "sim/export/slicer_files.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <sstream>

#include "engine/core/files.h"
#include "engine/core/temporary_path.h"
#include "sim/case/landmark_files.h"

namespace condyle {
namespace {

/// What 3D Slicer does with a transform file: reads matrix and translation, and inverts them, since
/// the file maps from the parent.
Eigen::Affine3d as_slicer(const std::string& text) {
  std::istringstream stream(text);
  std::string line, word;
  Eigen::Affine3d from_parent = Eigen::Affine3d::Identity();
  while (std::getline(stream, line)) {
    std::istringstream words(line);
    words >> word;
    if (word == "Transform:") {
      words >> word;
      EXPECT_EQ(word, "AffineTransform_double_3_3");
    }
    if (word != "Parameters:") continue;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) words >> from_parent.linear()(i, j);
    for (int i = 0; i < 3; ++i) words >> from_parent.translation()[i];
    EXPECT_TRUE(words);
  }
  return from_parent.inverse();
}

}  // namespace

TEST(SlicerFiles, TransformsMoveTheBodyAsThePoseDoes) {
  const Pose X{Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, -2, 0.5).normalized())),
               {3, -7, 11}};
  const std::string text = itk_transform(X);
  EXPECT_TRUE(text.starts_with("#Insight Transform File V1.0\n"));
  EXPECT_NE(text.find("FixedParameters: 0 0 0"), std::string::npos);
  const Eigen::Affine3d read = as_slicer(text);
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(40, -90, -60)})
    EXPECT_LT((read * p - X * p).norm(), 1e-12);
}

TEST(SlicerFiles, LandmarksAreReadBackByTheImport) {
  Landmarks landmarks;
  landmarks.points = {{"nasion", {0.125, -88.3, 41}}, {"left_gonion", {51, -20.5, -60}}};
  const TemporaryPath folder("markups");
  make_folder(folder.path());
  const auto file = folder.path() / "landmarks.mrk.json";
  write_file(file, slicer_markups({landmark_markup(landmarks, "landmarks")}));
  const LandmarkTable table = read_landmark_table(file);
  EXPECT_TRUE(table.own_frame);
  const Landmarks read = name_landmarks(file, table);
  ASSERT_EQ(read.points.size(), 2u);
  for (const auto& [name, point] : landmarks.points) EXPECT_EQ(*read.find(name), point) << name;
}

TEST(SlicerFiles, MeasuresStateTheirValues) {
  const SlicerMarkup line{
      SlicerMarkup::Kind::line, "</script>", {{"a", {0, 0, 0}}, {"b", {3, 4, 0}}}},
      angle{
          SlicerMarkup::Kind::angle, "SNA", {{"s", {1, 0, 0}}, {"n", {0, 0, 0}}, {"a", {0, 2, 0}}}};
  const auto json = nlohmann::json::parse(slicer_markups({line, angle}));
  const auto& markups = json["markups"];
  ASSERT_EQ(markups.size(), 2u);
  EXPECT_EQ(markups[0]["type"], "Line");
  EXPECT_EQ(markups[0]["coordinateSystem"], "LPS");
  EXPECT_EQ(markups[0]["coordinateUnits"], "mm");
  EXPECT_NEAR(markups[0]["measurements"][0]["value"].get<double>(), 5, 1e-12);
  EXPECT_EQ(markups[1]["type"], "Angle");
  EXPECT_NEAR(markups[1]["measurements"][0]["value"].get<double>(), 90, 1e-9);
}

}  // namespace condyle
