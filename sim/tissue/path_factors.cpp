#include "sim/tissue/path_factors.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/frame/body_poses.h"
#include "sim/tissue/tissue_defaults.h"

namespace condyle {

PathFactors::PathFactors(const TissueModel& model, int threads)
    : threads_(threads),
      mesh_(model.mesh),
      contact_(model.contact),
      planned_(model.planned),
      path_(model.opening.path),
      along_(model.opening.along),
      of_knot_(tissue_defaults::path_knots) {}

PathFactors::Factor PathFactors::make(std::size_t knot) const {
  BodyPoses at;
  if (knot > 0)
    for (const BodyId body : along_)
      at[body] = path_->pose(static_cast<double>(knot) * path_->step_rad);
  const Nodes& rest = planned_ ? planned_->nodes : mesh_->rest;
  const Nodes& x = knot == 0 ? rest : path_->nodes[knot];
  MeshLoads loads;
  set_contacts(find_tissue_contacts(*contact_, mesh_->own_stiffness,
                                    poses_from_mesh(planned_.get(), at.X_CB), x, threads_),
               loads);
  return std::make_shared<HessianFactor>(mesh_->elements, loads, mesh_->sheets, x, threads_);
}

PathFactors::Factor PathFactors::of(std::size_t knot) const {
  {
    const std::lock_guard lock(mutex_);
    if (of_knot_[knot]) return of_knot_[knot];
  }
  // Outside the lock: whoever waits for it may do so in a loop that this one is divided over.
  Factor made = make(knot);
  const std::lock_guard lock(mutex_);
  if (!of_knot_[knot]) of_knot_[knot] = std::move(made);
  return of_knot_[knot];
}

std::shared_ptr<const HessianFactor> PathFactors::nearest(double turned_rad) const {
  const std::size_t last = std::max<std::size_t>(path_->nodes.size(), 1) - 1;
  const double knot = std::floor(turned_rad / path_->step_rad + 0.5);
  return of(static_cast<std::size_t>(std::clamp(knot, 0.0, static_cast<double>(last))));
}

int PathFactors::made() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(std::count_if(of_knot_.begin(), of_knot_.end(),
                                        [](const Factor& factor) { return factor != nullptr; }));
}

int PathFactors::most() const {
  return static_cast<int>(std::max<std::size_t>(path_->nodes.size(), 1));
}

std::size_t PathFactors::bytes() const {
  const std::lock_guard lock(mutex_);
  std::size_t sum = 0;
  for (const Factor& factor : of_knot_)
    if (factor) sum += factor->bytes() + factor->shared_bytes();
  return sum;
}

std::size_t PathFactors::bytes_of_one() const {
  const Factor first = of(0);
  return first->bytes() + first->shared_bytes();
}

}  // namespace condyle
