#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <mutex>
#include <vector>

#include "engine/collide/box_bound.h"

namespace condyle {

/// Where the traversal of two box trees ended: the pairs of boxes that it did not open, and the
/// pairs of triangles, each with a lower bound of its gap. Where the bodies hardly move, as a jaw
/// that is held by its teeth, a query goes on from there and looks again only at pairs that may
/// have come too near. Where they move faster, beginning at the roots is as fast. source: Li and
/// Chen 1998, incremental collision detection with hierarchical data structures.
class TraversalFront {
 public:
  struct End {
    int a = 0, b = 0;    // boxes: twice the index of the node, plus 0 or 1
    float clear_mm = 0;  // lower bound of the gap, plus the travel by then
  };

  /// Begins a query with body B at X in body A. False: this query does not use the front.
  bool begin(const std::vector<BoxPair>& a, const std::vector<BoxPair>& b,
             const Eigen::Isometry3d& X);
  /// Whether the query has to begin at the roots of the trees.
  bool at_roots() const { return at_roots_; }
  /// Of the last query, in the order of its traversal.
  const std::vector<End>& ends() const { return last_; }
  /// Lower bound of the gap at the pose of this query.
  double gap_mm(const End& end) const { return static_cast<double>(end.clear_mm) - travelled_mm_; }

  void keep(const End& end) { next_.push_back(end); }
  void add(int a, int b, double gap_mm);
  void finish();

 private:
  const BoxPair *a_ = nullptr, *b_ = nullptr;  // the trees of the last query
  Eigen::Isometry3d X_;                        // its pose
  double travelled_mm_ =
      0;  // since the query that began at the roots: at least that of any point of B
  double unused_mm_ = 0;  // of that, since a query used the front
  std::vector<End> last_, next_;
  std::size_t first_count_ = 0;  // of the ends after the query that began at the roots
  bool at_roots_ = true;
};

/// What queries of one pair of surfaces keep from pose to pose. It never changes an answer. Threads
/// may share it: a query that finds it in use does without.
struct PairCache {
  std::mutex in_use;
  TraversalFront nearest, crossing;
};

}  // namespace condyle
