#pragma once

#include <memory>
#include <optional>

#include "engine/collide/broadphase.h"
#include "sim/contact/collider.h"
#include "sim/contact/contact.h"

namespace condyle {

class Slider;

/// What a contact model keeps: colliders, pairs, and how they are at rest.
struct ContactModel::State {
  ContactSettings settings;
  std::vector<Body> carrier;  // of each free part
  std::vector<std::unique_ptr<Collider>> colliders;
  std::vector<ColliderPair> pairs;
  std::vector<ColliderPair> guards;      // see ContactSet::away_from_rest
  std::vector<std::size_t> guarded;      // the pair of each guard
  std::vector<Eigen::Vector3d> pivot;    // of each body, about its middle
  std::vector<PairRule> rules;           // of each pair
  std::optional<Broadphase> broadphase;  // of the colliders, where there are free parts
  std::unique_ptr<Slider> slider;
  ContactSet rest;
  std::vector<std::string> notes;

  int body_count() const { return first_free_body + static_cast<int>(carrier.size()); }

  /// Pairs, then guards, under one number.
  std::size_t count() const { return pairs.size() + guards.size(); }
  const ColliderPair& judged(std::size_t i) const {
    return i < pairs.size() ? pairs[i] : guards[i - pairs.size()];
  }
  PairContact& slot(ContactSet& set, std::size_t i) const {
    return i < pairs.size() ? set.pairs[i] : set.away_from_rest[i - pairs.size()];
  }
  const PairContact& slot(const ContactSet& set, std::size_t i) const {
    return i < pairs.size() ? set.pairs[i] : set.away_from_rest[i - pairs.size()];
  }
  bool fits(const ContactSet* set) const {
    return set && set->pairs.size() == pairs.size() && set->away_from_rest.size() == guards.size();
  }
  TrianglePair start(const ContactSet* previous, std::size_t i) const {
    if (!fits(previous)) return {};
    return {slot(*previous, i).triangle_a, slot(*previous, i).triangle_b};
  }
  Looking full_look(std::size_t i) const {
    const ColliderPair& pair = judged(i);
    return {.max_contacts = i < pairs.size() ? settings.max_contacts : 0,
            .far_mm = pair.b->body < first_free_body ? nowhere_mm : settings.far_mm};
  }

  /// One pose per body. throws: InputError for values that are no numbers.
  std::vector<Pose> body_poses(const BodyPoses& at) const;
  BodyPoses as_poses(const std::vector<Pose>& X_CB) const;

  /// Pairs with a free part that the broadphase knows to be farther apart than asked for.
  std::vector<bool> far_pairs(const std::vector<Pose>& X_CB) const;
  /// Measures what is only bounded there.
  void measure_bounds(const std::vector<Pose>& X_CB, ContactSet& set) const;
  ContactSet judge_all(const std::vector<Pose>& X_CB, const ContactSet* previous,
                       int threads) const;
  /// Counts what the guards found into the depths of their pairs.
  ContactSet with_guards(ContactSet set) const;
};

bool same_bits(const Pose& x, const Pose& y);

}  // namespace condyle
