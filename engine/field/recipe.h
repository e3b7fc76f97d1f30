#pragma once

#include <vector>

#include "engine/field/primitives.h"

namespace condyle {

/// The half of space in which a solid is described.
enum class Symmetry { none, mirror_x };  // mirror_x: the field at x is the field at |x|

/// A solid made by joining and cutting primitives in order, each with its own rounding k (mm).
/// Farther from a primitive than the widest rounding applied to it, only its box counts, which does
/// not change the surface.
class FieldRecipe {
 public:
  explicit FieldRecipe(Symmetry symmetry = Symmetry::none) : symmetry_(symmetry) {}

  void add(Primitive primitive, double k);   // union
  void cut(Primitive primitive, double k);   // minus the primitive
  void keep(Primitive primitive, double k);  // intersection; acts everywhere

  /// Signed distance, mm; `nothing` far from every primitive.
  double operator()(const Eigen::Vector3d& p) const;

  /// Indices of the steps that can affect the inside of a box.
  std::vector<int> steps_near(const Eigen::AlignedBox3d& box) const;
  std::vector<int> steps_near(const Eigen::AlignedBox3d& box, const std::vector<int>& among) const;
  /// Signed distance by these steps only.
  double value(const Eigen::Vector3d& p, const std::vector<int>& steps) const;

  Symmetry symmetry() const { return symmetry_; }
  /// The whole solid as one primitive of another recipe.
  Primitive as_primitive(const Eigen::AlignedBox3d& box) const;

  static constexpr double nothing = 50;  // mm, before the first step

 private:
  enum class Act { add, cut, keep };
  struct Step {
    Act act;
    Primitive primitive;
    double k, margin;
    Eigen::AlignedBox3d reach;  // the primitive's box grown by the margin
  };
  static bool act_everywhere(Act act) { return act == Act::keep; }
  void push(Act act, Primitive primitive, double k);
  /// The box in |x|, where the recipe is mirrored.
  Eigen::AlignedBox3d folded(Eigen::AlignedBox3d box) const;
  static double apply(const Step& step, double d, const Eigen::Vector3d& p);

  Symmetry symmetry_;
  std::vector<Step> steps_;
};

}  // namespace condyle
