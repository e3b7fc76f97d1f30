#include "render/face_openings.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/mesh/rims.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// By rim length and middle, from the tip of the nose: beside it, behind it, above it; mm.
bool is_eye(double length, double beside, double behind, double above, const Vector3d& outward) {
  return length > 45 && length < 160 && beside > 15 && beside < 55 && behind > 0 && behind < 75 &&
         above > 5 && above < 60 && -outward.y() > 0.5;
}

bool is_nostril(double length, double beside, double behind, double above,
                const Vector3d& outward) {
  return length > 12 && length < 80 && beside < 22 && behind > 0 && behind < 35 && above > -25 &&
         above < 8 && -outward.z() > 0.25;
}

}  // namespace

std::vector<FaceOpening> find_openings(const TriMesh& face) {
  std::vector<FaceOpening> found;
  if (face.vertices.empty()) return found;
  const Vector3d tip =
      *std::min_element(face.vertices.begin(), face.vertices.end(),
                        [](const Vector3d& a, const Vector3d& b) { return a.y() < b.y(); });
  for (auto& rim : rims_of(face)) {
    Vector3d middle = Vector3d::Zero(), area = Vector3d::Zero();
    double length = 0;
    const auto place = [&](std::size_t i) -> const Vector3d& {
      return face.vertices[static_cast<std::size_t>(rim[i % rim.size()])];
    };
    for (std::size_t i = 0; i < rim.size(); ++i) {
      middle += place(i) / static_cast<double>(rim.size());
      area += (place(i) - place(0)).cross(place(i + 1) - place(0));
      length += (place(i + 1) - place(i)).norm();
    }
    if (!(area.norm() > 0)) continue;
    const Vector3d outward = area.normalized(), way = middle - tip;
    for (const auto& [kind, fits] : {std::pair(FaceOpening::Kind::eye, &is_eye),
                                     std::pair(FaceOpening::Kind::nostril, &is_nostril)})
      if (fits(length, std::abs(way.x()), way.y(), way.z(), outward)) {
        found.push_back({kind, std::move(rim), middle, outward});
        break;
      }
  }
  return found;
}

}  // namespace condyle
