#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "engine/minimize/objective.h"
#include "engine/tissue/contact_spring.h"
#include "engine/tissue/element_batches.h"
#include "engine/tissue/muscle_line.h"

namespace condyle {

using Nodes = Points;  // mm

/// A body of springs and volume elements (prisms) over nodes. Structure of arrays; the order of
/// springs and prisms determines the order of every sum.
struct SpringPrismMesh {
  int node_count = 0;

  // Springs between two nodes.
  std::vector<int> spring_a, spring_b;
  std::vector<double> rest_length;  // mm
  std::vector<double> stiffness;    // N/mm; the spring's energy is stiffness * (l - rest)^2

  // Zero-length springs from a node to a point given at each evaluation, with energy stiffness *
  // |d|^2.
  std::vector<int> anchor_node;
  std::vector<double> anchor_stiffness;

  // Prisms: corners 0 1 2 counter-clockwise seen from outside, 3 4 5 below them.
  std::vector<std::array<int, 6>> prisms;
  std::vector<double> rest_volume;    // mm^3
  std::vector<double> volume_weight;  // energy is weight * (v - rest)^2, N/mm^5

  /// Pairs of nodes without a spring that contact may couple: a preconditioner reserves entries for
  /// them.
  std::vector<std::array<int, 2>> may_touch;

  /// Ratio of the stiffness of a shortened spring to that of a stretched one. 1 is the unmodified
  /// energy; smaller values model fibres that buckle in compression and prevent most folding of
  /// thin sheets.
  double compression_ratio = 0.05;
  double lambda = 0.5;  // weight of the springs; 1 - lambda that of the volumes
  /// Below this fraction of its rest volume a prism has an additional barrier energy, unbounded at
  /// zero volume.
  double barrier_fraction = 0.5;
  double barrier_weight = 4.0;

  // Layer of each spring (the outermost of several), and the sheet of which it is an edge, or -1
  // across layers.
  std::vector<int> spring_layer, spring_sheet;
  std::vector<double> node_mass_kg;  // one per node, or none
};

/// External loads and constraints at one time.
struct MeshLoads {
  Nodes anchor_target;                  // one per anchor
  std::vector<double> anchor_scale;     // of the stiffness, above 0; one per anchor, or empty for 1
  std::vector<ContactSpring> contacts;  // active or potential contacts
  std::vector<MuscleLine> muscles;      // with the weight lambda
  /// Forces on the nodes, N; one per node, or empty. They have the weight lambda, as the springs
  /// have, so a spring under a force stretches by force / (2 stiffness) for any lambda.
  Nodes node_force;
};

inline double anchor_stiffness(const SpringPrismMesh& mesh, const MeshLoads& loads, std::size_t i) {
  return mesh.anchor_stiffness[i] * (loads.anchor_scale.empty() ? 1 : loads.anchor_scale[i]);
}

/// Weight of the nodes along `down` (unit), 9.81 N/kg.
Nodes weight_of_nodes(const SpringPrismMesh& mesh, const Eigen::Vector3d& down);

/// Signed volume, the mean over both splits of each side quad; positive for the corner order above.
double prism_volume(const Nodes& nodes, const std::array<int, 6>& prism);

/// The same, with its derivative with respect to each corner.
double prism_volume_gradient(const Nodes& nodes, const std::array<int, 6>& prism,
                             std::array<Eigen::Vector3d, 6>& gradient);

/// Second derivative of the volume by the corners a and b, for b < a in the order 10 20 21 30 ...:
/// the matrices whose product with v is cross[.] x v. (Its transpose by b and a; zero by a and a.)
std::array<Eigen::Vector3d, 15> prism_volume_bend(const Nodes& nodes,
                                                  const std::array<int, 6>& prism);

/// First derivative of a prism's energy, over its weight times its rest volume, by its volume.
double volume_pressure(double fraction, double barrier_fraction, double barrier_weight);
/// Second derivative of a prism's energy, over its weight, by its volume, at v = fraction * rest.
double volume_stiffness(double fraction, double barrier_fraction, double barrier_weight);

/// Energy, gradient and curvature of a mesh; owns its work space and a copy of the mesh's
/// constants. The order of the sums does not depend on the number of threads.
class SpringPrismEnergy final : public Objective {
 public:
  /// Keeps `loads` by reference; they may change between calls. `batches`: of the mesh, where
  /// available.
  SpringPrismEnergy(const SpringPrismMesh& mesh, const MeshLoads& loads, int threads,
                    std::shared_ptr<const ElementBatches> batches = nullptr);

  /// Energy, mJ: lambda sum k (l - l0)^2 + (1 - lambda) sum w (v - v0)^2, anchors, contacts,
  /// muscles and node forces with the springs. Infinite where a prism has no positive volume.
  double value(const Nodes& x) override;
  /// The same, with its gradient (N).
  double value_and_gradient(const Nodes& x, Nodes& gradient) override;
  /// Precondition: the last call of value_and_gradient was at `x`, because spring lengths are
  /// reused.
  Curvature curvature(const Nodes& x, const Nodes& d) override;
  int threads() const { return threads_; }

 private:
  static constexpr int chunks_ = 2;  // fixed: sums must not depend on the number of threads
  using Rows = std::vector<double>;  // see AxisRows
  AxisRows rows(Rows& of) const;
  void set_rows(const Nodes& x, Rows& to) const;
  double energy(const Nodes& x, bool with_gradient);
  double chunk_energy(int chunk, const Nodes& x, bool with_gradient);
  Curvature chunk_curvature(int chunk, const Nodes& x, const Nodes& d);

  const SpringPrismMesh& mesh_;
  const MeshLoads& loads_;
  int threads_;
  std::shared_ptr<const ElementBatches> batches_;
  Rows x_, d_;
  std::array<Rows, chunks_> gradient_;
  std::vector<double> inverse_length_;  // per lane of the spring batches, 1/mm
};

}  // namespace condyle
