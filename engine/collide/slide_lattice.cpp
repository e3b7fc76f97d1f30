#include "engine/collide/slide_lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace condyle {
namespace {

using Eigen::Vector3d;

// Ratio of displacement to rotation in a cell: a rolling body has many resting poses and must start
// near the target rotation.
constexpr double part_fraction[2] = {1, 0.5};
constexpr double cell_fraction = 0.5;     // of the band: between lattice positions of the lattice
constexpr double node_settled_mm = 0.02;  // they only serve as starting points
constexpr std::size_t max_nodes = 20000;
constexpr int longest_chain = 400;
constexpr double farthest_carried_mm = 0.3;
constexpr double ahead_frames[] = {2, 4, 8};
constexpr double farthest_ahead = 4;         // cells
constexpr int min_ahead = 2, max_ahead = 8;  // steps per frame
constexpr double rest_reach_mm = 5;
constexpr double free_mm = 0.05;        // clearance of a body that has been moved out
constexpr double drawn_fraction = 0.7;  // of the depth, per step
constexpr int max_draws = 60;

}  // namespace

SlideLattice::SlideLattice(const SlidingContact& model, int threads)
    : model_(model), probe_(model, threads), cell_mm_(cell_fraction * model.band_mm_) {
  if (model.pairs_.empty()) return;
  // The lattice is attached to the surfaces: the answers do not depend on where these are placed.
  const auto& first = model.pairs_.front();
  axes_ = first.X_FS.R;
  origin_ = model.rest_.value_or(first.X_FS * first.X_MS.inverse());
}

SlideLattice::Key SlideLattice::key_of(const Pose& X) const {
  const Twist x = probe_.between(origin_, X) / cell_mm_;
  Key key;
  for (int part = 0; part < 2; ++part) {
    const Vector3d along =
        axes_.conjugate() * Vector3d(x.segment<3>(3 * part)) / part_fraction[part];
    for (int k = 0; k < 3; ++k)
      key[3 * part + k] = static_cast<int>(std::lround(std::clamp(along[k], -1e8, 1e8)));
  }
  return key;
}

Pose SlideLattice::place_of(const Key& key) const {
  Twist x;
  for (int part = 0; part < 2; ++part)
    x.segment<3>(3 * part) = axes_ * Vector3d(key[3 * part], key[3 * part + 1], key[3 * part + 2]) *
                             (part_fraction[part] * cell_mm_);
  return probe_.moved(origin_, x);
}

/// Along the sum of the exit directions of all overlapping samples.
SlideLattice::ExitDirection SlideLattice::exit_direction(const Pose& X) {
  SlideProbe::Overlap overlap = probe_.overlap_at(X);
  const double slop = model_.settings_.slop_mm;
  if (overlap.depth_mm <= slop) {  // approximate; now the exact test
    probe_.look_at(X, 0);
    if (!(probe_.deepest_gap() < -slop)) return {true, 0, Vector3d::Zero()};
    overlap = {-probe_.deepest_gap(), Vector3d::Zero(), 0};
    for (const SlideCandidate& c : probe_.candidates()) {
      overlap.outward -= c.gap * c.gradient;
      overlap.sum_mm -= c.gap;
    }
  }
  ExitDirection exit{false, overlap.depth_mm, Vector3d::Zero()};
  if (overlap.outward.norm() > 0.02 * overlap.sum_mm) exit.direction = overlap.outward.normalized();
  return exit;
}

/// A free pose: the body is moved out by a fraction of its depth at a time.
std::optional<Pose> SlideLattice::moved_out(const Pose& target) {
  Pose X = target;
  Vector3d last = Vector3d::Zero();
  for (int k = 0; k < max_draws; ++k) {
    const ExitDirection exit = exit_direction(X);
    if (exit.free) return X;
    if (exit.direction.isZero()) return std::nullopt;
    Vector3d out = exit.direction;
    // Between two walls the directions alternate: their common component leads out.
    if (out.dot(last) < 0) out = (out + last).normalized();
    X.t += (drawn_fraction * exit.depth_mm + free_mm) * out;
    last = out;
  }
  return std::nullopt;
}

