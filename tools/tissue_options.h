#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/case/tissue_plan.h"

namespace CLI {
class App;
}

namespace condyle {

/// Deviations of the soft tissue from the case's own, unparsed.
struct TissueOptions {
  bool simulated = true;
  int surface_nodes = 520;
  std::optional<int> layers = {};
  std::optional<double> turgor = {}, lambda = {};
  std::string gravity = {};
  bool glued = false;
  std::vector<std::string> attach = {}, detach = {};
};

/// The group "Tissue".
void add_tissue(CLI::App& command, TissueOptions& tissue);

/// The command line's plan of the soft tissue. throws: InputError naming option and value.
TissuePlan parse_tissue(const TissueOptions& options);

}  // namespace condyle
