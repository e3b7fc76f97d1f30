#include "sim/tissue/stored_tissue.h"

#include <utility>

#include "engine/core/user_cache.h"
#include "engine/tissue/float_kernels.h"
#include "sim/tissue/anatomy.h"
#include "sim/tissue/model_fields.h"
#include "sim/tissue/path_factors.h"
#include "sim/tissue/rest_state.h"

namespace condyle {
namespace {

constexpr const char* file_kind = "tissue";

template <class T>
std::uint64_t hash_of(const std::vector<T>& list, std::uint64_t h) {
  const std::size_t count = list.size();
  return word_hash(list.data(), count * sizeof(T), word_hash(&count, sizeof count, h));
}
std::uint64_t hash_of(const std::string& text, std::uint64_t h) {
  const std::size_t count = text.size();
  return word_hash(text.data(), count, word_hash(&count, sizeof count, h));
}

/// Of all that build_tissue() reads, but the muscles of the face. Processors that compute with
/// other vectors may round otherwise.
std::uint64_t inputs_of(const Case& patient, const TissueSettings& settings) {
  const JawBodies& jaw = patient.jaw;
  const std::size_t numbers[] = {static_cast<std::size_t>(settings.surface_nodes),
                                 static_cast<std::size_t>(settings.upper_face),
                                 usable_float_kernels().size(),
                                 usable_element_kernels().size(),
                                 index_of(jaw.upper_arch),
                                 index_of(jaw.lower_arch),
                                 index_of(jaw.left_condyle),
                                 index_of(jaw.right_condyle)};
  std::uint64_t h = word_hash(numbers, sizeof numbers);
  TissuePlan plan = overlaid(patient.tissue, settings.plan);
  ArchiveWriter of_plan;
  of_plan(plan);
  h = hash_of(of_plan.take(), h);
  for (const auto& [name, point] : patient.landmarks.points) {
    h = hash_of(name, h);
    h = word_hash(point.data(), sizeof point, h);
  }
  for (const Part& part : patient.parts) {
    if (part.role != Role::face && !collides(part.role)) continue;
    const std::size_t kind[] = {static_cast<std::size_t>(part.role), index_of(part.body)};
    h = word_hash(kind, sizeof kind, h);
    h = hash_of(part.mesh.triangles, hash_of(part.mesh.vertices, h));
  }
  return h;
}

/// Surfaces of the tissue that touch others are built again from their triangles.
template <class Archive>
void surface_fields(Archive& archive, const Nodes& rest, TissueContact& contact) {
  for (Flap* flap : {static_cast<Flap*>(&contact.upper), static_cast<Flap*>(&contact.lower),
                     &contact.fold.chin, &contact.fold.throat}) {
    auto triangles = flap->surface.triangles();
    archive(triangles);
    if constexpr (Archive::reading)
      if (!triangles.empty()) flap->surface = MeshSurface(std::move(triangles), rest);
  }
}

/// The parts of a model that are stored.
struct Stored {
  TissueMesh mesh;
  TissueSupport support;
  TissueContact contact;
  OpeningPath path;
  FaceDisplay display;
  TissueSummary summary;
};

template <class Archive>
void fields(Archive& archive, Stored& of) {
  archive(of.mesh, of.support, of.contact);
  surface_fields(archive, of.mesh.rest, of.contact);
  archive(of.path, of.display, of.summary);
}

std::string bytes_of(const TissueModel& model) {
  Stored stored{*model.mesh,         model.support,  *model.contact,
                *model.opening.path, *model.display, model.summary};
  ArchiveWriter writer;
  writer(stored);
  return writer.take();
}

/// Null where the bytes are none of this patient's model.
std::shared_ptr<const TissueModel> model_from(std::string_view bytes, const Case& patient,
                                              const TissueSettings& settings) {
  Stored stored;
  ArchiveReader reader(bytes);
  reader(stored);
  if (!reader.complete()) return nullptr;
  const Nodes& rest = stored.mesh.rest;
  for (Obstacle& obstacle : stored.contact.obstacles)
    obstacle.surface = surface_near(
        stored.contact, rest, {obstacle.body, jaw_mesh(patient, obstacle.body)}, settings.threads);
  stored.display.face_rest = patient.find(Role::face)->mesh.vertices;

  auto mesh = std::make_shared<TissueMesh>(std::move(stored.mesh));
  prepare_elements(*mesh);
  auto model = std::make_shared<TissueModel>();
  model->mesh = std::move(mesh);
  model->support = std::move(stored.support);
  model->contact = std::make_shared<const TissueContact>(std::move(stored.contact));
  model->opening = {std::make_shared<const OpeningPath>(std::move(stored.path)),
                    patient.jaw.lower_arch,
                    {patient.jaw.lower_arch}};
  model->display = std::make_shared<const FaceDisplay>(std::move(stored.display));
  model->summary = std::move(stored.summary);
  model->factors = std::make_shared<const PathFactors>(*model, settings.threads);
  model->muscles = muscles_in_mesh(*model->mesh, model->support, settings.face_muscles,
                                   model->display->region.upper_face);
  return model;
}

}  // namespace

std::shared_ptr<const TissueModel> stored_tissue(const std::filesystem::path& cache,
                                                 const Case& patient,
                                                 const TissueSettings& settings,
                                                 const Progress& progress) {
  const Part* face = patient.find(Role::face);
  if (!face || face->mesh.empty()) return nullptr;
  const ResultCache results(cache, file_kind);
  const std::uint64_t inputs = inputs_of(patient, settings);
  if (const auto bytes = results.read(inputs))
    if (auto model = model_from(*bytes, patient, settings)) return model;
  auto model = build_tissue(patient, settings, progress);
  results.write(inputs, bytes_of(*model));
  return model;
}

}  // namespace condyle
