#pragma once

#include <span>
#include <string>
#include <vector>

#include "sim/case/face_muscle.h"
#include "sim/muscles/excitation_curve.h"

namespace condyle {

/// Excitation of the muscles of the face over time.
struct Expression {
  struct Channel {
    ExcitationCurve curve;
    std::vector<std::size_t> muscles;  // that it excites
  };
  std::string name;
  double duration_s = 0;
  std::size_t muscles = 0;
  std::vector<Channel> channels;

  /// One value from 0 to 1 for each muscle; constant beyond the ends.
  std::vector<double> at(double time_s) const;
};

/// Names of the built-in expressions.
std::vector<std::string> builtin_expressions();

/// Checks a name, its strength and its side, and that a file exists. throws: InputError.
void check_expression(const std::string& spec);

/// A built-in expression, NAME[:STRENGTH[:left|right]], which begins at 0 s and is complete at 0.5
/// s; or a CSV file with a column time_s and one for each muscle or, for both sides, each kind,
/// with values from 0 to 1. A side excites the muscles of that side and those in the middle.
/// throws: InputError as check_expression(), and with file, line and value.
Expression make_expression(const std::string& spec, std::span<const FaceMuscle> muscles);

}  // namespace condyle
