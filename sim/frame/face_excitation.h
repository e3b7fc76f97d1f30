#pragma once

#include <algorithm>
#include <vector>

namespace condyle {

/// How far the upper lids are closed: 0 as at rest, 1 closed, below 0 raised, -1 as far as they
/// rise. Lids are drawn, not simulated: nothing measured depends on it.
struct LidClosure {
  double left = 0, right = 0;
  bool any() const { return left != 0 || right != 0; }
  bool operator==(const LidClosure&) const = default;
};

/// A closure, or the larger one that a blink adds.
inline LidClosure with_blink(const LidClosure& lids, const LidClosure& blink) {
  const auto of = [](double lid, double closes) {
    return lid < 0 ? lid + closes * (1 - lid) : std::max(lid, closes);
  };
  return {of(lids.left, blink.left), of(lids.right, blink.right)};
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
  LidClosure lids = {};              // by the muscles that close them, 0 to 1
  LidClosure raise = {};             // of the upper lids, by the muscle that raises them, 0 to 1

  bool moves_lids() const { return lids.any() || raise.any(); }
  /// The muscle that raises a lid acts on what the others leave open.
  LidClosure closure() const {
    const auto of = [](double closes, double raises) { return closes - raises * (1 - closes); };
    return {of(lids.left, raise.left), of(lids.right, raise.right)};
  }
};

}  // namespace condyle
