#pragma once

#include <memory>
#include <vector>

#include "engine/collide/collision_mesh.h"
#include "sim/case/case.h"
#include "sim/frame/body_poses.h"
#include "sim/frame/contact_set.h"

namespace condyle {

/// How much of a motion one tooth touches the teeth opposite.
struct ToothUse {
  int fdi = 0;
  int touching_frames = 0;
  int touches = 0;  // times that it came to touch; from the start on counts as one
};

/// Asks, tooth by tooth, whether its crown touches the other arch. Of parts whose crowns are
/// separate. Queries are const and thread-safe.
class ToothContacts {
 public:
  /// The patient must outlive this.
  explicit ToothContacts(const Case& patient);

  /// FDI numbers, part after part.
  const std::vector<int>& teeth() const { return numbers_; }

  /// Which of the teeth touch; `contacts` as found at these poses. shape: one per tooth.
  std::vector<bool> touching_at(const ContactSet& contacts, const BodyPoses& at) const;

 private:
  struct Crown {
    int part = 0;
    CollisionMesh surface;
  };
  const Case& patient_;
  std::vector<int> numbers_;
  std::vector<Crown> crowns_;                           // of each tooth
  std::vector<std::unique_ptr<CollisionMesh>> arches_;  // of each part that is teeth, else null
};

/// Counts frame by frame. shape: a row per frame, one per tooth.
std::vector<ToothUse> tooth_use(const std::vector<int>& teeth,
                                const std::vector<std::vector<bool>>& touching);

}  // namespace condyle
