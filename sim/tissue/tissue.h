#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "sim/case/case.h"
#include "sim/case/face_muscle.h"
#include "sim/frame/tissue_state.h"
#include "sim/tissue/body_weights.h"

namespace condyle {

/// Soft tissue between face and bone of one patient; read only once built.
struct TissueModel;

struct TissueSettings {
  /// Approximate number per sheet. A finer mesh models the same tissue: attachment per area is the
  /// same, and layers are divided until springs fill them evenly (split_layers).
  int surface_nodes = 520;
  /// Also simulates the skin around the eyes and up over the forehead, with nodes of its own. For
  /// expressions that move the brows: it takes longer, and other expressions differ slightly.
  bool upper_face = false;
  TissuePlan plan = {};                       // takes precedence over the case's own
  std::vector<FaceMuscle> face_muscles = {};  // without excitation they change nothing
  int threads = 2;  // of the builder; the model is bit-identical for any number
};

/// Limits of one frame's minimization.
struct TissueBudget {
  double tolerance_mm = 1e-2;  // stop when the estimated step of every node is smaller
  /// A frame that has used them up ends once its contacts are within 0.1 mm, reports that it has
  /// not converged, and leaves the rest to the next frame.
  int max_iterations = 2000;
  /// Contact stiffness over the default. Stiffer contact needs fewer contact searches to converge,
  /// and more iterations for each.
  double contact_firmness = 1;
  /// Contacts at sharp edges, as of cut bones, converge where they would oscillate; elsewhere they
  /// may take a few iterations more.
  bool relaxed_contact = false;
  /// Contact planes are averaged with their earlier ones from the first search on. Where frames at
  /// unchanged poses would oscillate, they then converge; moving tissue needs more iterations.
  bool damped_contact = false;
  int threads = 1;  // the result is bit-identical for any number
};

/// What the builder made, and what it had to omit, for reports and people.
struct TissueSummary {
  int nodes = 0, springs = 0, prisms = 0;
  int layers = 0;  // as requested; a fine mesh divides them
  int attached_to_cranium = 0, attached_to_mandible = 0, boundary = 0;
  bool lips_cut = false;
  // so deep in the other lip at rest that they are not checked against it
  int lip_points_left_out = 0;
  // deepest overlap with bone, teeth or the other lip at rest: it is allowed
  double rest_overlap_mm = 0;
  double rest_force_N = 0;  // largest on any node of the unmoved model
  double rest_move_mm = 0;  // largest displacement of a node when the unmoved model is solved
  std::vector<std::string> notes;
};

/// Null when the case has no face. throws: InputError stating what is wrong with the face and
/// where.
std::shared_ptr<const TissueModel> build_tissue(const Case& patient,
                                                const TissueSettings& settings = {},
                                                const Progress& progress = {});
const TissueSummary& summary(const TissueModel& model);
const std::vector<FaceMuscle>& face_muscles_of(const TissueModel& model);
/// Length of each muscle of the face, the mean of its lines, mm.
std::vector<double> face_muscle_lengths(const TissueModel& model, const TissueState& state);

/// The unmoved tissue.
TissueState rest_tissue(const TissueModel& model);

struct SolverCache;

/// What makes the next solve of a sequence short: the preconditioner and the contacts with their
/// forces. A value that is kept beside the loop: a sequence continues bit-identically from a copy
/// of it and of the state. Without it the next solve takes more iterations to an equally good
/// result.
struct TissueWarmStart {
  std::shared_ptr<const SolverCache> last;  // of the last successful solve; null without
};

/// The tissue of minimum energy (quasi-static, without inertia) with the bodies at X_CB, each a
/// pose in the cranium's frame from rest to now, by number; bodies beyond the end are at rest.
/// Starts from `previous`, moved with the bodies. `warm` belongs to the solve that gave `previous`;
/// it is replaced. `excitation`: 0 to 1, of each muscle of the face; missing ones are relaxed.
/// status: `converged` and `reused` of the result.
TissueState solve_tissue(const TissueModel& model, const TissueState& previous,
                         std::span<const Pose> X_CB, const TissueBudget& budget,
                         TissueWarmStart& warm, std::span<const double> excitation = {});
/// The same without a warm start.
TissueState solve_tissue(const TissueModel& model, const TissueState& previous,
                         std::span<const Pose> X_CB, const TissueBudget& budget = {});

/// The equilibrium at the bodies' poses of `state`, independent of the path: solved in rounds until
/// all further rounds would move no node farther than the tolerance (mm), by estimate. A frame
/// stops when its contact springs are exact to 0.03 mm, which soft sliding tissue can amplify to
/// tenths of a millimetre. status: `converged` of the result; iterations are of all rounds.
constexpr double equilibrium_mm = 1e-3;
struct SettleSettings {
  double tolerance_mm = equilibrium_mm;
  int max_rounds = 100;
  int threads = 1;
};
/// `warm` belongs to the solve that gave `state`; it is replaced.
TissueState solve_to_equilibrium(const TissueModel& model, const TissueState& state,
                                 TissueWarmStart& warm, const SettleSettings& settings = {});
TissueState solve_to_equilibrium(const TissueModel& model, const TissueState& state,
                                 double tolerance_mm = equilibrium_mm, int threads = 1,
                                 TissueWarmStart warm = {});

/// Vertices of the displayed face (the case's face part, in its order), carried by the tissue.
/// Bit-identical for any number of threads.
void deform_face(const TissueModel& model, const TissueState& state,
                 std::vector<Eigen::Vector3f>& face, int threads = 1);

/// A point of the face surface carried by the tissue (soft landmarks), mm.
Eigen::Vector3d carried_point(const TissueModel& model, const TissueState& state,
                              const Eigen::Vector3d& rest);

}  // namespace condyle
