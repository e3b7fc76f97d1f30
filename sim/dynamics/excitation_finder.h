#pragma once

#include <vector>

#include "sim/dynamics/muscle_jaw.h"

namespace condyle {

struct ExcitationFinderSettings {
  double hold_s = 0.005;        // excitations are kept so long
  double catch_up_per_s = 40;   // of a place that was missed
  double condyle_weight = 0.3;  // of a condyle's velocity against the incisal point's
  // What a fully excited muscle, and a change of one by 1, cost against a miss of 1 mm/s; squared.
  double effort_mm_s = 60, change_mm_s = 60;
};

/// Finds, for one hold after the other, the excitations under which the incisal point and the
/// condyles follow a wanted motion: least squares of their velocities, regularised by effort and by
/// change, with the excitations from 0 to 1. The guides count as held; contact is not foreseen.
class ExcitationFinder {
 public:
  ExcitationFinder(const Case& patient, const MuscleJaw& jaw,
                   const ExcitationFinderSettings& settings = {});

  /// For the hold that begins now; `now` and `after`: wanted poses at its beginning and end.
  std::vector<double> find(const MuscleJaw& jaw, const Pose& now, const Pose& after);

 private:
  ExcitationFinderSettings settings_;
  std::vector<Eigen::Vector3d> points_;  // incisal point and condyles, at rest
  std::vector<double> weights_;
  std::vector<double> last_;
  MuscleLawSettings law_;
};

}  // namespace condyle
