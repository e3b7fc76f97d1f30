#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>

#include "engine/core/error.h"
#include "engine/tissue/hessian_factor.h"
#include "engine/tissue/layered_mesh.h"
#include "sim/tissue/anchors.h"
#include "sim/tissue/attachment.h"
#include "sim/tissue/coarse_skin.h"
#include "sim/tissue/columns.h"
#include "sim/tissue/face_display.h"
#include "sim/tissue/flattened_skin.h"
#include "sim/tissue/model.h"
#include "sim/tissue/placement.h"
#include "sim/tissue/rest_state.h"
#include "sim/tissue/tissue_defaults.h"
#include "sim/tissue/tissue_layers.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

const int default_surface_nodes = TissueSettings{}.surface_nodes;

/// The lower quartile: edges are shorter around the mouth, where motion is largest.
double short_edge(const TriMesh& mesh) {
  std::vector<double> length;
  for (const auto& [a, b] : edges_of(mesh.triangles))
    length.push_back((mesh.vertices[b] - mesh.vertices[a]).norm());
  const auto quartile = length.begin() + static_cast<std::ptrdiff_t>(length.size() / 4);
  std::nth_element(length.begin(), quartile, length.end());
  return *quartile;
}

/// Columns under the whole sheet. The sheet is smoothed where it folds too sharply for tissue of
/// any depth; the displayed face keeps its shape.
std::vector<Column> make_columns(CoarseSkin& skin, const Bones& bones, const Anatomy& anatomy,
                                 const ColumnSettings& settings, const Landmarks& landmarks,
                                 const TissuePlan& plan, const std::vector<signed char>& side,
                                 std::vector<std::string>& notes) {
  // rounds of smoothing before more of the surroundings of a few folds moves, and before triangles
  // are unfolded
  constexpr int before_widening = 12, before_ears = 20, max_rounds = 40;
  constexpr std::size_t columns_per_fold = 50;  // folds are few up to one in so many columns
  std::vector<Column> columns;
  ShapedColumns shaped;
  int rounds = 0;
  for (;; ++rounds) {
    columns = march_columns(skin, bones, settings);
    attach_columns(skin, anatomy, bones.jaw, columns);
    attach_as_planned(plan, landmarks, skin, side, bones.jaw, columns);
    shaped = shape_columns(skin, settings, columns);
    if (shaped.sound() || rounds == max_rounds) break;
    if (rounds >= before_ears) unfold_ears(skin, shaped.folded);
    const auto folded = std::count(shaped.folded.begin(), shaped.folded.end(), 1);
    const bool local = static_cast<std::size_t>(folded) * columns_per_fold <= columns.size();
    relax_folds(skin, shaped.folded, 1 + (local ? std::max(0, rounds - before_widening) / 4 : 0));
  }
  if (shaped.thinned > 0)
    notes.push_back(std::to_string(shaped.thinned) + " of " + std::to_string(columns.size()) +
                    " tissue columns were thinned where straight columns would cross");
  if (rounds > 0)
    notes.push_back("folds of the simulated sheet were smoothed in " + std::to_string(rounds) +
                    " rounds");
  return columns;
}

/// State passed between the steps of the build.
struct Build {
  const Case& patient;
  const TissueSettings& settings;
  TissuePlan plan;
  LayerStack asked_layers, layers;  // requested by the plan, and of the mesh
  Anatomy anatomy;
  Bones bones;
  SkinRegion region;
  CoarseSkin skin;
  ColumnSettings column_settings;
  std::vector<Column> columns;
  std::vector<signed char> side;  // of each column: +1 above the lip line

  Build(const Case& of, const TissueSettings& as)
      : patient(of), settings(as), plan(overlaid(of.tissue, as.plan)), bones(collect_bones(of)) {}
};

Build prepare(const Case& patient, const TissueSettings& settings, const TriMesh& face,
              TissueSummary& summary) {
  if (settings.surface_nodes < 60 || settings.surface_nodes > 50000)
    throw InputError("soft tissue: surface nodes must be 60 to 50000, not " +
                     std::to_string(settings.surface_nodes));
  check_plan(settings.plan, "soft tissue: ");
  Build build(patient, settings);
  build.asked_layers = layers_of(build.plan);
  build.anatomy = read_anatomy(patient, summary.notes);
  build.region =
      cut_region(face, patient.landmarks, build.anatomy, settings.upper_face, summary.notes);
  return build;
}

