#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "render/image/drawn_box.h"

namespace condyle {

/// The pixels of a picture in which surfaces have edges; in all others the samples are alike.
class EdgePixels {
 public:
  /// Marks of the pixels of the box, row by row from the bottom, to be filled: not 0 on an edge.
  std::span<std::uint8_t> marks_within(const DrawnBox& box);

  /// Of these triangles, in their order, those that may cover part of such a pixel, and those
  /// before the near plane. to_clip: of the points, for a picture of width x height pixels.
  /// widened: pixels by which corners may be drawn elsewhere. Valid until the next call.
  const std::vector<Eigen::Vector3i>& touching(std::span<const Eigen::Vector3f> points,
                                               std::span<const Eigen::Vector3i> triangles,
                                               const Eigen::Matrix4f& to_clip, int width,
                                               int height, float widened = 0);

 private:
  bool any(const Eigen::Vector2f& low, const Eigen::Vector2f& high, float widened) const;

  DrawnBox box_;
  std::vector<std::uint8_t> marks_;
  std::vector<Eigen::Vector3f> projected_;  // pixels; 1, or 0 before the near plane
  std::vector<Eigen::Vector3i> chosen_;
};

}  // namespace condyle
