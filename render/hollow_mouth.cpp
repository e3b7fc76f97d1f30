#include "render/hollow_mouth.h"

#include <algorithm>
#include <cmath>

#include "render/vertex_normals.h"

namespace condyle {
namespace {

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.f, 1.f)));
}

}  // namespace

HollowMouth::HollowMouth(const MouthLining& lining) : lining_(lining) {
  part_ = {"mouth lining", Role::upper_gums, {}, {}};
  const std::size_t count = lining_.rest.size(), around = lining_.rim.size();
  std::vector<GpuMesh::Bytes> colors(count), extras(count);
  for (std::size_t v = 0; v < count; ++v) {
    // As red as what lines the lips, paler on the cheeks; the throat sees little of the sky.
    const float deep = static_cast<float>(v / around) / static_cast<float>(count / around);
    const Eigen::Vector3f color(0.52f + 0.12f * std::min(1.f, 3 * deep),
                                0.24f + 0.10f * std::min(1.f, 3 * deep),
                                0.23f + 0.09f * std::min(1.f, 3 * deep));
    const std::uint8_t sky = to_byte(0.8f - 0.35f * deep);
    colors[v] = {to_byte(color.x()), to_byte(color.y()), to_byte(color.z()), sky};
    extras[v] = {sky, 0, 255, 0};
  }
  GpuMesh mesh(lining_.rest, lining_.triangles, true);
  Eigen::AlignedBox3f box;
  for (const auto& place : lining_.rest) box.extend(place);
  drawable_.emplace(Drawable{&part_,
                             material_of(part_.role),
                             false,
                             box,
                             std::move(mesh),
                             {},
                             std::move(colors),
                             std::move(extras),
                             {},
                             {}});
  drawable_->mesh.send_colors(drawable_->colors);
  drawable_->mesh.send_extras(drawable_->extras);
}

Drawable& HollowMouth::place(const GpuMesh& face, const Pose& X_CM) {
  std::vector<Eigen::Vector3f> rim, normals;
  for (const int v : lining_.rim) rim.push_back(face.point_of(v));
  const auto now = places_now(lining_, rim, X_CM);
  vertex_normals(now, lining_.triangles, normals);
  drawable_->mesh.send_shape(now, normals);
  return *drawable_;
}

}  // namespace condyle
