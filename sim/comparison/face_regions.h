#pragma once

#include <array>
#include <string>
#include <vector>

#include "engine/mesh/tri_mesh.h"
#include "sim/case/landmarks.h"

namespace condyle {

/// Regions of the skin. The upper face lies above operations of the jaws: it is what surfaces are
/// registered on.
enum class FaceRegion { none, nose, upper_lip, lower_lip, chin, right_cheek, left_cheek, upper };

inline constexpr std::array face_regions{
    FaceRegion::nose,        FaceRegion::upper_lip,  FaceRegion::lower_lip, FaceRegion::chin,
    FaceRegion::right_cheek, FaceRegion::left_cheek, FaceRegion::upper};

/// "nose", "upper lip", "right cheek", "upper face".
std::string region_name(FaceRegion region);

/// Region of each vertex, along the patient's own axes (those of LPS where the landmarks for them
/// are missing): nose from sellion to subnasale, as wide as the alares; lips between the cheilions,
/// parted at stomion, the lower one down to soft_b_point; chin down to soft_menton; cheeks beside
/// these, from the orbits' lower rims to soft_menton and back to halfway between exocanthion and
/// tragion; upper face above the orbits' lower rims and in front of the tragions. The inside of
/// nostrils, lips and lids belongs to no region.
/// throws: InputError naming the landmarks that the face lacks.
std::vector<FaceRegion> regions_of_face(const TriMesh& face, const Landmarks& landmarks,
                                        int threads = 2);

/// Landmarks of the skin that operations of the jaws leave in place.
const std::vector<std::string>& stable_soft_landmarks();

}  // namespace condyle
