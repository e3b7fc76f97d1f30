#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "engine/math/pose.h"
#include "sim/frame/part.h"

namespace condyle {

inline const Eigen::Vector3f tongue_color(0.66f, 0.37f, 0.36f);  // of the lining's tongue

/// The lining of the mouth from the face's rim behind the lips to the throat: around both arches,
/// under the palate, over the floor. It closes the face so that the mouth is a cavity. mm, at rest.
/// It lies within bone, gums and tongue, which are visible instead of it. A patient without a
/// tongue gets one: the floor rises between the lower crowns.
struct MouthLining {
  std::vector<int> rim;               // vertices of the face, in order around the mouth
  bool cut = false;                   // the rim is a border of removed triangles: see even_rim
  std::vector<Eigen::Vector3f> rest;  // rings of equal size, the first at the rim; then the throat
  std::vector<float> jaw;             // how far each follows the mandible, 0 to 1
  std::vector<float> lip;             // and the deformation of the rim beyond that, 0 to 1
  std::vector<float> tongue;          // how far each is the back of a tongue, 0 to 1
  std::vector<Eigen::Vector3i> triangles;  // of `rest`; facing into the mouth
  std::vector<Eigen::Vector3i> face;       // the displayed triangles of the face: up to the rim
  float mid_z = 0;                         // height of the closed lips
};

/// None for a face without such a rim. The fronts of the jaws replace teeth that are not separate
/// parts; none for a patient with neither. drawn: replaces the face's mesh.
std::optional<MouthLining> line_mouth(std::span<const Part> parts, const TriMesh* drawn = nullptr);

/// Smooths the positions of a rim's vertices: where triangles were removed it is ragged.
void even_rim(std::vector<Eigen::Vector3f>& places, std::span<const int> rim);

/// Current positions for the current rim and mandible.
std::vector<Eigen::Vector3f> places_now(const MouthLining& lining,
                                        std::span<const Eigen::Vector3f> rim, const Pose& X_CM);

/// Triangles of the face's vertices that would close its rim.
std::vector<Eigen::Vector3i> rim_fan(const MouthLining& lining);

}  // namespace condyle
