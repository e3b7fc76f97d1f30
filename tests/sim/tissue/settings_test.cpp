// The model has the tissue that the plan specifies.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <regex>
#include <utility>

#include "engine/core/error.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/model.h"
#include "tests/sim/tissue/plain_patient.h"
#include "tests/support/jaw_pose.h"
#include "tests/support/scan_case.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

std::shared_ptr<const TissueModel> plain_model(const TissuePlan& plan) {
  Case patient = plain_patient();
  part_lips(patient);
  return build_tissue(patient, {.surface_nodes = 220, .plan = plan});
}

double farthest(const Nodes& a, const Nodes& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

TEST(TissueSettings, NothingMovesBeforeSurgeryUnderPretensionAndWeightInAnyDirection) {
  const auto plain = plain_model({});
  for (const Vector3d& down : {Vector3d(0, 0, -1), Vector3d(0, 3, 0), Vector3d(-1, 2, 0.5)}) {
    const auto model = plain_model({.turgor = 0.9, .down = down});
    // It carries a load at all: without balanced strains it would sag.
    ASSERT_FALSE(model->support.node_force.empty());
    double weight = 0;
    for (const auto& f : model->support.node_force) weight += f.dot(down.normalized());
    EXPECT_GT(weight, 0.3);  // N: some 50 ml of tissue and more
    EXPECT_LT(weight, 20);
    EXPECT_LT(summary(*model).rest_move_mm, 1e-4) << down.transpose();
    EXPECT_LT(summary(*model).rest_force_N, 1e-3) << down.transpose();
    // The strains change how it answers a motion.
    const Pose X_CM = opening(plain_patient(), 8);
    const TissueState one = solve_tissue(*model, rest_tissue(*model), jaw_at(X_CM));
    const TissueState other = solve_tissue(*plain, rest_tissue(*plain), jaw_at(X_CM));
    EXPECT_GT(farthest(one.nodes, other.nodes), 0.05);
    EXPECT_EQ(one.inverted_prisms, 0);
  }
}

// Without weight the answer depends on no stiffness, only on its shares.
TEST(TissueSettings, TissueFirmerThanAnyLivingSettlesWhereOrdinaryDoes) {
  std::vector<Nodes> ends;
  for (const double modulus_MPa : {0.1, 100.0}) {
    const auto model = plain_model({.layers = {{.fraction = 1, .modulus_MPa = modulus_MPa}}});
    TissueState state = rest_tissue(*model);
    TissueWarmStart warm;
    for (int degrees = 2; degrees <= 20; degrees += 2) {
      state = solve_tissue(*model, state, jaw_at(opening(plain_patient(), degrees)), {}, warm);
      EXPECT_TRUE(state.converged) << modulus_MPa << " MPa at " << degrees << " degrees";
      EXPECT_LT(state.penetration_mm, 0.2);
    }
    ends.push_back(state.nodes);
  }
  EXPECT_LT(farthest(ends[0], ends[1]), 0.02);
}

TEST(TissueSettings, LayersHaveTheirOwnThicknessStiffnessAndMass) {
  TissuePlan plan;
  plan.layers = {{.fraction = 0.3, .modulus_MPa = 0.08, .mass_kg = 0.05}, {.fraction = 0.7}};
  plan.down = Vector3d(0, 0, -1);
  const auto model = plain_model(plan);
  EXPECT_EQ(summary(*model).layers, 2);
  for (int c = 0; c < model->mesh->columns; ++c) {
    const Vector3d outer = model->mesh->rest[3 * c], middle = model->mesh->rest[3 * c + 1],
                   inner = model->mesh->rest[3 * c + 2];
    EXPECT_NEAR((middle - outer).norm() / (inner - outer).norm(), 0.3, 1e-9);
  }
  double outer_weight = 0, all = 0;
  for (int c = 0; c < model->mesh->columns; ++c)
    for (int s = 0; s < 3; ++s) {
      const double weight = -model->support.node_force[3 * c + s].z();
      all += weight;
      if (s == 0) outer_weight += 2 * weight;  // half of the layer belongs to the skin's nodes
    }
  EXPECT_NEAR(outer_weight, 9.81 * 0.05, 1e-6);
  EXPECT_GT(all, outer_weight);
}

TEST(TissueSettings, LayersDividedInAFineMeshKeepMassAndStiffness) {
  Case patient = plain_patient();
  part_lips(patient);
  TissuePlan plan;
  plan.layers = {{.fraction = 0.2, .modulus_MPa = 0.08, .mass_kg = 0.05}, {.fraction = 0.8}};
  plan.down = Vector3d(0, 0, -1);
  const auto weight = [](const TissueModel& model) {
    double sum = 0;
    for (const auto& f : model.support.node_force) sum -= f.z();
    return sum;
  };
  const auto by_default = build_tissue(patient, {.plan = plan});
  const auto fine = build_tissue(patient, {.surface_nodes = 700, .plan = plan});
  EXPECT_EQ(by_default->mesh->sheets, 3);
  EXPECT_GT(fine->mesh->sheets, 3);
  EXPECT_EQ(summary(*fine).layers, 2);
  bool reported = false;
  for (const auto& note : summary(*fine).notes)
    reported = reported || note.find("layers are cut, 2 into") != std::string::npos;
  EXPECT_TRUE(reported);
  // A kilogramme a litre where the plan does not say.
  const auto due = [](const TissueModel& model) {
    double volume = 0;  // of the deeper layer
    for (const auto& prism : model.mesh->elements.prisms)
      if (prism[0] % model.mesh->sheets > 0) volume += prism_volume(model.mesh->rest, prism);
    return 9.81 * (0.05 + 1e-6 * volume);
  };
  EXPECT_NEAR(weight(*by_default), due(*by_default), 1e-6);
  EXPECT_NEAR(weight(*fine), due(*fine), 1e-6);
  EXPECT_NEAR(weight(*fine), weight(*by_default), 0.02 * weight(*by_default));
  // The supports of the finer mesh have the same total, distributed over more nodes.
  const auto held = [](const TissueModel& model) {
    double sum = 0;
    for (std::size_t i = 0; i < model.mesh->elements.anchor_node.size(); ++i)
      if (model.mesh->elements.anchor_node[i] % model.mesh->sheets == model.mesh->sheets - 1)
        sum += model.mesh->elements.anchor_stiffness[i];
    return sum;
  };
  EXPECT_GT(fine->mesh->elements.anchor_node.size(),
            1.2 * by_default->mesh->elements.anchor_node.size());
  EXPECT_NEAR(held(*fine), held(*by_default), 0.15 * held(*by_default));
}

TEST(TissueSettings, AttachmentsAreChosenByLandmarkOrPointAndBone) {
  const auto by_default = plain_model({});
  TissuePlan loose;
  loose.attachments = {
      {.bone = mandible_body, .attached = false, .landmark = "", .radius_mm = 200}};
  const auto without = plain_model(loose);
  EXPECT_GT(summary(*by_default).attached_to_mandible, 0);
  EXPECT_EQ(summary(*without).attached_to_mandible, 0);
  EXPECT_EQ(summary(*without).attached_to_cranium, summary(*by_default).attached_to_cranium);
  bool reported = false;
  for (const auto& note : summary(*without).notes)
    reported = reported || note.find("no tissue is attached to the mandible") != std::string::npos;
  EXPECT_TRUE(reported);
  loose.attachments.push_back({.bone = mandible_body, .landmark = "stomion", .radius_mm = 45});
  const auto some = plain_model(loose);
  EXPECT_GT(summary(*some).attached_to_mandible, 0);
  loose.attachments.back().landmark = "nowhere";
  EXPECT_THROW(plain_model(loose), InputError);
}

TEST(TissueSettings, GluedAndSlidingLipsDifferAndTheSlipIsReported) {
  const auto sliding = plain_model({});
  const auto glued = plain_model({.bond = TissueBond::glued});
  TissueState s = rest_tissue(*sliding), g = rest_tissue(*glued);
  TissueWarmStart warm_s, warm_g;
  double penetration = 0;
  for (int degrees = 1; degrees <= 12; ++degrees) {
    const Pose X_CM = opening(plain_patient(), degrees);
    s = solve_tissue(*sliding, s, jaw_at(X_CM), {}, warm_s);
    g = solve_tissue(*glued, g, jaw_at(X_CM), {}, warm_g);
    penetration = std::max(penetration, s.penetration_mm);
  }
  EXPECT_TRUE(s.converged);
  EXPECT_LT(penetration, 0.2);
  EXPECT_GT(s.slip_mm, 0.5);
  EXPECT_LT(g.slip_mm, s.slip_mm);
  EXPECT_GT(farthest(s.nodes, g.nodes), 1);
}

TEST(TissueSettings, ASolveThatFailsKeepsTheLastGoodStateAndSaysSo) {
  const auto model = plain_model({});
  TissueWarmStart warm;
  const TissueState good =
      solve_tissue(*model, rest_tissue(*model), jaw_at(opening(plain_patient(), 2)), {}, warm);
  ASSERT_FALSE(good.reused);
  Pose nowhere;
  nowhere.t = Vector3d(std::nan(""), 0, 0);
  const TissueState bad = solve_tissue(*model, good, jaw_at(nowhere), {}, warm);
  EXPECT_TRUE(bad.reused);
  EXPECT_FALSE(bad.converged);
  EXPECT_EQ(bad.nodes, good.nodes);
  const TissueState later =
      solve_tissue(*model, bad, jaw_at(opening(plain_patient(), 2.2)), {}, warm);
  EXPECT_FALSE(later.reused);
  EXPECT_LT(farthest(later.nodes, good.nodes), 2);
}

struct Misplaced {
  const char* name;
  Vector3d shift;
  double scale;  // about the middle of the bones
  const char* reported;
};
class MisplacedFace : public testing::TestWithParam<Misplaced> {};

TEST_P(MisplacedFace, IsRefusedWithAReason) {
  Case patient = plain_patient();
  const Vector3d middle(0, -44, -40);
  for (auto& part : patient.parts)
    if (part.role == Role::face)
      for (auto& p : part.mesh.vertices)
        p = middle + GetParam().scale * (p - middle) + GetParam().shift;
  try {
    part_lips(patient);
    const auto model = build_tissue(patient, {.surface_nodes = 220});
    FAIL() << "built with " << summary(*model).nodes << " nodes";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().reported), std::string::npos)
        << error.what();
  }
}
INSTANTIATE_TEST_SUITE_P(All, MisplacedFace,
                         testing::Values(Misplaced{"Inside", {0, 0, 0}, 0.55, "face: "},
                                         Misplaced{"Far", {0, -140, 0}, 1, "face: "},
                                         Misplaced{"Elsewhere", {0, 0, 900}, 1, "face: "}),
                         [](const auto& row) { return row.param.name; });

