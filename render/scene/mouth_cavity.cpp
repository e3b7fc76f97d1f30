#include "render/scene/mouth_cavity.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "render/face/tongue_relief.h"
#include "render/mesh/vertex_normals.h"

namespace condyle {
namespace {

constexpr float of_lip_mm = 7;  // distance from the rim over which the lining blends with the lip

/// Unit normals of the rim's vertices, of the face alone.
std::vector<Eigen::Vector3f> rim_normals(std::span<const int> rim,
                                         std::span<const Eigen::Vector3i> beside,
                                         const GpuMesh& face) {
  std::unordered_map<int, Eigen::Vector3f> sums;
  for (const int v : rim) sums.emplace(v, Eigen::Vector3f::Zero());
  for (const auto& t : beside) {
    const Eigen::Vector3f &a = face.point_of(t[0]), &b = face.point_of(t[1]),
                          &c = face.point_of(t[2]);
    const Eigen::Vector3f area = (b - a).cross(c - a);
    for (const int v : t)
      if (const auto sum = sums.find(v); sum != sums.end()) sum->second += area;
  }
  std::vector<Eigen::Vector3f> normals;
  normals.reserve(rim.size());
  for (const int v : rim) normals.push_back(sums.at(v).normalized());
  return normals;
}

}  // namespace

MouthCavity::MouthCavity(const MouthLining& lining, const Drawable& face) : lining_(lining) {
  part_ = {"mouth lining", Role::upper_gums, {}, {}};
  const std::unordered_set<int> rim(lining_.rim.begin(), lining_.rim.end());
  for (const auto& t : lining_.face)
    if (std::any_of(t.begin(), t.end(), [&](int v) { return rim.contains(v); }))
      beside_rim_.push_back(t);
  const std::size_t count = lining_.rest.size(), around = lining_.rim.size();
  std::vector<GpuMesh::Bytes> colors(count), extras(count);
  const bool papillae =
      std::any_of(lining_.tongue.begin(), lining_.tongue.end(), [](float t) { return t > 0; });
  for (std::size_t v = 0; v < count; ++v) {
    // As red as the inner side of the lips, paler on the cheeks; little of the sky is visible from
    // the throat.
    const float deep = static_cast<float>(v / around) / static_cast<float>(count / around);
    Eigen::Vector3f color(0.52f + 0.12f * std::min(1.f, 3 * deep),
                          0.24f + 0.10f * std::min(1.f, 3 * deep),
                          0.23f + 0.09f * std::min(1.f, 3 * deep));
    color += lining_.tongue[v] * (tongue_color - color);
    float sky = 0.8f - 0.35f * deep;
    const float fraction = (lining_.rest[v] - lining_.rest[v % around]).norm() / of_lip_mm;
    const float lip = fraction < 1 ? (1 - fraction) * (1 - fraction) * (1 + 2 * fraction) : 0.f;
    lip_.push_back(lip);
    if (lip > 0) {
      const auto of = static_cast<std::size_t>(lining_.rim[v % around]);
      const auto& skin = face.colors[of];
      const auto& more = face.extras[of];
      color += lip * (Eigen::Vector3f(skin[0], skin[1], skin[2]) / 255 - color);
      // The remaining gloss of lips that have opened.
      sky += lip * (std::max(more[0], static_cast<std::uint8_t>(0.42f * more[2])) / 255.f - sky);
    }
    const std::uint8_t seen = to_byte(sky);
    colors[v] = {to_byte(color.x()), to_byte(color.y()), to_byte(color.z()), seen};
    extras[v] = {seen, papillae ? to_byte(1 - lining_.tongue[v]) : std::uint8_t{0}, 255,
                 to_byte(lip)};
  }
  GpuMesh mesh(lining_.rest, lining_.triangles, GpuMesh::Use::moving);
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
  drawable_->papillae = papillae;
  if (papillae) drawable_->mesh.send_rest(unrolled_tongue(lining_));
}

Drawable& MouthCavity::place(const GpuMesh& face, const Pose& X_CM) {
  std::vector<Eigen::Vector3f> rim, normals;
  for (const int v : lining_.rim) rim.push_back(face.point_of(v));
  const auto now = places_now(lining_, rim, X_CM);
  vertex_normals(now, lining_.triangles, normals);
  const auto of_rim = rim_normals(lining_.rim, beside_rim_, face);
  // Rounded as a lip: turned within one ring it would glint along a hairline.
  for (std::size_t v = 0; v < normals.size(); ++v)
    if (lip_[v] > 0)
      normals[v] = (normals[v] + lip_[v] * (of_rim[v % of_rim.size()] - normals[v])).normalized();
  drawable_->mesh.send_shape(now, normals);
  return *drawable_;
}

}  // namespace condyle
