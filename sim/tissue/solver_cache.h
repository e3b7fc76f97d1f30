#pragma once

#include <memory>
#include <vector>

#include "engine/math/pose.h"
#include "engine/tissue/async_preconditioner.h"
#include "engine/tissue/mesh_contact.h"
#include "sim/tissue/model.h"

namespace condyle {

/// What one solve of a sequence passes to the next; see TissueWarmStart.
struct SolverCache {
  std::vector<Pose> X_CB;                        // of the bodies in that solve
  std::shared_ptr<const TissueMesh> mesh;        // that the factor belongs to
  std::shared_ptr<const TissueContact> contact;  // that the contacts and distances belong to
  AsyncPreconditioner factor;  // the preconditioner, perhaps with a newer one being computed
  ContactLists touches;        // contacts with their forces
  // lower bounds of the distances to bone and teeth: they do not affect results
  NearObstacles near;
};

}  // namespace condyle
