#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace condyle {

struct SpringPrismNet;

/// The springs and prisms of a net four by four, as the processor takes them: a run is up to four
/// that follow each other in the net and whose nodes do so too (nodes a, a + 1, ... against b, b +
/// 1, ...), as those of one edge of a layered net. Then places and forces are read and written in
/// one go, and no two lanes write to one node.
struct NetRuns {
  static constexpr int lanes = 4;
  static constexpr std::size_t align = 4;  // the numbers of runs are multiples of it
  explicit NetRuns(const SpringPrismNet& net);

  /// The first of the nodes that stand at one end of a run. Where it is `late`, forces are added
  /// from the node before it on, the last lane's going nowhere: then the nodes of a column are
  /// written to at one place, which the processor's stores want.
  struct Place {
    int first = 0;
    int late = 0;
  };
  struct Springs {
    Place a, b;
  };
  struct Prisms {
    std::array<Place, 6> corner;
    int count;  // lanes in use
  };
  std::vector<Springs> springs;
  std::vector<Prisms> prisms;
  // `lanes` of each run; those not in use have no stiffness, no weight.
  std::vector<double> rest_length, stiffness, rest_volume, volume_weight;
};

/// Three rows of numbers, one for each axis, followed by NetRuns::lanes more.
struct AxisRows {
  double *x, *y, *z;
};

/// Sums over runs [first, last) of a net, both even; see SpringPrismEnergy. They use the widest
/// vectors that the processor has and give the same bits on each that can fuse products and sums.
struct RunKernels {
  struct Range {
    std::size_t first, last;
  };
  /// sum k (l - l0)^2; adds its gradient to `gradient` if that has rows; keeps 1 / l of each lane.
  double (*springs)(const NetRuns& net, Range runs, double compression_share, const AxisRows& x,
                    const AxisRows& gradient, double* inverse_length);
  /// sum w v0^2 law(v / v0) and `scale` times its gradient; infinite where a prism has less than a
  /// thousandth of its volume.
  double (*prisms)(const NetRuns& net, Range runs, double barrier_share, double barrier_weight,
                   const AxisRows& x, double scale, const AxisRows& gradient);
  /// Second derivatives along d: all, and without the parts that may be negative.
  struct Bend {
    double exact, gauss_newton;
  };
  Bend (*springs_bend)(const NetRuns& net, Range runs, double compression_share, const AxisRows& x,
                       const AxisRows& d, const double* inverse_length);
  Bend (*prisms_bend)(const NetRuns& net, Range runs, double barrier_share, double barrier_weight,
                      const AxisRows& x, const AxisRows& d);
};

/// Those for this processor.
const RunKernels& run_kernels();

}  // namespace condyle
