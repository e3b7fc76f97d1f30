#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sim/operation/operation.h"

namespace condyle {

/// Bone and teeth that share space at the planned positions and did not before.
struct SegmentOverlap {
  enum class Kind {
    trimmed,   // pieces of one bone: the surgeon burrs it away
    occlusal,  // teeth of opposing arches
    collision  // anything else
  };
  std::string a, b;            // names of the parts
  std::string body_a, body_b;  // of their bodies
  Kind kind = Kind::collision;
  double depth_mm = 0;  // of the deepest point of either surface in the other
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // that point, cranium's frame
  double volume_mm3 = 0;                         // of the space that they share
};

/// Overlaps of parts on bodies that the plan moves relative to each other, deepest first; those of
/// less than 0.1 mm beyond the uncut rest are left out. With a name, those of that segment and of
/// what was cut from it alone. Bit-identical for any number of threads.
std::vector<SegmentOverlap> segment_overlaps(const Operated& operated,
                                             const std::string& segment = {});

/// Overlaps of the parts of one body alone, with those of its children too.
std::vector<SegmentOverlap> body_overlaps(const Operated& operated, const std::string& body);

/// Whether bones that cuts made, on two bodies, share space at the planned positions: as above
/// without volumes.
bool cut_bones_overlap(const Operated& operated, const std::string& a, const std::string& b);

/// The largest fraction of a move, in steps of 0.25 mm and then to 0.01 mm, up to which the segment
/// collides with nothing (see Kind::collision). `pose`: X_CS of the segment at a fraction from 0 to
/// 1; all else lies as planned. 1 where the whole move is free.
double free_fraction(const Operated& operated, const std::string& segment,
                     const std::function<Pose(double)>& pose);

/// "proximal_left and distal overlap by 4.3 mm (812 mm³) at (...): bone that is trimmed".
std::string overlap_text(const SegmentOverlap& overlap, const Landmarks& landmarks);

/// "(31.2, -60.0, -71.5), 4 mm from left_gonion".
std::string place_words(const Eigen::Vector3d& place, const Landmarks& landmarks);

}  // namespace condyle
