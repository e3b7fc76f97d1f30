#include "sim/motion/measures.h"

namespace condyle {

Measures measure(const Case& patient, const Pose& X_CM) {
  constexpr double degrees = 180 / 3.14159265358979323846;
  const Landmarks& landmarks = patient.landmarks;
  Measures out;
  if (const auto p = landmarks.find("lower_incisal_point")) {
    out.incisor = X_CM * *p;
    out.opening_mm = p->z() - out.incisor.z();
    if (const auto upper = landmarks.find("upper_incisal_point"))
      out.interincisal_mm = (out.incisor - *upper).norm();
  }
  if (const auto p = landmarks.find("left_condyle")) out.left_condyle = X_CM * *p;
  if (const auto p = landmarks.find("right_condyle")) out.right_condyle = X_CM * *p;
  out.rotation_deg = rotation_angle(X_CM) * degrees;
  return out;
}

}  // namespace condyle
