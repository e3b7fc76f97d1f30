#include "render/window/view/measuring.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/mesh/triangle_tree.h"
#include "engine/mesh_io/mesh_files.h"
#include "render/window/picture/displayed_face.h"
#include "render/window/view/landmark_list.h"
#include "sim/frame/body_poses.h"
#include "tests/render/scene_parts.h"
#include "tests/render/window/panel_stage.h"
#include "tests/support/places.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

TEST(Measuring, DistanceAngleAndArea) {
  const std::vector<Vector3d> two = {{0, 0, 0}, {3, 4, 12}};
  EXPECT_DOUBLE_EQ(measured(two).length_mm, 13);
  EXPECT_FALSE(measured(two).angle_deg);
  EXPECT_FALSE(measured(two).area_mm2);
  const std::vector<Vector3d> three = {{5, 0, 1}, {0, 0, 1}, {0, 0, 8}};
  EXPECT_DOUBLE_EQ(*measured(three).angle_deg, 90);
  EXPECT_DOUBLE_EQ(*measured(three).area_mm2, 17.5);
  const std::vector<Vector3d> square = {{0, 0, 0}, {0, 10, 0}, {0, 10, 10}, {0, 0, 10}};
  EXPECT_DOUBLE_EQ(*measured(square).area_mm2, 100);
  EXPECT_DOUBLE_EQ(measured(square).length_mm, 30);
  EXPECT_FALSE(measured(square).angle_deg);
  EXPECT_EQ(words_of(measured(three)),
            (std::vector<std::string>{"12.0 mm", "90.0\u00b0", "18 mm\u00b2"}));
  EXPECT_EQ(measured({}).length_mm, 0);
}

TEST(Measuring, PointsFollowTheirBoneAndTheDeformingFace) {
  const std::vector<Part> parts = box_patient();
  FrameState frame = box_frame(1, 20);
  const PinnedPoint on_jaw{4, parts[4].mesh.triangles[3], {0.2, 0.3, 0.5}};
  Vector3d at_rest = Vector3d::Zero();
  for (int k = 0; k < 3; ++k)
    at_rest += on_jaw.barycentric[k] * parts[4].mesh.vertices[on_jaw.triangle[k]];
  EXPECT_LT((place_of(on_jaw, parts, frame) - frame.poses[mandible_body] * at_rest).norm(), 1e-12);
  const PinnedPoint on_face{5, parts[5].mesh.triangles[0], {1, 0, 0}};
  frame.face.clear();
  for (const auto& v : parts[5].mesh.vertices)
    frame.face.push_back((v + Vector3d(0, 0, -7)).cast<float>());
  EXPECT_LT((place_of(on_face, parts, frame) - parts[5].mesh.vertices[on_face.triangle[0]] -
             Vector3d(0, 0, -7))
                .norm(),
            1e-5);
}

TEST(Measuring, OnACoarseFaceMarksLieOnWhatIsSeen) {
  TriMesh mesh = ball({0, 0, 0}, 70, 24);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)  // as rough as a segmented one
    mesh.vertices[v] *= 1 + 0.03 * std::sin(7.0 * static_cast<double>(v));
  std::vector<Part> parts = {make_part("face", Role::face, mesh)};
  ASSERT_TRUE(DrawnFace::smooths(mesh));
  FrameState frame;
  const Vector3d shift(3, -2, -9);
  for (const auto& v : mesh.vertices) frame.face.push_back((v + shift).cast<float>());
  const auto seen = DisplayedFace(parts).places(frame);
  ASSERT_EQ(seen.size(), mesh.vertices.size());
  const TriangleTree tree(DrawnFace(mesh, {}, Eigen::Vector3f::Ones()).mesh());
  double measured_off = 0, seen_off = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
    const PinnedPoint point{0, mesh.triangles[t], {1, 0, 0}};
    const Landmark landmark = landmark_on("pronasale", point, parts);
    const Vector3d mark = place_of(point, parts, frame, seen) - shift;
    EXPECT_LT((place_of(landmark, parts, frame, seen) - shift - mark).norm(), 1e-4);
    const Vector3d vertex = mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][0])];
    EXPECT_LT((place_of(point, parts, frame) - shift - vertex).norm(), 1e-4);
    measured_off = std::max(measured_off, tree.nearest(vertex).distance);
    seen_off = std::max(seen_off, tree.nearest(mark).distance);
  }
  EXPECT_GT(measured_off, 1);
  EXPECT_LT(seen_off, 0.4 * measured_off);
  // A fine one is displayed unchanged.
  parts[0].mesh = ball({0, 0, 0}, 70, 120);
  EXPECT_TRUE(DisplayedFace(parts).places(frame).empty());
}

TEST(Measuring, MarksLieOnARealFaceBetweenItsVerticesToo) {
  const auto file =
      test::source_folder() / ".." / "shared" / "data" / "case-badin" / "face_skin.ply";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "real anatomy absent";
  const std::vector<Part> parts = {make_part("face", Role::face, read_mesh(file))};
  const TriMesh& mesh = parts[0].mesh;
  const auto seen = DisplayedFace(parts).places({});
  ASSERT_EQ(seen.size(), mesh.vertices.size());
  const TriangleTree tree(DrawnFace(mesh, {}, Eigen::Vector3f::Ones()).mesh());
  double between = 0, at_vertices = 0;
  for (const auto& t : mesh.triangles)
    for (const Vector3d& barycentric : {Vector3d(1. / 3, 1. / 3, 1. / 3), Vector3d(0, .5, .5)})
      between =
          std::max(between, tree.nearest(place_of({0, t, barycentric}, parts, {}, seen)).distance);
  for (const auto& v : mesh.vertices) at_vertices = std::max(at_vertices, tree.nearest(v).distance);
  EXPECT_LT(between, 0.8);
  EXPECT_GT(at_vertices, 2 * between);  // of what is measured
}

}  // namespace
}  // namespace condyle
