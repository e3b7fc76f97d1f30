#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "engine/collide/distance_field.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

struct SampleSettings {
  double spacing_mm =
      0.4;  // on faces and flat edges; 0.6 gives equivalent sliding in three quarters of the time
  // Two edges can cross between samples: on a convex edge the samples are so dense that the edge
  // rises above them by at most this, down to the least spacing.
  double edge_rise_mm = 0.03;
  double edge_spacing_mm = 0.1;
  std::optional<Box> region;  // only samples within (body coordinates)
  // Samples nearer to each other than this fraction of the spacing are merged where the surface
  // between them rises by no more than edge_rise_mm; 0: none.
  double thin_fraction = 0.75;
};

/// Points spread over a surface, in a tree of balls.
struct SurfaceSamples {
  struct alignas(32) Ball {  // bounds a range of points
    Eigen::Vector3f center;
    float radius = 0;  // rounded up
    int first = 0, count = 0;
    int right = 0;   // second child (the first is next); 0 for a leaf
    int block = -1;  // of a leaf: index of its points in `blocks`
  };
  std::vector<Eigen::Vector3d> points;   // in the order of the balls
  std::vector<Eigen::Vector3d> normals;  // unit, outward
  std::vector<float> spread;             // cosine of the widest angle to a face's normal there
  std::vector<Ball> balls;               // depth first
  // The points of each leaf relative to its centre; unused entries repeat the last point.
  std::vector<DistanceField::Batch16> blocks;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  double gyration_mm = 0;  // root mean square distance from the centroid
};

/// Samples vertices, edges and faces about one spacing apart, convex edges more densely; concave
/// edges at their ends only. The mesh must be welded.
SurfaceSamples sample_surface(const TriMesh& mesh, const SampleSettings& settings = {});

}  // namespace condyle
