#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "sim/case/case.h"
#include "sim/frame/body_poses.h"
#include "sim/frame/contact_set.h"

namespace condyle {

struct ContactSettings {
  int max_contacts = 64;      // reported per pair
  double slack_mm = 0.02;     // penetration beyond rest that is tolerated
  double stop_gap_mm = 0.01;  // clearance left when a pose is stopped at a surface
  double friction = 0;        // Coulomb coefficient of sliding
  // In addition to the case's own; the last match applies. Unknown part names: InputError.
  std::vector<PairRule> pair_rules = {};
  // For pairs that no joint connects and that are farther apart than this, only a lower bound of
  // the distance is computed (PairContact::distance_is_bound); infinite: every distance is exact.
  double far_mm = 30;
  // Note how a part that starts deep inside another could be moved clear of it: takes seconds, and
  // is no advice for segments of a plan.
  bool advise_exits = true;
};

/// The colliders of a case (one BVH per bone, arch or piece) and the pairs of different bodies,
/// each with its rule and its overlap at rest: the baseline, valid in its neighbourhood (10 mm)
/// only. Surfaces that were apart at rest may not touch. Copies share their data.
class ContactModel {
 public:
  /// `earlier`: of the patient before an edit; unchanged surfaces and their distance fields are
  /// reused. throws: InputError for rules that do not match the case.
  explicit ContactModel(const Case& patient, const ContactSettings& settings = {},
                        const ContactModel* earlier = nullptr);
  /// Of a patient whose bodies pass through each other.
  static ContactModel none(const BodyTree& bodies);

  /// Contacts at the poses, warm-started from an earlier answer (may be null). Pairs run on
  /// `threads` threads; bit-identical for any number.
  /// throws: InputError for poses with values that are not finite, here and below.
  ContactSet find(const BodyPoses& at, const ContactSet* previous, int threads = 1) const;

  /// As `find`, several times as fast: of pairs that do not touch, only that they are apart
  /// (PairContact::distance_is_bound).
  ContactSet find_touching(const BodyPoses& at, int threads = 1) const;

  struct Slide {
    BodyPoses at;
    bool stopped = false;  // contact kept a body from its target
    ContactSet contacts;   // there
  };

  /// Moves one body with its descendants along the straight path to the pose `X_CB_target` as far
  /// as no pair is deeper than at rest; nothing thicker than 0.1 mm is passed through. A start that
  /// is itself too deep may be left, but does not deepen. `previous` taken at `from` saves time.
  Slide stop_at_contact(const BodyPoses& from, const Pose& X_CB_target, const ContactSet* previous,
                        int threads = 1, BodyId body = mandible_body) const;

  /// All bodies at their targets in their parents' frames, regardless of obstacles.
  BodyPoses placed(std::span<const Pose> X_PB_target) const;

  /// Moves each body to the nearest pose that it can slide to, in the order of the tree, with its
  /// descendants, against all others at their present poses. X_PB_target: in the parents' frames;
  /// missing ones at rest. Distance fields find the pose, which without friction depends on the
  /// target alone; the exact surfaces verify it: no pair is deeper than at rest by more than the
  /// slack. A body that overlaps deeply at rest is held there or slides beside it, whichever is
  /// nearer to the target. Where the fields are incomplete (open shells from behind, two thin
  /// walls, far from the rest poses) the body advances from `from` in steps of a millimetre, each
  /// verified by the exact surfaces, and does not go deeper than it was. Bit-identical for any
  /// number of threads; caches never change a result. `bound_far`: surfaces that are at least 5 mm
  /// apart need not be measured; then PairContact::distance_is_bound.
  Slide slide(const BodyPoses& from, std::span<const Pose> X_PB_target, const ContactSet* previous,
              int threads = 1, bool bound_far = false) const;

  /// Computes the distance fields that sliding needs, or reads them from the cache; otherwise
  /// slide() does so at first contact. Threads may share a model.
  void prepare_sliding(const Progress& progress = {}, int threads = 2) const;

  const ContactSet& at_rest() const;
  /// The rule of each pair, in the order of ContactSet::pairs.
  const std::vector<PairRule>& rules() const;
  /// Notes for people on inexact measurements (open shells) and on overlap at rest.
  const std::vector<std::string>& notes() const;

  struct State;

 private:
  std::shared_ptr<const State> state_;
};

}  // namespace condyle
