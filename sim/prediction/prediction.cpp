#include "sim/prediction/prediction.h"

#include <algorithm>

#include "engine/mesh/measure.h"
#include "sim/prediction/predictor.h"

namespace condyle {
namespace {

Eigen::Vector3d middle_of(const Case& patient, BodyId body) {
  Box box;
  for (const Part& part : patient.parts)
    if (part.body == body) box.add(bounding_box(part.mesh));
  return box.empty() ? Eigen::Vector3d::Zero() : box.center();
}

}  // namespace

double Prediction::max_displacement_mm() const {
  float most = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    most = std::max(most, (after[i] - before[i]).norm());
  return most;
}

std::vector<Pose> poses_at(const Operated& operated, double fraction) {
  std::vector<Pose> poses = operated.poses.X_CB;
  for (std::size_t i = 0; i < poses.size(); ++i)
    poses[i] = interpolate({}, poses[i], fraction,
                           middle_of(operated.patient, BodyId{static_cast<int>(i)}));
  return poses;
}

Prediction predict(const Case& patient, const Plan& plan, const PredictionSettings& settings,
                   const Progress& progress) {
  return Predictor(patient, settings).predict(plan, progress);
}

}  // namespace condyle
