#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/overlay/overlay_key.h"
#include "sim/case/muscle.h"

namespace condyle {

/// What a muscle does, by which it is coloured.
enum class MuscleAction { elevator, protrusor, depressor, hyoid, facial };

MuscleAction action_of(const Muscle& muscle);

/// sRGB, in Okabe and Ito's palette: darker at rest, bright when fully excited.
Eigen::Vector3f muscle_color(MuscleAction group, double excitation);
/// Of a tendon, sRGB.
inline const Eigen::Vector3f tendon_color{0.88f, 0.85f, 0.76f};

/// Entries for the groups of these muscles, in a fixed order.
std::vector<KeyEntry> muscle_key(std::span<const Muscle> muscles);
KeyEntry facial_muscle_key();

/// How a belly lies along the bone that it covers: straight; pushed out of it; on it as far as it
/// is near, a fan that then passes beneath the zygomatic arch.
enum class Lie { straight, outside, fan };

/// Cross-section of a belly and the directions in which it lies.
struct BellyShape {
  enum class Thin { lateral, medial, vertical, front };
  double flatness = 1.6;                             // width over thickness in the middle
  double origin_width = 0.8, insertion_width = 0.8;  // over that in the middle
  Thin thin = Thin::lateral;  // the direction of its thickness, away from the bone
  Lie lie = Lie::outside;
};

/// By kind; muscles of other kinds are spindles. source: attachments and proportions after Gray's
/// Anatomy, 41st ed.
BellyShape belly_shape(std::string_view kind);

/// Area of the belly at rest, mm^2: strength over 40 N/cm^2, at least 20 mm^2.
double belly_area_mm2(double max_force_N);

}  // namespace condyle
