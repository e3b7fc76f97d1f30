#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/tissue/front_tree.h"
#include "engine/tissue/spring_prism.h"

namespace condyle {

/// Which second derivatives: all; or without the parts that may be negative (of shortened springs,
/// and of volumes under pressure), which is always positive definite.
enum class Curvatures { gauss_newton, exact };

/// Where the entries of a net's Hessian go; made once. Nodes are taken together in columns of
/// consecutive nodes, the blocks of the tree.
struct HessianPattern {
  HessianPattern(const SpringPrismNet& net, int nodes_per_column, const Nodes& x);

  /// A 3 x 3 part of the matrix: its first float, that of its row node and column node, which is
  /// the one eliminated first.
  struct Spot {  // eight bytes: there are many, and all are read
    static constexpr std::uint32_t nowhere = ~0u;
    std::uint32_t at = nowhere;  // not stored
    std::uint32_t stride : 31;
    std::uint32_t swapped : 1;  // the row is the second of the two nodes
    bool stored() const { return at != nowhere; }
  };
  Spot spot(int a, int b) const;
  /// Which of the order's three parts the node is in.
  int part_of(int node) const {
    const auto& part = tree->order.part;
    const int at = tree->place[node / nodes_per_column];
    return at < part[1] ? 0 : at < part[2] ? 1 : 2;
  }

  static constexpr int corner_pairs = 15;  // of a prism
  /// A prism with entries in a part.
  struct PrismPart {
    int prism;
    std::uint16_t pairs;  // a bit for each pair of corners whose entry is there
    bool first;           // of the parts with the prism: adds to its corners' own entries
  };
  /// What a part is added up from.
  struct Elements {
    std::vector<int> springs, anchors;
    std::vector<PrismPart> prisms;
  };

  std::shared_ptr<const FrontTree> tree;
  int nodes_per_column = 1;
  std::vector<int> seats;            // of each node, in the order of elimination
  std::vector<Spot> diagonal;        // of each seat
  std::vector<Spot> spring;          // of its two nodes
  std::vector<Spot> prism;           // corner_pairs of each
  std::array<Elements, 3> elements;  // of each part
};

/// The Hessian of a net at one state, added up in single precision.
class HessianAssembly {
 public:
  /// Keeps all of them.
  HessianAssembly(const HessianPattern& pattern, const SpringPrismNet& net, const NetLoads& loads,
                  const Nodes& x, Curvatures curvatures);

  /// Adds the entries whose column is in one of the order's parts to the panels, which are zero.
  /// Once for each part, from any threads; the third after the others.
  void add(int part, float* panels);

 private:
  void add_springs(int part, float* panels);
  void add_anchors(int part);
  void add_contacts(int part, float* panels) const;
  void add_prisms(int part, float* panels);
  void add_diagonal(int part, float* panels) const;

  /// Three numbers of a column of the matrix; the fourth is not used.
  typedef float Column __attribute__((vector_size(4 * sizeof(float))));
  /// A node's own entry.
  using Own = std::array<Column, 3>;
  /// What two nodes of a surface that is pressed add.
  struct Press {
    HessianPattern::Spot spot;
    int contact;
    double weight;
  };

  const HessianPattern& pattern_;
  const SpringPrismNet& net_;
  const NetLoads& loads_;
  const Nodes& x_;
  const bool exact_;
  std::array<std::vector<Press>, 3> presses_;  // of each part
  std::array<std::vector<Own>, 3> own_;        // what each part's elements add, seat by seat
};

}  // namespace condyle
