#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/choice/plan_view.h"
#include "sim/operation/operation.h"

namespace condyle {

/// What a cut would do to its bone, at the uncut rest in the cranium's frame.
struct CutPreview {
  CutPreviewView words;
  std::string body;  // that is cut
  struct Piece {
    std::string name;
    bool stays = false;
    TriMesh mesh;
    std::vector<Eigen::Vector3d> rims;  // edges between cut faces and the bone's surface, in pairs
  };
  std::vector<Piece> pieces;
};

/// Makes single cuts of a plan, without all that follows from them: fast enough to follow a hand.
/// The bone that the steps before a cut leave is kept between calls.
class CutPreviewer {
 public:
  explicit CutPreviewer(std::shared_ptr<const Case> uncut) : uncut_(std::move(uncut)) {}

  /// The cut of a step. What refuses it is in `words.problem`.
  CutPreview preview(const Plan& plan, int step);

  /// Handles of a named osteotomy's numbers: its stations, and where a cut face moves farthest with
  /// another number. Numbers that move it by less than 0.2 mm a unit have none. Places at the uncut
  /// rest.
  /// `body`: name of the body that carries them; their own numbers are not set.
  std::vector<PlanHandle> number_handles(const Plan& plan, int step, std::string& body);

 private:
  const Operated& before(const Plan& plan, int step);

  std::shared_ptr<const Case> uncut_;
  std::optional<Plan> earlier_;  // the steps before the cut
  Operated bones_;               // that they leave
};

}  // namespace condyle
