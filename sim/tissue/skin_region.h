#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/mesh/tri_mesh.h"
#include "sim/tissue/anatomy.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/slit.h"

namespace condyle {

/// The part of the face that is simulated, and how deep inside it a point lies.
struct RegionShape {
  Anatomy anatomy;
  double floor_z = 0;  // neck below this stays put

  /// About the distance to the region's rim, mm; negative outside. The region is the face from the
  /// cheek bones down, back to the ears, and below them the front and sides of the neck.
  double inside(const Eigen::Vector3d& p) const;
};

struct SkinRegion {
  RegionShape shape;
  TriMesh mesh;             // manifold, one piece, the lips parted
  std::vector<int> rim;     // vertices on the cut toward the rest of the face: these stay put
  std::vector<int> border;  // vertices on borders that the face itself has, the mouth's left out
  MouthOutline mouth;       // indices into mesh; may be empty
  LipSlit slit;
  std::vector<signed char>
      face_side;  // of every vertex of the face part: +1 above the lip line, -1 below
};

/// The lining behind the lips, where the face has one, is not part of the region.
/// throws: InputError when the face has nothing in the region.
SkinRegion cut_region(const TriMesh& face, const Landmarks& landmarks, const Anatomy& anatomy,
                      std::vector<std::string>& notes);

}  // namespace condyle
