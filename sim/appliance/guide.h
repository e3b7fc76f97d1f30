#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "sim/appliance/appliance.h"
#include "sim/appliance/cut_line.h"
#include "sim/appliance/saws.h"
#include "sim/appliance/shape_lengths.h"
#include "sim/osteotomy/danger_zones.h"
#include "sim/plan/clinical_frame.h"

namespace condyle {

/// The part of a cut that a guide leads.
enum class GuideSide { both, left, right };

struct GuideSettings {
  Saw saw;
  double tolerance_mm = 0.25;  // of the printer, at each side of the blade
  double reach_mm = 11;        // of the shell, from the cut
  double shell_mm = 2.5;       // thickness
  double height_mm = 8;        // of the slot's walls, from the bone
  double slot_wall_mm = 2;     // thickness of those
  double hole_mm = 2;          // diameter of the screw holes; 0: none
  double gap_mm = 0.1;         // between bone and shell
  double grip_mm = 0.4;        // deepest undercut that the shell holds
  double voxel_mm = 0.2;
  GuideSide side = GuideSide::both;
  /// Where it comes from, unit, clinical frame (left, back, up); absent: the direction that shows
  /// most of the cut.
  std::optional<Eigen::Vector3d> from = {};
  int threads = 1;
};

inline constexpr std::array guide_lengths{
    ShapeLength<GuideSettings>{"tolerance", &GuideSettings::tolerance_mm, 0, 1,
                               "Room at each side of the blade"},
    ShapeLength<GuideSettings>{"reach", &GuideSettings::reach_mm, 6, 25,
                               "Width of the shell on each side of the cut"},
    ShapeLength<GuideSettings>{"shell", &GuideSettings::shell_mm, 1.2, 6, "Thickness of the shell"},
    ShapeLength<GuideSettings>{"height", &GuideSettings::height_mm, 2, 20,
                               "Height of the slot's walls"},
    ShapeLength<GuideSettings>{"slot-wall", &GuideSettings::slot_wall_mm, 1.2, 5,
                               "Thickness of the slot's walls"},
    ShapeLength<GuideSettings>{"hole", &GuideSettings::hole_mm, 0, 4,
                               "Diameter of the screw holes, 0 for none"},
    ShapeLength<GuideSettings>{"gap", &GuideSettings::gap_mm, 0, 0.5, "Gap between bone and shell"},
    ShapeLength<GuideSettings>{"grip", &GuideSettings::grip_mm, 0, 1,
                               "Deepest undercut that the shell holds"},
    ShapeLength<GuideSettings>{"voxel", &GuideSettings::voxel_mm, least_voxel_mm, largest_voxel_mm,
                               "Spacing of the samples"}};

/// What a guide lies on, at rest: closed surfaces, cranium.
struct GuideSupport {
  std::string name;
  TriMesh bone;
  TriMesh teeth;                         // that it keeps away from; may be empty
  std::vector<DangerZone> dangers = {};  // that screws keep away from
  ClinicalFrame frame = {};              // sides of the patient, and directions
};

/// A piece of a slot along which the finished surface lacks a wall.
struct SlotGap {
  Eigen::Vector3d from, to;  // on the bone
  double length_mm = 0;
  bool both = false;  // walls; else one
};

/// A straight piece of the slot, and its width between the walls of the finished surface.
struct GuideSlot {
  Eigen::Vector3d from, to;  // on the bone
  double length_mm = 0;
  double guided_mm = 0;       // of it with walls on both sides of the blade
  std::vector<SlotGap> gaps;  // the rest
  double width_min_mm = 0, width_max_mm = 0;
  double wall_min_mm = 0;  // thinnest of its walls
};

struct ScrewHole {
  Eigen::Vector3d point, axis;  // on the bone; outward, unit
  double diameter_mm = 0;       // measured
};

struct Guide {
  TriMesh mesh;  // cranium at rest, mm
  std::string on;
  std::vector<CrossedBone> bones;  // that the cut passes through, as in CutLine
  ApplianceMeasure measure;
  double slot_mm = 0;  // intended width
  double bone_mm = 0;  // thickness of the bone in the saw's direction, median
  // Length of the cut on this side of the bone, of its slots, and of those between two walls.
  double line_mm = 0, led_mm = 0, guided_mm = 0;
  std::vector<GuideSlot> slots;
  std::vector<ScrewHole> holes;
  std::vector<std::string> notes;
};

/// A shell on the bone about a cut, with slots for the saw, walls that lead it, and screw holes.
/// Deterministic for any number of threads. throws: InputError for settings out of range, a saw
/// thicker than the bone, a cut that no slot can lead from there, and walls below 1 mm.
Guide make_guide(const GuideSupport& support, const CutLine& line, const GuideSettings& settings,
                 const Progress& progress = {});

/// The bone of a cut line with the teeth and dangers of its body. throws: InputError where it
/// cannot be closed.
GuideSupport guide_support(const Case& patient, const Plan& plan, const CutLine& line,
                           std::vector<std::string>& notes);

}  // namespace condyle
