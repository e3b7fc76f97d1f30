#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "engine/mesh/tri_mesh.h"
#include "sim/case/eyes.h"
#include "sim/tissue/anatomy.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/oral_fissure.h"

namespace condyle {

/// The simulated part of the face, and how deep inside it a point lies.
struct RegionShape {
  Anatomy anatomy;
  double floor_z = 0;  // the neck below this is fixed
  bool upper_face = false;
  double forehead_z = 0;  // of the upper face: what is above this is fixed

  /// About the distance to the region's rim, mm; negative outside. The region is the face from the
  /// cheek bones down, or from the upper forehead, back to the ears, and below them the front and
  /// sides of the neck.
  double inside(const Eigen::Vector3d& p) const;
};

struct SkinRegion {
  RegionShape shape;
  TriMesh mesh;             // manifold, connected, the lips separated
  std::vector<int> rim;     // vertices on the cut towards the rest of the face: these are fixed
  std::vector<int> border;  // vertices on free borders of the face, the mouth excluded
  MouthOutline mouth;       // indices into mesh; may be empty
  OralFissure fissure;
  std::optional<Eyes> eyes;  // within the region; none: it ends below them
  std::vector<signed char>
      face_side;  // of every vertex of the face part: +1 above the lip line, -1 below
  // The point of the skin with which each vertex of the face part moves: itself, except of the
  // lining of the lips.
  std::vector<Eigen::Vector3d> carried_at;
};

/// The lining behind the lips, if the face has one, is not part of the region. `upper_face`: with
/// forehead and eyes, where the eyes are known.
/// throws: InputError when the face has nothing in the region.
SkinRegion cut_region(const TriMesh& face, const Landmarks& landmarks, const Anatomy& anatomy,
                      bool upper_face, std::vector<std::string>& notes);

}  // namespace condyle
