#include "render/scene/section_anatomy.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "render/shaders/material.h"

namespace condyle {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

/// Outline in the median plane for a tongue from y = -87 to -30 and z = -73 to -38, mm.
struct Outline {
  Vector3f color;
  float half_width;
  bool with_tongue;
  std::vector<Vector2f> points;
};

const Vector3f air(.055f, .045f, .045f);

const std::vector<Outline>& outlines() {
  const Vector3f muscle = cut_color_of(Role::tongue), mucosa = cut_color_of(Role::upper_gums);
  static const std::vector<Outline> all = {
      {air, 9, false, {{-45, -28},  {-45, -17},  {-40, -13},  {-31, -14},  {-24, -22},
                       {-19, -32},  {-15, -45},  {-13, -60},  {-13, -80},  {-16, -99},
                       {-19, -112}, {-23, -130}, {-24, -150}, {-25, -182}, {-40, -182},
                       {-39, -150}, {-38, -128}, {-35, -112}, {-36, -99},  {-31, -90},
                       {-28, -76},  {-27, -62},  {-30, -50},  {-36, -40},  {-44, -34}}},
      {mucosa,
       15,
       false,
       {{-45, -27},
        {-45, -31.5f},
        {-39, -36},
        {-33, -43},
        {-28, -52},
        {-25, -54},
        {-23.5f, -51},
        {-26, -43},
        {-30, -35},
        {-37, -28}}},
      {mucosa,
       8,
       false,
       {{-36, -100}, {-32, -89}, {-27, -80}, {-25, -80}, {-26, -89}, {-31, -101}}},
      {muscle,
       13,
       true,
       {{-81, -64},
        {-79, -78},
        {-70, -88},
        {-58, -94},
        {-46, -97},
        {-38, -97},
        {-33, -91},
        {-29, -78},
        {-28.5f, -62},
        {-34, -54},
        {-50, -56},
        {-70, -56}}},
      {cut_color_of(Role::mandible),
       4,
       true,
       {{-46, -98}, {-44, -95}, {-40, -95}, {-38, -98}, {-40, -101}, {-44, -101}}},
  };
  return all;
}

/// A prism across the median plane. Its ends are fans: only winding numbers count.
GpuMesh prism(const std::vector<Vector2f>& outline, const Eigen::Affine3f& place,
              float half_width) {
  std::vector<Vector3f> positions;
  std::vector<Eigen::Vector3i> triangles;
  const int n = static_cast<int>(outline.size());
  for (const float x : {-half_width, half_width})
    for (const Vector2f& p : outline) positions.push_back(place * Vector3f(x, p.x(), p.y()));
  float area = 0;
  for (int i = 0; i < n; ++i) {
    const Vector2f &a = outline[static_cast<std::size_t>(i)],
                   &b = outline[static_cast<std::size_t>((i + 1) % n)];
    area += a.x() * b.y() - a.y() * b.x();
  }
  const auto add = [&](int a, int b, int c) {
    if (area > 0) std::swap(b, c);
    triangles.emplace_back(a, b, c);
  };
  for (int i = 0; i < n; ++i) {
    const int next = (i + 1) % n;
    add(i, n + i, next);
    add(next, n + i, n + next);
    if (i == 0 || next == 0) continue;
    add(0, i, next);
    add(n, n + next, n + i);
  }
  return GpuMesh(positions, triangles, GpuMesh::Use::still);
}

}  // namespace

std::vector<SectionSolid> section_solids(std::span<const Part> parts) {
  const auto tongue = std::find_if(parts.begin(), parts.end(), [](const Part& part) {
    return part.role == Role::tongue && !part.mesh.empty();
  });
  std::vector<SectionSolid> solids;
  if (tongue == parts.end()) return solids;
  Eigen::AlignedBox3f box;
  for (const auto& v : tongue->mesh.vertices) box.extend(v.cast<float>());
  const Eigen::AlignedBox3f model(Vector3f(-24, -87.4f, -72.5f), Vector3f(24, -30, -37.7f));
  const Vector3f scale = box.sizes().cwiseQuotient(model.sizes());
  const Eigen::Affine3f place = Eigen::Translation3f(box.center()) * Eigen::Scaling(scale) *
                                Eigen::Translation3f(Vector3f(-model.center()));
  for (const Outline& outline : outlines()) {
    GpuMesh mesh = prism(outline.points, place, outline.half_width);
    std::vector<Vector3f> places;
    for (const float x : {-outline.half_width, outline.half_width})
      for (const Vector2f& p : outline.points) places.push_back(place * Vector3f(x, p.x(), p.y()));
    mesh.send_shape(places, std::vector<Vector3f>(places.size(), Vector3f::UnitX()));
    solids.push_back({std::move(mesh), outline.color, outline.with_tongue});
  }
  return solids;
}

}  // namespace condyle
