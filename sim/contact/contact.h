#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "sim/case/case.h"
#include "sim/frame/body_poses.h"
#include "sim/frame/contact_set.h"

namespace condyle {

struct ContactSettings {
  int max_contacts = 64;      // reported per pair
  double slack_mm = 0.02;     // how much deeper than at rest counts as penetrating
  double stop_gap_mm = 0.01;  // clearance left when a pose is stopped at a surface
  double friction = 0;        // Coulomb coefficient of sliding
  // On top of the case's own; the last that fits counts. Unknown part names: InputError.
  std::vector<PairRule> pair_rules = {};
  // Of pairs with a free part that are farther apart than this only a lower bound of the distance
  // is found (PairContact::distance_is_bound); infinite: every distance is exact.
  double far_mm = 30;
};

/// The colliders of a case (one BVH per bone, arch or free part) and the pairs of those that belong
/// to different bodies, each with its rule and its overlap at rest: the baseline, in its
/// neighbourhood (10 mm) only. Surfaces that were apart at rest may not touch.
class ContactModel {
 public:
  /// throws: InputError for rules that do not fit the case.
  explicit ContactModel(const Case& patient, const ContactSettings& settings = {});
  ~ContactModel();
  ContactModel(ContactModel&&) noexcept;

  /// Contacts at the poses, warm-started from an earlier answer (may be null). Pairs run on
  /// `threads` threads; the result has the same bits for any number.
  /// throws: InputError for poses with values that are no numbers, here and below.
  ContactSet find(const BodyPoses& at, const ContactSet* previous, int threads = 1) const;

  /// The pose farthest along the straight way from `from` to `wanted` up to which no pair is deeper
  /// than at rest; nothing thicker than 0.1 mm is passed through. A `from` that is itself too deep
  /// may leave, but goes no deeper. `previous` taken at `from` saves time. Free parts stay with
  /// their carriers.
  struct Stop {
    Pose X_CM;
    bool stopped = false;
    ContactSet contacts;  // at X_CM
  };
  Stop stop_at_contact(const Pose& from, const Pose& wanted, const ContactSet* previous,
                       int threads = 1) const;

  /// Where the hand, a motion or a plan wants the bodies.
  struct Wanted {
    Pose X_CM;
    std::vector<Pose> X_BF = {};  // of each free part in its carrier's frame; missing: as at rest
  };
  /// All bodies where they are wanted, whatever is in the way.
  BodyPoses placed(const Wanted& wanted) const;

  struct Slide {
    BodyPoses at;
    bool stopped = false;  // something kept a body from where it was wanted
    ContactSet contacts;   // there
  };
  /// Each body to the nearest pose that it can slide to: the mandible with what it carries, then
  /// the free parts in order, each against all others as they are. Distance fields find it, and
  /// without friction it depends on the wanted pose alone; the exact surfaces judge it: no pair is
  /// deeper than at rest by more than the slack. What overlaps deeply at rest is held there or
  /// slides beside it, whichever is nearer. Where fields do not see all (open shells from behind,
  /// walls as thin as each other, far from where bodies were at rest) the body creeps from `from`
  /// in stretches of a millimetre, each proved by the exact surfaces, and goes no deeper than it
  /// was. Same bits for any number of threads; nothing that is remembered from call to call changes
  /// an answer. `bound_far`: surfaces that are sure to be apart by 5 mm need not be measured; then
  /// PairContact::distance_is_bound.
  Slide slide(const BodyPoses& from, const Wanted& wanted, const ContactSet* previous,
              int threads = 1, bool bound_far = false) const;

  /// Makes the distance fields that sliding needs, or reads them from the cache: slide() does so
  /// where it first meets something. Threads may share a model.
  void prepare_sliding(const Progress& progress = {}, int threads = 2) const;

  const ContactSet& at_rest() const;
  /// The rule of each pair, in the order of ContactSet::pairs.
  const std::vector<PairRule>& rules() const;
  /// What could not be judged (open shells) and what overlaps at rest, for people.
  const std::vector<std::string>& notes() const;

  struct State;

 private:
  std::unique_ptr<State> state_;
};

}  // namespace condyle
