#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/frame/frame_state.h"
#include "sim/frame/part.h"

namespace condyle {

/// A point fixed to a surface that moves or deforms.
struct PinnedPoint {
  std::size_t part = 0;
  Eigen::Vector3i triangle = Eigen::Vector3i::Zero();
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();  // of the triangle's corners
  bool operator==(const PinnedPoint&) const = default;
};

/// Its present position in the cranium's frame, mm.
Eigen::Vector3d place_of(const PinnedPoint& point, std::span<const Part> parts,
                         const FrameState& frame);
/// The same with the face's vertices elsewhere (see DisplayedFace), where there are any.
Eigen::Vector3d place_of(const PinnedPoint& point, std::span<const Part> parts,
                         const FrameState& frame, std::span<const Eigen::Vector3f> face);

/// Measures of a sequence of points. Angle: at the second of three. Area: of the polygon through
/// three or more, as seen along its own normal.
struct Measured {
  double length_mm = 0;  // along the sequence
  std::optional<double> angle_deg, area_mm2;
};
Measured measured(std::span<const Eigen::Vector3d> points);

/// "34.2 mm", "83.1°", "512 mm²": one line each.
std::vector<std::string> words_of(const Measured& measured);

}  // namespace condyle
