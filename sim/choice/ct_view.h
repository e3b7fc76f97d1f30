#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace condyle {

/// A series of a scan, as a front end lists it. No text names a person, a date or a file.
struct CtSeriesItem {
  int number = 0;                         // 0: the volume of a file
  std::string facts;                      // "CT, 210 slices of 512 x 512, ..."
  std::vector<std::string> remarks = {};  // what was corrected, why it is refused
  bool readable = false;
  bool uneven = false;  // readable once its slices are interpolated
};

/// A point that the user has set in a bone, mm.
struct CtSeed {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  bool in_jaw = false;  // the lower jaw; else the skull
  bool operator==(const CtSeed&) const = default;
};

/// What the user chooses of a CT that is being imported.
struct CtChoice {
  Eigen::Vector3d cross = Eigen::Vector3d::Zero();  // where the three slices meet, mm
  double threshold_hu = 0;                          // least value of bone
  std::vector<CtSeed> seeds = {};
  double turn_deg = 25, tilt_deg = 10;  // of the 3-D view: to the patient's left, upward
  bool operator==(const CtChoice&) const = default;
};

/// Pixels, 8-bit RGBA, opaque, rows from the top.
struct CtPixels {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba = {};
};

/// A slice as drawn: grey values in the window of bone, with the outlines of bone and skin.
struct CtSliceView {
  std::string name = {};                             // "Axial"
  std::shared_ptr<const CtPixels> picture = {};      // none: not drawn yet
  double width_mm = 1, height_mm = 1;                // of the picture
  Eigen::Vector3d corner = Eigen::Vector3d::Zero();  // its top left one, mm
  Eigen::Vector3d right = Eigen::Vector3d::UnitX();  // unit directions in the picture
  Eigen::Vector3d down = Eigen::Vector3d::UnitY();
  Eigen::Vector3d step = Eigen::Vector3d::UnitZ();  // to the next slice, mm
  std::array<std::string, 4> sides = {};            // letters at the left, right, top and bottom
  int number = 0, count = 0;                        // of the slice, from 1, and of all
};

enum class CtStage { listing, series, reading, slices, making };

/// A CT that is imported in a front end.
struct CtView {
  int opened = 0;  // number of this import
  CtStage stage = CtStage::listing;
  std::string name = {};  // of the folder or file that the user named
  std::vector<CtSeriesItem> series = {};
  std::vector<std::string> notes = {};  // of the folder
  int best = -1;                        // index of the series to be read by default; -1: none
  std::string no_best = {};             // why there is none
  // Of the volume that was read:
  std::vector<std::string> volume_notes = {};
  CtChoice first = {};           // before the user changes it
  CtChoice chosen = {};          // its pictures may still be being drawn
  std::string seed_remark = {};  // on seeds that are not on bone
  double lowest_hu = -200, highest_hu = 2000;
  std::array<CtSliceView, 3> slices = {};      // axial, coronal, sagittal
  std::shared_ptr<const CtPixels> solid = {};  // 3-D view of the bone
  std::filesystem::path case_folder = {};      // proposed for the patient
};

}  // namespace condyle
