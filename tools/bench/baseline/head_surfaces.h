#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "sim/case/case.h"

namespace condyle {

/// Surfaces of a head as from a scanner, with the landmarks' true places. Triangles are not those
/// of the built-in patient, vertices have noise, and the head is turned and displaced.
struct HeadSurfaces {
  TriMesh skull, mandible, skin;  // bones with their teeth
  std::map<std::string, Eigen::Vector3d> truth;
  Pose X_SH;  // from the head's frame to the scanner's

  TriMesh bone() const;  // skull and mandible in one mesh
};

enum class HeadPopulation {
  seeded,  // HeadChoice::seed
  warped   // other proportions and smooth waves
};

/// seed: from 1. turned by 8 degrees and displaced by 20 mm (standard deviations); noise 0.15 mm.
HeadSurfaces scanned_head(const Case& model, HeadPopulation population, std::uint64_t seed);

/// What a scan from `low_mm` to `high_mm` in the head's height contains, cut level in the scanner.
TriMesh scanned_between(const TriMesh& mesh, const HeadSurfaces& head, double low_mm,
                        double high_mm);

}  // namespace condyle
