#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "engine/math/pchip.h"
#include "engine/math/pose.h"
#include "sim/case/case.h"
#include "sim/motion/condylar_path_table.h"
#include "sim/motion/joint_surfaces.h"

namespace condyle {

/// The four inputs that determine a jaw's pose: six degrees of freedom less the contact of both
/// condyles with their fossae.
struct JawInputs {
  double theta = 0;                  // rad of opening about the line through the condyles
  double left_mm = 0, right_mm = 0;  // forward travel (toward -y) of each condyle
  double shift_mm = 0;               // of the jaw to the left
};

/// Whether a motion includes lateral movement, so that condylar paths are also tabulated for
/// lateral shifts.
enum class JointReach { straight, aside };

/// The patient's two joints driven by four inputs: each condyle follows its path, the intercondylar
/// distance is constant, and the jaw rotates about the intercondylar axis.
/// source: four inputs after the jaw's two joint-surface constraints; Bennett angle and immediate
/// side shift (an exponential of 1 mm) of the orbiting condyle.
class JawJoints {
 public:
  /// The path of a side is, in order of precedence: one of the given inclination; the patient's
  /// fossa at the disc gap; the path in the case; an average path. throws: InputError naming
  /// missing or implausible landmarks.
  JawJoints(const Case& patient, const MotionParameters& parameters, JointReach reach, int threads);

  /// Pose of the mandible, rest to now.
  Pose pose(const JawInputs& inputs) const;

  /// Lateral shift due to Bennett angle and immediate side shift for the given forward travels, mm:
  /// toward the side of the condyle that stays behind.
  double bennett_shift_mm(double left_mm, double right_mm) const;

  /// Inferior translation of the condyle centre, mm.
  double inferior_translation_mm(JawSide side, double forward_mm, double theta = 0,
                                 double shift_mm = 0) const;

  /// Secant of the condyle's path over its first 5 mm forward to the horizontal, deg; positive
  /// down. Without rotation of the jaw.
  double inclination_deg(JawSide side) const;

  const Eigen::Vector3d& incisor() const { return incisor_; }  // lower incisal point at rest
  /// Lower incisal point in the closed position, and the rotation of that position, rad; the rest
  /// pose and 0 unless the patient was scanned with the mouth open.
  const Eigen::Vector3d& closed_incisor() const { return closed_incisor_; }
  double closed_theta() const { return closed_theta_; }
  const Eigen::Vector3d& condyle(JawSide side) const {
    return side == JawSide::left ? left_ : right_;
  }
  Eigen::Vector3d incisor(const JawInputs& inputs) const { return pose(inputs) * incisor_; }
  /// Descent of the lower incisal point from the closed position, mm.
  double opening_mm(const JawInputs& inputs) const {
    return closed_incisor_.z() - incisor(inputs).z();
  }

  /// Condyle centre to lower incisal point, mean of both sides, mm; and the angle of the triangle
  /// of these three points to the horizontal, deg.
  double bonwill_mm() const;
  double balkwill_deg() const;

  /// The fossae, where they guide.
  const std::optional<JointSurfaces>& surfaces() const { return surfaces_; }
  /// The disc that a fossa guides by.
  const DiscGap& disc_gap(JawSide which) const { return side(which).gap; }
  /// Whether the case contains the condylar path, so that the maximum opening is not estimated.
  bool well_known() const { return well_known_; }
  /// Description of the source of the paths.
  const std::string& guide() const { return guide_; }

 private:
  void set_condyles(const Case& patient, const MotionParameters& parameters);
  struct Side {
    std::optional<CondylarPathTable> table;
    DiscGap gap;
    Pchip path;  // inferior translation by forward travel, without a table
  };
  const Side& side(JawSide which) const { return sides_[which == JawSide::left ? 0 : 1]; }

  Eigen::Vector3d left_, right_, incisor_, closed_incisor_;
  double closed_theta_ = 0;
  double bennett_slope_ = 0, side_shift_mm_ = 0;
  std::array<Side, 2> sides_;
  std::optional<JointSurfaces> surfaces_;
  bool well_known_ = false;
  bool articulator_ = false;  // condyles placed by Bonwill and Balkwill
  std::string guide_;
};

}  // namespace condyle
