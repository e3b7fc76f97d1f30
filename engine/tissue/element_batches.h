#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace condyle {

struct SpringPrismMesh;

/// The springs and prisms of a mesh in batches of four for SIMD evaluation. Consecutive nodes (a, a
/// + 1, ...) are loaded and stored as one vector; the columns of a layered mesh once for all
/// springs of an edge, and once for all prisms between three columns.
struct ElementBatches {
  static constexpr int lanes = 4;
  static constexpr std::size_t align = 4;  // the numbers of batches are multiples of this
  explicit ElementBatches(const SpringPrismMesh& mesh);

  /// Up to twelve springs between two columns of up to four sheets. In lane i, `level` joins a + i
  /// and b + i, `rising` a + i and b + i + 1, `falling` a + i + 1 and b + i; i + 1 is 0 after the
  /// last lane.
  struct Edge {
    int a = 0, b = 0;
    enum Direction { level, rising, falling, directions };
  };
  /// Up to three springs within a column: lane i joins a + i and a + i + 1.
  struct VerticalEdge {
    int a = 0;
  };
  /// Up to four springs: lane i joins a + i and b + i.
  struct SpringBatch {
    int a = 0, b = 0;
  };
  std::vector<Edge> edges;
  std::vector<VerticalEdge> vertical_edges;
  std::vector<SpringBatch> spring_batches;  // all other springs

  /// Up to three prisms between columns: in lane i, corners k and k + 3 are the nodes at[k] + i and
  /// at[k] + i + 1.
  struct PrismColumn {
    std::array<int, 3> at;
    int count;  // lanes in use
  };
  struct Prisms {
    std::array<int, 6> at;
    int count;
  };
  std::vector<PrismColumn> prism_columns;
  std::vector<Prisms> prisms;  // all others

  /// First lane of a direction of an edge, of a vertical edge, of a spring batch. The directions of
  /// two edges alternate.
  static std::size_t lane(std::size_t edge, Edge::Direction direction) {
    return (edge / 2 * 2 * Edge::directions + direction * 2 + edge % 2) * lanes;
  }
  std::size_t lane_of_vertical(std::size_t vertical) const {
    return (edges.size() * Edge::directions + vertical) * lanes;
  }
  std::size_t lane_of_springs(std::size_t batch) const {
    return lane_of_vertical(vertical_edges.size() + batch);
  }
  // Per lane; unused lanes have zero stiffness.
  std::vector<double> rest_length, stiffness;
  // Per lane of the prism columns, then of the other prisms: 1 / v0 and w v0^2; zero in unused
  // lanes.
  std::vector<double> inverse_volume, volume_energy;

 private:
  void batch_springs(const SpringPrismMesh& mesh);
  void batch_prisms(const SpringPrismMesh& mesh);
};

/// Three rows of numbers, one per axis, each padded by ElementBatches::lanes.
struct AxisRows {
  double *x, *y, *z;
};

/// Sums over half 0 or 1 of the batches of a mesh; see SpringPrismEnergy. They use the widest
/// vectors of the processor and are bit-identical on all processors with fused multiply-add.
struct ElementKernels {
  /// sum k (l - l0)^2; adds its gradient to `gradient` unless null; stores 1 / l of each lane.
  double (*springs)(const ElementBatches& elements, int half, double compression_ratio,
                    const AxisRows& x, const AxisRows& gradient, double* inverse_length);
  /// sum w v0^2 law(v / v0) and `scale` times its gradient; infinite where a prism has less than a
  /// thousandth of its rest volume.
  double (*prisms)(const ElementBatches& elements, int half, double barrier_fraction,
                   double barrier_weight, const AxisRows& x, double scale,
                   const AxisRows& gradient);
  /// Second derivatives along d: exact, and without the parts that may be negative.
  struct Bend {
    double exact, gauss_newton;
  };
  Bend (*springs_bend)(const ElementBatches& elements, int half, double compression_ratio,
                       const AxisRows& x, const AxisRows& d, const double* inverse_length);
  Bend (*prisms_bend)(const ElementBatches& elements, int half, double barrier_fraction,
                      double barrier_weight, const AxisRows& x, const AxisRows& d);
};

/// The kernels that this processor supports, the fastest first; the last is portable and uses no
/// fused multiply-add.
const std::vector<const ElementKernels*>& usable_element_kernels();
inline const ElementKernels& element_kernels() { return *usable_element_kernels().front(); }

}  // namespace condyle
