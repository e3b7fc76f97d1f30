#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/registration/similarity_fit.h"

namespace condyle {

/// Where one point shall go: onto a plane, and less strongly onto a point of it.
struct Pull {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   // where it is now
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  // where it shall go
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit, of the plane through the target
  double weight = 1;
};

struct LayerSettings {
  double reach_mm = 100;   // a control point moves what lies within this distance
  double spacing_mm = 20;  // of the control points
  int max_controls = 600;
  double stiffness = 0.6;   // resistance to displacement
  double tangential = 0.1;  // weight of the distance along the plane; 1: point to point
};

/// A smooth displacement: control points with a kernel of bounded reach.
class DisplacementLayer {
 public:
  /// Least squares of the pulls and of the energy of the displacement. Deterministic.
  DisplacementLayer(std::span<const Pull> pulls, const LayerSettings& settings);

  Eigen::Vector3d operator()(const Eigen::Vector3d& p) const;  // displaced point

  int controls() const { return static_cast<int>(centers_.size()); }

 private:
  using Row = std::vector<std::pair<int, double>>;  // control, kernel value
  Row row_of(const Eigen::Vector3d& p) const;
  std::int64_t cell_of(const Eigen::Vector3d& p, int dx, int dy, int dz) const;
  void add_center(const Eigen::Vector3d& p);
  template <class Visit>
  void visit_near(const Eigen::Vector3d& p, const Visit& visit) const;
  void choose_centers(std::span<const Pull> pulls, const LayerSettings& settings);
  void solve(std::span<const Pull> pulls, const LayerSettings& settings);

  double reach_ = 0;
  std::vector<Eigen::Vector3d> centers_, moves_;
  std::unordered_map<std::int64_t, std::vector<int>> cells_;  // controls that may reach a cell
};

/// An affine map followed by smooth displacements.
struct Deformation {
  AffineMap affine;
  std::vector<DisplacementLayer> layers;

  Eigen::Vector3d operator()(Eigen::Vector3d p) const {
    p = affine * p;
    for (const auto& layer : layers) p = layer(p);
    return p;
  }
  /// All points carried, on a number of threads.
  std::vector<Eigen::Vector3d> carried(std::span<const Eigen::Vector3d> points, int threads) const;
};

}  // namespace condyle
