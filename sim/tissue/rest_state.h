#pragma once

#include "sim/tissue/model.h"

namespace condyle {

/// Nothing moves before surgery: assigns the mesh the initial strains that balance skin pretension
/// and weight. A remainder that they cannot balance is held by constant forces and noted.
void balance(TissueMesh& mesh, TissueModel& model);

/// Derives from the elements at rest what a solver reads beside them.
void prepare_elements(TissueMesh& mesh);

/// Measures residual forces and motion of the unmoved model and its overlap with the bones, for the
/// summary.
void measure_rest(TissueModel& model, int threads);

}  // namespace condyle
