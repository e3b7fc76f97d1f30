#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "engine/mesh/measure.h"
#include "sim/frame/body_poses.h"
#include "sim/prediction/operated_tissue.h"
#include "sim/prediction/prediction.h"

namespace condyle {

/// A face that follows moved segments.
struct MovedFace {
  TissueState state;
  std::vector<Eigen::Vector3f> vertices;  // of the displayed face
};

/// Predicts faces of one patient, plan after plan. It keeps the tissue of the uncut patient, the
/// tissue on the pieces of the last cuts, and the last state: a plan with other moves continues
/// from there, one with other cuts begins at rest with the tissue of the uncut patient. The first
/// prediction of a plan is that of predict(), bit for bit; settled ones of any history agree with
/// it as far as the tissue has one equilibrium (0.05 mm where no lip is pressed in).
class Predictor {
 public:
  /// throws: InputError for a case without a face.
  explicit Predictor(const Case& patient, PredictionSettings settings = {});

  /// Replays a plan and makes its tissue, the first time also that of the uncut patient; after a
  /// plan with the same cuts it replays the moves alone.
  /// throws: InputError as apply_plan().
  const Operated& prepare(const Plan& plan, const Progress& progress = {});

  /// The settled face. throws: InputError as apply_plan(); MachineError where the tissue has no
  /// solution.
  Prediction predict(const Plan& plan, const Progress& progress = {});

  /// The face of the prepared plan with its bodies at other poses, from the last face, within a
  /// number of iterations: for segments that are being dragged. Not settled; repeated calls with
  /// the same poses settle it. Where the tissue has no solution, `reused` and the last face.
  MovedFace move(const BodyPoses& poses, int max_iterations = 60);

 private:
  void build_whole(const Progress& progress);
  void begin_at_rest();
  bool move_in_steps(const std::vector<Pose>& planned, const Progress& progress);
  void move_to(const std::vector<Pose>& planned, const Progress& progress);

  Case patient_, uncut_;  // the second with its lips parted
  PredictionSettings settings_;
  std::shared_ptr<const TissueModel> whole_;  // null before the first plan
  std::vector<Eigen::Vector3f> rest_face_;
  std::optional<Plan> plan_;  // prepared
  Operated cuts_, operated_;  // of it: all at rest; with its moves
  OperatedTissue tissue_;
  std::vector<Box> extent_;   // of each body at rest
  TissueState state_;
  TissueWarmStart warm_;
  bool from_rest_ = true;  // nothing has moved since the cuts
};

}  // namespace condyle