/// The columns with their layers, and the resulting mesh.
std::shared_ptr<TissueMesh> make_layers(Build& build, std::vector<std::string>& notes) {
  auto [skin, columns] = std::tie(build.skin, build.columns);
  ColumnSettings& column_settings = build.column_settings;
  column_settings.finer = build.settings.surface_nodes / static_cast<double>(default_surface_nodes);
  build.layers = column_settings.finer > 1
                     ? split_layers(build.asked_layers, column_settings.default_depth_mm,
                                    short_edge(skin.mesh), HessianFactor::most_per_column - 1)
                     : build.asked_layers;
  if (build.layers.fraction.size() > build.asked_layers.fraction.size())
    notes.push_back(fmt::format(
        "layers are cut, {} into {}: springs of so fine a mesh would not fill them evenly",
        build.asked_layers.fraction.size(), build.layers.fraction.size()));
  column_settings.layer_fraction = build.layers.fraction;
  const auto sides = [&] {
    return sides_of(skin.mesh, skin.mouth, build.region.fissure, tissue_defaults::side_reach_mm)
        .side;
  };
  columns = make_columns(skin, build.bones, build.anatomy, column_settings, build.patient.landmarks,
                         build.plan, sides(), notes);
  check_placement(skin, build.bones, columns, column_settings, notes);
  build.side = sides();

  auto mesh = std::make_shared<TissueMesh>();
  mesh->cut_from = build.layers.cut_from;
  mesh->columns = static_cast<int>(columns.size());
  mesh->sheets = static_cast<int>(build.layers.fraction.size()) + 1;
  mesh->triangles = skin.mesh.triangles;
  mesh->rest = column_nodes(skin, columns, column_settings);
  const double parted = part_closed_lips(
      {skin, columns, build.side, mesh->sheets, mesh->rest, {}, {}, {}, build.bones.jaw},
      mesh->rest);
  if (parted > 0.5)
    notes.push_back("the simulated lips overlapped: separated by up to " +
                    fmt::format("{:.1f} mm", parted));
  mesh->elements = make_elements(build.plan, build.layers, skin.mesh.triangles, mesh->rest);
  return mesh;
}

/// Where prisms of the mesh are inverted: their columns.
std::vector<int> inverted_columns(const TissueMesh& mesh) {
  std::vector<int> columns;
  for (std::size_t p = 0; p < mesh.elements.prisms.size(); ++p)
    if (mesh.elements.rest_volume[p] <= 0)
      for (int node : mesh.elements.prisms[p]) columns.push_back(node / mesh.sheets);
  std::sort(columns.begin(), columns.end());
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  return columns;
}

/// The mesh below the skin, which is flattened where no tissue fits below it: more widely until it
/// does.
std::shared_ptr<TissueMesh> make_mesh(Build& build, TissueSummary& summary) {
  constexpr double flattened_mm = 6;  // around such places, and as much more each time
  constexpr int most_times = 3;
  SkinRegion region = build.region;
  std::optional<Vector3d> folded;  // on the skin itself
  const auto refused = [&] {
    return InputError(
        fmt::format("face: the skin folds near ({:.1f}, {:.1f}, {:.1f}) mm so that tissue below it "
                    "would turn inside out; smooth the face there",
                    folded->x(), folded->y(), folded->z()));
  };
  for (int times = 0;; ++times) {
    try {
      std::vector<std::string> notes;
      build.skin = make_coarse_skin(region, build.settings.surface_nodes);
      const TriMesh sheet = build.skin.mesh;
      std::shared_ptr<TissueMesh> mesh = make_layers(build, notes);
      const std::vector<int> inverted = inverted_columns(*mesh);
      if (inverted.empty()) {
        summary.notes.insert(summary.notes.end(), notes.begin(), notes.end());
        if (times > 0)
          summary.notes.push_back("the simulated sheet is flat where the skin folds too sharply");
        return mesh;
      }
      if (!folded) folded = sheet.vertices[inverted.front()];
      if (times == most_times) throw refused();
      std::vector<Vector3d> places;
      for (int column : inverted) places.push_back(sheet.vertices[column]);
      region.mesh = flattened_near(region.mesh, places, (times + 1) * flattened_mm);
    } catch (const InputError&) {
      if (!folded) throw;
      throw refused();
    }
  }
}

