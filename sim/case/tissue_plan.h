#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "sim/frame/part.h"

namespace condyle {

/// One layer of soft tissue; what is not given is as usual.
struct TissueLayer {
  double share = 1;                                  // of the thickness; all add up to 1
  std::optional<double> modulus_MPa = std::nullopt;  // of the layer's springs
  std::optional<double> poisson = std::nullopt;      // Poisson's ratio: against change of volume
  std::optional<double> mass_kg = std::nullopt;      // of the whole layer; else 1 kg a litre
};

/// Where tissue that lies on a bone is attached to it, or is not, unlike usual.
struct AttachmentRegion {
  Body bone = Body::cranium;  // or mandible
  bool attached = true;
  std::string landmark;                              // its middle; empty: `centre`
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // mm
  double radius_mm = 10;
};

/// What tissue that is not attached does where it lies on bone or teeth.
enum class TissueBond { sliding, glued };

/// How the soft tissue of a patient is modelled; what is not given is as usual.
struct TissuePlan {
  std::optional<int> layer_count = std::nullopt;  // of usual layers: 1, 2, 3 (usual) or 5
  std::vector<TissueLayer> layers = {};           // from the skin inward; instead of these
  std::optional<double> turgor = std::nullopt;    // rest length of skin over its length, usual 1
  std::optional<double> lambda = std::nullopt;    // weight of springs against volumes, usual 0.5
  std::optional<Eigen::Vector3d> down = std::nullopt;  // where weight pulls; usual: no weight
  std::optional<TissueBond> bond = std::nullopt;       // usual: sliding
  std::vector<AttachmentRegion> attachments = {};      // the last that holds a point counts
};

/// `plan` where `over` says nothing; attachments of both, those of `over` last.
TissuePlan overlaid(TissuePlan plan, const TissuePlan& over);

/// throws: InputError that names the item and its value, `where` before it.
void check_plan(const TissuePlan& plan, const std::string& where);

}  // namespace condyle