SlideWalk SlideLattice::walk(const Node& parent, const Pose& to) {
  return {model_, probe_, parent.X, to, node_settled_mm};
}

/// The result of sliding from the parent's answer; that answer itself where sliding fails.
SlideLattice::Node SlideLattice::finish(const Node& parent, SlideWalk&& walk, const Pose& to) {
  Node node = parent;
  const SlideResult result = walk.run();
  if (result.settled) {
    node.X = result.X_FM;
    node.reached &= result.reached;
    node.contacts = result.contacts;
  }
  node.left = probe_.between(node.X, to).norm();
  return node;
}

SlideLattice::Node SlideLattice::alone(const Pose& place) {
  const auto start = moved_out(place);
  if (!start) return {.solved = true};
  return slid({.solved = true, .found = true, .reached = true, .X = *start, .root = *start}, place);
}

/// The neighbour in that direction. All but the first of a chain lie on a lattice of twice the cell
/// size, so many chains share them.
SlideLattice::Key SlideLattice::outer(const Key& key, const Vector3d& direction) const {
  const Vector3d along = axes_.conjugate() * direction;
  const bool coarse = std::all_of(key.begin(), key.end(), [](int k) { return k % 2 == 0; });
  Key next = key;
  for (int k = 0; k < 3; ++k) {
    next[k] += (coarse ? 2 : 1) * static_cast<int>(std::lround(along[k]));
    if (next[k] % 2 != 0) next[k] += along[k] > 0 ? 1 : -1;
  }
  for (int k = 3; k < 6; ++k)
    if (next[k] % 2 != 0) next[k] += next[k] > 0 ? -1 : 1;
  return next;
}

/// A node with its parent; not yet solved unless it has none.
SlideLattice::Node& SlideLattice::visited(const Key& key) {
  const auto [place, fresh] = outside_.try_emplace(key);
  Node& node = place->second;
  if (!fresh) return node;
  const Pose X = place_of(key);
  const ExitDirection exit = exit_direction(X);
  if (exit.free)
    node = {.solved = true, .found = true, .reached = true, .X = X, .root = X};
  else if (exit.direction.isZero())
    node = alone(X);
  else
    node.parent = outer(key, exit.direction);
  return node;
}

/// The chain of nodes to solve, beginning with this one, and the solution of the last one's parent.
std::pair<std::vector<SlideLattice::Key>, SlideLattice::Node> SlideLattice::chain_outside(Key key) {
  std::vector<Key> chain;
  for (;;) {
    const Node& node = visited(key);
    if (node.solved) return {chain, node};
    if (const auto again = std::find(chain.begin(), chain.end(), key); again != chain.end()) {
      // The exit directions form a cycle: each of these nodes is solved by itself.
      for (auto k = again; k != chain.end(); ++k) outside_[*k] = alone(place_of(*k));
      chain.erase(again, chain.end());
      continue;
    }
    if (static_cast<int>(chain.size()) == longest_chain) return {{}, {}};
    chain.push_back(key);
    key = node.parent;
  }
}

bool SlideLattice::near_rest(const Key& key) const {
  return model_.rest_ &&
         probe_.max_displacement_mm(probe_.between(*model_.rest_, place_of(key))) < rest_reach_mm;
}

/// A pose that overlaps at rest may be reachable from rest only.
std::pair<std::vector<SlideLattice::Key>, SlideLattice::Node> SlideLattice::chain_to_rest(Key key) {
  rest_.try_emplace(Key{}, Node{.solved = true,
                                .found = true,
                                .reached = true,
                                .X = *model_.rest_,
                                .root = *model_.rest_});
  std::vector<Key> chain;
  for (auto known = rest_.find(key);; known = rest_.find(key)) {
    if (known != rest_.end()) return {chain, known->second};
    chain.push_back(key);
    int farthest = 0;
    for (const int k : key) farthest = std::max(farthest, std::abs(k));
    for (int& k : key) k = static_cast<int>(std::lround(k * (farthest - 1.0) / farthest));
  }
}

