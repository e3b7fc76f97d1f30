#pragma once

#include "engine/minimize/minimize.h"
#include "engine/tissue/hessian_factor.h"

namespace condyle {

/// When the preconditioner is refactored, in iterations: fixed, so that results do not depend on
/// timing. A factorisation costs as much as a dozen iterations, and several dozen in large meshes.
/// Far from the minimum a factor is useful for few iterations, because the set of compressed
/// springs changes with each; near it the exact Hessian, where positive definite, is useful for
/// many.
struct RefactorPolicy {
  int first = 1;     // with the given factor
  int far = 1;       // number of factors computed far from the minimum
  int each_far = 4;  // with each of them
  int later = 9;     // with each of the next two; three more for each further pair
  int most = 16;
  /// Whether convergence must be confirmed with an exact factor: with any other, a plateau before
  /// buckling resembles a minimum.
  bool confirm = false;
};
/// For meshes of ten thousand nodes and more.
constexpr RefactorPolicy large_mesh_policy{
    .first = 1, .far = 2, .each_far = 1, .later = 8, .most = 20, .confirm = true};
/// For meshes of 40,000 nodes and more.
constexpr RefactorPolicy largest_mesh_policy{
    .first = 1, .far = 2, .each_far = 2, .later = 20, .most = 60, .confirm = true};

/// Minimisation far from the state of the given factor: newly compressed springs and rotated tissue
/// require refactorisation at intermediate states.
MinimizeResult minimize_with_refactorization(const SpringPrismMesh& mesh, const MeshLoads& loads,
                                             SpringPrismEnergy& energy, const HessianFactor& factor,
                                             const MinimizeSettings& settings, Nodes& x,
                                             const RefactorPolicy& schedule = {});

}  // namespace condyle
