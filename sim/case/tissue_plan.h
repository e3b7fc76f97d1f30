#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "sim/frame/part.h"

namespace condyle {

/// One layer of soft tissue; absent values have their defaults.
struct TissueLayer {
  double fraction = 1;                               // of the thickness; the sum is 1
  std::optional<double> modulus_MPa = std::nullopt;  // of the layer's springs
  std::optional<double> poisson = std::nullopt;  // Poisson's ratio: resistance to change of volume
  std::optional<double> mass_kg = std::nullopt;  // of the whole layer; default: 1 kg/l
};

/// A region where tissue that lies on a bone is attached or detached, unlike the default.
struct AttachmentRegion {
  BodyId bone = cranium_body;  // or mandible_body
  bool attached = true;
  std::string landmark;                              // its centre; empty: `centre`
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // mm
  double radius_mm = 10;
};

/// Behaviour of detached tissue that lies on bone or teeth.
enum class TissueBond { sliding, glued };

/// Model of a patient's soft tissue; absent values have their defaults.
struct TissuePlan {
  std::optional<int> layer_count = std::nullopt;  // of default layers: 1, 2, 3 (default) or 5
  std::vector<TissueLayer> layers = {};           // from the skin inward; instead of these
  std::optional<double> turgor = std::nullopt;    // rest length of skin over its length, default 1
  // weight of springs relative to volumes, default 0.5
  std::optional<double> lambda = std::nullopt;
  std::optional<Eigen::Vector3d> down = std::nullopt;  // direction of gravity; default: no weight
  std::optional<TissueBond> bond = std::nullopt;       // default: sliding
  std::vector<AttachmentRegion> attachments = {};  // the last region that contains a point applies
};

/// `plan` where `over` has no value; attachments of both, those of `over` last.
TissuePlan overlaid(TissuePlan plan, const TissuePlan& over);

/// throws: InputError with the item and its value, prefixed by `where`.
void check_plan(const TissuePlan& plan, const std::string& where);

}  // namespace condyle
