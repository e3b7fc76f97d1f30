#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "sim/case/case.h"
#include "sim/frame/tissue_state.h"

namespace condyle {

/// Soft tissue between face and bone of one patient; built once, then read only.
struct TissueModel;

struct TissueSettings {
  /// Of one sheet, about. More are the same tissue, finer: bones hold an area as firmly, and layers
  /// are cut until springs fill them evenly (split_layers).
  int surface_nodes = 520;
  TissuePlan plan = {};  // counts before the case's own
  int threads = 2;       // of the builder; the model has the same bits for any number
};

/// How far one frame's minimisation goes.
struct TissueBudget {
  double tolerance_mm = 1e-2;  // stop when a step moves no node farther than this, estimated
  /// A frame that has spent them ends as soon as what it touches is within 0.1 mm, says that it has
  /// not converged, and leaves the rest to the next.
  int max_iterations = 2000;
  /// Of what the tissue touches, over the usual. Firmer contact needs fewer looks at what is
  /// touched to be told to the end, and more iterations for each.
  double contact_firmness = 1;
  int threads = 1;  // the result has the same bits for any number
};

/// What the builder made, and what it had to leave out, for reports and people.
struct TissueSummary {
  int nodes = 0, springs = 0, prisms = 0;
  int layers = 0;  // as asked for; a fine net cuts them
  int attached_to_cranium = 0, attached_to_mandible = 0, boundary = 0;
  bool lips_cut = false;
  int lip_points_left_out = 0;  // so deep in the other lip at rest that nothing keeps them out
  double rest_overlap_mm = 0;   // deepest in bone, teeth or the other lip at rest: it may stay
  double rest_force_N = 0;      // largest on any node of the unmoved model
  double rest_move_mm = 0;      // farthest way of any node when the unmoved model is solved
  std::vector<std::string> notes;
};

/// Null when the case has no face. throws: InputError saying what is wrong with the face and where.
std::shared_ptr<const TissueModel> build_tissue(const Case& patient,
                                                const TissueSettings& settings = {},
                                                const Progress& progress = {});
const TissueSummary& summary(const TissueModel& model);

/// The unmoved tissue.
TissueState rest_tissue(const TissueModel& model);

/// The tissue of minimum energy with the mandible at X_CM, warm-started from `previous`.
TissueState follow(const TissueModel& model, const TissueState& previous, const Pose& X_CM,
                   const TissueBudget& budget = {});

/// The tissue of `state` at its pose where it came from no longer matters: followed on until all
/// further solving would take no node farther than the tolerance (mm), estimated. A frame stops
/// when what touches is told to 0.03 mm of its spring, which soft tissue that slides can turn into
/// tenths. `converged` tells whether that was reached; iterations are of all rounds.
constexpr double settled_mm = 1e-3;
TissueState settle(const TissueModel& model, const TissueState& state,
                   double tolerance_mm = settled_mm, int threads = 1);

/// Vertices of the displayed face (the case's face part, in its order), carried by the tissue.
/// Same bits for any number of threads.
void deform_face(const TissueModel& model, const TissueState& state,
                 std::vector<Eigen::Vector3f>& face, int threads = 1);

/// A point of the face surface carried by the tissue (soft landmarks), mm.
Eigen::Vector3d carried_point(const TissueModel& model, const TissueState& state,
                              const Eigen::Vector3d& rest);

}  // namespace condyle
