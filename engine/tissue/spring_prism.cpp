#include "engine/tissue/spring_prism.h"

#include <Eigen/Geometry>
#include <cassert>
#include <cmath>
#include <limits>

#include "engine/core/parallel.h"
#include "engine/tissue/prism_forms.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

using Corners = std::array<Vector3d, 6>;

/// Corners relative to corner 0, for accuracy; [0] is zero.
Corners relative_corners(const Nodes& x, const std::array<int, 6>& prism) {
  Corners c;
  const Vector3d& origin = x[prism[0]];
  c[0].setZero();
  for (int k = 1; k < 6; ++k) c[k] = x[prism[k]] - origin;
  return c;
}

void volume_gradient(const Corners& c, Corners& g) {
  prism_volume_slopes(
      c, [](const Vector3d& p, const Vector3d& q) -> Vector3d { return p.cross(q); }, g);
}

double contract(const Corners& a, const Corners& b) {
  return a[1].dot(b[1]) + a[2].dot(b[2]) + a[3].dot(b[3]) + a[4].dot(b[4]) + a[5].dot(b[5]);
}

/// The volume is a cubic form of the corners: the product of its gradient with them is three times
/// the volume.
double volume_and_gradient(const Corners& c, Corners& gradient) {
  volume_gradient(c, gradient);
  return contract(gradient, c) / 3;
}

/// Energy of a prism with volume ratio j = v / rest, without the factor weight * rest^2, and its
/// derivatives with respect to j.
struct VolumeLaw {
  double e, de, dde;
};
VolumeLaw volume_law(double j, double barrier_fraction, double barrier_weight) {
  VolumeLaw law{(j - 1) * (j - 1), 2 * (j - 1), 2};
  if (j < barrier_fraction) {
    const double u = barrier_fraction - j, r = u / j;
    law.e += barrier_weight * u * u * r;
    law.de -= barrier_weight * (3 * u * r + u * r * r);
    law.dde += barrier_weight * (6 * r + 6 * r * r + 2 * r * r * r);
  }
  return law;
}

struct Range {
  std::size_t first, last;
};
Range fraction(std::size_t count, int chunk, int chunks) {
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
  return prism_volume_bends(relative_corners(nodes, prism), 1.0 / 12.0);
}

double volume_pressure(double volume_ratio, double barrier_fraction, double barrier_weight) {
  return volume_law(volume_ratio, barrier_fraction, barrier_weight).de;
}

double volume_stiffness(double volume_ratio, double barrier_fraction, double barrier_weight) {
  return volume_law(volume_ratio, barrier_fraction, barrier_weight).dde;
}

Nodes weight_of_nodes(const SpringPrismMesh& mesh, const Vector3d& down) {
  constexpr double newton_per_kg = 9.81;
  Nodes weight;
  for (double mass : mesh.node_mass_kg) weight.push_back(newton_per_kg * mass * down);
  return weight;
}

SpringPrismEnergy::SpringPrismEnergy(const SpringPrismMesh& mesh, const MeshLoads& loads,
                                     int threads, std::shared_ptr<const ElementBatches> batches)
    : mesh_(mesh),
      loads_(loads),
      threads_(threads),
      batches_(batches ? std::move(batches) : std::make_shared<const ElementBatches>(mesh)) {
  const std::size_t size = 3 * (static_cast<std::size_t>(mesh.node_count) + ElementBatches::lanes);
  x_.assign(size, 0.0);
  d_.assign(size, 0.0);
  for (auto& gradient : gradient_) gradient.resize(size);
  inverse_length_.resize(batches_->rest_length.size());
}

AxisRows SpringPrismEnergy::rows(Rows& of) const {
  const std::size_t row = of.size() / 3;
  return {of.data(), of.data() + row, of.data() + 2 * row};
}

void SpringPrismEnergy::set_rows(const Nodes& x, Rows& to) const {
  const AxisRows at = rows(to);
  for (std::size_t i = 0; i < x.size(); ++i) {
    at.x[i] = x[i].x();
    at.y[i] = x[i].y();
    at.z[i] = x[i].z();
  }
}

