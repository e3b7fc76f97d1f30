// The face as shipped, sliding on bone and teeth, beside finite elements on another mesh of the
// same tissue: twice the nodes, the same materials, anchors by area and one-sided contact.
// Smoothing of displacements without any elasticity must not pass as well.
#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "engine/minimize/minimize.h"
#include "engine/tissue/hessian_factor.h"
#include "engine/tissue/layered_mesh.h"
#include "sim/prediction/operated_tissue.h"
#include "sim/prediction/prediction.h"
#include "sim/prediction/predictor.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/model.h"
#include "tests/support/builtin.h"
#include "tests/support/real_cases.h"
#include "tests/support/wedge_elements.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Face = std::vector<Eigen::Vector3f>;
using Path = std::vector<std::vector<Pose>>;  // of the bodies

constexpr int threads = 2;

/// The tissue of a model as finite elements, followed along a path of the bodies from rest.
class ReferenceTissue {
 public:
  explicit ReferenceTissue(const TissueModel& model)
      : model_(model),
        body_(model.mesh->rest, model.mesh->elements.prisms, materials(*model.mesh)),
        near_stiffness_(model.mesh->elements) {
    // A preconditioner that is as stiff in compression as in tension.
    for (double& k : near_stiffness_.stiffness) k *= 0.5 * (1 + near_stiffness_.compression_ratio);
    near_stiffness_.compression_ratio = 1;
  }

  /// The displayed face in equilibrium at the end.
  Face followed(const Path& path) {
    state_ = rest_tissue(model_);
    contacts_.clear();
    for (std::size_t i = 0; i < path.size(); ++i) go(path[i], i + 1 == path.size());
    Face face;
    deform_face(model_, state_, face, threads);
    return face;
  }

 private:
  static std::vector<fe::Material> materials(const TissueMesh& mesh) {
    const LayerStack stack = default_layers(3);
    const std::size_t layers = static_cast<std::size_t>(mesh.sheets) - 1;
    std::vector<fe::Material> of_wedge;
    for (std::size_t p = 0; p < mesh.elements.prisms.size(); ++p) {
      const std::size_t layer = p % layers;
      const auto& [young_MPa, poisson, mass] =
          stack.material[mesh.cut_from.empty() ? layer : mesh.cut_from[layer]];
      of_wedge.push_back(fe::Material::of(young_MPa, poisson));
    }
    return of_wedge;
  }

  void go(std::span<const Pose> X_CB, bool last) {
    constexpr double firmness = 10;
    constexpr int iterations = 60, before_refactoring = 40;
    const std::vector<Pose> from_mesh = poses_from_mesh(model_, X_CB);
    MeshLoads loads = loads_at(model_, X_CB);
    OpeningPredictor with_bodies = model_.opening;
    with_bodies.path = nullptr;  // which the springs found
    Nodes x = with_bodies.extrapolated(state_.nodes, model_.support.node, state_.X_CB, X_CB);
    for (std::size_t i = 0; i < contacts_.size() && i < model_.contact->obstacles.size(); ++i) {
      const BodyId body = model_.contact->obstacles[i].body;
      move_contacts(pose_in(X_CB, body) * pose_in(state_.X_CB, body).inverse(), contacts_[i]);
    }
    fe::WedgeEnergy energy(body_, model_.mesh->elements, loads, threads);
    ASSERT_TRUE(std::isfinite(energy.value(x)));
    std::unique_ptr<HessianFactor> factor;
    int since = 0;
    MinimizeSettings settings;
    settings.tolerance_mm = last ? 2e-3 : 2e-2;
    settings.max_iterations = iterations;
    const double error_mm = last ? 0.01 : 0.1;
    const ContactSolveResult result = solve_contact(
        [&](const Nodes& at) {
          return find_tissue_contacts(*model_.contact, model_.mesh->own_stiffness, from_mesh, at,
                                      threads, nullptr, firmness);
        },
        [&](bool) {
          if (!factor)
            factor = std::make_unique<HessianFactor>(near_stiffness_, loads, model_.mesh->sheets, x,
                                                     threads);
          if (since > before_refactoring) {
            factor->refactor(near_stiffness_, loads, x, threads);
            since = 0;
          }
          const MinimizeResult solved = minimize(energy, *factor, settings, x);
          since += solved.iterations;
          return solved.converged() ? Solved::at_minimum : Solved::in_progress;
        },
        loads, x,
        {.max_contact_searches = last ? 60 : 8,
         .tolerance_mm = error_mm,
         .gap_mm = error_mm,
         .relaxed = true},
        contacts_);
    if (last) {
      EXPECT_TRUE(result.settled) << result.error_mm << ' ' << result.gap_mm;
    }
    contacts_ = result.contacts;
    state_.nodes = x;
    state_.X_CB.assign(X_CB.begin(), X_CB.end());
  }

  const TissueModel& model_;
  fe::WedgeBody body_;
  SpringPrismMesh near_stiffness_;
  TissueState state_;
  ContactLists contacts_;
};

