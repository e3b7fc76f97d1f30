#pragma once

#include <Eigen/Core>
#include <optional>

#include "engine/math/pose.h"
#include "render/camera/camera.h"
#include "sim/frame/face_excitation.h"

namespace condyle {

/// Switches life on in a picture.
struct Life {
  /// A point of the transverse axis about which the head nods: between the atlanto-occipital
  /// joints, mm.
  Eigen::Vector3d nodding_axis = Eigen::Vector3d::Zero();
  /// Landmark pronasale at rest, mm: the nostrils beside it breathe.
  std::optional<Eigen::Vector3d> nose_tip = {};
  LidStrength lids = {};  // a weak side blinks less
  bool operator==(const Life&) const = default;
};

/// Nodding axis by the midpoint of the condyles of the mandible; its offset was estimated.
Life life_about(const Eigen::Vector3d& condyles,
                const std::optional<Eigen::Vector3d>& nose_tip = std::nullopt);

/// What a face does by itself, and what an expression does to its lids. Values between published
/// extremes; the choice at each time is pseudo-random.
struct LifeSigns {
  LidClosure lids = {};  // by a blink or an expression
  double gaze_left = 0;  // to the patient's left, rad
  double gaze_up = 0;    // rad
  double pupil = 1;      // radius over that at rest
  double breath = 0;     // 0 after expiration, 1 after inspiration
  double extension = 0;  // of the head with the jaw's opening, rad
  bool alive = true;     // false: lids alone move, from where the face has them
  bool operator==(const LifeSigns&) const = default;
};

/// A function of its arguments alone. X_CM: pose of the lower jaw.
/// Blinks every 3 to 5 s, the first before 2 s, the lids closing in 0.1 s and opening in 0.17 s;
/// saccades of up to 9 degrees; 13.5 breaths a minute; the head extends by 0.07 of the jaw's
/// rotation, so that the upper incisors move by 8 % of the path of the lower ones.
/// source: closing is faster than opening by 40 to 47 %: Sforza 2008; that the head extends as the
/// jaw opens: Eriksson 2000, Zafar 2000; ratio of the amplitudes of head and jaw, 7 % in men and
/// 9 % in women: Haeggman-Henrikson and others, Gender Difference in Motor Strategy in Response to
/// Jaw-opening Resistance, 2018. Here it is that of upper and lower incisors.
LifeSigns life_signs(double time_s, const Pose& X_CM = {});

/// Pose in the cranium's frame of what stays where it is while the head extends.
Pose still_in_cranium(const Life& life, double extension);

/// The camera that sees the head extend, in the cranium's frame.
Camera seeing_extension(const Camera& camera, const Life& life, double extension);

}  // namespace condyle
