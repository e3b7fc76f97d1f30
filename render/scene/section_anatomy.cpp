#include "render/scene/section_anatomy.h"

#include <algorithm>

#include "render/shaders/material.h"

namespace condyle {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;
using Tissue = SectionOutline::Tissue;

Vector3f color_of(Tissue tissue) {
  switch (tissue) {
    case Tissue::flesh:
      return cut_color_of(Role::face);
    case Tissue::mucosa:
      return cut_color_of(Role::upper_gums);
    case Tissue::muscle:
      return cut_color_of(Role::tongue);
    case Tissue::bone:
      return cut_color_of(Role::mandible);
    case Tissue::air:
      break;
  }
  return {.055f, .045f, .045f};
}

/// Vertices of a prism across the median plane.
std::vector<Vector3f> positions_of(const SectionOutline& outline) {
  std::vector<Vector3f> positions;
  for (const float x : {-outline.half_width, outline.half_width})
    for (const Vector2f& p : outline.points)
      positions.emplace_back(outline.middle + x, p.x(), p.y());
  return positions;
}

/// Its ends are fans: only winding numbers count.
std::vector<Eigen::Vector3i> prism(const std::vector<Vector2f>& outline) {
  std::vector<Eigen::Vector3i> triangles;
  const int n = static_cast<int>(outline.size());
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
  return triangles;
}

}  // namespace

std::span<const SectionSolid> SectionAnatomy::place(const Pose& X_CM) {
  const auto outlines = throat_.at(X_CM);
  const bool fresh = solids_.empty();
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    const auto positions = positions_of(outlines[i]);
    if (fresh)
      solids_.push_back({GpuMesh(positions, prism(outlines[i].points), GpuMesh::Use::overlay),
                         color_of(outlines[i].tissue), outlines[i].with_tongue});
    solids_[i].mesh.send_shape(positions,
                               std::vector<Vector3f>(positions.size(), Vector3f::UnitX()));
  }
  return solids_;
}

}  // namespace condyle
