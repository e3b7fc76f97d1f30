#include "engine/tissue/spring_prism.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "engine/core/parallel.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

using Corners = std::array<Vector3d, 6>;

/// Corners taken from corner 0, which makes the numbers small; [0] is zero.
Corners relative_corners(const Nodes& x, const std::array<int, 6>& prism) {
  Corners c;
  const Vector3d& origin = x[prism[0]];
  c[0].setZero();
  for (int k = 1; k < 6; ++k) c[k] = x[prism[k]] - origin;
  return c;
}

/// Gradient of the volume. Twelve times the volume is, with (pqr) for a determinant,
/// (134) + (214) + (245) + (215) + (145) + (253) - 2 (345): floor, then both splits of each side.
void volume_gradient(const Corners& c, Corners& g) {
  const Vector3d c45 = c[4].cross(c[5]), c12 = c[1].cross(c[2]);
  const Vector3d sum = c[4] + c[5], lean = c[1] + c[2] - 2 * c[3];
  constexpr double scale = 1.0 / 12.0;
  g[1] = scale * (c[3].cross(c[4]) + sum.cross(c[2]) + c45);
  g[2] = scale * (c[1].cross(sum) + c45 + c[5].cross(c[3]));
  g[3] = scale * (c[4].cross(c[1]) + c[2].cross(c[5]) - 2 * c45);
  g[4] = scale * (c[5].cross(lean) + c[1].cross(c[3]) - c12);
  g[5] = scale * (lean.cross(c[4]) + c[3].cross(c[2]) - c12);
  g[0] = -(g[1] + g[2] + g[3] + g[4] + g[5]);
}

double contract(const Corners& a, const Corners& b) {
  return a[1].dot(b[1]) + a[2].dot(b[2]) + a[3].dot(b[3]) + a[4].dot(b[4]) + a[5].dot(b[5]);
}

/// The volume is a cubic form of the corners: its gradient times them is three times itself.
double volume_and_gradient(const Corners& c, Corners& gradient) {
  volume_gradient(c, gradient);
  return contract(gradient, c) / 3;
}

/// Energy of a prism of share j = v / rest, without the factor weight * rest^2, and derivatives in
/// j.
struct VolumeLaw {
  double e, de, dde;
};
VolumeLaw volume_law(double j, double barrier_share, double barrier_weight) {
  VolumeLaw law{(j - 1) * (j - 1), 2 * (j - 1), 2};
  if (j < barrier_share) {
    const double u = barrier_share - j, r = u / j;
    law.e += barrier_weight * u * u * r;
    law.de -= barrier_weight * (3 * u * r + u * r * r);
    law.dde += barrier_weight * (6 * r + 6 * r * r + 2 * r * r * r);
  }
  return law;
}

struct Range {
  std::size_t first, last;
};
Range share(std::size_t count, int chunk, int chunks) {
  return {count * chunk / chunks, count * (chunk + 1) / chunks};
}

}  // namespace

double prism_volume(const Nodes& nodes, const std::array<int, 6>& prism) {
  Corners gradient;
  return volume_and_gradient(relative_corners(nodes, prism), gradient);
}

double prism_volume_gradient(const Nodes& nodes, const std::array<int, 6>& prism,
                             std::array<Eigen::Vector3d, 6>& gradient) {
  return volume_and_gradient(relative_corners(nodes, prism), gradient);
}

std::array<Vector3d, 15> prism_volume_bend(const Nodes& nodes, const std::array<int, 6>& prism) {
  // From volume_gradient: the derivative of u x v is -(v x) by u and (u x) by v.
  const Corners c = relative_corners(nodes, prism);
  constexpr double scale = 1.0 / 12.0;
  std::array<Vector3d, 15> cross;
  const auto of = [&](int a, int b) -> Vector3d& { return cross[a * (a - 1) / 2 + b]; };
  of(2, 1) = -scale * (c[4] + c[5]);
  of(3, 1) = scale * c[4];
  of(4, 1) = scale * (c[2] + c[5] - c[3]);
  of(5, 1) = scale * (c[2] - c[4]);
  of(3, 2) = -scale * c[5];
  of(4, 2) = scale * (c[5] - c[1]);
  of(5, 2) = scale * (c[3] - c[1] - c[4]);
  of(4, 3) = scale * (c[1] - 2 * c[5]);
  of(5, 3) = scale * (2 * c[4] - c[2]);
  of(5, 4) = scale * (c[1] + c[2] - 2 * c[3]);
  for (int a = 1; a < 6; ++a) {  // the rows sum to zero
    of(a, 0).setZero();
    for (int b = 1; b < 6; ++b)
      if (b < a)
        of(a, 0) -= of(a, b);
      else if (b > a)
        of(a, 0) += of(b, a);
  }
  return cross;
}