void expect_refused(Case patient, const std::string& reason) {
  part_lips(patient);
  try {
    build_tissue(patient, {.surface_nodes = 220});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
  }
}

void expect_inside_out_is_refused(Case patient) {
  for (auto& part : patient.parts)
    if (part.role == Role::face)
      for (auto& t : part.mesh.triangles) std::swap(t[1], t[2]);
  expect_refused(patient, "inside out");
}

TEST(FaceInsideOut, WithClosedLipsIsRefusedWithTheReason) {
  expect_inside_out_is_refused(plain_patient());
}

TEST(FaceInsideOut, WithOpenLipsIsRefusedWithTheReason) {
  const auto patient = case_badin_with_face();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  expect_inside_out_is_refused(*patient);
}

TEST(MisplacedFaceAside, IsBuiltAndReported) {
  const auto reported = [](double aside_mm) -> testing::AssertionResult {
    auto patient = case_badin_with_face();
    for (auto& part : patient->parts)
      if (part.role == Role::face)
        for (auto& v : part.mesh.vertices) v.x() += aside_mm;
    const auto model = build_tissue(*patient, {.surface_nodes = 220});
    for (const auto& note : model->summary.notes)
      if (note.find("in the same frame?") != std::string::npos)
        return testing::AssertionSuccess() << note;
    return testing::AssertionFailure();
  };
  if (!case_badin_with_face()) GTEST_SKIP() << "real anatomy absent";
  EXPECT_TRUE(reported(15));
  EXPECT_FALSE(reported(0));
}

