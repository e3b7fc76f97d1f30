#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/collide/signed_surface.h"

namespace condyle {

/// One connected piece of a contact.
struct ContactPatch {
  double area_mm2 = 0;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  // world
  double depth_mm = 0;                                 // deepest point of B's surface in A
  Eigen::Vector3d deepest = Eigen::Vector3d::Zero();   // that point, world
  int triangle = -1;                                   // of B, under it
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    // mean, from A to B; zero if it cancels
  Box box;                                             // around it, world
};

/// Where surface B lies inside A or near to it.
struct ContactRegion {
  double area_mm2 = 0;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  // world; weighted by area
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    // mean, from A to B; zero without area
  std::vector<ContactPatch> patches;                   // largest first
};

struct RegionSettings {
  double within_mm = 0.1;  // from A counts as contact
  // Triangles at the rim are divided to this size and then cut by the distance, taken as linear.
  // Patches nearer to each other than twice this are one.
  double resolution_mm = 0.25;
};

/// Area of B's surface inside A or within a distance of it, by patches. B's triangles may be of any
/// size: pieces entirely inside or outside are classified by one distance, because distances change
/// by at most one millimetre per millimetre.
ContactRegion contact_region(const SignedSurface& a, const Pose& X_WA, const TriMesh& b,
                             const Pose& X_WB, const RegionSettings& settings = {});

/// Volume inside both surfaces.
struct OverlapVolume {
  double mm3 = 0;
  double error_mm3 = 0;  // largest difference from the results of grids of half the resolution
};

/// Both are cut into columns along the shortest side of their common box; along a column the common
/// length is exact, across it the midpoint rule applies (`columns`: number of columns along either
/// side of the common box). Only closed shells have an inside; see closed_shells.
OverlapVolume overlap_volume(const TriMesh& a, const Pose& X_WA, const TriMesh& b, const Pose& X_WB,
                             int columns = 256);

}  // namespace condyle