double SpringPrismEnergy::chunk_energy(int chunk, const Nodes& x, bool with_gradient) {
  const ElementKernels& kernels = element_kernels();
  const AxisRows at = rows(x_);
  AxisRows slope{nullptr, nullptr, nullptr};
  if (with_gradient) {
    std::fill(gradient_[chunk].begin(), gradient_[chunk].end(), 0.0);
    slope = rows(gradient_[chunk]);
  }
  const auto push = [&](int node, const Vector3d& force) {
    slope.x[node] += force.x();
    slope.y[node] += force.y();
    slope.z[node] += force.z();
  };
  double spring_energy =
      kernels.springs(*batches_, chunk, mesh_.compression_ratio, at, slope, inverse_length_.data());
  const Range anchors = fraction(mesh_.anchor_node.size(), chunk, chunks_);
  for (std::size_t i = anchors.first; i < anchors.last; ++i) {
    const int node = mesh_.anchor_node[i];
    const Vector3d d = x[node] - loads_.anchor_target[i];
    const double stiffness = anchor_stiffness(mesh_, loads_, i);
    spring_energy += stiffness * d.squaredNorm();
    if (with_gradient) push(node, (2 * stiffness) * d);
  }
  const Range contacts = fraction(loads_.contacts.size(), chunk, chunks_);
  for (std::size_t i = contacts.first; i < contacts.last; ++i) {
    const ContactSpring& row = loads_.contacts[i];
    const double gap = row.gap(x);
    if (gap >= 0) continue;
    spring_energy += row.stiffness * gap * gap;
    for (int k = 0; with_gradient && k < row.count; ++k)
      push(row.node[k], (2 * row.stiffness * gap * row.weight[k]) * row.normal);
  }
  const Range muscles = fraction(loads_.muscles.size(), chunk, chunks_);
  for (std::size_t i = muscles.first; i < muscles.last; ++i)
    spring_energy += with_gradient ? loads_.muscles[i].energy_and_gradient(x, push)
                                   : loads_.muscles[i].energy(x);
  const Range forced = fraction(loads_.node_force.size(), chunk, chunks_);
  for (std::size_t i = forced.first; i < forced.last; ++i) {
    spring_energy -= loads_.node_force[i].dot(x[i]);
    if (with_gradient) push(static_cast<int>(i), -loads_.node_force[i]);
  }
  // Springs and volumes accumulate in one gradient: the part of the volumes is scaled to the weight
  // of the springs.
  const double lambda = mesh_.lambda, volume_scale = (1 - lambda) / lambda;
  const double volume_energy = kernels.prisms(*batches_, chunk, mesh_.barrier_fraction,
                                              mesh_.barrier_weight, at, volume_scale, slope);
  return lambda * (spring_energy + volume_scale * volume_energy);
}

double SpringPrismEnergy::energy(const Nodes& x, bool with_gradient) {
  assert(x.size() == static_cast<std::size_t>(mesh_.node_count));
  assert(loads_.anchor_target.size() == mesh_.anchor_node.size());
  assert(loads_.node_force.empty() || loads_.node_force.size() == x.size());
  set_rows(x, x_);
  std::array<double, chunks_> energy{};
  parallel_for(chunks_, threads_, [&](std::size_t c) {
    energy[c] = chunk_energy(static_cast<int>(c), x, with_gradient);
  });
  double total = 0;
  for (double e : energy) total += e;
  return total;
}

double SpringPrismEnergy::value(const Nodes& x) { return energy(x, false); }

double SpringPrismEnergy::value_and_gradient(const Nodes& x, Nodes& gradient) {
  const double total = energy(x, true);
  gradient.resize(mesh_.node_count);
  const AxisRows a = rows(gradient_[0]), b = rows(gradient_[1]);
  static_assert(chunks_ == 2);
  for (int i = 0; i < mesh_.node_count; ++i)
    gradient[i] = mesh_.lambda * Vector3d(a.x[i] + b.x[i], a.y[i] + b.y[i], a.z[i] + b.z[i]);
  return total;
}

Objective::Curvature SpringPrismEnergy::chunk_curvature(int chunk, const Nodes& x, const Nodes& d) {
  const ElementKernels& kernels = element_kernels();
  const AxisRows at = rows(x_), direction = rows(d_);
  const auto springs = kernels.springs_bend(*batches_, chunk, mesh_.compression_ratio, at,
                                            direction, inverse_length_.data());
  const auto prisms = kernels.prisms_bend(*batches_, chunk, mesh_.barrier_fraction,
                                          mesh_.barrier_weight, at, direction);
  double linear = 0;  // terms with exact, non-negative curvature
  const Range anchors = fraction(mesh_.anchor_node.size(), chunk, chunks_);
  for (std::size_t i = anchors.first; i < anchors.last; ++i)
    linear += 2 * anchor_stiffness(mesh_, loads_, i) * d[mesh_.anchor_node[i]].squaredNorm();
  const Range contacts = fraction(loads_.contacts.size(), chunk, chunks_);
  for (std::size_t i = contacts.first; i < contacts.last; ++i) {
    const ContactSpring& row = loads_.contacts[i];
    if (row.gap(x) >= 0) continue;
    const double speed = row.along(d);
    linear += 2 * row.stiffness * speed * speed;
  }
  const Range muscles = fraction(loads_.muscles.size(), chunk, chunks_);
  for (std::size_t i = muscles.first; i < muscles.last; ++i)
    linear += loads_.muscles[i].curvature(x, d);
  const double lambda = mesh_.lambda;
  return {lambda * (springs.exact + linear) + (1 - lambda) * prisms.exact,
          lambda * (springs.gauss_newton + linear) + (1 - lambda) * prisms.gauss_newton};
}

Objective::Curvature SpringPrismEnergy::curvature(const Nodes& x, const Nodes& d) {
  assert(x.size() == static_cast<std::size_t>(mesh_.node_count) && d.size() == x.size());
  set_rows(d, d_);
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
