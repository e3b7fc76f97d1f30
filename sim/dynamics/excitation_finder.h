#pragma once

#include <vector>

#include "sim/dynamics/muscle_jaw.h"

namespace condyle {

struct ExcitationFinderSettings {
  double hold_s = 0.005;        // interval of constant excitation
  double catch_up_per_s = 40;   // feedback gain on position errors
  double condyle_weight = 0.3;  // weight of a condyle's velocity relative to the incisal point's
  // Penalties of full excitation, and of a change by 1, relative to an error of 1 mm/s; squared.
  double effort_mm_s = 60, change_mm_s = 60;
};

/// Finds, interval by interval, the excitations under which the incisal point and the condyles
/// track a motion: bounded least squares of their velocities, regularised by effort and change,
/// with excitations from 0 to 1. The condylar guides are constraints; contact is not predicted.
class ExcitationFinder {
 public:
  ExcitationFinder(const Case& patient, const MuscleJaw& jaw,
                   const ExcitationFinderSettings& settings = {});

  /// Excitations for the interval that begins now; `now` and `after`: target poses at its start and
  /// end.
  std::vector<double> find(const MuscleJaw& jaw, const Pose& now, const Pose& after);

 private:
  ExcitationFinderSettings settings_;
  std::vector<Eigen::Vector3d> points_;  // incisal point and condyles, at rest
  std::vector<double> weights_;
  std::vector<double> last_;
  MuscleLawSettings law_;
};

}  // namespace condyle
