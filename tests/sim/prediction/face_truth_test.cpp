// The displayed face in equilibrium, sliding on bone and teeth, compared with finite elements on a
// finer mesh of the same tissue. Both have the same materials, supports, contact search and
// display; they differ in mesh, elasticity and minimisation. Displacements that are smoothed
// without any elasticity must fail.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/minimize/minimize.h"
#include "engine/tissue/hessian_factor.h"
#include "engine/tissue/layered_mesh.h"
#include "sim/prediction/operated_tissue.h"
#include "sim/prediction/prediction.h"
#include "sim/prediction/predictor.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/model.h"
#include "sim/tissue/tissue_layers.h"
#include "tests/support/builtin.h"
#include "tests/support/real_cases.h"
#include "tests/support/wedge_elements.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Face = std::vector<Eigen::Vector3f>;
using Path = std::vector<std::vector<Pose>>;  // of the bodies

constexpr int threads = 2;

Face displayed(const TissueModel& model, const TissueState& state) {
  Face face;
  deform_face(model, state, face, threads);
  return face;
}

/// The tissue of a model as finite elements, followed along a path of the bodies from rest.
class ReferenceTissue {
 public:
  ReferenceTissue(const Case& patient, const TissueModel& model)
      : model_(model),
        body_(model.mesh->rest, model.mesh->elements.prisms,
              materials(layers_of(patient.tissue), *model.mesh)),
        preconditioner_mesh_(model.mesh->elements) {
    EXPECT_TRUE(!model.planned && model.support.held_force.empty()) << "prestress is left out";
    // A preconditioner that is as stiff in compression as in tension.
    for (double& k : preconditioner_mesh_.stiffness)
      k *= 0.5 * (1 + preconditioner_mesh_.compression_ratio);
    preconditioner_mesh_.compression_ratio = 1;
  }

  /// The displayed face in equilibrium at the end.
  Face followed(const Path& path) {
    state_ = rest_tissue(model_);
    contacts_.clear();
    for (std::size_t i = 0; i < path.size(); ++i) go(path[i], i + 1 == path.size());
    return displayed(model_, state_);
  }

 private:
  static std::vector<fe::Material> materials(const LayerStack& stack, const TissueMesh& mesh) {
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
    with_bodies.path = nullptr;  // it was solved with springs
    Nodes x = with_bodies.extrapolated(state_.nodes, model_.support.node, state_.X_CB, X_CB);
    for (std::size_t i = 0; i < contacts_.size() && i < model_.contact->obstacles.size(); ++i) {
      const BodyId body = model_.contact->obstacles[i].body;
      move_contacts(pose_in(X_CB, body) * pose_in(state_.X_CB, body).inverse(), contacts_[i]);
    }
    fe::WedgeEnergy energy(body_, model_.mesh->elements, loads, threads);
    if (!std::isfinite(energy.value(x))) x = state_.nodes;
    std::unique_ptr<HessianFactor> factor;
    int since = 0;
    MinimizeSettings settings;
    settings.tolerance_mm = last ? 1e-3 : 2e-2;
    settings.max_iterations = iterations;
    const double error_mm = last ? 5e-3 : 0.1;
    const ContactSolveResult result = solve_contact(
        [&](const Nodes& at) {
          return find_tissue_contacts(*model_.contact, model_.mesh->own_stiffness, from_mesh, at,
                                      threads, nullptr, firmness);
        },
        [&](bool) {
          if (!factor)
            factor = std::make_unique<HessianFactor>(preconditioner_mesh_, loads,
                                                     model_.mesh->sheets, x, threads);
          if (since > before_refactoring) {
            factor->refactor(preconditioner_mesh_, loads, x, threads);
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
  SpringPrismMesh preconditioner_mesh_;
  TissueState state_;
  ContactLists contacts_;
};

/// The face as Condyle moves it, in equilibrium at the end.
Face shipped(const TissueModel& model, const Path& path) {
  TissueState state = rest_tissue(model);
  TissueWarmStart warm;
  for (const auto& X_CB : path)
    state = solve_tissue(model, state, X_CB, {.threads = threads}, warm);
  state = solve_to_equilibrium(model, state, warm, {.threads = threads});
  EXPECT_TRUE(state.converged);
  return displayed(model, state);
}

/// The face whose displacements have the least sum of squared differences along the edges of the
/// mesh and, times `weight`, from those of the anchors: no elasticity and no contact.
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
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
  EXPECT_EQ(factor.info(), Eigen::Success);
  const Eigen::MatrixX3d moved = factor.solve(right);
  TissueState state = rest_tissue(model);
  for (std::size_t i = 0; i < rest.size(); ++i)
    state.nodes[i] = rest[i] + moved.row(static_cast<Eigen::Index>(i)).transpose();
  state.X_CB.assign(X_CB.begin(), X_CB.end());
  return displayed(model, state);
}

double quantile(std::vector<double> values, double fraction) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1))];
}

