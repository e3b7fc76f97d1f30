#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "engine/math/pose.h"
#include "sim/frame/part.h"

namespace condyle {

/// What lines the mouth from a face's rim behind the lips to the throat: round both arches, under
/// the palate, over the floor. With it the face has an inside that leaves the mouth hollow. mm, at
/// rest. Where bone, gums or tongue are, it lies within them: they are what is seen there.
struct MouthLining {
  std::vector<int> rim;               // vertices of the face, one after the other round the mouth
  bool cut = false;                   // the rim is where triangles were left out: see even_rim
  std::vector<Eigen::Vector3f> rest;  // rings of as many, the first in the rim; then the throat
  std::vector<float> jaw;             // how far each goes with the mandible, 0 to 1
  std::vector<float> lip;             // and with what the rim does beside that, 0 to 1
  std::vector<Eigen::Vector3i> triangles;  // of `rest`; their front looks into the mouth
  std::vector<Eigen::Vector3i> face;       // what is drawn of the face with it: as far as the rim
  float mid_z = 0;                         // height of the closed lips
};

/// None for a face without such a rim. The jaws' fronts stand in for teeth that are no parts of
/// their own; none for a patient who has neither. drawn: in place of the face's mesh.
std::optional<MouthLining> line_mouth(std::span<const Part> parts, const TriMesh* drawn = nullptr);

/// Draws the places of a rim's vertices together to an even line: where triangles were left out it
/// is ragged.
void even_rim(std::vector<Eigen::Vector3f>& places, std::span<const int> rim);

/// Where it is with the rim's vertices and the mandible where they are now.
std::vector<Eigen::Vector3f> places_now(const MouthLining& lining,
                                        std::span<const Eigen::Vector3f> rim, const Pose& X_CM);

/// Triangles of the face's vertices that would close its rim.
std::vector<Eigen::Vector3i> rim_fan(const MouthLining& lining);

}  // namespace condyle