double volume_pressure(double share_of_rest, double barrier_share, double barrier_weight) {
  return volume_law(share_of_rest, barrier_share, barrier_weight).de;
}

double volume_stiffness(double share_of_rest, double barrier_share, double barrier_weight) {
  return volume_law(share_of_rest, barrier_share, barrier_weight).dde;
}

Nodes weight_of_nodes(const SpringPrismNet& net, const Vector3d& down) {
  constexpr double newton_per_kg = 9.81;
  Nodes weight;
  for (double mass : net.node_mass_kg) weight.push_back(newton_per_kg * mass * down);
  return weight;
}

SpringPrismEnergy::SpringPrismEnergy(const SpringPrismNet& net, const NetLoads& loads, int threads)
    : net_(net), loads_(loads), threads_(threads) {
  for (auto& nodes : partial_) nodes.resize(net.node_count);
  inverse_length_.resize(net.spring_a.size());
}

template <bool with_gradient>
double SpringPrismEnergy::chunk_energy(int chunk, const Nodes& x, Nodes& gradient) {
  if constexpr (with_gradient)
    for (auto& g : gradient) g.setZero();
  double spring_energy = 0;
  const Range springs = share(net_.spring_a.size(), chunk, chunks_);
  for (std::size_t s = springs.first; s < springs.last; ++s) {
    const int a = net_.spring_a[s], b = net_.spring_b[s];
    const Vector3d d = x[b] - x[a];
    const double inverse = 1 / std::sqrt(d.squaredNorm());
    if constexpr (with_gradient) inverse_length_[s] = inverse;
    const double tension = 1 - net_.rest_length[s] * inverse;  // (l - rest) / l
    const double k = net_.stiffness[s] * (tension < 0 ? net_.compression_share : 1.0);
    const Vector3d force = (2 * k * tension) * d;
    spring_energy += 0.5 * tension * force.dot(d);
    if constexpr (with_gradient) {
      gradient[a] -= force;
      gradient[b] += force;
    }
  }
  const Range anchors = share(net_.anchor_node.size(), chunk, chunks_);
  for (std::size_t i = anchors.first; i < anchors.last; ++i) {
    const int node = net_.anchor_node[i];
    const Vector3d d = x[node] - loads_.anchor_target[i];
    spring_energy += net_.anchor_stiffness[i] * d.squaredNorm();
    if constexpr (with_gradient) gradient[node] += (2 * net_.anchor_stiffness[i]) * d;
  }
  const Range contacts = share(loads_.contacts.size(), chunk, chunks_);
  for (std::size_t i = contacts.first; i < contacts.last; ++i) {
    const ContactRow& row = loads_.contacts[i];
    const double gap = row.gap(x);
    if (gap >= 0) continue;
    spring_energy += row.stiffness * gap * gap;
    if constexpr (with_gradient)
      for (int k = 0; k < row.count; ++k)
        gradient[row.node[k]] += (2 * row.stiffness * gap * row.weight[k]) * row.normal;
  }
  const Range forced = share(loads_.node_force.size(), chunk, chunks_);
  for (std::size_t i = forced.first; i < forced.last; ++i) {
    spring_energy -= loads_.node_force[i].dot(x[i]);
    if constexpr (with_gradient) gradient[i] -= loads_.node_force[i];
  }
  // Springs and volumes share the gradient: the volumes' part is scaled to the springs' weight.
  const double lambda = net_.lambda, volume_scale = (1 - lambda) / lambda;
  double volume_energy = 0;
  const Range prisms = share(net_.prisms.size(), chunk, chunks_);
  Corners slope;
  for (std::size_t p = prisms.first; p < prisms.last; ++p) {
    const auto& prism = net_.prisms[p];
    const double rest = net_.rest_volume[p];
    const double j = volume_and_gradient(relative_corners(x, prism), slope) / rest;
    if (!(j > 1e-3)) return std::numeric_limits<double>::infinity();
    const VolumeLaw law = volume_law(j, net_.barrier_share, net_.barrier_weight);
    const double scale = volume_scale * net_.volume_weight[p] * rest;
    volume_energy += scale * rest * law.e;
    if constexpr (with_gradient) {
      const double pressure = scale * law.de;
      for (int k = 0; k < 6; ++k) gradient[prism[k]] += pressure * slope[k];
    }
  }
  return lambda * (spring_energy + volume_energy);
}

