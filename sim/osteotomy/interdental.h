#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "engine/mesh/triangle_tree.h"
#include "sim/osteotomy/surgical_anatomy.h"

namespace condyle {

/// Above the crest of the bone between two teeth, which is parted with a thin chisel, their roots
/// may come nearer to the cut.
constexpr double crest_mm = 3;
/// Crowns that touch may reach so far beyond a cut between them.
constexpr double grazed_crown_mm = 0.5;

/// Corners of a tooth: its root, more than crest_mm from the crest of the bone, and the rest.
struct NeighbourTooth {
  std::vector<Eigen::Vector3d> root, crown;
};
/// The crest is where the first corner lies in the bone, along the tooth from its crown. No root
/// where fewer than a tenth of the corners lie in the bone.
NeighbourTooth split_tooth(std::vector<Eigen::Vector3d> points, const TriangleTree& bone);

/// The plane between two neighbouring teeth that lies farthest from them.
struct InterdentalPlane {
  int first = 0, second = 0;      // FDI numbers
  Eigen::Vector3d point, normal;  // patient's axes; the normal points from the first to the second
  double root_mm = 0;             // least distance of the roots; infinite where none is known
  double crown_mm = 0;            // least distance of the crowns; negative: it grazes them
};

/// Turned up to 20 degrees about the vertical and tilted up to 15. Of the planes that cut no crown
/// the one farthest from the roots; where the crowns leave none, they are cut by the least. Absent
/// without both teeth by themselves.
std::optional<InterdentalPlane> find_interdental(const SurgicalAnatomy& jaw, int first, int second);

/// "teeth 22 and 23: their roots leave 1.2 mm for the cut; 1 mm of bone on each and the saw need
/// 2.6 mm".
std::string room_text(const InterdentalPlane& plane, double kerf_mm);

}  // namespace condyle
