#include "engine/field/recipe.h"

#include <algorithm>
#include <cmath>

#include "engine/field/smooth.h"

namespace condyle {
namespace {

Eigen::AlignedBox3d grown(const Eigen::AlignedBox3d& box, double margin) {
  return {box.min().array() - margin, box.max().array() + margin};
}

}  // namespace

void FieldRecipe::push(Act act, Primitive primitive, double k) {
  const double margin = k + 3;
  // A later wide rounding still depends on an earlier primitive at that distance.
  const Eigen::AlignedBox3d wide = grown(primitive.box, margin);
  for (auto& step : steps_)
    if (step.margin < margin && grown(step.primitive.box, margin).intersects(wide)) {
      step.margin = margin;
      step.reach = act_everywhere(step.act) ? unbounded_box() : grown(step.primitive.box, margin);
    }
  const Eigen::AlignedBox3d reach = act_everywhere(act) ? unbounded_box() : wide;
  steps_.push_back({act, std::move(primitive), k, margin, reach});
}

void FieldRecipe::add(Primitive primitive, double k) { push(Act::add, std::move(primitive), k); }
void FieldRecipe::cut(Primitive primitive, double k) { push(Act::cut, std::move(primitive), k); }
void FieldRecipe::keep(Primitive primitive, double k) { push(Act::keep, std::move(primitive), k); }

double FieldRecipe::apply(const Step& step, double d, const Eigen::Vector3d& p) {
  const double e = step.primitive.distance(p);
  switch (step.act) {
    case Act::add:
      return smooth_min(d, e, step.k);
    case Act::cut:
      return smooth_max(d, -e, step.k);
    default:
      return smooth_max(d, e, step.k);
  }
}

double FieldRecipe::operator()(const Eigen::Vector3d& at) const {
  Eigen::Vector3d p = at;
  if (symmetry_ == Symmetry::mirror_x) p.x() = std::abs(p.x());
  double d = nothing;
  for (const auto& step : steps_) {
    if (step.reach.contains(p)) {
      d = apply(step, d, p);
      continue;
    }
    // Far away its box replaces it, so that the distance is continuous.
    const double far = step.primitive.box.exteriorDistance(p);
    d = step.act == Act::add ? std::min(d, far) : std::max(d, -far);
  }
  return d;
}

Eigen::AlignedBox3d FieldRecipe::folded(Eigen::AlignedBox3d box) const {
  if (symmetry_ == Symmetry::none || box.min().x() >= 0) return box;
  const double low = box.max().x() < 0 ? -box.max().x() : 0;
  box.max().x() = std::max(-box.min().x(), box.max().x());
  box.min().x() = low;
  return box;
}

std::vector<int> FieldRecipe::steps_near(const Eigen::AlignedBox3d& given) const {
  const Eigen::AlignedBox3d box = folded(given);
  std::vector<int> near;
  for (std::size_t i = 0; i < steps_.size(); ++i)
    if (steps_[i].reach.intersects(box)) near.push_back(static_cast<int>(i));
  return near;
}

std::vector<int> FieldRecipe::steps_near(const Eigen::AlignedBox3d& given,
                                         const std::vector<int>& among) const {
  const Eigen::AlignedBox3d box = folded(given);
  std::vector<int> near;
  for (const int i : among)
    if (steps_[static_cast<std::size_t>(i)].reach.intersects(box)) near.push_back(i);
  return near;
}

double FieldRecipe::value(const Eigen::Vector3d& at, const std::vector<int>& steps) const {
  Eigen::Vector3d p = at;
  if (symmetry_ == Symmetry::mirror_x) p.x() = std::abs(p.x());
  double d = nothing;
  for (const int i : steps) d = apply(steps_[static_cast<std::size_t>(i)], d, p);
  return d;
}

Primitive FieldRecipe::as_primitive(const Eigen::AlignedBox3d& box) const {
  return {[recipe = *this](const Eigen::Vector3d& p) { return recipe(p); }, box};
}

}  // namespace condyle
