#include "tests/support/wedge_elements.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "engine/core/parallel.h"

namespace condyle::fe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Corners = Eigen::Matrix<double, 3, 6>;

constexpr int chunks = 8;  // fixed: sums must not depend on the number of threads

Corners corners_of(const std::array<int, 6>& node, const Nodes& x) {
  Corners at;
  for (int k = 0; k < 6; ++k) at.col(k) = x[node[k]];
  return at;
}

/// Derivatives of the shape functions by the coordinates of the unit wedge.
Corners unit_slopes(double r, double s, double t) {
  const double below = 0.5 * (1 - t), above = 0.5 * (1 + t), o = 1 - r - s;
  Corners slope;
  slope.col(0) << -above, -above, 0.5 * o;
  slope.col(1) << above, 0, 0.5 * r;
  slope.col(2) << 0, above, 0.5 * s;
  slope.col(3) << -below, -below, -0.5 * o;
  slope.col(4) << below, 0, -0.5 * r;
  slope.col(5) << 0, below, -0.5 * s;
  return slope;
}

template <class OfChunk>
void for_chunks(std::size_t count, int threads, const OfChunk& of_chunk) {
  parallel_for(chunks, threads,
               [&](std::size_t c) { of_chunk(c, count * c / chunks, count * (c + 1) / chunks); });
}

}  // namespace

Material Material::of(double young_MPa, double poisson) {
  const double shear = young_MPa / (2 * (1 + poisson));
  return {shear, 2 * shear * poisson / (1 - 2 * poisson)};
}

WedgeBody::WedgeBody(const Nodes& rest, const std::vector<std::array<int, 6>>& wedges,
                     const std::vector<Material>& material) {
  const double gauss = 1 / std::sqrt(3.0);
  for (std::size_t i = 0; i < wedges.size(); ++i) {
    Wedge wedge{wedges[i], {}, {}, 0, material[i]};
    const Corners at = corners_of(wedges[i], rest);
    int p = 0;
    for (const double t : {-gauss, gauss})
      for (const auto& [r, s] :
           {std::array{1.0 / 6, 1.0 / 6}, {2.0 / 3, 1.0 / 6}, {1.0 / 6, 2.0 / 3}}) {
        const Corners unit = unit_slopes(r, s, t);
        const Matrix3d to_rest = at * unit.transpose();
        wedge.weight[p] = to_rest.determinant() / 6;
        if (!(wedge.weight[p] > 0)) throw std::invalid_argument("a wedge is inside out");
        wedge.slope[p] = to_rest.inverse().transpose() * unit;
        wedge.volume += wedge.weight[p++];
      }
    wedges_.push_back(wedge);
  }
}

double WedgeBody::energy_of(const Wedge& wedge, const Nodes& x, Nodes* gradient) const {
  const Corners at = corners_of(wedge.node, x);
  const auto [shear, lame] = wedge.material;
  std::array<Matrix3d, points> cofactor;
  Corners force = Corners::Zero();
  double energy = 0, volume = 0;
  for (int p = 0; p < points; ++p) {
    const Matrix3d F = at * wedge.slope[p].transpose();
    const double J = F.determinant(), w = wedge.weight[p];
    if (!(J > 0)) return std::numeric_limits<double>::infinity();
    volume += w * J;
    energy += w * 0.5 * shear * (F.squaredNorm() - 3 - 2 * std::log(J));
    if (!gradient) continue;
    const Matrix3d inverse_transposed = F.inverse().transpose();
    cofactor[p] = J * inverse_transposed;
    force += w * shear * (F - inverse_transposed) * wedge.slope[p];
  }
  const double dilatation = volume / wedge.volume - 1;
  if (gradient) {
    for (int p = 0; p < points; ++p)
      force += wedge.weight[p] * lame * dilatation * cofactor[p] * wedge.slope[p];
    for (int k = 0; k < 6; ++k) (*gradient)[wedge.node[k]] += force.col(k);
  }
  return energy + 0.5 * wedge.volume * lame * dilatation * dilatation;
}

