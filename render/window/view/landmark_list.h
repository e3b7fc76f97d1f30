#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "render/window/view/measuring.h"
#include "sim/frame/frame_state.h"
#include "sim/frame/part.h"

namespace condyle {

/// A named point of the patient at rest, and the part that carries it.
struct Landmark {
  std::string name;                                   // canonical: lower_incisal_point
  Eigen::Vector3d at_rest = Eigen::Vector3d::Zero();  // cranium's frame, mm
  std::size_t part = 0;                               // whose surface is nearest
  int vertex = 0;                                     // of it, nearest
  bool operator==(const Landmark&) const = default;
};

/// A landmark at a point, carried by the part of the scene whose surface is nearest; condyles
/// belong to the mandible wherever they lie.
Landmark landmark_at(const std::string& name, const Eigen::Vector3d& at_rest,
                     std::span<const Part> parts);
/// A landmark where a surface was clicked.
Landmark landmark_on(const std::string& name, const PinnedPoint& point,
                     std::span<const Part> parts);

/// Its present position in the cranium's frame, mm.
Eigen::Vector3d place_of(const Landmark& landmark, std::span<const Part> parts,
                         const FrameState& frame);
/// The same with the face's vertices elsewhere (see DisplayedFace), where there are any.
Eigen::Vector3d place_of(const Landmark& landmark, std::span<const Part> parts,
                         const FrameState& frame, std::span<const Eigen::Vector3f> face);

/// "lower incisal point" as "lower_incisal_point"; empty when no letter or digit is left.
std::string landmark_name(const std::string& words);

}  // namespace condyle
