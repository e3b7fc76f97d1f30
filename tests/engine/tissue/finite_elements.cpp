#include "tests/engine/tissue/finite_elements.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>

namespace condyle::fe {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix34 = Eigen::Matrix<double, 3, 4>;

/// Gradients of the four shape functions (columns, 1/mm) and the volume.
struct Element {
  Matrix34 slope;
  double volume;
};

Element element_of(const Nodes& rest, const std::array<int, 4>& t) {
  Matrix3d edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = rest[t[k + 1]] - rest[t[0]];
  Element e;
  e.volume = edges.determinant() / 6;
  e.slope.rightCols<3>() = edges.inverse().transpose();
  e.slope.col(0) = -e.slope.rightCols<3>().rowwise().sum();
  return e;
}

/// The rotational part of a tetrahedron's deformation.
Matrix3d rotation_of(const Element& e, const Nodes& x, const std::array<int, 4>& t) {
  Matrix3d deformation = Matrix3d::Zero();
  for (int k = 0; k < 4; ++k) deformation += x[t[k]] * e.slope.col(k).transpose();
  const Eigen::JacobiSVD<Matrix3d> svd(deformation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

}  // namespace

Body body_of(const SpringPrismMesh& mesh, const Nodes& rest, const Elastic& elastic) {
  Body body{rest, {}, elastic};
  for (const auto& prism : mesh.prisms) {
    // From the corner column with the smallest number the others follow; each side quad is cut
    // through its smallest node, so neighbours cut it alike.
    const int first =
        static_cast<int>(std::min_element(prism.begin(), prism.begin() + 3) - prism.begin());
    std::array<int, 6> p;
    for (int k = 0; k < 3; ++k) {
      p[k] = prism[(first + k) % 3];
      p[k + 3] = prism[(first + k) % 3 + 3];
    }
    const auto add = [&](int a, int b, int c, int d) {
      std::array<int, 4> tet{p[a], p[b], p[c], p[d]};
      if (element_of(rest, tet).volume < 0) std::swap(tet[2], tet[3]);
      body.tets.push_back(tet);
    };
    add(0, 3, 4, 5);
    if (p[1] < p[2]) {
      add(0, 1, 2, 5);
      add(0, 1, 4, 5);
    } else {
      add(0, 1, 2, 4);
      add(0, 2, 4, 5);
    }
  }
  return body;
}

Solution solve(const Body& body, const Given& given, int rounds, double tolerance_mm) {
  const std::size_t count = body.rest.size();
  const double nu = body.elastic.poisson;
  const double mu = body.elastic.young_MPa / (2 * (1 + nu));
  const double lame = 2 * mu * nu / (1 - 2 * nu);

  Solution solution{body.rest, 0, 0};
  Nodes& x = solution.nodes;
  std::vector<int> unknown(count, 0);
  for (std::size_t i = 0; i < given.node.size(); ++i) {
    unknown[given.node[i]] = -1;
    x[given.node[i]] = given.at[i];
  }
  Index free = 0;
  for (auto& u : unknown)
    if (u >= 0) u = static_cast<int>(free++);

  std::vector<Element> elements;
  for (const auto& t : body.tets) elements.push_back(element_of(body.rest, t));
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;
  Nodes turned_by = body.rest;  // the state whose rotations the elements take
  while (solution.rounds < rounds) {
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(3 * free);
    for (std::size_t e = 0; e < elements.size(); ++e) {
      const auto& t = body.tets[e];
      const auto& [slope, volume] = elements[e];
      const Matrix3d R = rotation_of(elements[e], turned_by, t);
      // Block of nodes a and b: V (lame g_a g_b' + mu (g_b g_a' + g_a.g_b I)), turned.
      for (int a = 0; a < 4; ++a) {
        if (unknown[t[a]] < 0) continue;
        const Index row = 3 * unknown[t[a]];
        for (int b = 0; b < 4; ++b) {
          const Vector3d ga = slope.col(a), gb = slope.col(b);
          const Matrix3d block = volume * (lame * ga * gb.transpose() + mu * gb * ga.transpose() +
                                           mu * ga.dot(gb) * Matrix3d::Identity());
          const Matrix3d turned = R * block * R.transpose();
          right.segment<3>(row) += R * (block * body.rest[t[b]]);
          if (unknown[t[b]] < 0) {
            right.segment<3>(row) -= turned * x[t[b]];
            continue;
          }
          const Index column = 3 * unknown[t[b]];
          for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) entries.emplace_back(row + i, column + j, turned(i, j));
        }
      }
    }
    for (std::size_t i = 0; i < given.force.size(); ++i)
      if (unknown[i] >= 0) right.segment<3>(3 * unknown[i]) += given.force[i];
    Eigen::SparseMatrix<double> matrix(3 * free, 3 * free);
    matrix.setFromTriplets(entries.begin(), entries.end());
    if (solution.rounds == 0) solver.analyzePattern(matrix);
    solver.factorize(matrix);
    const Eigen::VectorXd answer = solver.solve(right);
    solution.last_change = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (unknown[i] < 0) continue;
      const Vector3d now = answer.segment<3>(3 * unknown[i]);
      solution.last_change = std::max(solution.last_change, (now - x[i]).norm());
      x[i] = now;
    }
    ++solution.rounds;
    if (solution.rounds > 1 && solution.last_change < tolerance_mm) break;
    turned_by = x;
  }
  return solution;
}

}  // namespace condyle::fe
