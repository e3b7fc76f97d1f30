#include "sim/prediction/predicted_landmarks.h"

namespace condyle {

Landmarks predicted_landmarks(const Prediction& prediction) {
  const Operated& operated = prediction.operated;
  Landmarks landmarks =
      moved_landmarks(operated.patient.landmarks, operated.owners, operated.poses);
  for (const SoftPoint& point : prediction.points) landmarks.points[point.landmark] = point.after;
  return landmarks;
}

}  // namespace condyle
