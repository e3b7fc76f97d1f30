#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/case/face_muscle.h"
#include "sim/frame/expression_level.h"
#include "sim/frame/face_excitation.h"

namespace condyle {

/// Kind of the muscle that closes the lids, which needs no line in a patient: see LidClosure. No
/// expression excites a muscle of this kind.
inline constexpr std::string_view lid_closer = "orbicularis_oculi_palpebral";
/// Likewise the muscle that raises the upper lids.
inline constexpr std::string_view lid_raiser = "levator_palpebrae_superioris";
inline bool is_lid_muscle(std::string_view kind) {
  return kind == lid_closer || kind == lid_raiser;
}

/// Excitation of a kind of muscle of the face, 0 to 1.
struct KindExcitation {
  std::string kind;
  double value = 0;
};

/// A built-in expression, or an action unit of the Facial Action Coding System.
struct NamedExpression {
  std::string name;    // "smile", "AU12"
  std::string action;  // of an action unit: "lip corner puller"; empty: an expression
  std::vector<KindExcitation> kinds;  // at full strength, on both sides

  bool action_unit() const { return !action.empty(); }
};

/// Expressions first, then action units by number: those whose muscles exist and move the face as
/// described.
const std::vector<NamedExpression>& named_expressions();

/// Null: there is none. Case does not count.
const NamedExpression* find_expression(std::string_view name);

/// Whether one of them pulls skin above the lower lids, see TissueSettings::upper_face.
bool moves_upper_face(std::span<const ExpressionLevel> levels);

/// Names of the built-in expressions, without action units.
std::vector<std::string> builtin_expressions();
/// All names, as "smile, sad, AU9": for messages.
std::string list_expressions();

/// One value for each muscle: the sum of the levels, at most 1. Muscles in the middle are excited
/// as the stronger side. Unknown names excite nothing.
FaceExcitation excitation_of(std::span<const ExpressionLevel> levels,
                             std::span<const FaceMuscle> muscles);

/// A sentence on the kinds of muscles that the levels excite and the face lacks; empty: none.
std::string missing_kinds(std::span<const ExpressionLevel> levels,
                          std::span<const FaceMuscle> muscles);

/// The sums, at most 1; of muscles, the shorter list counts as 0 beyond its end.
FaceExcitation added_excitations(FaceExcitation a, const FaceExcitation& b);
/// a + fraction * (b - a), of excitations of the same muscles.
FaceExcitation between(FaceExcitation a, const FaceExcitation& b, double fraction);

}  // namespace condyle