/// Errors of the skin that moves by more than 2 mm in either of two faces.
struct Errors {
  std::vector<double> mm, of_movement, moved_mm;

  /// The largest of median and 95th percentile, each over its bound: acceptable up to 1.
  double score() const {
    return std::max({quantile(mm, 0.5) / 0.5, quantile(of_movement, 0.5) / 0.15,
                     quantile(mm, 0.95) / 1.5, quantile(of_movement, 0.95) / 0.40});
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
ByRegion errors_of(const Case& patient, const Face& rest, const Face& shown,
                   const Face& reference) {
  ByRegion by_region;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const double moved = std::max((reference[i] - rest[i]).norm(), (shown[i] - rest[i]).norm());
    const double error = (shown[i] - reference[i]).norm();
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

/// One patient with its shipped tissue and a finer one.
struct Models {
  const Case& patient;
  Case parted;  // with its lips parted
  std::shared_ptr<const TissueModel> tissue, finer;
  Face rest;

  Models(const Case& whole, int finer_surface_nodes) : patient(whole), parted(whole) {
    part_lips(parted);
    TissueSettings settings{.threads = threads};
    tissue = build_tissue(parted, settings);
    settings.surface_nodes = finer_surface_nodes;
    finer = build_tissue(parted, settings);
    rest = displayed(*tissue, rest_tissue(*tissue));
    std::printf("%d nodes, finite elements with %d\n", summary(*tissue).nodes,
                summary(*finer).nodes);
    EXPECT_GT(summary(*finer).nodes, 1.8 * summary(*tissue).nodes);
  }

  Vector3d condyle(const char* side) const {
    return *patient.landmarks.find(std::string(side) + "_condyle");
  }
  Vector3d incisor() const { return *patient.landmarks.find("lower_incisal_point"); }
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
  /// About the condyles, which translate forward and down from 10 mm on.
  Path opened(double mm) const {
    const Vector3d hinge = 0.5 * (condyle("left") + condyle("right"));
    const double arm = (incisor() - hinge).norm();
    return path(static_cast<int>(std::ceil(mm / 2.5)), [=](double fraction) {
      Pose X_CM;
      X_CM.R = Eigen::Quaterniond(Eigen::AngleAxisd(fraction * mm / arm, Vector3d::UnitX()));
      const double slide = 0.3 * std::max(0.0, fraction * mm - 10);
      X_CM.t = hinge - X_CM.R * hinge + Vector3d(0, -slide, -0.6 * slide);
      return X_CM;
    });
  }
  Path protruded(double mm) const {
    return path(3, [=](double fraction) {
      Pose X_CM;
      X_CM.t = fraction * mm * Vector3d(0, -3, -1).normalized();
      return X_CM;
    });
  }
  /// To the left, about the left condyle, parted by 2 mm.
  Path moved_left(double mm) const {
    const Vector3d pivot = condyle("left");
    const double arm = (incisor() - pivot).head<2>().norm();
    return path(4, [=](double fraction) {
      Pose X_CM;
      X_CM.R = Eigen::Quaterniond(Eigen::AngleAxisd(fraction * mm / arm, Vector3d::UnitZ()));
      X_CM.t = pivot - X_CM.R * pivot + Vector3d(0, 0, -2 * fraction);
      return X_CM;
    });
  }
};

/// A move with the tissues that follow it.
struct Move {
  const char* name;
  Path path;
  std::shared_ptr<const TissueModel> tissue, finer;
};

/// Compares the faces of moves, and those of smoothing with the weight that suits all of them best.
void compare(const Models& models, const std::vector<Move>& moves) {
  constexpr std::size_t least_vertices = 100;
  constexpr double least_failure = 1.2;
  std::vector<Face> references;
  for (const Move& move : moves) {
    SCOPED_TRACE(move.name);
    references.push_back(ReferenceTissue(models.patient, *move.finer).followed(move.path));
    ByRegion errors =
        errors_of(models.patient, models.rest, shipped(*move.tissue, move.path), references.back());
    for (const auto& [region, of] : errors)
      std::printf("%-14s %-16s%s\n", move.name, region.c_str(), of.text().c_str());
    ASSERT_GE(errors["all"].mm.size(), least_vertices);
    EXPECT_LE(errors["all"].score(), 1) << errors["all"].text();
  }
  double best_score = 1e9, best_weight = 0;
  std::vector<double> best;  // of each move
  for (double exponent = -1; exponent <= 5; exponent += 0.25) {
    const double weight = std::pow(10, exponent);
    std::vector<double> scores;
    for (std::size_t i = 0; i < moves.size(); ++i)
      scores.push_back(errors_of(models.patient, models.rest,
                                 smoothed(*moves[i].tissue, moves[i].path.back(), weight),
                                 references[i])["all"]
                           .score());
    const double score = *std::max_element(scores.begin(), scores.end());
    ASSERT_TRUE(std::isfinite(score));
    if (score >= best_score) continue;
    best_score = score;
    best_weight = weight;
    best = scores;
  }
  std::printf("smoothing, best with weight %g; worst error over its bound:", best_weight);
  for (std::size_t i = 0; i < moves.size(); ++i) std::printf(" %s %.2f;", moves[i].name, best[i]);
  std::printf("\n");
  EXPECT_GT(best_score, least_failure);
}

TEST(FaceTruth, TheOpenedFaceOfTheBuiltInPatientAgreesWithFiniteElements) {
  const Models models(test::builtin(), 1000);
  compare(models, {{"open 10", models.opened(10), models.tissue, models.finer}});
}

TEST(FaceTruth, ARealFaceAgreesWithFiniteElementsInMovesOfTheJawAndAChinAdvance) {
  const auto real = test::case_badin(test::Faced::yes);
  if (!real) GTEST_SKIP() << "real anatomy absent";
  const Models models(*real, 2000);
  Plan plan{.name = "chin", .geometry = geometry_of(*real)};
  plan = with_step(plan,
                   CutStep{.osteotomy = "genioplasty", .pieces = {"chin"}, .below_margins = true});
  Pose forward;
  forward.t = Vector3d(0, -5, 0);
  plan = with_step(plan, MoveStep{"chin", ExplicitMove{forward}});
  PredictionSettings settings;
  settings.threads = threads;
  const Operated operated = Predictor(*real, settings, models.tissue).prepare(plan);
  const auto tissue_of = [&](const std::shared_ptr<const TissueModel>& whole) {
    return operated_tissue(models.parted, whole, operated, plan, settings.stripping, threads).model;
  };
  Path advanced;
  for (const double fraction : {0.25, 0.5, 0.75, 1.0})
    advanced.push_back(poses_at(operated, fraction));

  const auto jaw = [&](const char* name, const Path& path) {
    return Move{name, path, models.tissue, models.finer};
  };
  compare(models, {jaw("open 5", models.opened(5)),
                   jaw("open 10", models.opened(10)),
                   jaw("open 20", models.opened(20)),
                   jaw("protrude 6", models.protruded(6)),
                   jaw("left 8", models.moved_left(8)),
                   {"chin advance", advanced, tissue_of(models.tissue), tissue_of(models.finer)}});
}

TEST(FaceTruth, FiniteElementsStayAtRest) {
  const Models models(test::builtin(), 1000);
  const Face still =
      ReferenceTissue(models.patient, *models.finer).followed(models.path(1, [](double) {
        return Pose{};
      }));
  float most = 0;
  for (std::size_t i = 0; i < still.size(); ++i)
    most = std::max(most, (still[i] - models.rest[i]).norm());
  EXPECT_LT(most, 0.05);
}

}  // namespace
}  // namespace condyle
