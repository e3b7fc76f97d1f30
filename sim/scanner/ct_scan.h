#pragma once

#include <cstdint>
#include <vector>

#include "engine/core/progress.h"
#include "engine/mesh/measure.h"
#include "engine/volume/volume.h"
#include "sim/scanner/scanned_head.h"

namespace condyle {

/// What a voxel's centre lies in.
enum class ScanTissue : std::uint8_t {
  outside,  // air, table and head rest
  soft,
  cavity,  // air inside the skin: mouth and nose
  skull,
  mandible,
  upper_teeth,
  lower_teeth
};

struct CtSettings {
  Eigen::Vector3d spacing_mm = {0.5, 0.5, 1.0};
  Box field_of_view = {{-105, -130, -130}, {105, 120, 125}};  // mm
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // of the lattice, about the view's middle
  double noise_hu = 40;                                // standard deviation
  double point_spread = 0.5;                           // standard deviation, voxels
  std::uint64_t seed = 1;                              // of the noise and the streaks
  bool fillings = false;                               // three of metal, with streaks
  bool table = false;                                  // table with rails, and a head rest
  bool dark_marrow = false;                            // 50 to 250 instead of 450 HU
  int threads = 1;
};

struct CtScan {
  Volume volume;
  std::vector<ScanTissue> truth;  // one per voxel
};

/// The head as a CT scanner sees it. Bit-identical for any number of threads.
CtScan scan_ct(const ScannedHead& head, const CtSettings& settings, const Progress& progress = {});

/// Adds white noise of a standard deviation, limited as scanners store values.
void add_noise(double sigma_hu, std::uint64_t seed, int threads, Volume& volume);

}  // namespace condyle
