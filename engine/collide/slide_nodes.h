#pragma once

#include <Eigen/Geometry>
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "engine/collide/slide.h"
#include "engine/collide/slide_probe.h"
#include "engine/collide/slide_walk.h"

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
    std::vector<SlideContact> contacts = {};  // that hold the answer
  };

  SlideNodes(const SlidingContact& model, int threads);

  /// What to slide from towards a wanted pose that overlaps.
  Node nearest(const Pose& wanted);

  /// A node's answer carried along its contacts as far as the wanted pose lies from its place.
  Pose carried(const Node& node, const Pose& wanted) const;

  /// Does some steps of the walks that the next wanted poses will ask for, where the last two lead,
  /// so that no whole one falls on one frame: a few, and more while `more` holds.
  void look_ahead(const Pose& wanted, const std::function<bool()>& more);

 private:
  using Tree = std::map<Key, Node>;
  struct WayOut {
    bool free = false;
    double depth_mm = 0;
    Eigen::Vector3d direction = {0, 0, 0};  // unit; zero where none leads out
  };

  /// A node that is being solved ahead of time.
  struct Ahead {
    Tree* tree;
    Key key;
    Node parent;
    SlideWalk walk;
  };

  Key key_of(const Pose& X) const;
  Pose place_of(const Key& key) const;
  bool near_rest(const Key& key) const;
  WayOut way_out(const Pose& X);
  std::optional<Pose> drawn_out(const Pose& wanted);
  SlideWalk walk(const Node& parent, const Pose& to);
  Node at_end(const Node& parent, SlideWalk&& walk, const Pose& to);
  Node slid(const Node& parent, const Pose& to) { return at_end(parent, walk(parent, to), to); }
  Node alone(const Pose& place);
  Node& visited(const Key& key);
  Key outer(const Key& key, const Eigen::Vector3d& direction) const;
  std::pair<std::vector<Key>, Node> chain_outside(Key key);
  std::pair<std::vector<Key>, Node> chain_to_rest(Key key);
  Node solve(Tree& tree, const std::pair<std::vector<Key>, Node>& chain);
  bool begin_ahead(Tree& tree, const std::pair<std::vector<Key>, Node>& chain);
  void go_on_ahead(int steps);
  bool find_ahead(const Pose& wanted, const Twist& way);

  const SlidingContact& model_;
  SlideProbe probe_;
  double cell_mm_;  // between places
  Pose origin_;     // the place of the key 0: rest, where there is one
  Eigen::Quaterniond axes_ = Eigen::Quaterniond::Identity();
  Tree outside_, rest_;
  std::optional<Ahead> ahead_;
  bool asked_ = false;               // for nodes that were not there, since the last look ahead
  std::optional<Pose> last_wanted_;  // at the last look ahead
};

}  // namespace condyle
