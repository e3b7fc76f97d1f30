#pragma once

#include <cassert>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace condyle {

/// Number of a rigid body in its tree.
enum class BodyId : int {};

/// The root: its frame of reference is the world.
constexpr BodyId cranium_body{0};
/// The mandible of a native patient. After a split JawBodies names the jaw's bodies.
constexpr BodyId mandible_body{1};

constexpr std::size_t index_of(BodyId body) { return static_cast<std::size_t>(body); }

/// What moves a body in its parent's frame of reference.
enum class BodyDriver {
  fixed,     // nothing: it moves with its parent
  motion,    // built-in physiology, a recording or muscles
  plan,      // a surgical plan
  hand,      // the user
  dynamics,  // contact and gravity
};

/// How two bodies are connected.
enum class BodyLink {
  same,   // they are the same body
  joint,  // parent and child, moved by a motion: mandible and cranium
  cut,    // parent and child, one cut from or fixed to the other
  none
};

struct Body {
  std::string name;              // unique in the tree
  BodyId parent = cranium_body;  // the root's parent is the root
  BodyDriver driver = BodyDriver::fixed;
};

/// The rigid bodies of a patient. Parents precede their children; body 0 is the cranium.
class BodyTree {
 public:
  BodyTree();

  int size() const { return static_cast<int>(bodies_.size()); }
  const Body& operator[](BodyId body) const {
    assert(index_of(body) < bodies_.size());
    return bodies_[index_of(body)];
  }
  const std::vector<Body>& bodies() const { return bodies_; }
  std::optional<BodyId> find(std::string_view name) const;

  /// Whether `body` is `ancestor` or one of its descendants.
  bool is_within(BodyId body, BodyId ancestor) const;
  /// `body` and its descendants, in order.
  std::vector<BodyId> subtree(BodyId body) const;
  BodyLink link(BodyId a, BodyId b) const;
  /// Whether a motion of the jaw determines the body's pose: it drives the body but not its parent.
  bool moved_by_motion(BodyId body) const;
  /// Whether the body can be moved freely: it is neither the root nor driven by a motion.
  bool roams(BodyId body) const {
    return body != cranium_body && (*this)[body].driver != BodyDriver::motion;
  }

  /// Appends a body. throws: InputError for an empty or duplicate name, or an unknown parent.
  BodyId add(Body body);
  /// Gives a body another parent. If it would precede its parent, the tree is reordered; returns
  /// the new number of each old body.
  /// throws: InputError for the root, an unknown body, or a parent within the body's own subtree.
  std::vector<BodyId> reparent(BodyId body, BodyId parent);
  /// Removes a body; its children become children of its parent. Returns the new number of each old
  /// body, none for the removed one. throws: InputError for the root or an unknown body.
  std::vector<std::optional<BodyId>> remove(BodyId body);

  bool operator==(const BodyTree&) const;

 private:
  std::vector<Body> bodies_;
};

/// The bodies of a native patient: the cranium and the mandible, which a motion drives.
BodyTree native_bodies();

/// "fixed", "motion", "plan", "hand", "dynamics".
std::string driver_name(BodyDriver driver);
std::optional<BodyDriver> driver_named(std::string_view name);

/// The bodies that carry the jaw's working surfaces. In a native patient the last three are one.
struct JawBodies {
  BodyId upper_arch = cranium_body;
  BodyId lower_arch = mandible_body;
  BodyId left_condyle = mandible_body;
  BodyId right_condyle = mandible_body;

  bool operator==(const JawBodies&) const = default;
};

}  // namespace condyle
