#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/cut/region.h"
#include "sim/operation/operation.h"

namespace condyle {

/// Where a wall of a saw cut leaves the bone: a short piece of its border, cranium at rest.
struct CutEdge {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // its middle
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // of the bone's surface there
  double length_mm = 0;
  int wall = 0;  // index into CutLine::walls
};

/// A bone that a cut passes through, and the length of its line on it.
struct CrossedBone {
  std::string name;  // part of the uncut case
  double length_mm = 0;
};

/// The lines in which a cut step leaves a bone.
struct CutLine {
  int step = 0;
  std::string title;               // "cut le_fort_1"
  std::string bone;                // part of the uncut case whose edges these are
  std::vector<CrossedBone> bones;  // all that the cut passes through, longest line first
  std::vector<Plane> walls;        // in the middle of the kerf
  std::vector<CutEdge> edges;
};

/// The lines of a cut of the plan. `cut`: number of its step, name of its osteotomy, or of a
/// segment that it makes. `on`: the bone; empty: that with the longest line. throws: InputError for
/// a cut that the plan lacks or has more than once, listing those that it has, one that meets no
/// bone, and a bone that it does not pass through, listing those that it does.
CutLine find_cut_line(const Operated& operated, const Plan& plan, const std::string& cut,
                      const std::string& on = {});

}  // namespace condyle
