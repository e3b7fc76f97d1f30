#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/tissue/front_tree.h"
#include "engine/tissue/spring_prism.h"

namespace condyle {

/// Exact second derivatives; or Gauss-Newton, without the parts that may be negative (shortened
/// springs, volumes under pressure), which is always positive definite.
enum class HessianKind { gauss_newton, exact };

/// Sparsity pattern and storage locations of a mesh's Hessian; computed once. Consecutive nodes are
/// grouped in columns, the blocks of the tree.
struct HessianPattern {
  HessianPattern(const SpringPrismMesh& mesh, int nodes_per_column, const Nodes& x);

  /// A 3 x 3 part of the matrix: index of its first float, for a row node and a column node, the
  /// one eliminated first.
  struct Spot {  // eight bytes: many are read in sequence
    static constexpr std::uint32_t nowhere = ~0u;
    std::uint32_t at = nowhere;  // not stored
    std::uint32_t stride : 31;
    std::uint32_t swapped : 1;  // the row belongs to the second of the two nodes
    bool stored() const { return at != nowhere; }
  };
  Spot spot(int a, int b) const;
  /// Part of the elimination order (0 to 2) that contains the node.
  int part_of(int node) const {
    const auto& part = tree->order.part;
    const int at = tree->place[node / nodes_per_column];
    return at < part[1] ? 0 : at < part[2] ? 1 : 2;
  }

  static constexpr int corner_pairs = 15;  // of a prism
  /// A prism with entries in one part.
  struct PrismPart {
    int prism;
    std::uint16_t pairs;  // a bit for each pair of corners with an entry in the part
    bool first;           // first part with this prism: it adds the diagonal entries of the corners
  };
  /// Elements that contribute to a part.
  struct Elements {
    std::vector<int> springs, anchors;
    std::vector<PrismPart> prisms;
  };

  std::shared_ptr<const FrontTree> tree;
  int nodes_per_column = 1;
  std::vector<int> seats;            // elimination index of each node
  std::vector<Spot> diagonal;        // per elimination index
  std::vector<Spot> spring;          // per spring, of its two nodes
  std::vector<Spot> prism;           // corner_pairs per prism
  std::array<Elements, 3> elements;  // of each part
};

/// Assembles the Hessian of a mesh at one state, in single precision.
class HessianAssembly {
 public:
  /// Keeps references to all arguments.
  HessianAssembly(const HessianPattern& pattern, const SpringPrismMesh& mesh,
                  const MeshLoads& loads, const Nodes& x, HessianKind curvatures);

  /// Adds the entries with columns in one part of the order to the zeroed panels. To be called once
  /// per part, from any thread; the third part after the others.
  void add(int part, float* panels);

 private:
  void add_springs(int part, float* panels);
  void add_anchors(int part);
  void add_line(const MuscleLine& muscle);
  void couple(std::span<const int> node, std::span<const double> weight,
              const Eigen::Matrix3d& matrix);
  void add_couplings(int part, float* panels) const;
  void add_prisms(int part, float* panels);
  void add_diagonal(int part, float* panels) const;

  /// Three elements of a matrix column; the fourth is padding.
  typedef float Column __attribute__((vector_size(4 * sizeof(float))));
  /// The diagonal entry of a node.
  using Own = std::array<Column, 3>;
  /// Contribution of two nodes of a contact or a muscle.
  struct Coupling {
    HessianPattern::Spot spot;
    int matrix;
    double weight;
  };

  const HessianPattern& pattern_;
  const SpringPrismMesh& mesh_;
  const MeshLoads& loads_;
  const Nodes& x_;
  const bool exact_;
  std::vector<Eigen::Matrix3d> matrices_;           // of contacts and muscles
  std::array<std::vector<Coupling>, 3> couplings_;  // of each part
  std::array<std::vector<Own>, 3>
      own_;  // contribution of each part's elements, by elimination index
};

}  // namespace condyle
