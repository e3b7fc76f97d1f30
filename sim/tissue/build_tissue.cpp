#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "engine/core/error.h"
#include "engine/math/smooth_step.h"
#include "engine/tissue/equilibrium.h"
#include "engine/tissue/layered_net.h"
#include "engine/tissue/net_weights.h"
#include "sim/tissue/attachment.h"
#include "sim/tissue/coarse_skin.h"
#include "sim/tissue/columns.h"
#include "sim/tissue/model.h"
#include "sim/tissue/placement.h"
#include "sim/tissue/tissue_layers.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

// Of each node of the usual net; see `tissue_of_columns` for others.
constexpr double bone_stiffness = 2.0;       // N/mm, some 50 times a skin spring
constexpr double boundary_stiffness = 2.0;   // N/mm
constexpr double cartilage_stiffness = 0.5;  // N/mm
constexpr double neck_stiffness = 0.1;       // N/mm
constexpr double loose_stiffness = 0.15;     // N/mm
/// N/mm, of what lies above the inner side under the chin: fat and platysma hang on jaw and neck
/// through their whole depth. Without them the skin snaps from fold to fold as the mouth opens.
constexpr double platysma_stiffness = 0.05;
/// N/mm: the muscles of a lip hold its inner side to its own jaw, so that it does not roll over the
/// teeth's edges.
constexpr double lip_stiffness = 0.3;
constexpr double lip_margin_mm = 14;  // from the mouth's line
/// N/mm: and, much less, the whole of its edge, which would buckle to and fro.
constexpr double lip_edge_stiffness = 0.15;
constexpr double lip_edge_mm = 6;

/// How much the rim of a face that ends below the jaw goes with the mandible: fully at it, not at
/// all from this far on.
double rim_follows(double to_mandible_mm) { return 1 - smooth_step((to_mandible_mm - 15) / 65); }

/// N/mm of a bone spring.
double held_stiffness(double firm) {
  return loose_stiffness * std::pow(bone_stiffness / loose_stiffness, firm);
}

/// The share of a lip's inner side: with its own jaw but near the corners.
double lip_share(double share) { return smooth_step(smooth_step(share)); }

/// How much the displayed face evens out the motion of a column: the coarse net of neck and jaw
/// folds more sharply than skin does; at the mouth it is fine enough.
double evened(double to_mouth_mm) { return 0.6 * smooth_step((to_mouth_mm - 35) / 25); }

const int usual_surface_nodes = TissueSettings{}.surface_nodes;
constexpr double side_reach_mm = 30;  // along the skin from the mouth's line

constexpr double widest_rad = 0.75;  // of the jaw's opening

/// The lower quartile: edges are shorter about the mouth, where most moves.
double short_edge(const TriMesh& mesh) {
  std::vector<double> length;
  for (const auto& [a, b] : edges_of(mesh.triangles))
    length.push_back((mesh.vertices[b] - mesh.vertices[a]).norm());
  const auto quartile = length.begin() + static_cast<std::ptrdiff_t>(length.size() / 4);
  std::nth_element(length.begin(), quartile, length.end());
  return *quartile;
}

/// How much tissue each column stands for, as a share of what it does in the usual net: of an area,
/// on a border of a length. On the mouth's line, where the usual net gives each the springs of a
/// whole area and it has half of one, the other half is the line's.
std::vector<double> tissue_of_columns(const CoarseSkin& skin, double finer) {
  const double by_area = 1 / finer, by_length = std::sqrt(by_area);
  std::vector<double> share(skin.mesh.vertices.size(), by_area);
  for (std::size_t c = 0; c < share.size(); ++c)
    if (skin.rim[c] || skin.border[c]) share[c] = by_length;
  for (const auto* lip : {&skin.mouth.upper, &skin.mouth.lower})
    for (int c : *lip) share[c] = 0.5 * (by_area + by_length);
  return share;
}

/// Solves a plain opening knot by knot, and keeps a factor at each: the tissue of the
/// lower face turns with the jaw, and a factor made unturned asks for several times the iterations.
void make_path(TissueModel& model, int threads) {
  constexpr int knots = 13;  // to 43 degrees
  model.runs = std::make_shared<const NetRuns>(model.net);
  model.factors.push_back(
      {0, std::make_shared<HessianFactor>(model.net, touching_loads(model, Pose{}, model.rest),
                                          model.sheets, model.rest, threads)});
  TissueState state = rest_tissue(model);
  std::vector<Nodes> nodes{model.rest};
  TissueBudget budget;
  budget.tolerance_mm = 2e-3;
  budget.max_iterations = 300;
  budget.threads = threads;
  for (int i = 1; i < knots; ++i) {
    const double angle = i * model.path.step_rad;
    state = follow(model, state, model.path.pose(angle), budget);
    if (!state.converged || state.inverted_prisms > 0) break;  // as far as this tissue opens
    nodes.push_back(state.nodes);
    model.factors.push_back(
        {angle - model.path.step_rad / 2,
         std::make_shared<HessianFactor>(model.net, touching_loads(model, state.X_CM, state.nodes),
                                         model.sheets, state.nodes, threads)});
  }
  model.path.nodes = std::move(nodes);
}

