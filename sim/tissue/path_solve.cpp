#include <array>
#include <memory>
#include <utility>

#include "sim/frame/body_poses.h"
#include "sim/tissue/model.h"
#include "sim/tissue/path_factors.h"
#include "sim/tissue/planned_rest.h"
#include "sim/tissue/tissue_defaults.h"

namespace condyle {

void make_opening_path(const Eigen::Vector3d& condyles, TissueModel& model, int threads) {
  auto path = std::make_shared<OpeningPath>();
  path->condyles = condyles;
  model.opening.path = path;
  model.factors = std::make_shared<const PathFactors>(model, threads);
  TissueState state = rest_tissue(model);
  TissueWarmStart warm;
  std::vector<Nodes> nodes{state.nodes};
  TissueBudget budget;
  budget.tolerance_mm = 2e-3;
  budget.max_iterations = 300;
  budget.threads = threads;
  for (int i = 1; i < tissue_defaults::path_knots; ++i) {
    BodyPoses at;
    for (const BodyId body : model.opening.along) at[body] = path->pose(i * path->step_rad);
    state = solve_tissue(model, state, at.X_CB, budget, warm);
    // the limit of opening for this tissue
    if (!state.converged || state.inverted_prisms > 0) break;
    nodes.push_back(state.nodes);
  }
  path->nodes = std::move(nodes);
  // Anew: without the arrays of factors that the solves needed at the same time.
  model.factors = std::make_shared<const PathFactors>(model, threads);
}

std::shared_ptr<const TissueModel> with_planned_rest(const TissueModel& model,
                                                     const TissueState& state, int threads) {
  auto planned = std::make_shared<PlannedRest>();
  planned->X_CB = state.X_CB;
  planned->nodes = state.nodes;
  std::vector<Eigen::Vector3f> face;
  deform_face(model, state, face, threads);
  for (const auto& vertex : face) planned->face.push_back(vertex.cast<double>());
  auto rested = std::make_shared<TissueModel>(model);
  rested->planned = std::move(planned);
  rested->muscles = at_new_rest(std::move(rested->muscles), state.nodes, state.X_CB);
  make_opening_path(model.opening.path->condyles, *rested, threads);
  return rested;
}

}  // namespace condyle
