#pragma once

#include <algorithm>
#include <vector>

namespace condyle {

/// How far the upper lids are closed, 0 open to 1 closed. Lids are drawn, not simulated: nothing
/// measured depends on it.
struct LidClosure {
  double left = 0, right = 0;
  bool any() const { return left > 0 || right > 0; }
  bool operator==(const LidClosure&) const = default;
};

/// The larger closure of each side.
inline LidClosure max_closure(const LidClosure& a, const LidClosure& b) {
  return {std::max(a.left, b.left), std::max(a.right, b.right)};
}

/// Of the muscles that close the lids: 1 healthy to 0 paralysed.
struct LidStrength {
  double left = 1, right = 1;
  bool operator==(const LidStrength&) const = default;
};

inline LidClosure operator*(const LidStrength& strength, const LidClosure& lids) {
  return {strength.left * lids.left, strength.right * lids.right};
}

/// What moves the face besides the jaw.
struct FaceExcitation {
  std::vector<double> muscles = {};  // 0 to 1, of each muscle; missing ones are relaxed
  LidClosure lids = {};
};

}  // namespace condyle
