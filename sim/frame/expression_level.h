#pragma once

#include <string>

namespace condyle {

/// Strength of an expression of the face, or of an action unit, on each side, 0 to 1.
struct ExpressionLevel {
  std::string name;
  double left = 0, right = 0;
  bool operator==(const ExpressionLevel&) const = default;
};

}  // namespace condyle
