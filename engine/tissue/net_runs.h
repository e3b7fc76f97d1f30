#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace condyle {

struct SpringPrismNet;

/// The springs and prisms of a net as the processor takes them, four at a time. Nodes that follow
/// each other (a, a + 1, ...) are read and written in one go; those of a layered net's columns once
/// for all springs of an edge, and once for all prisms between three columns.
struct NetRuns {
  static constexpr int lanes = 4;
  static constexpr std::size_t align = 4;  // the numbers of runs are multiples of it
  explicit NetRuns(const SpringPrismNet& net);

  /// Up to ten springs between two columns of up to four sheets: of lane i, `level` joins a + i and
  /// b + i, `rising` a + i and b + i + 1, `falling` a + i + 1 and b + i.
  struct Edge {
    int a = 0, b = 0;
    enum Way { level, rising, falling, ways };
  };
  /// Up to three springs within a column: of a + i and a + i + 1.
  struct Post {
    int a = 0;
  };
  /// Up to four springs of a + i and b + i.
  struct Run {
    int a = 0, b = 0;
  };
  std::vector<Edge> edges;
  std::vector<Post> posts;
  std::vector<Run> runs;  // all other springs

  /// Up to three prisms between columns: of lane i, corner k and k + 3 are at[k] + i and the next.
  struct Stack {
    std::array<int, 3> at;
    int count;  // lanes in use
  };
  struct Prisms {
    std::array<int, 6> at;
    int count;
  };
  std::vector<Stack> stacks;
  std::vector<Prisms> prisms;  // all others

  /// First lane of a way of an edge, of a post, of a run. The ways of two edges stand in turn.
  static std::size_t lane(std::size_t edge, Edge::Way way) {
    return (edge / 2 * 2 * Edge::ways + way * 2 + edge % 2) * lanes;
  }
  std::size_t lane_of_post(std::size_t post) const {
    return (edges.size() * Edge::ways + post) * lanes;
  }
  std::size_t lane_of_run(std::size_t run) const { return lane_of_post(posts.size() + run); }
  // Of each lane; those not in use have no stiffness.
  std::vector<double> rest_length, stiffness;
  // `lanes` of each stack, then of the other prisms: 1 / v0 and w v0^2; those not in use have none.
  std::vector<double> inverse_volume, volume_energy;
};

/// Three rows of numbers, one for each axis, followed by NetRuns::lanes more.
struct AxisRows {
  double *x, *y, *z;
};

/// Sums over half 0 or 1 of a net's runs; see SpringPrismEnergy. They use the widest vectors that
/// the processor has and give the same bits on each that can fuse products and sums.
struct RunKernels {
  /// sum k (l - l0)^2; adds its gradient to `gradient` if that has rows; keeps 1 / l of each lane.
  double (*springs)(const NetRuns& net, int half, double compression_share, const AxisRows& x,
                    const AxisRows& gradient, double* inverse_length);
  /// sum w v0^2 law(v / v0) and `scale` times its gradient; infinite where a prism has less than a
  /// thousandth of its volume.
  double (*prisms)(const NetRuns& net, int half, double barrier_share, double barrier_weight,
                   const AxisRows& x, double scale, const AxisRows& gradient);
  /// Second derivatives along d: all, and without the parts that may be negative.
  struct Bend {
    double exact, gauss_newton;
  };
  Bend (*springs_bend)(const NetRuns& net, int half, double compression_share, const AxisRows& x,
                       const AxisRows& d, const double* inverse_length);
  Bend (*prisms_bend)(const NetRuns& net, int half, double barrier_share, double barrier_weight,
                      const AxisRows& x, const AxisRows& d);
};

/// Those that this processor has, the fastest first; the last can be used anywhere, and does not
/// fuse.
const std::vector<const RunKernels*>& usable_run_kernels();
inline const RunKernels& run_kernels() { return *usable_run_kernels().front(); }

}  // namespace condyle
