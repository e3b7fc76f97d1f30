#include "sim/case/tissue_plan.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/core/error.h"

namespace condyle {

TissuePlan overlaid(TissuePlan plan, const TissuePlan& over) {
  if (over.layer_count) {
    plan.layer_count = over.layer_count;
    plan.layers.clear();
  }
  if (!over.layers.empty()) plan.layers = over.layers;
  if (over.turgor) plan.turgor = over.turgor;
  if (over.lambda) plan.lambda = over.lambda;
  if (over.down) plan.down = over.down;
  if (over.bond) plan.bond = over.bond;
  plan.attachments.insert(plan.attachments.end(), over.attachments.begin(), over.attachments.end());
  return plan;
}

void check_plan(const TissuePlan& plan, const std::string& where) {
  // NaN is outside any range.
  const auto require = [&](bool holds, const std::string& item, const std::string& rule,
                           double value) {
    if (!holds) throw InputError(fmt::format("{}{} must be {}, not {}", where, item, rule, value));
  };
  if (plan.layer_count) {
    const int n = *plan.layer_count;
    require(n == 1 || n == 2 || n == 3 || n == 5, "layers", "1, 2, 3 or 5", n);
  }
  require(plan.layers.size() <= 5, "the number of layers", "at most 5",
          static_cast<double>(plan.layers.size()));
  double sum = plan.layers.empty() ? 1 : 0;
  for (const auto& layer : plan.layers) {
    require(layer.fraction >= 0.02 && layer.fraction <= 1, "a layer's share of the thickness",
            "0.02 to 1", layer.fraction);
    sum += layer.fraction;
    if (layer.modulus_MPa)
      require(*layer.modulus_MPa >= 1e-5 && *layer.modulus_MPa <= 100, "a layer's modulus (MPa)",
              "0.00001 to 100", *layer.modulus_MPa);
    if (layer.poisson)
      require(*layer.poisson >= 0.26 && *layer.poisson <= 0.499, "a layer's Poisson's ratio",
              "0.26 to 0.499", *layer.poisson);
    if (layer.mass_kg)
      require(*layer.mass_kg >= 0 && *layer.mass_kg <= 10, "a layer's mass (kg)", "0 to 10",
              *layer.mass_kg);
  }
  require(std::abs(sum - 1) < 1e-3, "the sum of the layers' shares", "1", sum);
  if (plan.turgor)
    require(*plan.turgor > 0 && *plan.turgor <= 1, "turgor", "above 0 and at most 1 (1 is none)",
            *plan.turgor);
  if (plan.lambda)
    require(*plan.lambda >= 1e-3 && *plan.lambda <= 1 - 1e-3, "lambda", "0.001 to 0.999",
            *plan.lambda);
  if (plan.down && !(plan.down->allFinite() && plan.down->norm() > 1e-6 && plan.down->norm() < 1e6))
    throw InputError(fmt::format(
        "{}the direction of gravity is {}, {}, {}; it must have a length of more than 0.000001 and "
        "less than 1000000 (its size does not matter: 0, 0, -1 is upright)",
        where, plan.down->x(), plan.down->y(), plan.down->z()));
  for (const auto& region : plan.attachments) {
    require(region.radius_mm > 0 && region.radius_mm <= 200, "the radius of an attachment (mm)",
            "above 0 and at most 200", region.radius_mm);
    require(region.centre.allFinite(), "the centre of an attachment", "finite",
            region.centre.norm());
  }
}

}  // namespace condyle
