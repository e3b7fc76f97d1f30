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

/// Solutions of sliding contact for the target poses of a lattice. Each is reached from its
/// neighbour nearer to a free pose, or nearer to rest, in short walks; so a solution depends on its
/// lattice position alone, and caching never changes an answer.
class SlideLattice {
 public:
  using Key = std::array<int, 6>;
  struct Node {
    bool solved = false;
    bool found = false;    // otherwise unreachable
    bool reached = false;  // reached from `root` without passing through anything
    Pose X = {};           // answer
    Pose root = {};        // a free pose, or rest
    double left = 0;       // remaining distance from the answer to the target pose
    Key parent = {};
    std::vector<SlideContact> contacts = {};  // active at the answer
  };

  SlideLattice(const SlidingContact& model, int threads);

  /// The solution to start from towards a target pose that overlaps.
  Node nearest(const Pose& target);

  /// A node's answer, displaced within its contacts by the offset of the target pose from the
  /// node's position.
  Pose carried(const Node& node, const Pose& target) const;

  /// Performs some steps of the walks that the next target poses will need, extrapolated from the
  /// last two, so that no frame has to do a whole walk: a few steps, and further ones while `more`
  /// returns true.
  void prefetch(const Pose& target, const std::function<bool()>& more);

 private:
  using Tree = std::map<Key, Node>;
  struct ExitDirection {
    bool free = false;
    double depth_mm = 0;
    Eigen::Vector3d direction = {0, 0, 0};  // unit; zero where there is none
  };

  /// A node that is being solved in advance.
  struct Prefetch {
    Tree* tree;
    Key key;
    Node parent;
    SlideWalk walk;
  };

  Key key_of(const Pose& X) const;
  Pose place_of(const Key& key) const;
  bool near_rest(const Key& key) const;
  ExitDirection exit_direction(const Pose& X);
  std::optional<Pose> moved_out(const Pose& target);
  SlideWalk walk(const Node& parent, const Pose& to);
  Node finish(const Node& parent, SlideWalk&& walk, const Pose& to);
  Node slid(const Node& parent, const Pose& to) { return finish(parent, walk(parent, to), to); }
  Node alone(const Pose& place);
  Node& visited(const Key& key);
  Key outer(const Key& key, const Eigen::Vector3d& direction) const;
  std::pair<std::vector<Key>, Node> chain_outside(Key key);
  std::pair<std::vector<Key>, Node> chain_to_rest(Key key);
  Node solve(Tree& tree, const std::pair<std::vector<Key>, Node>& chain);
  bool begin_prefetch(Tree& tree, const std::pair<std::vector<Key>, Node>& chain);
  void continue_prefetch(int steps);
  bool find_prefetch(const Pose& target, const Twist& step);

  const SlidingContact& model_;
  SlideProbe probe_;
  double cell_mm_;  // between lattice positions
  Pose origin_;     // the position of key 0: rest, where there is one
  Eigen::Quaterniond axes_ = Eigen::Quaterniond::Identity();
  Tree outside_, rest_;
  std::optional<Prefetch> prefetch_;
  bool asked_ = false;               // a missing node was requested since the last prefetch
  std::optional<Pose> last_target_;  // at the last prefetch
};

}  // namespace condyle
