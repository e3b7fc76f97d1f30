#pragma once

#include <Eigen/Core>

#include "sim/case/case.h"

namespace condyle {

/// The plane in which the back teeth occlude at rest.
struct BitePlane {
  Eigen::Vector3d left, right;  // on the lower first molars
  Eigen::Vector3d normal;       // unit, downward, of the plane through both and the incisal point
};

/// From the landmarks left_bite and right_bite (also lbite, rbite), else from the lower teeth, else
/// from the mandible's landmarks.
BitePlane bite_plane(const Case& patient);

}  // namespace condyle
