#pragma once

#include <memory>
#include <vector>

#include "engine/collide/collision_mesh.h"
#include "sim/case/case.h"
#include "sim/frame/body_poses.h"
#include "sim/frame/contact_set.h"

namespace condyle {

/// Contact of one tooth with the opposing teeth during a motion.
struct ToothUse {
  int fdi = 0;
  int touching_frames = 0;
  int touches = 0;  // number of times it came into contact; contact at the start counts
};

/// Tests for each tooth of a part with separate crowns whether it touches the opposing arch.
/// Queries are const and thread-safe.
class ToothContacts {
 public:
  /// The patient must outlive this.
  explicit ToothContacts(const Case& patient);

  /// FDI numbers, part after part.
  const std::vector<int>& teeth() const { return numbers_; }

  /// Which teeth touch; `contacts` must belong to these poses. shape: one per tooth.
  std::vector<bool> touching_at(const ContactSet& contacts, const BodyPoses& at) const;

 private:
  struct Crown {
    int part = 0;
    CollisionMesh surface;
  };
  const Case& patient_;
  std::vector<int> numbers_;
  std::vector<Crown> crowns_;                           // of each tooth
  std::vector<std::unique_ptr<CollisionMesh>> arches_;  // one per part; null where it is not teeth
};

/// Counts contacts over the frames. shape of `touching`: [frame][tooth].
std::vector<ToothUse> tooth_use(const std::vector<int>& teeth,
                                const std::vector<std::vector<bool>>& touching);

}  // namespace condyle
