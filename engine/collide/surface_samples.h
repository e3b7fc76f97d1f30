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
      0.4;  // on faces and flat edges; 0.6 slides as well, in three quarters of the time
  // Two edges cross between samples: on a convex edge they lie so near each other that it cannot
  // rise above them by more than this, down to the least spacing.
  double edge_rise_mm = 0.03;
  double edge_spacing_mm = 0.1;
  std::optional<Box> region;  // only samples within (body coordinates)
  // Samples nearer than this share of the spacing are one, where the surface between them bends no
  // more than an edge may rise; 0: all stay.
  double thin_share = 0.75;
};

/// Points spread over a surface, in a tree of balls.
struct SurfaceSamples {
  struct alignas(32) Ball {  // of a run of points
    Eigen::Vector3f center;
    float radius = 0;  // rounded up
    int first = 0, count = 0;
    int right = 0;   // second child (the first is next); 0 for a leaf
    int block = -1;  // of a leaf: its points once more
  };
  std::vector<Eigen::Vector3d> points;   // in the order of the balls
  std::vector<Eigen::Vector3d> normals;  // unit, outward
  std::vector<float> spread;             // cosine of the widest angle to a face's normal there
  std::vector<Ball> balls;               // depth first
  // Of each leaf, from its centre; the last point stands in the places that are left.
  std::vector<DistanceField::Sixteen> blocks;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  double gyration_mm = 0;  // root mean square distance from the centroid
};

/// Vertices, edges and faces sampled about a spacing apart, convex edges closer; concave edges by
/// their ends. The mesh must be welded.
SurfaceSamples sample_surface(const TriMesh& mesh, const SampleSettings& settings = {});

}  // namespace condyle