SlideLattice::Node SlideLattice::solve(Tree& tree, const std::pair<std::vector<Key>, Node>& chain) {
  Node node = chain.second;
  for (auto k = chain.first.rbegin(); k != chain.first.rend(); ++k) {
    asked_ = true;
    if (prefetch_ && prefetch_->tree == &tree && prefetch_->key == *k) {
      continue_prefetch(std::numeric_limits<int>::max());
      node = tree[*k];
      continue;
    }
    const Pose place = place_of(*k);
    node = node.found ? slid(node, place) : alone(place);
    tree[*k] = node;
  }
  return node;
}

SlideLattice::Node SlideLattice::nearest(const Pose& target) {
  if (outside_.size() + rest_.size() > max_nodes) {
    prefetch_.reset();
    outside_.clear();
    rest_.clear();
  }
  const Key key = key_of(target);
  const Node node = solve(outside_, chain_outside(key));
  if (!near_rest(key)) return node;
  const Node other = solve(rest_, chain_to_rest(key));
  return !node.found || other.left < node.left ? other : node;
}

Pose SlideLattice::carried(const Node& node, const Pose& target) const {
  TwistSettings settings;
  settings.rotation_length_mm = model_.rotation_length_mm_;
  std::vector<ContactRow> rows;
  for (const SlideContact& contact : node.contacts)
    rows.push_back(contact_row(contact.point - node.X * model_.pivot_, contact.normal,
                               std::max(0.0, contact.gap_mm), model_.rotation_length_mm_));
  const Twist step = nearest_allowed(probe_.between(node.X, target), rows, settings).x;
  const double length = probe_.max_displacement_mm(step);
  return probe_.moved(node.X, step * std::min(1.0, farthest_carried_mm / length));
}

/// True where a node has to be solved.
bool SlideLattice::begin_prefetch(Tree& tree, const std::pair<std::vector<Key>, Node>& chain) {
  const auto& [keys, parent] = chain;
  if (keys.empty()) return false;
  const Pose place = place_of(keys.back());
  if (parent.found)
    prefetch_.emplace(Prefetch{&tree, keys.back(), parent, walk(parent, place)});
  else
    tree[keys.back()] = alone(place);
  return true;
}

void SlideLattice::continue_prefetch(int steps) {
  if (!prefetch_->walk.go_on(steps)) return;
  prefetch_->tree->insert_or_assign(
      prefetch_->key,
      finish(prefetch_->parent, std::move(prefetch_->walk), place_of(prefetch_->key)));
  prefetch_.reset();
}

/// True while a walk is in progress.
bool SlideLattice::find_prefetch(const Pose& target, const Twist& step) {
  for (const double frames : ahead_frames) {
    if (prefetch_) return true;
    if (!(frames * step.norm() < farthest_ahead * cell_mm_)) return false;
    const Key key = key_of(probe_.moved(target, frames * step));
    if (!begin_prefetch(outside_, chain_outside(key)) && near_rest(key))
      begin_prefetch(rest_, chain_to_rest(key));
  }
  return prefetch_.has_value();
}

void SlideLattice::prefetch(const Pose& target, const std::function<bool()>& more) {
  const auto last = std::exchange(last_target_, target);
  if (std::exchange(asked_, false) || !last) return;
  const Twist step = probe_.between(*last, target);
  for (int steps = 0; steps < min_ahead || (more() && steps < max_ahead); ++steps) {
    if (!find_prefetch(target, step)) return;
    continue_prefetch(1);
  }
}

}  // namespace condyle
