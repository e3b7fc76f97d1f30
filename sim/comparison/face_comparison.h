#pragma once

#include <string>
#include <vector>

#include "engine/math/pose.h"
#include "engine/mesh/tri_mesh.h"
#include "sim/case/landmarks.h"
#include "sim/comparison/face_regions.h"

namespace condyle {

/// How the face after the operation is registered to the predicted one: by landmarks of the upper
/// face, by its surface, or not at all.
enum class FaceAlignment { landmarks, surface, none };

/// A face and the landmarks known on it, in one frame, mm.
struct MarkedFace {
  TriMesh mesh;
  Landmarks landmarks;
};

/// Distances within a region, mm, weighted by area. Signed: positive where the prediction lies in
/// front of the face after the operation.
struct RegionDistances {
  std::string region;
  int points = 0;             // vertices with a distance
  double area_mm2 = 0;        // of the region on the predicted face
  double measured_share = 0;  // of that area, where the other surface has a partner
  double signed_mean_mm = 0, signed_median_mm = 0;
  double mean_mm = 0, median_mm = 0, p90_mm = 0, p95_mm = 0, max_mm = 0;  // absolute
  double share_below_2_mm = 0;
};

struct FaceComparison {
  Pose X_PO;                        // of the face after the operation in the prediction's frame
  double registration_rms_mm = 0;   // of the points that were registered
  int registration_points = 0;      // landmarks or points of the surface; 0: as delivered
  TriMesh after;                    // the face after the operation, registered
  std::vector<double> distance_mm;  // signed, by vertex of the prediction; infinite without partner
  std::vector<FaceRegion> regions;  // by vertex; empty where landmarks for them are missing
  std::vector<RegionDistances> rows;  // by region, then "whole": all regions but the upper face
  std::vector<std::string> notes;
};

struct FaceComparisonSettings {
  FaceAlignment alignment = FaceAlignment::surface;
  int threads = 2;
};

/// Measures a predicted face against the face after the operation. Without landmarks for regions
/// there is one row, "whole", of the whole face.
/// throws: InputError for surfaces that differ in size as other units do, lie too far apart, or
/// lack the landmarks by which they are to be registered.
FaceComparison compare_faces(const MarkedFace& predicted, const MarkedFace& after,
                             const FaceComparisonSettings& settings = {});

}  // namespace condyle