double SpringPrismEnergy::value(const Nodes& x) {
  std::array<double, chunks_> energy{};
  parallel_for(chunks_, threads_, [&](std::size_t c) {
    energy[c] = chunk_energy<false>(static_cast<int>(c), x, partial_[c]);
  });
  double total = 0;
  for (double e : energy) total += e;
  return total;
}

double SpringPrismEnergy::value_and_gradient(const Nodes& x, Nodes& gradient) {
  std::array<double, chunks_> energy{};
  parallel_for(chunks_, threads_, [&](std::size_t c) {
    energy[c] = chunk_energy<true>(static_cast<int>(c), x, partial_[c]);
  });
  double total = 0;
  for (double e : energy) total += e;
  gradient.resize(net_.node_count);
  for (int i = 0; i < net_.node_count; ++i) {
    Vector3d sum = partial_[0][i];
    for (int c = 1; c < chunks_; ++c) sum += partial_[c][i];
    gradient[i] = net_.lambda * sum;
  }
  return total;
}

Objective::Curvature SpringPrismEnergy::chunk_curvature(int chunk, const Nodes& x,
                                                        const Nodes& d) const {
  Curvature springs_sum, volumes_sum;
  const Range springs = share(net_.spring_a.size(), chunk, chunks_);
  for (std::size_t s = springs.first; s < springs.last; ++s) {
    const int a = net_.spring_a[s], b = net_.spring_b[s];
    const Vector3d e = x[b] - x[a], de = d[b] - d[a];
    const double along = e.dot(de) * inverse_length_[s];
    const double along2 = along * along;
    const double across2 = de.squaredNorm() - along2;
    const double tension = 1 - net_.rest_length[s] * inverse_length_[s];
    const double k2 = 2 * net_.stiffness[s] * (tension < 0 ? net_.compression_share : 1.0);
    springs_sum.exact += k2 * (along2 + tension * across2);
    springs_sum.gauss_newton += k2 * (along2 + (tension > 0 ? tension * across2 : 0));
  }
  double linear = 0;  // parts whose curvature is exact and never negative
  const Range anchors = share(net_.anchor_node.size(), chunk, chunks_);
  for (std::size_t i = anchors.first; i < anchors.last; ++i)
    linear += 2 * net_.anchor_stiffness[i] * d[net_.anchor_node[i]].squaredNorm();
  const Range contacts = share(loads_.contacts.size(), chunk, chunks_);
  for (std::size_t i = contacts.first; i < contacts.last; ++i) {
    const ContactRow& row = loads_.contacts[i];
    if (row.gap(x) >= 0) continue;
    const double speed = row.along(d);
    linear += 2 * row.stiffness * speed * speed;
  }
  const Range prisms = share(net_.prisms.size(), chunk, chunks_);
  Corners slope;
  for (std::size_t p = prisms.first; p < prisms.last; ++p) {
    const Corners c = relative_corners(x, net_.prisms[p]);
    const Corners e = relative_corners(d, net_.prisms[p]);
    const double rest = net_.rest_volume[p];
    const double j = volume_and_gradient(c, slope) / rest;
    const double first = contract(slope, e);
    volume_gradient(e, slope);  // of a cubic form: the second derivative is twice grad(d) . c
    const double second = 2 * contract(slope, c);
    const VolumeLaw law = volume_law(j, net_.barrier_share, net_.barrier_weight);
    const double weight = net_.volume_weight[p];
    const double square = weight * law.dde * first * first;
    const double bend = weight * rest * law.de * second;
    volumes_sum.exact += square + bend;
    volumes_sum.gauss_newton += square;
  }
  const double lambda = net_.lambda;
  return {lambda * (springs_sum.exact + linear) + (1 - lambda) * volumes_sum.exact,
          lambda * (springs_sum.gauss_newton + linear) + (1 - lambda) * volumes_sum.gauss_newton};
}

Objective::Curvature SpringPrismEnergy::curvature(const Nodes& x, const Nodes& d) {
  std::array<Curvature, chunks_> parts;
  parallel_for(chunks_, threads_,
               [&](std::size_t c) { parts[c] = chunk_curvature(static_cast<int>(c), x, d); });
  Curvature total;
  for (const auto& part : parts) {
    total.exact += part.exact;
    total.gauss_newton += part.gauss_newton;
  }
  return total;
}

}  // namespace condyle
