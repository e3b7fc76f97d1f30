#include "engine/collide/path_search.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/collide/path_refinement.h"
#include "engine/core/infinity.h"

namespace condyle {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double settled_mm = 0.05;  // of the walks
constexpr double least_mm = 0.4;     // a shorter move adds no pose to a tree
constexpr double arrived_mm = 0.02;
constexpr double local_share = 0.5;  // of the moves that start at any pose of a tree

struct Tree {
  struct Node {
    Pose X;
    int parent;
  };
  std::vector<Node> nodes = {};

  std::vector<Pose> to_root(int node) const {
    std::vector<Pose> poses;
    for (; node >= 0; node = nodes[static_cast<std::size_t>(node)].parent)
      poses.push_back(nodes[static_cast<std::size_t>(node)].X);
    return poses;
  }
};

class TreeSearch {
 public:
  TreeSearch(PathChecker& checker, const PathSearchSettings& settings)
      : checker_(checker), settings_(settings), random_(settings.seed) {}

  PathSearch run(const Pose& start, const std::vector<Pose>& goals);

 private:
  std::optional<int> extend(Tree& tree, int from, const Pose& target, bool& arrived);
  std::optional<int> connect(Tree& tree, const Pose& target);
  int nearest(const Tree& tree, const Pose& X) const;
  Pose limited(const Pose& from, const Pose& target) const;
  Pose random_pose(const Pose& start);
  Pose random_move(const Pose& from);
  bool within(const Pose& start, const Pose& X) const {
    return (X * checker_.pivot() - start * checker_.pivot()).norm() <= settings_.reach_mm &&
           rotation_angle(start.inverse() * X) <= settings_.turn_rad;
  }

  PathChecker& checker_;
  const PathSearchSettings& settings_;
  PathRandom random_;
};

int TreeSearch::nearest(const Tree& tree, const Pose& X) const {
  int best = 0;
  double least = infinity;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i)
    if (const double d = checker_.distance(tree.nodes[i].X, X); d < least) {
      least = d;
      best = static_cast<int>(i);
    }
  return best;
}

Pose TreeSearch::limited(const Pose& from, const Pose& target) const {
  const double length = checker_.distance(from, target);
  return length <= settings_.extend_mm
             ? target
             : interpolate(from, target, settings_.extend_mm / length, checker_.pivot());
}

/// Anywhere within reach.
Pose TreeSearch::random_pose(const Pose& start) {
  const Vector3d shift = settings_.reach_mm * std::cbrt(random_.uniform()) * random_.direction();
  const double angle = settings_.turn_rad * random_.uniform();
  return checker_.placed(start, shift, angle * random_.direction());
}

/// A move from a pose: along one of the directions, along any, a turn, or both.
Pose TreeSearch::random_move(const Pose& from) {
  const double length = settings_.extend_mm * (0.2 + 0.8 * random_.uniform());
  const double kind = random_.uniform();
  Vector3d along = random_.direction(), turn = random_.direction();
  const double per_length = length / checker_.rotation_length_mm();
  if (kind < 0.25 && !settings_.directions.empty()) {
    along = settings_.directions[random_.index(settings_.directions.size())];
    turn.setZero();
  } else if (kind < 0.45) {
    turn.setZero();
  } else if (kind < 0.7) {
    along.setZero();
  }
  return checker_.placed(from, length * along, per_length * turn);
}

/// Adds the pose that the body comes to on its way from a node, unless it hardly moves.
std::optional<int> TreeSearch::extend(Tree& tree, int from, const Pose& target, bool& arrived) {
  const Pose X = tree.nodes[static_cast<std::size_t>(from)].X;
  const Pose to = limited(X, target);
  const Pose reached = checker_.slid(X, to, settled_mm);
  arrived = checker_.distance(reached, target) < arrived_mm;
  if (!arrived && checker_.distance(X, reached) < least_mm) return std::nullopt;
  const double part = checker_.free_part(X, reached);
  if (part < 1) {
    arrived = false;
    if (part * checker_.distance(X, reached) < least_mm) return std::nullopt;
  }
  tree.nodes.push_back(
      {part < 1 ? interpolate(X, reached, part, checker_.pivot()) : reached, from});
  return static_cast<int>(tree.nodes.size()) - 1;
}

/// Moves the nearest pose of a tree towards a target as far as it comes nearer.
std::optional<int> TreeSearch::connect(Tree& tree, const Pose& target) {
  int at = nearest(tree, target);
  double left = checker_.distance(tree.nodes[static_cast<std::size_t>(at)].X, target);
  while (left > arrived_mm) {
    bool arrived = false;
    const auto next = extend(tree, at, target, arrived);
    if (!next) return std::nullopt;
    at = *next;
    if (arrived) break;
    const double now = checker_.distance(tree.nodes[static_cast<std::size_t>(at)].X, target);
    if (now > left - least_mm) return std::nullopt;
    left = now;
  }
  return at;
}

PathSearch TreeSearch::run(const Pose& start, const std::vector<Pose>& goals) {
  PathSearch found;
  Tree near{{{start, -1}}}, far;
  for (const Pose& goal : goals)
    if (checker_.is_free(goal)) far.nodes.push_back({goal, -1});
  std::size_t seen = 0;
  const auto note_farthest = [&] {
    for (; seen < near.nodes.size(); ++seen) {
      const Pose& X = near.nodes[seen].X;
      const double mm = (X * checker_.pivot() - start * checker_.pivot()).norm();
      if (mm > found.farthest_mm) {
        found.farthest_mm = mm;
        found.farthest = X;
      }
    }
  };
  for (bool grows_near = true; !far.nodes.empty() && checker_.examined() < settings_.max_poses;
       grows_near = !grows_near) {
    Tree &tree = grows_near ? near : far, &other = grows_near ? far : near;
    const bool local = random_.uniform() < local_share;
    const int from = local ? static_cast<int>(random_.index(tree.nodes.size())) : -1;
    const Pose target =
        local ? random_move(tree.nodes[static_cast<std::size_t>(from)].X) : random_pose(start);
    if (!within(start, target)) continue;
    bool arrived = false;
    const auto added = extend(tree, local ? from : nearest(tree, target), target, arrived);
    note_farthest();
    if (!added) continue;
    const auto met = connect(other, tree.nodes[static_cast<std::size_t>(*added)].X);
    note_farthest();
    if (!met) continue;
    found.poses = near.to_root(grows_near ? *added : *met);
    std::reverse(found.poses.begin(), found.poses.end());
    const auto rest = far.to_root(grows_near ? *met : *added);
    found.poses.insert(found.poses.end(), rest.begin() + 1, rest.end());
    break;
  }
  return found;
}

}  // namespace

PathSearch find_path(const SlidingContact& contact, const SlidingContact& finer, const Pose& start,
                     const std::vector<Pose>& goals, const PathSearchSettings& settings) {
  PathChecker checker(contact);
  PathSearch found = TreeSearch(checker, settings).run(start, goals);
  found.examined = checker.examined();
  if (found.poses.empty()) return found;
  PathChecker fine(finer);
  PathRandom random(settings.seed + 1);
  found.poses = refined_path(std::move(found.poses), fine, random, settings.margin_mm);
  found.examined += fine.examined();
  return found;
}

}  // namespace condyle