double WedgeBody::energy(const Nodes& x, Nodes* gradient, int threads) const {
  std::array<double, chunks> energy{};
  std::array<Nodes, chunks> part;
  for_chunks(wedges_.size(), threads, [&](std::size_t c, std::size_t first, std::size_t last) {
    if (gradient) part[c].assign(x.size(), Vector3d::Zero());
    for (std::size_t i = first; i < last; ++i)
      energy[c] += energy_of(wedges_[i], x, gradient ? &part[c] : nullptr);
  });
  double sum = 0;
  for (int c = 0; c < chunks; ++c) {
    sum += energy[c];
    if (gradient)
      for (std::size_t i = 0; i < x.size(); ++i) (*gradient)[i] += part[c][i];
  }
  return sum;
}

Objective::Curvature WedgeBody::curvature_of(const Wedge& wedge, const Nodes& x,
                                             const Nodes& d) const {
  const Corners at = corners_of(wedge.node, x), along = corners_of(wedge.node, d);
  const auto [shear, lame] = wedge.material;
  double volume = 0, rate = 0, bend = 0;  // of the volume
  Objective::Curvature sum;
  for (int p = 0; p < points; ++p) {
    const Matrix3d F = at * wedge.slope[p].transpose(), dF = along * wedge.slope[p].transpose();
    const double w = wedge.weight[p], J = F.determinant();
    const Matrix3d A = F.inverse() * dF;
    const double trace = A.trace(), square = A.cwiseProduct(A.transpose()).sum();
    volume += w * J;
    rate += w * J * trace;
    bend += w * J * (trace * trace - square);
    sum.gauss_newton += w * shear * dF.squaredNorm();
    sum.exact += w * shear * (dF.squaredNorm() + square);
  }
  const double stretch = lame * rate * rate / wedge.volume;
  sum.gauss_newton += stretch;
  sum.exact += stretch + lame * (volume / wedge.volume - 1) * bend;
  return sum;
}

Objective::Curvature WedgeBody::curvature(const Nodes& x, const Nodes& d, int threads) const {
  std::array<Objective::Curvature, chunks> part{};
  for_chunks(wedges_.size(), threads, [&](std::size_t c, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const auto of = curvature_of(wedges_[i], x, d);
      part[c].exact += of.exact;
      part[c].gauss_newton += of.gauss_newton;
    }
  });
  Objective::Curvature sum;
  for (const auto& of : part) {
    sum.exact += of.exact;
    sum.gauss_newton += of.gauss_newton;
  }
  return sum;
}

double WedgeEnergy::energy(const Nodes& x, Nodes* gradient) {
  if (gradient) gradient->assign(x.size(), Vector3d::Zero());
  double sum = body_.energy(x, gradient, threads_);
  for (std::size_t i = 0; i < mesh_.anchor_node.size(); ++i) {
    const Vector3d off = x[mesh_.anchor_node[i]] - loads_.anchor_target[i];
    const double k = anchor_stiffness(mesh_, loads_, i);
    sum += k * off.squaredNorm();
    if (gradient) (*gradient)[mesh_.anchor_node[i]] += 2 * k * off;
  }
  for (std::size_t i = 0; i < loads_.node_force.size(); ++i) {
    sum -= loads_.node_force[i].dot(x[i]);
    if (gradient) (*gradient)[i] -= loads_.node_force[i];
  }
  for (const ContactSpring& row : loads_.contacts) {
    const double gap = row.gap(x);
    if (gap >= 0) continue;
    sum += row.stiffness * gap * gap;
    for (int k = 0; gradient && k < row.count; ++k)
      (*gradient)[row.node[k]] += 2 * row.stiffness * gap * row.weight[k] * row.normal;
  }
  if (gradient)
    for (auto& g : *gradient) g *= mesh_.lambda;
  return mesh_.lambda * sum;
}

double WedgeEnergy::value(const Nodes& x) { return energy(x, nullptr); }
double WedgeEnergy::value_and_gradient(const Nodes& x, Nodes& gradient) {
  return energy(x, &gradient);
}

Objective::Curvature WedgeEnergy::curvature(const Nodes& x, const Nodes& d) {
  Curvature sum = body_.curvature(x, d, threads_);
  double linear = 0;
  for (std::size_t i = 0; i < mesh_.anchor_node.size(); ++i)
    linear += 2 * anchor_stiffness(mesh_, loads_, i) * d[mesh_.anchor_node[i]].squaredNorm();
  for (const ContactSpring& row : loads_.contacts)
    if (row.gap(x) < 0) linear += 2 * row.stiffness * std::pow(row.along(d), 2);
  return {mesh_.lambda * (sum.exact + linear), mesh_.lambda * (sum.gauss_newton + linear)};
}

}  // namespace condyle::fe
