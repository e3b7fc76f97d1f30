#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/collide/contact_twist.h"
#include "engine/collide/distance_field.h"
#include "engine/math/pose.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// A thin elastic foil between two surfaces: it is pressed where the gap g is less than its
/// thickness h, with the pressure S (h / g - 1), which no force can press to nothing. Below a
/// twentieth of the thickness, and in overlap, the pressure goes on along its tangent.
struct Foil {
  double thickness_mm = 0.1;
  double stiffness_MPa = 200;  // S: the pressure that halves the foil

  struct Answer {
    double energy = 0;     // N mm / mm^2
    double pressure = 0;   // N / mm^2: minus the energy's slope against the gap
    double stiffness = 0;  // N / mm^3: the energy's second derivative
  };
  Answer at(double gap_mm) const;
};

/// A surface as points that each stand for a piece of it, in a tree of balls.
struct FoilSurface {
  struct Piece {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    double area_mm2 = 0;
    int triangle = 0;  // of the mesh
  };
  struct Ball {  // of a run of pieces
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    double radius = 0;
    int first = 0, count = 0;
    int right = 0;  // second child (the first is next); 0 for a leaf
  };
  std::vector<Piece> pieces;
  std::vector<Ball> balls;  // depth first
};

/// The triangles with their middle in the box, divided into pieces not longer than the spacing, and
/// narrow pieces along sharp convex edges. The mesh must be welded.
FoilSurface make_foil_surface(const TriMesh& mesh, const Box& region, double spacing_mm);

/// What the foil between a fixed and a moving surface does at a pose.
struct FoilForce {
  double energy = 0;               // N mm
  Twist gradient = Twist::Zero();  // of the energy against a twist of the moving body, N
  Eigen::Matrix<double, 6, 6> hessian = Eigen::Matrix<double, 6, 6>::Zero();  // Gauss-Newton, N/mm
  double area_mm2 = 0;                                                        // where it is pressed
  double least_gap_mm = 0;  // by the fields; the band where nothing is near
};

/// Two surfaces with a foil between them. Each side's pieces are measured in the field of the
/// other, and both count half.
class FoilContact {
 public:
  struct Side {
    const FoilSurface* surface;
    const DistanceField* field;
  };
  FoilContact(Side fixed, Side moving, const Foil& foil)
      : fixed_(fixed), moving_(moving), foil_(foil) {}

  /// Twists are about the point `pivot` (moving coordinates), turned at `rotation_length_mm`. Same
  /// bits for any number of threads.
  FoilForce press(const Pose& X_FM, const Eigen::Vector3d& pivot, double rotation_length_mm,
                  int threads = 1) const;

  /// No piece is in the foil's thickness of the other surface, or inside it.
  bool free(const Pose& X_FM) const;

  const Foil& foil() const { return foil_; }

  /// A piece of the moving surface that presses.
  struct Pressed {
    int piece = 0;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  // fixed coordinates
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    double gap_mm = 0;
    double force_N = 0;
  };
  std::vector<Pressed> pressed(const Pose& X_FM) const;

 private:
  Side fixed_, moving_;
  Foil foil_;
};

}  // namespace condyle
