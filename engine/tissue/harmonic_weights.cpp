#include "engine/tissue/harmonic_weights.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cassert>

namespace condyle {

std::vector<double> harmonic_weights(const SpringPrismMesh& mesh, const std::vector<int>& given,
                                     const std::vector<double>& value) {
  assert(given.size() == value.size());
  std::vector<double> fraction(mesh.node_count, 0.0);
  std::vector<char> fixed(mesh.node_count, 0);
  for (std::size_t i = 0; i < given.size(); ++i) {
    fixed[given[i]] = 1;
    fraction[given[i]] = value[i];
  }
  std::vector<int> unknown(mesh.node_count, -1);
  int count = 0;
  for (int i = 0; i < mesh.node_count; ++i)
    if (!fixed[i]) unknown[i] = count++;
  if (count == 0) return fraction;

  Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
  std::vector<Eigen::Triplet<double>> entries;
  double scale = 0;
  for (double k : mesh.stiffness) scale += k;
  scale /= std::max<std::size_t>(1, mesh.stiffness.size());
  for (int i = 0; i < count; ++i) entries.emplace_back(i, i, 1e-9 * scale);
  for (std::size_t s = 0; s < mesh.spring_a.size(); ++s) {
    const double k = mesh.stiffness[s];
    for (const auto& [a, b] : {std::pair{mesh.spring_a[s], mesh.spring_b[s]},
                               std::pair{mesh.spring_b[s], mesh.spring_a[s]}}) {
      if (unknown[a] < 0) continue;
      entries.emplace_back(unknown[a], unknown[a], k);
      if (unknown[b] < 0)
        right[unknown[a]] += k * fraction[b];
      else
        entries.emplace_back(unknown[a], unknown[b], -k);
    }
  }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  const Eigen::VectorXd solution = solver.solve(right);
  for (int i = 0; i < mesh.node_count; ++i)
    if (unknown[i] >= 0) fraction[i] = solution[unknown[i]];
  return fraction;
}

}  // namespace condyle
