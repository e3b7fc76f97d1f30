#include "engine/collide/slide_nodes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace condyle {
namespace {

using Eigen::Vector3d;

// Of way and rotation in a cell: a body that rolls finds many places to rest, and must begin near
// the rotation that is wanted.
constexpr double part_share[2] = {1, 0.5};
constexpr double cell_share = 0.5;        // of the band: between places of the lattice
constexpr double node_settled_mm = 0.02;  // they are but starts
constexpr std::size_t most_kept = 20000;
constexpr int longest_chain = 400;
constexpr double farthest_carried_mm = 0.3;
constexpr double ahead_frames[] = {2, 4, 8};
constexpr double farthest_ahead = 4;            // cells
constexpr int least_ahead = 2, most_ahead = 8;  // steps in one frame
constexpr double rest_reach_mm = 5;
constexpr double free_mm = 0.05;     // clearance of what is drawn out
constexpr double drawn_share = 0.7;  // of the depth, at a time
constexpr int max_draws = 60;

}  // namespace

SlideNodes::SlideNodes(const SlidingContact& model, int threads)
    : model_(model), probe_(model, threads), cell_mm_(cell_share * model.band_mm_) {
  if (model.pairs_.empty()) return;
  // The lattice lies in the surfaces: they give the same answers wherever they are placed.
  const auto& first = model.pairs_.front();
  axes_ = first.X_FS.R;
  origin_ = model.rest_.value_or(first.X_FS * first.X_MS.inverse());
}

SlideNodes::Key SlideNodes::key_of(const Pose& X) const {
  const Twist x = probe_.between(origin_, X) / cell_mm_;
  Key key;
  for (int part = 0; part < 2; ++part) {
    const Vector3d along = axes_.conjugate() * Vector3d(x.segment<3>(3 * part)) / part_share[part];
    for (int k = 0; k < 3; ++k)
      key[3 * part + k] = static_cast<int>(std::lround(std::clamp(along[k], -1e8, 1e8)));
  }
  return key;
}

Pose SlideNodes::place_of(const Key& key) const {
  Twist x;
  for (int part = 0; part < 2; ++part)
    x.segment<3>(3 * part) = axes_ * Vector3d(key[3 * part], key[3 * part + 1], key[3 * part + 2]) *
                             (part_share[part] * cell_mm_);
  return probe_.moved(origin_, x);
}

/// Along the sum of the ways out of all that overlaps.
SlideNodes::WayOut SlideNodes::way_out(const Pose& X) {
  SlideProbe::Overlap overlap = probe_.overlap_at(X);
  const double slop = model_.settings_.slop_mm;
  if (overlap.depth_mm <= slop) {  // roughly; now in full
    probe_.look_at(X, 0);
    if (!(probe_.deepest_gap() < -slop)) return {true, 0, Vector3d::Zero()};
    overlap = {-probe_.deepest_gap(), Vector3d::Zero(), 0};
    for (const SlideCandidate& c : probe_.candidates()) {
      overlap.outward -= c.gap * c.gradient;
      overlap.sum_mm -= c.gap;
    }
  }
  WayOut way{false, overlap.depth_mm, Vector3d::Zero()};
  if (overlap.outward.norm() > 0.02 * overlap.sum_mm) way.direction = overlap.outward.normalized();
  return way;
}

/// A free pose: what overlaps is drawn out, a part of its depth at a time.
std::optional<Pose> SlideNodes::drawn_out(const Pose& wanted) {
  Pose X = wanted;
  Vector3d last = Vector3d::Zero();
  for (int k = 0; k < max_draws; ++k) {
    const WayOut way = way_out(X);
    if (way.free) return X;
    if (way.direction.isZero()) return std::nullopt;
    Vector3d out = way.direction;
    // Between two walls it would go to and fro: what both ways have in common leads out.
    if (out.dot(last) < 0) out = (out + last).normalized();
    X.t += (drawn_share * way.depth_mm + free_mm) * out;
    last = out;
  }
  return std::nullopt;
}

SlideWalk SlideNodes::walk(const Node& parent, const Pose& to) {
  return {model_, probe_, parent.X, to, node_settled_mm};
}

