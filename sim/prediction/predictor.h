#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "sim/frame/body_poses.h"
#include "sim/prediction/operated_tissue.h"
#include "sim/prediction/prediction.h"

namespace condyle {

/// A face that follows moved segments.
struct MovedFace {
  TissueState state;
  std::vector<Eigen::Vector3f> vertices;  // of the displayed face
};

/// Predicts faces of one patient, plan after plan. It keeps the tissue of the uncut patient and
/// that on the pieces of the last cuts, so that a plan with other moves costs the solution alone.
/// `predict` gives the face of predict(), bit for bit, whatever came before: lips that press on
/// each other have several equilibria, and only a path from rest chooses always the same. `move`
/// follows a segment from the last face.
class Predictor {
 public:
  /// `whole`: the tissue of the uncut patient where it is built already, else null.
  /// throws: InputError for a case without a face.
  explicit Predictor(const Case& patient, PredictionSettings settings = {},
                     std::shared_ptr<const TissueModel> whole = nullptr);

  /// Replays a plan and makes its tissue, the first time also that of the uncut patient; after a
  /// plan with the same cuts it replays the moves alone.
  /// throws: InputError as apply_plan().
  const Operated& prepare(const Plan& plan, const Progress& progress = {});

  /// What the cuts of the prepared plan strip.
  const Stripping& stripping() const { return tissue_.stripping; }

  /// The settled face. throws: InputError as apply_plan(); MachineError where the tissue has no
  /// solution.
  Prediction predict(const Plan& plan, const Progress& progress = {});

  /// The face of the prepared plan with its bodies at other poses, from the last face, within a
  /// number of iterations: for segments that are being dragged. Not settled as that of
  /// predict() is: the inner side of the lips may lie millimetres off.
  /// Where the tissue has no solution, `reused` and the last face.
  MovedFace move(const BodyPoses& poses, int max_iterations = 60);

 private:
  void build_whole(const Progress& progress);
  void begin_at_rest();
  void move_from_rest(const Progress& progress);

  Case patient_, uncut_;  // the second with its lips parted
  PredictionSettings settings_;
  std::shared_ptr<const TissueModel> whole_;  // null before the first plan
  std::vector<Eigen::Vector3f> rest_face_;
  std::optional<Plan> plan_;  // prepared
  Operated cuts_, operated_;  // of it: all at rest; with its moves
  OperatedTissue tissue_;
  TissueState state_;
  TissueWarmStart warm_;
};

}  // namespace condyle