/// The face as Condyle moves it.
Face shipped(const TissueModel& model, const Path& path) {
  TissueState state = rest_tissue(model);
  TissueWarmStart warm;
  for (const auto& X_CB : path)
    state = solve_tissue(model, state, X_CB, {.threads = threads}, warm);
  state = solve_to_equilibrium(model, state, warm, {.threads = threads});
  EXPECT_TRUE(state.converged);
  Face face;
  deform_face(model, state, face, threads);
  return face;
}

/// The face whose displacements have the least differences over the edges of the mesh, drawn to
/// those of the anchors with a weight: no elasticity and no contact.
Face smoothed(const TissueModel& model, std::span<const Pose> X_CB, double weight) {
  const auto& [elements, rest] = std::tie(model.mesh->elements, model.mesh->rest);
  const MeshLoads loads = loads_at(model, X_CB);
  std::set<std::pair<int, int>> edges;
  for (const auto& p : elements.prisms)
    for (const auto& [a, b] :
         {std::pair{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}})
      edges.insert(std::minmax(p[a], p[b]));
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& [a, b] : edges) {
    for (const int node : {a, b}) entries.emplace_back(node, node, 1);
    entries.emplace_back(std::max(a, b), std::min(a, b), -1);
  }
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(elements.node_count, 3);
  for (std::size_t i = 0; i < elements.anchor_node.size(); ++i) {
    const int node = elements.anchor_node[i];
    const double w = weight * anchor_stiffness(elements, loads, i);
    entries.emplace_back(node, node, w);
    right.row(node) += w * (loads.anchor_target[i] - rest[node]).transpose();
  }
  Eigen::SparseMatrix<double> matrix(elements.node_count, elements.node_count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::MatrixX3d moved =
      Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right);
  TissueState state = rest_tissue(model);
  for (std::size_t i = 0; i < rest.size(); ++i)
    state.nodes[i] = rest[i] + moved.row(static_cast<Eigen::Index>(i)).transpose();
  state.X_CB.assign(X_CB.begin(), X_CB.end());
  Face face;
  deform_face(model, state, face, threads);
  return face;
}

double quantile(std::vector<double> values, double fraction) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1))];
}

/// Errors of the skin that moves by more than 2 mm.
struct Errors {
  std::vector<double> mm, of_movement, moved_mm;

  bool acceptable() const {
    return quantile(mm, 0.5) <= 0.5 && quantile(of_movement, 0.5) <= 0.15 &&
           quantile(mm, 0.95) <= 1.5 && quantile(of_movement, 0.95) <= 0.40;
  }
  std::string text() const {
    char line[160];
    std::snprintf(
        line, sizeof line,
        "%6zu vertices, moved %5.2f mm: median %.2f mm (%2.0f %%), p95 %.2f mm (%2.0f %%), "
        "most %.2f mm",
        mm.size(), quantile(moved_mm, 0.5), quantile(mm, 0.5), 100 * quantile(of_movement, 0.5),
        quantile(mm, 0.95), 100 * quantile(of_movement, 0.95), quantile(mm, 1));
    return line;
  }
};

std::string region_of(const Case& patient, const Vector3d& p) {
  const Vector3d stomion = *patient.landmarks.find("stomion");
  const Vector3d from = p - stomion;
  const double lip = (*patient.landmarks.find("left_cheilion") - stomion).head<2>().norm() + 6;
  if (std::abs(from.x()) < lip && std::abs(from.z()) < 14 && from.y() < lip) return "lips";
  if (from.z() > 0) return "cheeks and nose";
  if (std::abs(from.x()) < lip && from.z() > -45) return "chin";
  return from.z() > -45 ? "jaw" : "neck";
}

using ByRegion = std::map<std::string, Errors>;
ByRegion errors_of(const Case& patient, const Face& rest, const Face& is, const Face& should) {
  ByRegion by_region;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const double moved = (should[i] - rest[i]).norm(), error = (is[i] - should[i]).norm();
    if (moved <= 2) continue;
    for (const std::string& region :
         {std::string("all"), region_of(patient, rest[i].cast<double>())}) {
      Errors& of = by_region[region];
      of.mm.push_back(error);
      of.of_movement.push_back(error / moved);
      of.moved_mm.push_back(moved);
    }
  }
  return by_region;
}

/// One patient with its shipped tissue and the finite elements.
struct Pair {
  const Case& patient;
  Case parted;  // with its lips parted
  std::shared_ptr<const TissueModel> tissue, finer;
  Face rest;

  explicit Pair(const Case& whole) : patient(whole), parted(whole) {
    part_lips(parted);
    TissueSettings settings{.threads = threads};
    tissue = build_tissue(parted, settings);
    settings.surface_nodes = 1000;
    finer = build_tissue(parted, settings);
    deform_face(*tissue, rest_tissue(*tissue), rest, threads);
  }

