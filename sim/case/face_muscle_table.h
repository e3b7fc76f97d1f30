#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/case/face_muscle.h"

namespace condyle {

/// A table of the muscles of facial expression, one row for each point of a fibre: CSV with the
/// columns muscle, side (left, right, both), fibre, point, x_mm, y_mm, z_mm; optionally body
/// (cranium, mandible; tissue, or empty), depth (0 at the skin to 1 at the inner side of the soft
/// tissue; empty: where the point lies), spread_mm (0), max_force_N and shortening of the whole
/// muscle (above 0; empty: those of its kind), law (bounded, hill), full_name (not used). A muscle
/// is a kind, "zygomaticus_major", or an abbreviation of one, "ZYG". Points are as given in the
/// file.
struct FaceMuscleTable {
  std::vector<FaceMuscle> muscles;
  bool has_bodies = false;  // else nothing is known of the ends
  std::vector<std::string> unused_columns = {};
};

/// `zero`: whether a force or shortening of 0 means that of the muscle's kind, as in saved cases of
/// earlier versions. throws: InputError with file, line, column and value.
enum class ZeroStrength { refused, of_the_kind };
FaceMuscleTable read_face_muscles(const std::filesystem::path& file,
                                  ZeroStrength zero = ZeroStrength::refused);

/// The muscles as CSV text with exact round trip.
std::string face_muscles_csv(const std::vector<FaceMuscle>& muscles);

/// Whether force and shortening of this kind are known.
bool is_face_muscle_kind(const std::string& kind);

/// Whether muscles of this kind pull skin above the lower lids.
bool pulls_upper_face(const std::string& kind);

/// "left", "right", "both" by a muscle's name.
std::string face_muscle_side(const FaceMuscle& muscle);

}  // namespace condyle