TEST(MisplacedFaceOnBone, HasNoThickness) {
  Case patient = plain_patient();
  // A bone that is the face itself.
  TriMesh bone = patient.find(Role::face)->mesh;
  for (auto& part : patient.parts)
    if (part.role == Role::skull || part.role == Role::mandible) part.mesh = bone;
  expect_refused(patient, "no thickness");
}

TEST(TissueSettings, NothingAttachedIsRefusedWithAdvice) {
  TissuePlan loose;
  for (BodyId bone : {cranium_body, mandible_body})
    loose.attachments.push_back(
        {.bone = bone, .attached = false, .landmark = "", .radius_mm = 200});
  try {
    plain_model(loose);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("nothing is attached to bone"), std::string::npos)
        << error.what();
    EXPECT_NE(std::string(error.what()).find("--attach"), std::string::npos) << error.what();
  }
}

// A strip of the cheek is folded over and through itself.
TEST(TissueSettings, AFaceThatPassesThroughItselfMovesWithoutInversion) {
  Case patient = plain_patient();
  int folded = 0;
  for (auto& part : patient.parts)
    if (part.role == Role::face)
      for (auto& p : part.mesh.vertices)
        if (p.x() > 30 && p.x() < 52 && p.z() < -15 && p.z() > -35) {
          p.z() = -25 - 0.7 * (p.z() + 25);  // upside down: rows cross the rows around them
          p.y() -= 0.4 * std::sin(0.6 * p.z());
          ++folded;
        }
  ASSERT_GT(folded, 100);
  part_lips(patient);
  const auto model = build_tissue(patient, {.surface_nodes = 220});
  EXPECT_LT(summary(*model).rest_move_mm, 1e-4);
  TissueState state = rest_tissue(*model);
  TissueWarmStart warm;
  for (double degrees : {4.0, 8.0, 12.0}) {
    state = solve_tissue(*model, state, jaw_at(opening(patient, degrees)), {}, warm);
    EXPECT_EQ(state.inverted_prisms, 0);
    EXPECT_FALSE(state.reused);
    std::vector<Eigen::Vector3f> face;
    deform_face(*model, state, face);
    ASSERT_EQ(face.size(), patient.find(Role::face)->mesh.vertices.size());
    for (const auto& p : face) EXPECT_TRUE(p.allFinite());
  }
}

