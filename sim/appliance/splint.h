#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "engine/math/pose.h"
#include "sim/appliance/appliance.h"
#include "sim/appliance/shape_lengths.h"

namespace condyle {

/// A dental arch as a splint sees it: closed surface and directions, cranium, mm.
struct SplintArch {
  std::string name;                                // of its part, for messages
  TriMesh mesh;                                    // closed; shells may overlap
  Eigen::Vector3d edge = Eigen::Vector3d::Zero();  // midpoint of the incisal edge
  std::array<Eigen::Vector3d, 2> molars;           // cusps of the first molars: left, right
};

/// Both arches at the positions that the splint holds.
struct SplintArches {
  SplintArch upper, lower;
  std::optional<std::array<Eigen::Vector3d, 2>> condyles;  // axis of the hinge: left, right
  std::vector<std::string> notes = {};
};

struct SplintSettings {
  double thickness_mm = 1.5;  // least between cusps
  double depth_mm = 2;        // of the prints, from the tips of the teeth
  double wall_mm = 2.5;       // beside the teeth
  double gap_mm = 0.1;        // between teeth and print
  double grip_mm = 0.4;       // deepest undercut that the print holds
  double voxel_mm = 0.2;
  std::optional<double> opening_mm = {};  // at the incisors, by the hinge; absent: what is needed
  int threads = 1;
};

inline constexpr std::array splint_lengths{
    ShapeLength<SplintSettings>{"thickness", &SplintSettings::thickness_mm, 0.5, 10,
                                "Least thickness between cusps"},
    ShapeLength<SplintSettings>{"depth", &SplintSettings::depth_mm, 0.5, 6,
                                "Depth of the prints from the tips of the teeth"},
    ShapeLength<SplintSettings>{"wall", &SplintSettings::wall_mm, 1.2, 6, "Width beside the teeth"},
    ShapeLength<SplintSettings>{"gap", &SplintSettings::gap_mm, 0, 0.5,
                                "Gap between teeth and print"},
    ShapeLength<SplintSettings>{"grip", &SplintSettings::grip_mm, 0, 1,
                                "Deepest undercut that the print holds"},
    ShapeLength<SplintSettings>{"voxel", &SplintSettings::voxel_mm, least_voxel_mm,
                                largest_voxel_mm, "Spacing of the samples"}};

/// An occlusal splint between two arches.
struct Splint {
  TriMesh mesh;                                      // cranium, mm
  Pose X_lower;                                      // rotation of the lower arch about the hinge
  double opening_mm = 0, opening_deg = 0;            // of the bite, at the lower incisal edge
  double clearance_before_mm = 0, clearance_mm = 0;  // between the arches; negative: overlap
  double thickness_mm = 0;  // least distance between the prints, measured on the surface
  ApplianceMeasure measure;
  std::vector<std::string> notes;
};

/// Opens the bite by the hinge until the splint has its thickness, forms a plate around the crowns,
/// prints both arches into it, and measures the surface. Each print is widened where the splint
/// could not be taken off with its grip. Deterministic for any number of threads.
/// throws: InputError for settings out of range, an arch that is too short or has no tips, a bite
/// without room where the opening is given, and one that no hinge opens.
Splint make_splint(const SplintArches& arches, const SplintSettings& settings,
                   const Progress& progress = {});

}  // namespace condyle
