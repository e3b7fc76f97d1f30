#include "sim/frame/body_tree.h"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/core/error.h"

namespace condyle {

BodyTree::BodyTree() : bodies_{{.name = "cranium"}} {}

std::optional<BodyId> BodyTree::find(std::string_view name) const {
  for (int i = 0; i < size(); ++i)
    if (bodies_[static_cast<std::size_t>(i)].name == name) return BodyId{i};
  return std::nullopt;
}

bool BodyTree::is_within(BodyId body, BodyId ancestor) const {
  while (body > ancestor) body = bodies_[index_of(body)].parent;
  return body == ancestor;
}

std::vector<BodyId> BodyTree::subtree(BodyId body) const {
  std::vector<BodyId> found;
  for (int i = static_cast<int>(body); i < size(); ++i)
    if (is_within(BodyId{i}, body)) found.push_back(BodyId{i});
  return found;
}

BodyLink BodyTree::link(BodyId a, BodyId b) const {
  if (a == b) return BodyLink::same;
  const BodyId child = std::max(a, b);  // parents precede their children
  if ((*this)[child].parent != std::min(a, b)) return BodyLink::none;
  return moved_by_motion(child) ? BodyLink::joint : BodyLink::cut;
}

bool BodyTree::moved_by_motion(BodyId body) const {
  const Body& it = (*this)[body];
  return body != cranium_body && it.driver == BodyDriver::motion &&
         (*this)[it.parent].driver != BodyDriver::motion;
}

namespace {

void require_body(const BodyTree& tree, BodyId body, const char* what) {
  if (static_cast<int>(body) < 0 || static_cast<int>(body) >= tree.size())
    throw InputError(std::string(what) + " " + std::to_string(static_cast<int>(body)) +
                     " does not exist: the patient has " + std::to_string(tree.size()) + " bodies");
}

void require_movable(const BodyTree& tree, BodyId body) {
  require_body(tree, body, "body");
  if (body == cranium_body)
    throw InputError("the cranium is the root of the body tree: it has no parent and is fixed");
}

}  // namespace

BodyId BodyTree::add(Body body) {
  if (body.name.empty()) throw InputError("a body needs a name");
  if (find(body.name))
    throw InputError(body.name + ": the patient already has a body of this name");
  require_body(*this, body.parent, "the parent body");
  bodies_.push_back(std::move(body));
  return BodyId{size() - 1};
}

std::vector<BodyId> BodyTree::reparent(BodyId body, BodyId parent) {
  require_movable(*this, body);
  require_body(*this, parent, "the parent body");
  if (is_within(parent, body))
    throw InputError(bodies_[index_of(body)].name + ": its parent cannot be " +
                     bodies_[index_of(parent)].name + ", which is its own descendant");
  std::vector<BodyId> parents;
  for (const auto& each : bodies_) parents.push_back(each.parent);
  parents[index_of(body)] = parent;
  // Bodies are placed in their old order, each as soon as its parent has been placed.
  std::vector<BodyId> number(bodies_.size(), BodyId{-1});
  std::vector<Body> sorted;
  number[0] = cranium_body;
  sorted.push_back(std::move(bodies_[0]));
  while (sorted.size() < bodies_.size())
    for (std::size_t i = 1; i < bodies_.size(); ++i) {
      const BodyId above = number[index_of(parents[i])];
      if (number[i] != BodyId{-1} || above == BodyId{-1}) continue;
      number[i] = BodyId{static_cast<int>(sorted.size())};
      sorted.push_back(std::move(bodies_[i]));
      sorted.back().parent = above;
      break;
    }
  bodies_ = std::move(sorted);
  return number;
}

std::vector<std::optional<BodyId>> BodyTree::remove(BodyId body) {
  require_movable(*this, body);
  const auto new_number = [&](BodyId old) {
    return old < body ? old : BodyId{static_cast<int>(old) - 1};
  };
  const BodyId heir = bodies_[index_of(body)].parent;
  std::vector<std::optional<BodyId>> number;
  for (int i = 0; i < size(); ++i) {
    Body& each = bodies_[static_cast<std::size_t>(i)];
    each.parent = each.parent == body ? heir : new_number(each.parent);
    number.push_back(BodyId{i} == body ? std::nullopt : std::optional(new_number(BodyId{i})));
  }
  bodies_.erase(bodies_.begin() + static_cast<int>(body));
  return number;
}

bool BodyTree::operator==(const BodyTree& other) const {
  return std::equal(bodies_.begin(), bodies_.end(), other.bodies_.begin(), other.bodies_.end(),
                    [](const Body& a, const Body& b) {
                      return a.name == b.name && a.parent == b.parent && a.driver == b.driver;
                    });
}

BodyTree native_bodies() {
  BodyTree tree;
  tree.add({.name = "mandible", .driver = BodyDriver::motion});
  return tree;
}

namespace {

constexpr std::array<std::pair<BodyDriver, const char*>, 5> drivers = {{
    {BodyDriver::fixed, "fixed"},
    {BodyDriver::motion, "motion"},
    {BodyDriver::plan, "plan"},
    {BodyDriver::hand, "hand"},
    {BodyDriver::dynamics, "dynamics"},
}};

}  // namespace

std::string driver_name(BodyDriver driver) {
  for (const auto& [known, name] : drivers)
    if (known == driver) return name;
  return "";
}

std::optional<BodyDriver> driver_named(std::string_view name) {
  for (const auto& [driver, known] : drivers)
    if (name == known) return driver;
  return std::nullopt;
}

}  // namespace condyle
