#include "engine/tissue/equilibrium.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

namespace condyle {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Tension (N, a pull is above zero) of a spring strained by e = (l - l0) / l.
double tension_of(const SpringPrismNet& net, std::size_t s, double length, double strain) {
  return 2 * net.stiffness[s] * (strain < 0 ? net.compression_share : 1.0) * length * strain;
}

double largest(const VectorXd& force) {
  double most = 0;
  for (Index i = 0; i < force.size(); i += 3) most = std::max(most, force.segment<3>(i).norm());
  return most;
}

}  // namespace

// The strains of least energy that balance given forces are those that a linear net would take if
// these forces displaced it: with B the force on the nodes per tension (or pressure) and W the
// stiffnesses, the tensions are W B^T y where B W B^T y = -force. A spring that would push counts
// with its stiffness when it pushes; one that comes to its bound keeps that tension and leaves the
// system. Both choices are taken again in each round until nothing changes. Without the pressures
// the weight of soft tissue would have to rest on fibres that buckle.
Equilibrium balance_strains(SpringPrismNet& net, const NetLoads& loads, const Nodes& x,
                            const EquilibriumSettings& settings) {
  const std::size_t springs = net.spring_a.size();
  const Index n = 3 * static_cast<Index>(net.node_count);
  Equilibrium result;

  std::vector<char> chosen(springs);
  std::vector<double> length(springs), strain(springs, 0.0), given(springs, 0.0);
  std::vector<Vector3d> along(springs);
  for (std::size_t s = 0; s < springs; ++s) {
    along[s] = x[net.spring_b[s]] - x[net.spring_a[s]];
    length[s] = along[s].norm();
    along[s] /= length[s];
    chosen[s] = net.spring_sheet[s] != 0;
    if (chosen[s]) net.rest_length[s] = length[s];
  }
  const std::size_t prisms = net.prisms.size();
  std::vector<std::array<Vector3d, 6>> slope(prisms);  // of the volumes
  std::vector<double> volume(prisms), volume_weight(prisms);
  for (std::size_t p = 0; p < prisms; ++p) {
    volume[p] = net.rest_volume[p] = prism_volume_gradient(x, net.prisms[p], slope[p]);
    volume_weight[p] = 2 * (1 - net.lambda) / net.lambda * net.volume_weight[p];
  }
  Nodes gradient;
  SpringPrismEnergy(net, loads, 1).value_and_gradient(x, gradient);
  VectorXd outer(n);  // force of all that is not chosen
  for (int i = 0; i < net.node_count; ++i) outer.segment<3>(3 * i) = -gradient[i] / net.lambda;
  result.force_before = largest(outer);

  enum class State : char { pulls, pushes, bound };
  std::vector<State> state(springs, State::pulls);
  VectorXd anchor_force = VectorXd::Zero(n), force = outer;
  VectorXd pressure(static_cast<Index>(prisms));  // above zero: it would grow
  const auto spread = [&](VectorXd& to, std::size_t s, double tension) {
    to.segment<3>(3 * net.spring_a[s]) += tension * along[s];
    to.segment<3>(3 * net.spring_b[s]) -= tension * along[s];
  };
  VectorXd anchor_stiffness = VectorXd::Zero(net.node_count);
  for (std::size_t i = 0; i < net.anchor_node.size(); ++i)
    anchor_stiffness[net.anchor_node[i]] += 2 * net.anchor_stiffness[i];
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;
  for (int round = 0; round < settings.rounds; ++round) {
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](int a, int b, const Matrix3d& m) {
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) entries.emplace_back(3 * a + i, 3 * b + j, m(i, j));
    };
    VectorXd wanted = outer;
    double scale = 0;
    const auto weight = [&](std::size_t s) {
      if (state[s] == State::bound) return 0.0;  // but stays in the matrix's pattern
      return 2 * net.stiffness[s] * (state[s] == State::pushes ? net.compression_share : 1.0);
    };
    for (std::size_t s = 0; s < springs; ++s) {
      if (!chosen[s]) continue;
      if (state[s] == State::bound) spread(wanted, s, tension_of(net, s, length[s], strain[s]));
      const int a = net.spring_a[s], b = net.spring_b[s];
      const Matrix3d m = weight(s) * along[s] * along[s].transpose();
      add(a, a, m);
      add(b, b, m);
      add(a, b, -m);
      add(b, a, -m);
      scale = std::max(scale, weight(s));
    }
    for (std::size_t p = 0; p < prisms; ++p)
      for (int a = 0; a < 6; ++a)
        for (int b = 0; b < 6; ++b)
          add(net.prisms[p][a], net.prisms[p][b],
              volume_weight[p] * slope[p][a] * slope[p][b].transpose());
    // Every node is held a little, so that what no spring can balance does not run away.
    for (int i = 0; i < net.node_count; ++i)
      add(i, i, Matrix3d::Identity() * (anchor_stiffness[i] + 1e-7 * scale));
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    if (round == 0) solver.analyzePattern(matrix);
    solver.factorize(matrix);

    // Solve for the tensions; what the small hold took is asked for again.
    VectorXd tension = VectorXd::Zero(static_cast<Index>(springs));
    pressure.setZero();
    anchor_force.setZero();
    force = wanted;
    for (int refine = 0; refine < 6; ++refine) {
      const VectorXd y = solver.solve(force);
      for (std::size_t s = 0; s < springs; ++s)
        if (chosen[s] && state[s] != State::bound)
          tension[static_cast<Index>(s)] +=
              weight(s) *
              along[s].dot(y.segment<3>(3 * net.spring_b[s]) - y.segment<3>(3 * net.spring_a[s]));
      for (std::size_t p = 0; p < prisms; ++p) {
        double change = 0;
        for (int k = 0; k < 6; ++k) change += slope[p][k].dot(y.segment<3>(3 * net.prisms[p][k]));
        pressure[static_cast<Index>(p)] -= volume_weight[p] * change;
      }
      for (int i = 0; i < net.node_count; ++i)
        anchor_force.segment<3>(3 * i) -= anchor_stiffness[i] * y.segment<3>(3 * i);
      force = wanted + anchor_force;
      for (std::size_t s = 0; s < springs; ++s)
        if (chosen[s] && state[s] != State::bound) spread(force, s, tension[static_cast<Index>(s)]);
      for (std::size_t p = 0; p < prisms; ++p)
        for (int k = 0; k < 6; ++k)
          force.segment<3>(3 * net.prisms[p][k]) += pressure[static_cast<Index>(p)] * slope[p][k];
      if (largest(force) < 1e-13 * result.force_before) break;
    }

    bool changed = false;
    for (std::size_t s = 0; s < springs; ++s) {
      if (!chosen[s] || state[s] == State::bound) continue;
      const double t = tension[static_cast<Index>(s)];
      const State now = t < 0 ? State::pushes : State::pulls;
      strain[s] = t / (2 * net.stiffness[s] * length[s] * (t < 0 ? net.compression_share : 1.0));
      if (std::abs(strain[s]) > settings.max_strain) {
        strain[s] = std::copysign(settings.max_strain, strain[s]);
        state[s] = State::bound;
        changed = true;
      } else if (now != state[s]) {
        state[s] = now;
        changed = true;
      }
    }
    if (!changed) break;
  }

  for (std::size_t s = 0; s < springs; ++s) {
    if (!chosen[s]) continue;
    net.rest_length[s] = length[s] * (1 - strain[s]);
    result.max_strain = std::max(result.max_strain, std::abs(strain[s]));
    result.at_bound += state[s] == State::bound;
  }
  for (std::size_t p = 0; p < prisms; ++p) {
    const double change = pressure[static_cast<Index>(p)] / volume_weight[p];
    net.rest_volume[p] = volume[p] + change;
    result.max_volume_strain = std::max(result.max_volume_strain, std::abs(change) / volume[p]);
  }
  // What the anchors of a node must pull together, by a shift of their targets.
  NetLoads shifted = loads;
  for (std::size_t i = 0; i < net.anchor_node.size(); ++i) {
    const int node = net.anchor_node[i];
    result.anchor_offset.emplace_back(anchor_force.segment<3>(3 * node) / anchor_stiffness[node]);
    shifted.anchor_target[i] += result.anchor_offset.back();
  }
  result.rest_energy = SpringPrismEnergy(net, shifted, 1).value_and_gradient(x, gradient);
  for (const auto& g : gradient)
    result.force_after = std::max(result.force_after, g.norm() / net.lambda);
  return result;
}

}  // namespace condyle