TEST(TissueSettings, AFaceThatInvertsTissueIsReportedWithAReadableLocation) {
  Case patient = plain_patient();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> off_mm(-12, 12);
  for (auto& part : patient.parts)
    if (part.role == Role::face)
      for (auto& p : part.mesh.vertices)
        if (std::abs(p.x()) > 30)  // the cheeks
          p += Eigen::Vector3d(off_mm(random), off_mm(random), off_mm(random));
  part_lips(patient);
  try {
    build_tissue(patient, {.surface_nodes = 220});
    FAIL();
  } catch (const InputError& error) {
    const std::regex place("folds near \\(-?\\d+\\.\\d, -?\\d+\\.\\d, -?\\d+\\.\\d\\) mm");
    EXPECT_TRUE(std::regex_search(std::string(error.what()), place)) << error.what();
  }
}

TEST(TissueSettings, OutOfRangeIsRefusedByNameAndValue) {
  const auto refused = [](const TissuePlan& plan, const char* item, const char* value) {
    try {
      plain_model(plan);
      ADD_FAILURE() << item;
    } catch (const InputError& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find(item), std::string::npos) << text;
      EXPECT_NE(text.find(value), std::string::npos) << text;
    }
  };
  refused({.turgor = 1.2}, "turgor", "1.2");
  refused({.turgor = std::nan("")}, "turgor", "nan");
  refused({.lambda = 0}, "lambda", "not 0");
  refused({.lambda = 1}, "lambda", "not 1");
  refused({.layer_count = 4}, "layers", "4");
  refused({.layers = {{.fraction = 0}, {.fraction = 1}}}, "share", "not 0");
  refused({.layers = {{.fraction = 1, .modulus_MPa = -3}}}, "modulus", "-3");
  refused({.layers = {{.fraction = 0.4}, {.fraction = 0.4}}}, "sum", "0.8");
  refused({.down = Vector3d::Zero()}, "gravity", "0");
}

}  // namespace
}  // namespace condyle::test
