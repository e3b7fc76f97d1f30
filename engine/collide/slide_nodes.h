#pragma once

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <optional>
#include <vector>

#include "engine/collide/slide.h"
#include "engine/collide/slide_probe.h"

namespace condyle {

/// Where the body gets to for the wanted poses of a lattice. Each is slid to from its neighbour
/// nearer to freedom, or nearer to rest, in short walks; so an answer depends on its place alone,
/// and what is kept of them changes no bit.
class SlideNodes {
 public:
  using Key = std::array<int, 6>;
  struct Node {
    bool solved = false;
    bool found = false;    // else no way leads there
    bool reached = false;  // from `root`, and nothing can lie between
    Pose X = {};           // answer
    Pose root = {};        // free, or rest
    double left = 0;       // from the answer to the place
    Key parent = {};
  };

  SlideNodes(const SlidingContact& model, SlideProbe& probe);

  /// Whether anything is too deep at X.
  bool overlaps(const Pose& X);

  /// What to slide from towards a wanted pose that overlaps.
  Node nearest(const Pose& wanted);

  /// Does a part of the work that the next wanted poses will ask for, where the last two lead, so
  /// that not all of it falls on one frame.
  void look_ahead(const Pose& wanted);

 private:
  using Tree = std::map<Key, Node>;
  struct WayOut {
    bool free = false;
    double depth_mm = 0;
    Eigen::Vector3d direction = {0, 0, 0};  // unit; zero where none leads out
  };

  Key key_of(const Pose& X) const;
  Pose place_of(const Key& key) const;
  bool near_rest(const Key& key) const;
  WayOut way_out(const Pose& X);
  std::optional<Pose> drawn_out(const Pose& wanted);
  Node slid(const Node& parent, const Pose& to);
  Node alone(const Pose& place);
  Node& visited(const Key& key);
  Key outer(const Key& key, const Eigen::Vector3d& direction) const;
  Node solve(Tree& tree, const std::vector<Key>& chain, Node node, int most);
  Node from_outside(const Key& key, int most);
  Node from_rest(const Key& key, int most);

  const SlidingContact& model_;
  SlideProbe& probe_;
  double cell_mm_;  // between places
  Pose origin_;     // the place of the key 0: rest, where there is one
  Eigen::Quaterniond axes_ = Eigen::Quaterniond::Identity();
  Tree outside_, rest_;
  int solved_ = 0;                   // since the last look ahead
  std::optional<Pose> last_wanted_;  // at the last look ahead
};

}  // namespace condyle
