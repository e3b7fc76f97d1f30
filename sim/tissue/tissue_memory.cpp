#include "sim/tissue/tissue_memory.h"

#include "sim/tissue/model_fields.h"
#include "sim/tissue/path_factors.h"

namespace condyle {
namespace {

std::size_t bytes_held(const ElementBatches& runs) {
  const auto held = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
  return held(runs.edges) + held(runs.vertical_edges) + held(runs.spring_batches) +
         held(runs.prism_columns) + held(runs.prisms) + held(runs.rest_length) +
         held(runs.stiffness) + held(runs.inverse_volume) + held(runs.volume_energy);
}

/// Of the lists that the value names as its fields, which are read only.
template <class T>
std::size_t bytes_named(const T& value) {
  ArchiveMeasure measure;
  measure(const_cast<T&>(value));
  return measure.held();
}

}  // namespace

TissueMemory memory_of(const TissueModel& model) {
  TissueMemory memory;
  const TissueContact& contact = *model.contact;
  memory.tissue = bytes_named(*model.mesh) + bytes_held(*model.mesh->runs) +
                  model.mesh->own_stiffness.capacity() * sizeof(double) +
                  bytes_named(model.support) + bytes_named(contact) +
                  bytes_named(*model.opening.path);
  for (const auto* surface : {&contact.upper.surface, &contact.lower.surface,
                              &contact.fold.chin.surface, &contact.fold.throat.surface})
    memory.tissue += surface->bytes();
  memory.displayed_face =
      bytes_named(*model.display) + model.display->face_rest.capacity() * sizeof(Eigen::Vector3d);
  for (const Obstacle& obstacle : contact.obstacles)
    memory.bone_surfaces += obstacle.surface->bytes();
  const PathFactors& factors = *model.factors;
  memory.bytes_of_a_factor = factors.bytes_of_one();  // makes the first
  memory.factors = factors.bytes();
  memory.factors_made = factors.made();
  memory.factors_most = factors.most();
  return memory;
}

}  // namespace condyle
