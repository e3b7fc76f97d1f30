#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/case/case.h"
#include "sim/contact/seat.h"

namespace condyle {

struct TurnedPath {
  std::vector<Pose> poses = {};  // of the graft from its seat, 1 mm apart; empty: none was found
  int examined = 0;              // poses
  double farthest_mm = 0;        // that the graft's middle came from its seat
};

/// A path of a graft out of its seat to a place `length_mm` away along one of the directions, or
/// within 75 degrees of the approach, on which it turns. The search runs on distance fields
/// (find_path()); its result is then followed by contact (ContactModel::slide), whose poses are
/// returned. Searches at most twice, over 40,000 poses in all: some ten seconds of processor time.
/// Depends on patient, seat and directions alone. `directions`: unit, along which the graft may
/// leave its seat.
TurnedPath find_turned_path(const Case& patient, const Seat& seat, const std::vector<BodyId>& graft,
                            const std::vector<Eigen::Vector3d>& directions, double length_mm,
                            int threads);

}  // namespace condyle
