#pragma once

#include <optional>
#include <vector>

#include "sim/contact/contact_state.h"
#include "sim/contact/free_way.h"

namespace condyle {

/// One body on its way to a wanted pose, with what it carries, while all else stays.
struct Drive {
  int body = mandible_body;
  std::vector<Pose> X_CB;                 // of every body at the start
  std::vector<bool> moves;                // of every body
  std::vector<std::optional<Pose>> X_DM;  // of carried bodies in the driver's frame
  Pose wanted;

  const Pose& from() const { return X_CB[static_cast<std::size_t>(body)]; }
  std::vector<Pose> poses_at(const Pose& X_CD) const;
  bool concerns(const ColliderPair& pair) const {
    return moves[static_cast<std::size_t>(pair.a->body)] !=
           moves[static_cast<std::size_t>(pair.b->body)];
  }
};

/// The mandible with the free parts that it carries, or a free part.
Drive make_drive(const ContactModel::State& state, std::vector<Pose> X_CB, int body,
                 const Pose& wanted);

struct Arrival {
  Pose X_CD;
  bool stopped = false;
};

/// Straight on up to the first contact that is deeper than at rest or at the start. `set` is taken
/// at the start where `exact`, else only near it; afterwards the pairs concerned are as they are on
/// arrival. Guards are not counted in, before or after.
Arrival stop(const ContactModel::State& state, const Drive& drive, ContactSet& set, bool exact,
             int threads);

/// The same, sliding along what is in the way to the nearest pose allowed. `bound_far`: see
/// ContactModel::slide.
Arrival slide_drive(const ContactModel::State& state, const Drive& drive, ContactSet& set,
                    bool exact, bool bound_far, int threads);

/// Pairs and guards of which one side moves.
std::vector<std::size_t> concerned_pairs(const ContactModel::State& state, const Drive& drive);

/// One of them on its way from the drive's start to a pose.
Passage passage_of(const ContactModel::State& state, const Drive& drive, const ColliderPair& pair,
                   const Pose& to);

}  // namespace condyle
