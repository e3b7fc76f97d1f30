#include <algorithm>
#include <cmath>

#include "engine/mesh/triangle_tree.h"
#include "render/vertex_normals.h"
#include "tests/render/scene_fixture.h"

namespace condyle {
namespace {

using Details = WithContext;

/// Stripes: colours change where the shape does not.
double brightness(double z) { return 0.5 + 0.3 * std::sin(z / 2); }
TriMesh striped_ball() {
  TriMesh mesh = ball({0, 0, 0}, 60, 96);
  for (const auto& v : mesh.vertices)
    mesh.colors.emplace_back(Eigen::Vector3f::Constant(static_cast<float>(brightness(v.z()))));
  return mesh;
}

struct Left {
  std::size_t triangles = 0;
  double farthest_mm = 0;  // of the source's vertices
  double grey_off = 0;     // root mean square over them, levels
};
Left what_is_left(const TriMesh& source, Detail detail) {
  std::vector<Eigen::Vector3f> positions, normals;
  for (const auto& v : source.vertices) positions.push_back(v.cast<float>());
  vertex_normals(positions, source.triangles, normals);
  std::vector<float> bright;
  for (const auto& color : source.colors) bright.push_back(color.mean());
  GpuMesh mesh(positions, source.triangles, false);
  mesh.add_details(positions, normals, bright, source.triangles);
  mesh.send_shape(positions, normals);
  TriMesh surface;
  for (const auto& p : mesh.points()) surface.vertices.push_back(p.cast<double>());
  surface.triangles = mesh.surface(detail).triangles;
  const TriangleTree tree(surface);
  Left left{.triangles = surface.triangles.size()};
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const SurfacePoint found = tree.nearest(source.vertices[i]);
    left.farthest_mm = std::max(left.farthest_mm, (found.point - source.vertices[i]).norm());
    double grey = 0;
    for (int k = 0; k < 3; ++k) {
      const auto& corner = surface.vertices[surface.triangles[found.triangle][k]];
      grey += found.barycentric[k] * brightness(corner.z());
    }
    left.grey_off += std::pow(255 * (grey - brightness(source.vertices[i].z())), 2);
  }
  left.grey_off = std::sqrt(left.grey_off / static_cast<double>(positions.size()));
  return left;
}

TEST_F(Details, LessDetailStaysNearTheShapeAndItsColours) {
  const TriMesh source = striped_ball();
  const Left full = what_is_left(source, Detail::full), close = what_is_left(source, Detail::close),
             coarse = what_is_left(source, Detail::coarse);
  EXPECT_EQ(full.triangles, source.triangles.size());
  EXPECT_LT(full.farthest_mm, 1e-5);
  EXPECT_LT(3 * close.triangles, 2 * full.triangles);
  EXPECT_LT(close.farthest_mm, 0.4);
  EXPECT_LT(coarse.triangles, close.triangles);
  EXPECT_LT(coarse.farthest_mm, 0.4);
  EXPECT_LT(full.grey_off, 0.1);
  EXPECT_LT(close.grey_off, 1.5);
}

TEST_F(Details, WhatIsLeftOutIsNotSeen) {
  const std::vector<Part> parts = {make_part("mandible", Role::mandible, striped_ball())};
  SceneRenderer renderer(parts);
  PictureSettings settings, whole;
  settings.width = settings.height = 500;
  whole = settings;
  whole.wireframe = {"none of that name"};  // draws no edge, but keeps every triangle
  const auto apart = [&](const Camera& camera) {
    const Image a = renderer.picture(camera, settings), b = renderer.picture(camera, whole);
    double sum = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) sum += std::pow(a.rgba[i] - b.rgba[i], 2);
    return std::sqrt(sum / static_cast<double>(a.rgba.size()));
  };
  const double far_off = apart(front_camera(150));
  EXPECT_GT(far_off, 0);  // some was left out
  EXPECT_LT(far_off, 1);  // grey level
  EXPECT_EQ(apart(front_camera(20)), 0);
  settings.coarse = true;
  EXPECT_GT(apart(front_camera(150)), far_off);
}

}  // namespace
}  // namespace condyle