  Vector3d condyle(const char* side) const {
    return *patient.landmarks.find(std::string(side) + "_condyle");
  }
  /// From the condyles to the incisal point.
  double arm_mm() const {
    return (*patient.landmarks.find("lower_incisal_point") -
            0.5 * (condyle("left") + condyle("right")))
        .norm();
  }
  /// A move of the jaw in equal steps; `pose`: at a fraction of it.
  template <class PoseAt>
  Path path(int steps, const PoseAt& pose) const {
    Path along;
    for (int i = 1; i <= steps; ++i) {
      BodyPoses at;
      at[patient.jaw.lower_arch] = pose(static_cast<double>(i) / steps);
      along.push_back(at.X_CB);
    }
    return along;
  }
  /// About the condyles, which begin to translate at 10 mm.
  Path opened(double mm) const {
    const Vector3d hinge = 0.5 * (condyle("left") + condyle("right"));
    return path(static_cast<int>(std::ceil(mm / 2.5)), [&](double fraction) {
      Pose X_CM;
      X_CM.R = Eigen::Quaterniond(Eigen::AngleAxisd(fraction * mm / arm_mm(), Vector3d::UnitX()));
      const double slide = 0.3 * std::max(0.0, fraction * mm - 10);
      X_CM.t = hinge - X_CM.R * hinge + Vector3d(0, -slide, -0.6 * slide);
      return X_CM;
    });
  }
  Path protruded(double mm) const {
    return path(3, [&](double fraction) {
      Pose X_CM;
      X_CM.t = fraction * Vector3d(0, -mm, -mm / 3);
      return X_CM;
    });
  }
  /// To the left, about the right condyle, parted by 2 mm.
  Path moved_aside(double mm) const {
    return path(4, [&](double fraction) {
      Pose X_CM;
      X_CM.R = Eigen::Quaterniond(Eigen::AngleAxisd(fraction * mm / arm_mm(), Vector3d::UnitZ()));
      X_CM.t = condyle("right") - X_CM.R * condyle("right") + Vector3d(0, 0, -2 * fraction);
      return X_CM;
    });
  }
};

void expect_acceptable(const char* name, const Pair& pair, const Face& is, const Face& should) {
  for (const auto& [region, errors] : errors_of(pair.patient, pair.rest, is, should)) {
    std::printf("%-14s %-16s%s\n", name, region.c_str(), errors.text().c_str());
    if (region == "all") {
      EXPECT_TRUE(errors.acceptable()) << name << ": " << errors.text();
    }
  }
}

/// One move of the jaw.
struct Move {
  const char* name;
  Path path;
};

/// Compares the faces of moves; no weight of smoothing may be acceptable in all of them.
void compare(const Pair& pair, const std::vector<Move>& moves) {
  ReferenceTissue reference(*pair.finer);
  std::vector<Face> truth;
  for (const Move& move : moves) {
    truth.push_back(reference.followed(move.path));
    expect_acceptable(move.name, pair, shipped(*pair.tissue, move.path), truth.back());
  }
  for (const double weight : {1.0, 3.0, 10.0, 30.0, 1e2, 3e2, 1e3, 1e4, 1e5}) {
    bool all_acceptable = true;
    for (std::size_t i = 0; i < moves.size(); ++i) {
      const Face smooth = smoothed(*pair.tissue, moves[i].path.back(), weight);
      all_acceptable = all_acceptable &&
                       errors_of(pair.patient, pair.rest, smooth, truth[i])["all"].acceptable();
    }
    EXPECT_FALSE(all_acceptable) << "smoothing with weight " << weight;
  }
}

TEST(FaceTruth, TheOpenedFaceOfTheBuiltInPatientAgreesWithFiniteElements) {
  const Pair pair(test::builtin());
  compare(pair, {{"open 10", pair.opened(10)}});
}

TEST(FaceTruth, ARealFaceAgreesWithFiniteElementsInMovesOfTheJawAndAChinAdvance) {
  const auto real = test::case_badin(test::Faced::yes);
  if (!real) GTEST_SKIP() << "real anatomy absent";
  const Pair pair(*real);
  compare(pair, {{"open 5", pair.opened(5)},
                 {"open 10", pair.opened(10)},
                 {"open 20", pair.opened(20)},
                 {"protrude 6", pair.protruded(6)},
                 {"left 8", pair.moved_aside(8)}});

  Plan plan{.name = "chin", .geometry = geometry_of(*real)};
  plan = with_step(plan,
                   CutStep{.osteotomy = "genioplasty", .pieces = {"chin"}, .below_margins = true});
  Pose forward;
  forward.t = Vector3d(0, -5, 0);
  plan = with_step(plan, MoveStep{"chin", ExplicitMove{forward}});
  PredictionSettings settings;
  settings.threads = threads;
  Predictor predictor(*real, settings, pair.tissue);
  const Prediction prediction = predictor.predict(plan);
  const OperatedTissue operated = operated_tissue(pair.parted, pair.finer, prediction.operated,
                                                  plan, settings.stripping, threads);
  Path path;
  for (const double fraction : {0.25, 0.5, 0.75, 1.0})
    path.push_back(poses_at(prediction.operated, fraction));
  expect_acceptable("chin advance", pair, prediction.after,
                    ReferenceTissue(*operated.model).followed(path));
}

}  // namespace
}  // namespace condyle
