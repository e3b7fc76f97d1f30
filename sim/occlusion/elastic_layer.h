#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/collide/contact_twist.h"
#include "engine/collide/distance_field.h"
#include "engine/math/pose.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// A thin compliant layer between two surfaces, as articulating film: compressed where the gap g is
/// smaller than its thickness h, with pressure S (h / g - 1), which is unbounded as g vanishes.
/// Below a twentieth of the thickness, and in overlap, the pressure is continued along its tangent.
struct ElasticLayer {
  double thickness_mm = 0.1;
  double stiffness_MPa = 200;  // S: the pressure that halves the thickness

  struct Response {
    double energy = 0;     // N mm / mm^2
    double pressure = 0;   // N / mm^2: -d(energy)/d(gap)
    double stiffness = 0;  // N / mm^3: second derivative of the energy
  };
  Response at(double gap_mm) const;
};

/// A surface as points that each represent a small piece of it, in a tree of bounding balls.
struct LayerSurface {
  struct Piece {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    double area_mm2 = 0;
    int triangle = 0;  // of the mesh
  };
  struct Ball {  // of consecutive pieces
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    double radius = 0;
    int first = 0, count = 0;
    int right = 0;  // second child (the first is next); 0 for a leaf
  };
  std::vector<Piece> pieces;
  std::vector<Ball> balls;  // depth first
};

/// Samples the triangles with centroid in the box: pieces no longer than the spacing, and narrow
/// pieces along sharp convex edges. The mesh must be welded.
LayerSurface make_layer_surface(const TriMesh& mesh, const Box& region, double spacing_mm);

/// Energy and derivatives of the layer between a fixed and a moving surface at a pose.
struct LayerForce {
  double energy = 0;               // N mm
  Twist gradient = Twist::Zero();  // of the energy with respect to a twist of the moving body, N
  Eigen::Matrix<double, 6, 6> hessian = Eigen::Matrix<double, 6, 6>::Zero();  // Gauss-Newton, N/mm
  double area_mm2 = 0;    // of the compressed layer
  double min_gap_mm = 0;  // from the distance fields; their band where nothing is near
};

/// Two surfaces with a layer between them. The pieces of each side are evaluated in the distance
/// field of the other, each with half the weight.
class LayerContact {
 public:
  struct Side {
    const LayerSurface* surface;
    const DistanceField* field;
  };
  LayerContact(Side fixed, Side moving, const ElasticLayer& layer)
      : fixed_(fixed), moving_(moving), layer_(layer) {}

  /// Twists are about the point `pivot` (moving coordinates), with rotations scaled by
  /// `rotation_length_mm`. Bit-identical for any number of threads.
  LayerForce evaluate(const Pose& X_FM, const Eigen::Vector3d& pivot, double rotation_length_mm,
                      int threads = 1) const;

  /// Whether no piece is within the layer's thickness of the other surface, or inside it.
  bool free(const Pose& X_FM) const;

  const ElasticLayer& layer() const { return layer_; }

  /// A loaded piece of the moving surface.
  struct LoadedPiece {
    int piece = 0;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  // fixed coordinates
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    double gap_mm = 0;
    double force_N = 0;
  };
  std::vector<LoadedPiece> loaded_pieces(const Pose& X_FM) const;

 private:
  Side fixed_, moving_;
  ElasticLayer layer_;
};

}  // namespace condyle
