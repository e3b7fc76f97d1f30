#include "sim/case/eyes.h"

#include <algorithm>
#include <string>
#include <vector>

#include "sim/frame/face_openings.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

std::optional<Eye> marked_eye(const Landmarks& landmarks, const std::string& side) {
  const auto inner = landmarks.find(side + "_endocanthion"),
             outer = landmarks.find(side + "_exocanthion");
  if (!inner || !outer) return std::nullopt;
  return Eye{.inner = *inner, .outer = *outer};
}

/// Its corners are the points of the rim farthest to the left and to the right.
Eye opened_eye(const TriMesh& face, const std::vector<int>& rim) {
  std::vector<Vector3d> places;
  for (const int v : rim) places.push_back(face.vertices[static_cast<std::size_t>(v)]);
  const auto [right, left] =
      std::minmax_element(places.begin(), places.end(),
                          [](const Vector3d& a, const Vector3d& b) { return a.x() < b.x(); });
  return {.inner = *right, .outer = *left};
}

}  // namespace

double Eye::distance(const Vector3d& p) const {
  const Vector3d frontal(1, 0, 1);
  const Vector3d along = (outer - inner).cwiseProduct(frontal),
                 from = (p - inner).cwiseProduct(frontal);
  const double s = std::clamp(from.dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (from - s * along).norm();
}

std::optional<Eyes> find_eyes(const TriMesh& face, const Landmarks& landmarks) {
  // The eyeball's centre behind the middle of the canthi; source: an average adult.
  const Vector3d behind(0, 4, 0.5);
  std::optional<Eye> left = marked_eye(landmarks, "left"), right = marked_eye(landmarks, "right");
  if (!left || !right) {
    std::vector<Eye> opened;
    for (const FaceOpening& opening : find_openings(face))
      if (opening.kind == FaceOpening::Kind::eye) opened.push_back(opened_eye(face, opening.rim));
    if (opened.size() == 2) {
      if (opened[0].inner.x() < opened[1].inner.x()) std::swap(opened[0], opened[1]);
      std::swap(opened[1].inner, opened[1].outer);
      if (!left) left = opened[0];
      if (!right) right = opened[1];
    }
  }
  constexpr double narrowest_mm = 10;
  const auto open = [&](const std::optional<Eye>& eye) {
    return eye && std::abs(eye->outer.x() - eye->inner.x()) > narrowest_mm;
  };
  if (!open(left) || !open(right)) return std::nullopt;
  Eyes eyes{.left = *left, .right = *right};
  for (const auto& [side, eye] : {std::pair("left", &eyes.left), std::pair("right", &eyes.right)})
    eye->globe = landmarks.find(std::string(side) + "_eyeball")
                     .value_or(0.5 * (eye->inner + eye->outer) + behind);
  return eyes;
}

}  // namespace condyle