/// Nothing moves before surgery: strains carry turgor and weight, and what they cannot carry is
/// held and told.
void balance(TissueModel& model) {
  const Equilibrium balanced = balance_strains(model.net, loads_at(model, Pose{}), model.rest);
  model.anchor_offset = balanced.anchor_offset;
  if (!balanced.stable)
    model.summary.notes.push_back(
        "turgor and weight leave the tissue at rest where a touch would move it: turgor nearer "
        "to 1 or more layers are steadier");
  model.held_force = balanced.held;
  if (balanced.held.empty()) return;
  constexpr double worth_telling_N = 1e-4;
  if (balanced.force_held < worth_telling_N) return;
  model.summary.notes.push_back(fmt::format(
      "strains alone cannot balance this turgor and weight everywhere: constant forces of up to "
      "{:.2g} N hold the rest at {} of {} points",
      balanced.force_held, balanced.nodes_held, model.rest.size()));
}

/// How still the unmoved model stands, and how it lies on the bones.
void tell_rest(TissueModel& model, int threads) {
  TissueSummary& summary = model.summary;
  Nodes force;
  NetLoads loads = touching_loads(model, Pose{}, model.rest);
  SpringPrismEnergy(model.net, loads, 1).value_and_gradient(model.rest, force);
  for (const auto& f : force) summary.rest_force_N = std::max(summary.rest_force_N, f.norm());
  TissueBudget budget;
  budget.tolerance_mm = 1e-6;
  budget.threads = threads;
  const TissueState still = follow(model, rest_tissue(model), Pose{}, budget);
  summary.rest_move_mm = largest_way(model.rest, still.nodes);
  if (still.kept || !still.converged)
    summary.notes.push_back("the unmoved tissue could not be solved: it may move by itself");
  else if (summary.rest_move_mm > 1e-4)
    summary.notes.push_back("the unmoved tissue moves by " + std::to_string(summary.rest_move_mm) +
                            " mm: turgor and weight could not be balanced everywhere");
  summary.lip_points_left_out = model.contact.lip_points_left_out;
  summary.rest_overlap_mm =
      measure_contact(model.contact, Looks(contact_lists), Pose{}, model.rest, model.rest)
          .rest_overlap_mm;
  constexpr double usual_mm = 4;  // real faces in their places: up to 2.8
  if (summary.rest_overlap_mm > usual_mm)
    summary.notes.push_back(fmt::format(
        "tissue lies up to {:.1f} mm deep in bone, teeth or the other lip at rest, and may stay "
        "there: are face and bones of the same patient, and in the same place?",
        summary.rest_overlap_mm));
}

/// Columns under the whole sheet. Where the sheet itself folds too sharply for tissue of any depth
/// it is smoothed; the displayed face keeps its shape.
std::vector<Column> make_columns(CoarseSkin& skin, const Bones& bones, const Anatomy& anatomy,
                                 const ColumnSettings& settings, const Landmarks& landmarks,
                                 const TissuePlan& plan, const std::vector<signed char>& side,
                                 std::vector<std::string>& notes) {
  constexpr int before_ears = 20, most_rounds = 25;  // where all before did not do
  std::vector<Column> columns;
  ShapedColumns shaped;
  int rounds = 0;
  for (;; ++rounds) {
    columns = march_columns(skin, bones, settings);
    hold_columns(skin, anatomy, columns);
    hold_as_planned(plan, landmarks, skin, side, columns);
    shaped = shape_columns(skin, settings, columns);
    if (shaped.sound() || rounds == most_rounds) break;
    if (rounds >= before_ears) unfold_ears(skin, shaped.folded);
    relax_folds(skin, shaped.folded);
  }
  if (shaped.thinned > 0)
    notes.push_back(std::to_string(shaped.thinned) + " of " + std::to_string(columns.size()) +
                    " tissue columns were made thinner, where straight ones would cross");
  if (rounds > 0)
    notes.push_back("folds of the simulated sheet were smoothed in " + std::to_string(rounds) +
                    " rounds");
  return columns;
}

}  // namespace

