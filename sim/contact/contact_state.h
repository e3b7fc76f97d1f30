#pragma once

#include <memory>
#include <optional>

#include "engine/collide/broadphase.h"
#include "sim/contact/collider.h"
#include "sim/contact/contact.h"

namespace condyle {

class Slider;

/// What to measure of pairs that do not touch: their distance, or nothing.
enum class Distances { all, of_touching };

/// Data of a contact model: colliders, pairs, and their state at rest.
struct ContactModel::State {
  ContactSettings settings;
  BodyTree bodies;
  std::vector<std::unique_ptr<Collider>> colliders;
  std::vector<ColliderPair> pairs;
  std::vector<ColliderPair> complements;   // see ContactSet::outside_rest_overlap
  std::vector<std::size_t> complement_of;  // the pair of each complement
  std::vector<Eigen::Vector3d> pivot;      // of each body, near its centre
  std::vector<PairRule> rules;             // of each pair
  std::optional<Broadphase> broadphase;    // of the colliders, where bodies roam
  std::unique_ptr<Slider> slider;
  ContactSet rest;
  bool rest_known = false;  // bodies that lie as at rest to each other need no query
  std::vector<bool> mixed;  // per body: overlaps its joint at rest more than in one patient
  std::vector<std::string> notes;

  /// Whether the two form a joint: they are always near each other, so every distance matters.
  bool in_joint(const ColliderPair& pair) const {
    return bodies.link(pair.a->body, pair.b->body) == BodyLink::joint;
  }

  /// Pairs, then complements, in one numbering.
  std::size_t count() const { return pairs.size() + complements.size(); }
  const ColliderPair& pair_or_complement(std::size_t i) const {
    return i < pairs.size() ? pairs[i] : complements[i - pairs.size()];
  }
  PairContact& slot(ContactSet& set, std::size_t i) const {
    return i < pairs.size() ? set.pairs[i] : set.outside_rest_overlap[i - pairs.size()];
  }
  const PairContact& slot(const ContactSet& set, std::size_t i) const {
    return i < pairs.size() ? set.pairs[i] : set.outside_rest_overlap[i - pairs.size()];
  }
  bool fits(const ContactSet* set) const {
    return set && set->pairs.size() == pairs.size() &&
           set->outside_rest_overlap.size() == complements.size();
  }
  TrianglePair start(const ContactSet* previous, std::size_t i) const {
    if (!fits(previous)) return {};
    return {slot(*previous, i).triangle_a, slot(*previous, i).triangle_b};
  }
  QueryOptions full_query(std::size_t i) const {
    const ColliderPair& pair = pair_or_complement(i);
    return {.max_contacts = i < pairs.size() ? settings.max_contacts : 0,
            .far_mm = in_joint(pair) ? nowhere_mm : settings.far_mm};
  }

  /// Poses of all bodies. throws: InputError for values that are not finite.
  BodyPoses complete(const BodyPoses& at) const;

  /// Pairs that the broadphase proves to be farther apart than requested.
  std::vector<bool> far_pairs(const BodyPoses& at) const;
  /// Measures pairs that are only bounded there.
  void measure_bounds(const BodyPoses& at, ContactSet& set) const;
  ContactSet query_all(const BodyPoses& at, const ContactSet* previous, int threads,
                       Distances distances = Distances::all) const;
  /// Includes the depths of the complements in those of their pairs.
  ContactSet with_complements(ContactSet set) const;
};

}  // namespace condyle
