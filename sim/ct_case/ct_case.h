#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "engine/segmentation/head_labels.h"
#include "engine/segmentation/split_bones.h"
#include "engine/volume/volume.h"
#include "sim/anatomy_fit/anatomy_fit.h"
#include "sim/case/case.h"

namespace condyle {

struct CtCaseRequest {
  std::string name = {};                    // of the case
  std::string source = "the scan";          // in messages
  std::optional<double> threshold_hu = {};  // of bone; default: from the scan's histogram
  std::vector<SeedPoint> seeds = {};        // in the skull (1) or the lower jaw (2), by hand
  bool face = true;
  bool keep_metal_artifacts = false;
  int skull_triangles = 400000, mandible_triangles = 100000, face_triangles = 150000;
  int threads = 2;
};

struct CtCase {
  Case patient;
  AnatomyFit fit;
  double threshold_hu = 0;
  // Of each part: distance of the surface before decimation from the part, mm.
  struct Decimation {
    std::string part;
    double median_mm = 0, p95_mm = 0, max_mm = 0;
  };
  std::vector<Decimation> decimation;
};

/// Makes a patient of a CT scan: bone and skin are segmented, the built-in patient `model` is
/// fitted to them and gives the seeds that part the lower jaw from the skull and the crowns from
/// both, and the landmarks. Turned scans are brought to LPS. `notes` of the patient list what was
/// found and what is doubtful. throws: InputError where the scan shows no head, or seeds lie
/// outside bone.
CtCase case_of_ct(const Volume& volume, const Case& model, const CtCaseRequest& request,
                  const Progress& progress = {});

}  // namespace condyle
