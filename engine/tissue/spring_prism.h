#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "engine/minimize/objective.h"
#include "engine/tissue/contact_row.h"
#include "engine/tissue/net_runs.h"

namespace condyle {

using Nodes = Points;  // mm

/// A body of springs and volume elements (prisms) over nodes. Structure of arrays; the order of the
/// springs and prisms fixes the order of every sum.
struct SpringPrismNet {
  int node_count = 0;

  // Springs between two nodes.
  std::vector<int> spring_a, spring_b;
  std::vector<double> rest_length;  // mm
  std::vector<double> stiffness;    // N/mm; the spring's energy is stiffness * (l - rest)^2

  // Zero-length springs from a node to a point that is given at each evaluation: energy is
  // stiffness * |d|^2, so nothing is divided by a length.
  std::vector<int> anchor_node;
  std::vector<double> anchor_stiffness;

  // Prisms: corners 0 1 2 counter-clockwise seen from outside, 3 4 5 below them.
  std::vector<std::array<int, 6>> prisms;
  std::vector<double> rest_volume;    // mm^3
  std::vector<double> volume_weight;  // energy is weight * (v - rest)^2, N/mm^5

  /// Nodes that no spring joins but contact may couple: a preconditioner has room for them.
  std::vector<std::array<int, 2>> may_touch;

  /// Stiffness of a shortened spring, over that of a stretched one. 1 is the plain energy; less
  /// says that fibres buckle where they cannot push, and takes most of the folding out of thin
  /// sheets.
  double compression_share = 0.05;
  double lambda = 0.5;  // weight of the springs; 1 - lambda that of the volumes
  /// Below this share of its rest volume a prism resists ever more, without bound at zero.
  double barrier_share = 0.5;
  double barrier_weight = 4.0;

  // What each spring is: its layer, and the sheet that it is an edge of, or -1 across a layer.
  std::vector<int> spring_layer, spring_sheet;
  std::vector<double> node_mass_kg;  // one per node, or none
};

/// What the outer world asks at one time.
struct NetLoads {
  Nodes anchor_target;               // one per anchor
  std::vector<ContactRow> contacts;  // what may not be entered
  /// Pulls the nodes, N; one per node, or empty. Like the springs it counts with weight lambda, so
  /// that a spring under it stretches by force / (2 stiffness) whatever lambda is.
  Nodes node_force;
};

/// Weight of each node's mass: along `down` (unit), 9.81 N/kg.
Nodes weight_of_nodes(const SpringPrismNet& net, const Eigen::Vector3d& down);

/// Signed volume, the mean over both splits of each side quad; positive for the corner order above.
double prism_volume(const Nodes& nodes, const std::array<int, 6>& prism);

/// The same, and its derivative by each corner.
double prism_volume_gradient(const Nodes& nodes, const std::array<int, 6>& prism,
                             std::array<Eigen::Vector3d, 6>& gradient);

/// Second derivative of the volume by the corners a and b, for b < a in the order 10 20 21 30 ...:
/// the matrices whose product with v is cross[.] x v. (Its transpose by b and a; zero by a and a.)
std::array<Eigen::Vector3d, 15> prism_volume_bend(const Nodes& nodes,
                                                  const std::array<int, 6>& prism);

/// First derivative of a prism's energy, over its weight times its rest volume, by its volume.
double volume_pressure(double share, double barrier_share, double barrier_weight);
/// Second derivative of a prism's energy, over its weight, by its volume, at v = share * rest.
double volume_stiffness(double share, double barrier_share, double barrier_weight);

/// Energy, gradient and curvature of a net; keeps its work space, and the net's constants as they
/// were when it was made. The sums are taken in an order
/// that does not depend on the number of threads.
class SpringPrismEnergy final : public Objective {
 public:
  /// Keeps `loads` by reference: they may change between calls. `runs`: those of the net, when they
  /// have been made before.
  SpringPrismEnergy(const SpringPrismNet& net, const NetLoads& loads, int threads,
                    std::shared_ptr<const NetRuns> runs = nullptr);

  /// Energy, mJ: lambda sum k (l - l0)^2 + (1 - lambda) sum w (v - v0)^2, anchors, contacts and
  /// node forces with the springs. Infinite where a prism has no positive volume.
  double value(const Nodes& x) override;
  /// The same, and its gradient (N).
  double value_and_gradient(const Nodes& x, Nodes& gradient) override;
  /// Wants the last call of value_and_gradient to have been at `x`: lengths are kept from there.
  Curvature curvature(const Nodes& x, const Nodes& d) override;
  int threads() const { return threads_; }

 private:
  static constexpr int chunks_ = 2;  // fixed: the sums must not know the number of threads
  using Rows = std::vector<double>;  // see AxisRows
  AxisRows rows(Rows& of) const;
  void set_rows(const Nodes& x, Rows& to) const;
  double energy(const Nodes& x, bool with_gradient);
  double chunk_energy(int chunk, const Nodes& x, bool with_gradient);
  Curvature chunk_curvature(int chunk, const Nodes& x, const Nodes& d);

  const SpringPrismNet& net_;
  const NetLoads& loads_;
  int threads_;
  std::shared_ptr<const NetRuns> runs_;
  Rows x_, d_;
  std::array<Rows, chunks_> gradient_;
  std::vector<double> inverse_length_;  // of each lane of a run of springs, 1/mm
};

}  // namespace condyle
