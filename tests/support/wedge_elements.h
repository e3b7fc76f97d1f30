#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "engine/minimize/objective.h"
#include "engine/tissue/spring_prism.h"

/// A reference independent of springs and prism volumes: finite elements of a hyperelastic body.
namespace condyle::fe {

/// Lame's constants, MPa.
struct Material {
  double shear = 0, lame = 0;
  static Material of(double young_MPa, double poisson);
};

/// Six-node wedges with six integration points. Compressible neo-Hookean material, whose volume
/// term has the mean dilatation of the element, so that nearly incompressible tissue does not lock:
/// W = mu/2 (tr F'F - 3 - 2 ln det F) + lambda/2 (mean det F - 1)^2.
/// source: after Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, 2008.
class WedgeBody {
 public:
  /// Corners 0 1 2 counter-clockwise seen from outside, 3 4 5 below them; one material for each
  /// wedge. throws: std::invalid_argument for a wedge that is inside out at an integration point.
  WedgeBody(const Nodes& rest, const std::vector<std::array<int, 6>>& wedges,
            const std::vector<Material>& material);

  /// mJ; infinite where an element is inside out at an integration point. Adds its gradient where
  /// one is given.
  double energy(const Nodes& x, Nodes* gradient, int threads) const;
  Objective::Curvature curvature(const Nodes& x, const Nodes& d, int threads) const;

 private:
  static constexpr int points = 6;
  using Slopes = Eigen::Matrix<double, 3, 6>;  // of the shape functions by rest position
  struct Wedge {
    std::array<int, 6> node;
    std::array<Slopes, points> slope;
    std::array<double, points> weight;  // mm^3
    double volume;
    Material material;
  };
  double energy_of(const Wedge& wedge, const Nodes& x, Nodes* gradient) const;
  Objective::Curvature curvature_of(const Wedge& wedge, const Nodes& x, const Nodes& d) const;

  std::vector<Wedge> wedges_;
};

/// The body with anchors, node forces and contacts, all times mesh.lambda, as SpringPrismEnergy has
/// them; without muscles.
class WedgeEnergy final : public Objective {
 public:
  WedgeEnergy(const WedgeBody& body, const SpringPrismMesh& mesh, const MeshLoads& loads,
              int threads)
      : body_(body), mesh_(mesh), loads_(loads), threads_(threads) {}
  double value(const Nodes& x) override;
  double value_and_gradient(const Nodes& x, Nodes& gradient) override;
  Curvature curvature(const Nodes& x, const Nodes& d) override;

 private:
  double energy(const Nodes& x, Nodes* gradient);

  const WedgeBody& body_;
  const SpringPrismMesh& mesh_;
  const MeshLoads& loads_;
  int threads_;
};

}  // namespace condyle::fe
