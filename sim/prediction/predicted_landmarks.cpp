#include "sim/prediction/predicted_landmarks.h"

namespace condyle {

Landmarks predicted_landmarks(const Prediction& prediction) {
  Landmarks landmarks = planned_landmarks(prediction.operated);
  for (const SoftPoint& point : prediction.points) landmarks.points[point.landmark] = point.after;
  return landmarks;
}

}  // namespace condyle