/// Where it slides from its parent's answer; there it stays where that fails.
SlideNodes::Node SlideNodes::at_end(const Node& parent, SlideWalk&& walk, const Pose& to) {
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

SlideNodes::Node SlideNodes::alone(const Pose& place) {
  const auto start = drawn_out(place);
  if (!start) return {.solved = true};
  return slid({.solved = true, .found = true, .reached = true, .X = *start, .root = *start}, place);
}

/// The neighbour that way. All but the first of a chain lie on a lattice of twice the cells, so
/// that many chains share them.
SlideNodes::Key SlideNodes::outer(const Key& key, const Vector3d& direction) const {
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

/// A node with its parent, but not yet solved unless it has none.
SlideNodes::Node& SlideNodes::visited(const Key& key) {
  const auto [place, fresh] = outside_.try_emplace(key);
  Node& node = place->second;
  if (!fresh) return node;
  const Pose X = place_of(key);
  const WayOut way = way_out(X);
  if (way.free)
    node = {.solved = true, .found = true, .reached = true, .X = X, .root = X};
  else if (way.direction.isZero())
    node = alone(X);
  else
    node.parent = outer(key, way.direction);
  return node;
}

/// The nodes to solve before this one, itself the first, and what is known of the last one's
/// parent.
std::pair<std::vector<SlideNodes::Key>, SlideNodes::Node> SlideNodes::chain_outside(Key key) {
  std::vector<Key> chain;
  for (;;) {
    const Node& node = visited(key);
    if (node.solved) return {chain, node};
    if (const auto again = std::find(chain.begin(), chain.end(), key); again != chain.end()) {
      // Ways out that lead round in a circle: each of these finds out alone.
      for (auto k = again; k != chain.end(); ++k) outside_[*k] = alone(place_of(*k));
      chain.erase(again, chain.end());
      continue;
    }
    if (static_cast<int>(chain.size()) == longest_chain) return {{}, {}};
    chain.push_back(key);
    key = node.parent;
  }
}

bool SlideNodes::near_rest(const Key& key) const {
  return model_.rest_ &&
         probe_.way_of(probe_.between(*model_.rest_, place_of(key))) < rest_reach_mm;
}

/// What overlaps at rest may be reached from there alone.
std::pair<std::vector<SlideNodes::Key>, SlideNodes::Node> SlideNodes::chain_to_rest(Key key) {
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

SlideNodes::Node SlideNodes::solve(Tree& tree, const std::pair<std::vector<Key>, Node>& chain) {
  Node node = chain.second;
  for (auto k = chain.first.rbegin(); k != chain.first.rend(); ++k) {
    asked_ = true;
    if (ahead_ && ahead_->tree == &tree && ahead_->key == *k) {
      go_on_ahead(std::numeric_limits<int>::max());
      node = tree[*k];
      continue;
    }
    const Pose place = place_of(*k);
    node = node.found ? slid(node, place) : alone(place);
    tree[*k] = node;
  }
  return node;
}

SlideNodes::Node SlideNodes::nearest(const Pose& wanted) {
  if (outside_.size() + rest_.size() > most_kept) {
    ahead_.reset();
    outside_.clear();
    rest_.clear();
  }
  const Key key = key_of(wanted);
  const Node node = solve(outside_, chain_outside(key));
  if (!near_rest(key)) return node;
  const Node other = solve(rest_, chain_to_rest(key));
  return !node.found || other.left < node.left ? other : node;
}

Pose SlideNodes::carried(const Node& node, const Pose& wanted) const {
  TwistSettings settings;
  settings.rotation_length_mm = model_.rotation_length_mm_;
  std::vector<ContactRow> rows;
  for (const SlideContact& contact : node.contacts)
    rows.push_back(contact_row(contact.point - node.X * model_.pivot_, contact.normal,
                               std::max(0.0, contact.gap_mm), model_.rotation_length_mm_));
  const Twist way = nearest_allowed(probe_.between(node.X, wanted), rows, settings).x;
  const double length = probe_.way_of(way);
  return probe_.moved(node.X, way * std::min(1.0, farthest_carried_mm / length));
}

/// True where there is something to solve.
bool SlideNodes::begin_ahead(Tree& tree, const std::pair<std::vector<Key>, Node>& chain) {
  const auto& [keys, parent] = chain;
  if (keys.empty()) return false;
  const Pose place = place_of(keys.back());
  if (parent.found)
    ahead_.emplace(&tree, keys.back(), parent, walk(parent, place));
  else
    tree[keys.back()] = alone(place);
  return true;
}

void SlideNodes::go_on_ahead(int steps) {
  if (!ahead_->walk.go_on(steps)) return;
  ahead_->tree->insert_or_assign(
      ahead_->key, at_end(ahead_->parent, std::move(ahead_->walk), place_of(ahead_->key)));
  ahead_.reset();
}

/// True where a walk is under way.
bool SlideNodes::find_ahead(const Pose& wanted, const Twist& way) {
  for (const double frames : ahead_frames) {
    if (ahead_) return true;
    if (!(frames * way.norm() < farthest_ahead * cell_mm_)) return false;
    const Key key = key_of(probe_.moved(wanted, frames * way));
    if (!begin_ahead(outside_, chain_outside(key)) && near_rest(key))
      begin_ahead(rest_, chain_to_rest(key));
  }
  return ahead_.has_value();
}

void SlideNodes::look_ahead(const Pose& wanted, const std::function<bool()>& more) {
  const auto last = std::exchange(last_wanted_, wanted);
  if (std::exchange(asked_, false) || !last) return;
  const Twist way = probe_.between(*last, wanted);
  for (int steps = 0; steps < least_ahead || (more() && steps < most_ahead); ++steps) {
    if (!find_ahead(wanted, way)) return;
    go_on_ahead(1);
  }
}

}  // namespace condyle
