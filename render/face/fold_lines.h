#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace condyle {

/// A line on the face at rest along which the skin folds when it is compressed across it.
struct FoldLine {
  /// One sample of the line.
  struct Sample {
    Eigen::Vector3f point, normal;  // on the skin; unit
    Eigen::Vector3f across;         // unit, in the skin, towards the side that bulges
    float fraction = 1;             // of the depth; 0 at ends in even skin
  };
  std::vector<Sample> samples = {};
  float gauge_mm = 6;   // the surplus of skin is measured so far to either side,
  float far_mm = 0;     // and so far on the side that bulges; 0: not
  float onset = 0.03f;  // compression, as a fraction of the length, that leaves no surplus
  float gain = 0.8f;    // depth over the surplus
  float limit_mm = 2;   // largest depth
  float groove_mm = 2;  // half width of the groove
  float bulge = 0.6f;   // height of the skin beside the groove over the depth
  /// Least surplus between the first sample and the deepest one, over the largest: a fold that is
  /// deep anywhere continues to the line's beginning.
  float continued = 0;
};

/// Nasolabial folds, creases beside the corners of the mouth, lines around the lips, across the
/// forehead and between the brows, and the mentolabial sulcus of a face at rest, mm, LPS. normals:
/// unit, one per vertex. rim: vertices around the mouth. Lines that the surface does not show are
/// omitted. Their course, from the ala round the corner of the mouth, and their depths were chosen
/// by eye.
std::vector<FoldLine> find_fold_lines(std::span<const Eigen::Vector3f> rest,
                                      std::span<const Eigen::Vector3f> normals,
                                      std::span<const int> rim);

}  // namespace condyle