/// Anchors and contact.
void support_tissue(const Build& build, TissueMesh& mesh, TissueModel& model) {
  const double firmness = firmness_over_default(build.asked_layers);
  const std::vector<char> attached =
      add_anchors({.skin = build.skin,
                   .columns = build.columns,
                   .bones = build.bones,
                   .finer = build.column_settings.finer,
                   .depth_fraction = static_cast<double>(build.asked_layers.fraction.size()) /
                                     static_cast<double>(build.layers.fraction.size()),
                   .firmness = firmness},
                  mesh, model.support, model.summary);

  const JawBodies& jaw = build.bones.jaw;
  OpeningPath path;
  path.condyles = build.anatomy.condyles;
  const Pose wide_open = path.pose(tissue_defaults::widest_rad);
  const std::array<BodySurface, 2> surfaces{
      {{jaw.upper_arch, jaw_mesh(build.patient, jaw.upper_arch)},
       {jaw.lower_arch, jaw_mesh(build.patient, jaw.lower_arch)}}};
  TissueContact contact = make_contact({build.skin, build.columns, build.side, mesh.sheets,
                                        mesh.rest, attached, model.support.node, wide_open, jaw},
                                       surfaces, build.settings.threads);
  contact.firmness = firmness;
  mesh.elements.may_touch = lip_contact_pairs(contact, mesh.rest);
  model.contact = std::make_shared<const TissueContact>(std::move(contact));
  model.opening.body = jaw.lower_arch;
  model.opening.along = {jaw.lower_arch};
}

}  // namespace

std::shared_ptr<const TissueModel> build_tissue(const Case& patient, const TissueSettings& settings,
                                                const Progress& progress) {
  const Part* face = patient.find(Role::face);
  if (!face || face->mesh.empty()) return nullptr;
  auto model = std::make_shared<TissueModel>();
  TissueSummary& summary = model->summary;

  report(progress, "soft tissue: skin", 0.0);
  Build build = prepare(patient, settings, face->mesh, summary);
  report(progress, "soft tissue: layers", 0.5);
  const std::shared_ptr<TissueMesh> mesh = make_mesh(build, summary);
  model->mesh = mesh;
  report(progress, "soft tissue: contact", 0.55);
  support_tissue(build, *mesh, *model);
  // Nothing moves before surgery: initial strains balance skin pretension and weight.
  const TissuePlan& plan = build.plan;
  if (plan.down)
    model->support.node_force = weight_of_nodes(mesh->elements, plan.down->normalized());
  if (plan.down || plan.turgor.value_or(1) < 1) balance(*mesh, *model);
  prepare_elements(*mesh);

  report(progress, "soft tissue: opening path", 0.6);
  std::future<std::shared_ptr<const FaceDisplay>> display =
      std::async(settings.threads > 1 ? std::launch::async : std::launch::deferred, [&] {
        return make_face_display(*mesh, build.region, build.skin, build.columns, build.side,
                                 face->mesh);
      });
  make_opening_path(build.anatomy.condyles, *model, settings.threads);
  report(progress, "soft tissue: displayed face", 0.8);
  model->display = display.get();

  model->muscles = muscles_in_mesh(*mesh, model->support, settings.face_muscles,
                                   model->display->region.upper_face);
  summary.nodes = mesh->elements.node_count;
  summary.springs =
      static_cast<int>(mesh->elements.spring_a.size() + mesh->elements.anchor_node.size());
  summary.prisms = static_cast<int>(mesh->elements.prisms.size());
  summary.layers = static_cast<int>(build.asked_layers.fraction.size());
  summary.lips_cut = build.region.mouth.found();
  measure_rest(*model, settings.threads);
  report(progress, "soft tissue", 1.0);
  return model;
}

const TissueSummary& summary(const TissueModel& model) { return model.summary; }
const std::vector<FaceMuscle>& face_muscles_of(const TissueModel& model) {
  return model.muscles.muscles;
}
std::vector<double> face_muscle_lengths(const TissueModel& model, const TissueState& state) {
  return muscle_lengths(model.muscles, state.nodes, poses_from_mesh(model, state.X_CB));
}

}  // namespace condyle