std::shared_ptr<const TissueModel> build_tissue(const Case& patient, const TissueSettings& settings,
                                                const Progress& progress) {
  const Part* face = patient.find(Role::face);
  if (!face || face->mesh.empty()) return nullptr;
  if (settings.surface_nodes < 60 || settings.surface_nodes > 50000)
    throw InputError("soft tissue: surface nodes must be 60 to 50000, not " +
                     std::to_string(settings.surface_nodes));
  check_plan(settings.plan, "soft tissue: ");
  const TissuePlan plan = overlaid(patient.tissue, settings.plan);
  const LayerStack asked_layers = layers_of(plan);
  auto model = std::make_shared<TissueModel>();
  TissueSummary& summary = model->summary;

  report(progress, "soft tissue: skin", 0.0);
  const Anatomy anatomy = read_anatomy(patient, summary.notes);
  const Bones bones = collect_bones(patient);
  const SkinRegion region = cut_region(face->mesh, patient.landmarks, anatomy, summary.notes);
  CoarseSkin skin = make_coarse_skin(region, settings.surface_nodes);

  report(progress, "soft tissue: layers", 0.5);
  ColumnSettings column_settings;
  column_settings.finer = settings.surface_nodes / static_cast<double>(usual_surface_nodes);
  const LayerStack layers =
      column_settings.finer > 1
          ? split_layers(asked_layers, column_settings.default_depth_mm, short_edge(skin.mesh))
          : asked_layers;
  if (layers.share.size() > asked_layers.share.size())
    summary.notes.push_back(fmt::format(
        "layers are cut, {} into {}: springs of a net this fine would not fill them evenly",
        asked_layers.share.size(), layers.share.size()));
  column_settings.layer_share = layers.share;
  const auto columns =
      make_columns(skin, bones, anatomy, column_settings, patient.landmarks, plan,
                   sides_of(skin.mesh, skin.mouth, region.slit, side_reach_mm), summary.notes);
  check_placement(skin, bones, columns, column_settings, summary.notes);
  const int sheets = static_cast<int>(layers.share.size()) + 1;
  model->cut_from = layers.cut_from;
  model->columns = static_cast<int>(columns.size());
  model->sheets = sheets;
  model->triangles = skin.mesh.triangles;
  model->rest = column_nodes(skin, columns, column_settings);
  model->slit = region.slit;
  model->handle_side = sides_of(skin.mesh, skin.mouth, model->slit, side_reach_mm);
  const double parted = part_closed_lips(
      {skin, columns, model->handle_side, sheets, model->rest, {}, {}, {}}, model->rest);
  if (parted > 0.5)
    summary.notes.push_back("the simulated lips overlapped: parted by up to " +
                            fmt::format("{:.1f} mm", parted));
  model->net = net_of(plan, layers, skin.mesh.triangles, model->rest);
  SpringPrismNet& net = model->net;
  for (std::size_t p = 0; p < net.prisms.size(); ++p)
    if (net.rest_volume[p] <= 0) {
      const Vector3d& at = model->rest[net.prisms[p][0]];
      throw InputError(
          fmt::format("face: the skin folds near ({:.1f}, {:.1f}, {:.1f}) mm so that tissue below "
                      "it would turn inside out; smooth the face there",
                      at.x(), at.y(), at.z()));
    }

  // Bone springs.
  std::vector<int> given;
  std::vector<double> given_share;
  const auto tissue_share = tissue_of_columns(skin, column_settings.finer);
  const double depth_share =
      static_cast<double>(asked_layers.share.size()) / static_cast<double>(layers.share.size());
  const double firmness = firmness_over_usual(asked_layers);
  const auto anchor = [&](int node, double share, double stiffness) {
    const bool inner = node % sheets == sheets - 1;
    stiffness *= firmness * tissue_share[node / sheets] * (inner ? 1 : depth_share);
    net.anchor_node.push_back(node);
    net.anchor_stiffness.push_back(stiffness);
    model->anchor_share.push_back(share);
  };
  for (int c = 0; c < model->columns; ++c) {
    const int inner = node_of(c, sheets - 1, sheets);
    if (skin.rim[c]) continue;
    if (columns[c].hold != Hold::free) {
      const double share = columns[c].hold == Hold::mandible ? 1 : 0;
      anchor(inner, share, held_stiffness(columns[c].firm));
      given.push_back(inner);
      given_share.push_back(share);
      if (columns[c].cartilage)
        for (int s = 0; s + 1 < sheets; ++s)
          anchor(node_of(c, s, sheets), share, cartilage_stiffness);
      ++(columns[c].hold == Hold::mandible ? summary.attached_to_mandible
                                           : summary.attached_to_cranium);
    }
  }

  check_attachment(summary.attached_to_cranium, summary.attached_to_mandible, bones, summary.notes);

  // Boundary springs: every node of the rim stays put. A border of the face's own (a mask that ends
  // below the jaw) goes with the mandible as far as the tissue wants to and the distance allows.
  for (int c = 0; c < model->columns; ++c)
    if (skin.rim[c])
      for (int s = 0; s < sheets; ++s) {
        given.push_back(node_of(c, s, sheets));
        given_share.push_back(0);
        anchor(node_of(c, s, sheets), 0, boundary_stiffness);
        ++summary.boundary;
      }
  const auto wish = harmonic_shares(net, given, given_share);
  for (int c = 0; c < model->columns; ++c)
    if (skin.border[c] && !skin.rim[c])
      for (int s = 0; s < sheets; ++s) {
        const int node = node_of(c, s, sheets);
        const double distance =
            bones.mandible.empty() ? 1e9 : bones.mandible.nearest(model->rest[node]).distance;
        const double share = wish[node] * rim_follows(distance);
        if (s + 1 == sheets && columns[c].hold != Hold::free) continue;
        given.push_back(node);
        given_share.push_back(share);
        anchor(node, share, boundary_stiffness);
        ++summary.boundary;
      }
  model->node_share = harmonic_shares(net, given, given_share);

  // What is not grown on bone still hangs on both by loose tissue: one weak spring to each, with
  // the node's share. Without it the inner sheet of a stretched cheek may fold either way.
  std::vector<char> held(net.node_count, 0);
  for (int node : net.anchor_node) held[node] = 1;
  for (int c = 0; c < model->columns; ++c) {
    const int inner = node_of(c, sheets - 1, sheets);
    if (held[inner]) continue;
    const bool neck = columns[c].ground == Ground::none;
    const bool lip = columns[c].to_mouth < lip_margin_mm;
    const double share = model->node_share[inner];
    anchor(inner, lip && !neck ? lip_share(share) : share,
           neck  ? neck_stiffness
           : lip ? lip_stiffness
                 : loose_stiffness);
    if (!neck && columns[c].to_mouth > lip_edge_mm) continue;
    for (int s = 0; s + 1 < sheets; ++s) {
      const int node = node_of(c, s, sheets);
      if (held[node]) continue;
      const double own = model->node_share[node];
      if (neck)
        anchor(node, own, platysma_stiffness);
      else
        anchor(node, lip_share(own), lip_edge_stiffness);
    }
  }

  // What is held loosely still slides.
  for (int c = 0; c < model->columns; ++c)
    if (!skin.rim[c] && columns[c].firm < 0.5) held[node_of(c, sheets - 1, sheets)] = 0;

  report(progress, "soft tissue: contact", 0.55);
  model->path.condyles = anatomy.condyles;
  model->contact = make_contact({skin, columns, model->handle_side, sheets, model->rest, held,
                                 model->node_share, model->path.pose(widest_rad)},
                                jaw_mesh(patient, Body::cranium), jaw_mesh(patient, Body::mandible),
                                settings.threads);
  model->contact.firmness = firmness;
  net.may_touch = lips_that_may_touch(model->contact, model->rest);

  // Nothing moves before surgery: strains that carry turgor and weight.
  if (plan.down) model->node_force = weight_of_nodes(net, plan.down->normalized());
  if (plan.down || plan.turgor.value_or(1) < 1) balance(*model);

  report(progress, "soft tissue: path of opening", 0.6);
  make_path(*model, settings.threads);

  report(progress, "soft tissue: displayed face", 0.8);
  model->region = region.shape;
  model->handles = make_handles(skin.mesh.triangles, sheets, model->rest);
  for (int c = 0; c < model->columns; ++c)
    model->handle_evened.push_back(skin.rim[c] || skin.border[c] ? 0 : evened(columns[c].to_mouth));
  model->face_rest = face->mesh.vertices;
  model->face_side = region.face_side;
  for (std::size_t v = 0; v < model->face_rest.size(); ++v) {
    const CarriedPoint point = carry_face_point(*model, model->face_rest[v], model->face_side[v]);
    if (point.fade <= 0) continue;
    model->carried_vertex.push_back(static_cast<int>(v));
    model->carried.push_back(point);
  }

  summary.nodes = net.node_count;
  summary.springs = static_cast<int>(net.spring_a.size() + net.anchor_node.size());
  summary.prisms = static_cast<int>(net.prisms.size());
  summary.layers = static_cast<int>(asked_layers.share.size());
  summary.lips_cut = region.mouth.found();
  tell_rest(*model, settings.threads);
  report(progress, "soft tissue", 1.0);
  return model;
}

const TissueSummary& summary(const TissueModel& model) { return model.summary; }

}  // namespace condyle
