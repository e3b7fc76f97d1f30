#pragma once

#include <filesystem>

#include "sim/case/case.h"
#include "sim/phantom/head_shape.h"
#include "sim/scanner/ct_scan.h"
#include "tools/common.h"

namespace condyle {

/// Which files of the virtual scanners are written.
struct PhantomScanRequest {
  bool ct = false, laser = false;
  double voxel_mm = 0.8;
  double tooth_growth_mm = 0;  // above 0.05 teeth touch
  CtSettings ct_settings = {};
  std::uint64_t seed = 1;  // of noise, pose and errors of landmarks
};

/// Writes the head as machines would give it, and the truth beside it, into a new or empty folder:
/// ct.nrrd, ct/ (DICOM series) and ct-landmarks.csv; laser.json with its pictures and
/// laser-landmarks.csv; truth/ (the case) and truth-laser-pose.csv.
/// throws: InputError, MachineError.
void write_scans(const Case& patient, const HeadChoice& choice, const PhantomScanRequest& request,
                 const CommonOptions& common, ProgressBar& bar, const std::filesystem::path& out);

}  // namespace condyle
