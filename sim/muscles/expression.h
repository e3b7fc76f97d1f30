#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "sim/case/face_muscle.h"
#include "sim/muscles/expression_names.h"

namespace condyle {

/// Excitation of the face over time.
struct Expression {
  std::string name;
  double duration_s = 0;
  /// One value for each muscle; constant beyond the ends.
  std::function<FaceExcitation(double time_s)> at;
  std::vector<std::string> notes = {};  // on missing muscles, and on lids, which are only drawn
};

/// Duration of the rise to an expression, and of the return to rest. source: the first stage of a
/// spontaneous smile takes 0.5 s on average.
constexpr double expression_onset_s = 0.5, expression_release_s = 1;

/// Levels of expressions at increasing times. Between them the excitations follow a smoothstep:
/// zero slope at each time.
struct ExpressionKey {
  double time_s = 0;
  std::vector<ExpressionLevel> levels = {};
};
Expression expression_through(std::string name, std::span<const ExpressionKey> keys,
                              std::span<const FaceMuscle> muscles);

/// Checks a name, its strength and its side, and that a file exists. throws: InputError.
void check_expression(const std::string& spec);

/// Whether it moves brows or forehead, see TissueSettings::upper_face. throws: InputError as
/// check_expression().
bool expression_moves_upper_face(const std::string& spec);

/// Expressions and action units, NAME[:STRENGTH[:left|right]], several joined by "+" (their
/// excitations add up), which begin at 0 s and are complete at 0.5 s; or a CSV file with a column
/// time_s and, with values from 0 to 1, columns for muscles (left_risorius), or for both sides
/// their kinds (risorius), and for expressions and action units (AU12, left_AU12), which add up. A
/// side excites the muscles of that side and those in the middle. throws: InputError as
/// check_expression(), and with file, line and value.
Expression make_expression(const std::string& spec, std::span<const FaceMuscle> muscles);

}  // namespace condyle
