#include "engine/tissue/own_stiffness.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>

namespace condyle {

using Eigen::Matrix3d;
using Eigen::Vector3d;

std::vector<double> own_stiffness(const SpringPrismMesh& mesh, const Nodes& x) {
  std::vector<Matrix3d> own(x.size(), Matrix3d::Zero());
  for (std::size_t s = 0; s < mesh.spring_a.size(); ++s) {
    const int a = mesh.spring_a[s], b = mesh.spring_b[s];
    const Vector3d along = (x[b] - x[a]).normalized();
    const Matrix3d stiffness = mesh.stiffness[s] * along * along.transpose();
    own[a] += stiffness;
    own[b] += stiffness;
  }
  const double per_spring = (1 - mesh.lambda) / mesh.lambda;  // the weight of volumes
  for (std::size_t p = 0; p < mesh.prisms.size(); ++p) {
    std::array<Vector3d, 6> slope;
    prism_volume_gradient(x, mesh.prisms[p], slope);
    for (int corner = 0; corner < 6; ++corner)
      own[mesh.prisms[p][corner]] +=
          per_spring * mesh.volume_weight[p] * slope[corner] * slope[corner].transpose();
  }
  constexpr double softest = 1e-3;  // of the stiffest direction
  std::vector<double> mean;
  for (const Matrix3d& matrix : own) {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> principal(matrix, Eigen::EigenvaluesOnly);
    const Vector3d& stiffness = principal.eigenvalues();  // ascending
    mean.push_back(3 / stiffness.cwiseMax(softest * stiffness[2]).cwiseInverse().sum());
  }
  return mean;
}

void limit_stiffness(std::span<const double> own, double ratio,
                     std::vector<PointContact>& contacts) {
  for (PointContact& contact : contacts) {
    ContactSpring& spring = contact.spring;
    double yield = 0;  // mm/N: the nodes as springs in series
    for (int i = 0; i < spring.count; ++i)
      if (spring.weight[i] != 0) yield += spring.weight[i] * spring.weight[i] / own[spring.node[i]];
    if (yield > 0) spring.stiffness = std::min(spring.stiffness, ratio / yield);
  }
}

}  // namespace condyle
