#pragma once

#include <optional>
#include <vector>

#include "sim/contact/contact_state.h"
#include "sim/contact/motion_sweep.h"

namespace condyle {

/// Motion of one body, with its descendants, to a target pose; all other bodies are fixed.
struct BodyMove {
  BodyId body = mandible_body;
  BodyPoses at;                           // of every body at the start
  std::vector<bool> moves;                // of every body
  std::vector<std::optional<Pose>> X_DM;  // of bodies that hang on it, in its frame, where they
                                          // are not as at rest there
  Pose target;

  const Pose& from() const { return at[body]; }
  BodyPoses poses_at(const Pose& X_CD) const;
  /// Whether the pair has one moving side, and may stop it.
  bool obstructed_by(const ColliderPair& pair) const {
    return pair.obstructs && moves[index_of(pair.a->body)] != moves[index_of(pair.b->body)];
  }
};

/// Move of a body with its descendants.
BodyMove make_move(const ContactModel::State& state, BodyPoses at, BodyId body, const Pose& target);

struct MoveResult {
  Pose X_CD;
  bool stopped = false;
};

/// Straight motion up to the first contact that is deeper than at rest or at the start. `set` is
/// taken at the start if `exact`, else near it; on return the pairs that may stop the move are
/// those at the end. Guards are not included, before or after.
MoveResult stop(const ContactModel::State& state, const BodyMove& move, ContactSet& set, bool exact,
                int threads);

/// The same, sliding along obstacles to the nearest allowed pose. `bound_far`: see
/// ContactModel::slide.
MoveResult slide_move(const ContactModel::State& state, const BodyMove& move, ContactSet& set,
                      bool exact, bool bound_far, int threads);

/// Pairs and complements that may stop the move.
std::vector<std::size_t> obstructing_pairs(const ContactModel::State& state, const BodyMove& move);

/// The swept pair from the move's start to a pose.
SweptPair swept_pair(const ContactModel::State& state, const BodyMove& move,
                     const ColliderPair& pair, const Pose& to);

}  // namespace condyle
