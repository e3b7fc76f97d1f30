#include <gtest/gtest.h>

#include <functional>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"
#include "sim/case/case_io.h"
#include "sim/case/pair_rules.h"
#include "tests/sim/operation/box_operation.h"
#include "tests/support/builtin.h"
#include "tests/support/program.h"

using namespace condyle;
using namespace condyle::test;
using Eigen::Vector3d;

namespace {

std::string plan_refusal(const Case& patient, const Plan& plan) {
  try {
    apply_plan(patient, plan);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "the plan was accepted";
  return "";
}

void expect_has(const std::string& text, const std::string& words) {
  EXPECT_NE(text.find(words), std::string::npos) << text;
}

void expect_same_bits(const Case& a, const Case& b) {
  EXPECT_TRUE(a.bodies == b.bodies);
  EXPECT_TRUE(a.jaw == b.jaw);
  EXPECT_EQ(a.landmarks.points, b.landmarks.points);
  EXPECT_EQ(a.pair_rules.size(), b.pair_rules.size());
  ASSERT_EQ(a.parts.size(), b.parts.size());
  for (std::size_t i = 0; i < a.parts.size(); ++i) {
    EXPECT_EQ(a.parts[i].name, b.parts[i].name);
    EXPECT_EQ(a.parts[i].body, b.parts[i].body);
    EXPECT_EQ(mesh_hash(a.parts[i].mesh), mesh_hash(b.parts[i].mesh)) << a.parts[i].name;
  }
}

double volume_of(const Case& patient, const std::string& part) {
  const Part* found = part_named(patient, part);
  return found ? signed_volume(found->mesh) : 0;
}

}  // namespace

TEST(ApplyPlan, TheEmptyPlanReturnsTheSameCase) {
  const Case patient = operable_patient();
  const Operated operated = apply_plan(patient, plan_of(patient, {NoteStep{"nothing"}}));
  expect_same_bits(operated.patient, patient);
  expect_same_bits(operated_case(operated), patient);
  for (const Pose& X : operated.poses.X_CB) EXPECT_TRUE(bit_identical(X, {}));
  EXPECT_TRUE(operated.notes.empty());
}

TEST(ApplyPlan, ASegmentIsABodyOfItsOwn) {
  const Case patient = operable_patient();
  const Operated operated = apply_plan(
      patient, plan_of(patient, {chin_step(), MoveStep{"chin", ClinicalMove{.forward_mm = 5}}}));
  const Case& now = operated.patient;
  EXPECT_TRUE(operated.problems.empty()) << operated.problems[0];
  EXPECT_EQ(body_of(now, "chin"), "chin");
  EXPECT_EQ(parent_of(now, "chin"), "mandible");
  EXPECT_EQ(part_named(now, "chin")->role, Role::segment);
  EXPECT_EQ(now.bodies[*now.bodies.find("chin")].driver, BodyDriver::plan);
  EXPECT_TRUE(inspect(part_named(now, "chin")->mesh).closed());
  // The kerf lies on both sides of the plane.
  EXPECT_NEAR(volume_of(now, "chin"), 100 * 92 * 9.75, 1e-6);
  EXPECT_NEAR(volume_of(now, "mandible"), 100 * 92 * 28.75, 1e-6);
  ASSERT_EQ(operated.cuts.size(), 1u);
  EXPECT_LT(operated.cuts[0].volume_error_percent(), 1e-8);
  ASSERT_EQ(operated.cuts[0].pieces.size(), 2u);
  EXPECT_TRUE(operated.cuts[0].pieces[0].stays);
  EXPECT_TRUE(operated.cuts[0].outcomes[0].through);
  EXPECT_EQ(body_of(now, "lower_teeth"), "mandible");
  EXPECT_TRUE(now.jaw == patient.jaw);
  // Displacements of landmarks.
  const Landmarks moved = moved_landmarks(now.landmarks, operated.owners, operated.poses);
  const auto displaced = [&](const char* name) {
    return Vector3d(*moved.find(name) - *now.landmarks.find(name));
  };
  EXPECT_NEAR((displaced("pogonion") - Vector3d(0, -5, 0)).norm(), 0, 1e-9);
  EXPECT_EQ(displaced("lower_incisal_point"), Vector3d::Zero());
  EXPECT_EQ(displaced("left_mental_foramen"), Vector3d::Zero());
  const auto at = placed(now.bodies, operated.X_PB);
  EXPECT_NEAR((at[*now.bodies.find("chin")].t - Vector3d(0, -5, 0)).norm(), 0, 1e-9);
}

TEST(ApplyPlan, FacesKnowTheirTriangleOfTheScan) {
  const Case patient = operable_patient();
  const Plan plan = plan_of(
      patient, {ramus_step({"proximal", "distal"}), chin_step("distal"),
                plane_cut("chin", disc({0, -92, -75}, {1, 0, 0}), {"chin_left", "chin_right"})});
  const Operated operated = apply_plan(patient, plan);
  const SurfaceOrigin& origin = operated.origin.at("chin_left");
  EXPECT_EQ(origin.part, "mandible");
  const TriMesh &mesh = part_named(operated.patient, "chin_left")->mesh,
                &scan = part_named(patient, "mandible")->mesh;
  ASSERT_EQ(origin.triangle.size(), mesh.triangles.size());
  std::map<int, int> faces;  // by step
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    ++faces[origin.made_by[i]];
    if (origin.triangle[i] < 0) continue;
    const auto& t = scan.triangles[origin.triangle[i]];
    const Vector3d a = scan.vertices[t[0]];
    const Vector3d n = (scan.vertices[t[1]] - a).cross(scan.vertices[t[2]] - a).normalized();
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(n.dot(mesh.vertices[mesh.triangles[i][k]] - a), 0, 1e-9);
  }
  for (const int step : {0, 1, 2, 3}) EXPECT_GT(faces[step], 0) << step;
  EXPECT_FALSE(operated.origin.contains("mandible"));
}

TEST(ApplyPlan, TeethAndGumsGoWithTheirBone) {
  const Case patient = operable_patient();
  const Operated operated = apply_plan(
      patient, plan_of(patient, {maxilla_step(), MoveStep{"maxilla", ClinicalMove{.up_mm = 2}}}));
  const Case& now = operated.patient;
  EXPECT_EQ(body_of(now, "upper_teeth"), "maxilla");
  EXPECT_EQ(now.bodies[now.jaw.upper_arch].name, "maxilla");
  EXPECT_EQ(now.jaw.lower_arch, mandible_body);
  EXPECT_EQ(parent_of(now, "mandible"), "cranium");
  EXPECT_EQ(body_of(now, "lower_gums"), "mandible");
  EXPECT_EQ(operated.owners.at("upper_incisal_point"), now.jaw.upper_arch);
  const Case after = operated_case(operated);
  const Box before = bounding_box(part_named(patient, "upper_teeth")->mesh),
            box = bounding_box(part_named(after, "upper_teeth")->mesh);
  EXPECT_NEAR((box.low - before.low - Vector3d(0, 0, 2)).norm(), 0, 1e-9);
  EXPECT_EQ(mesh_hash(part_named(after, "mandible")->mesh),
            mesh_hash(part_named(patient, "mandible")->mesh));
  Folder folder;
  save_case(after, folder / "case");
  expect_same_bits(load_case(folder / "case"), after);
}

TEST(ApplyPlan, AnArchIsDividedBetweenItsTeeth) {
  const Case patient = operable_patient();
  const Plan plan =
      plan_of(patient, {maxilla_step(), plane_cut("maxilla", disc({0, -92, -20}, {1, 0, 0}),
                                                  {"maxilla_left", "maxilla_right"})});
  const Operated operated = apply_plan(patient, plan);
  const Case& now = operated.patient;
  EXPECT_EQ(part_named(now, "upper_teeth"), nullptr);
  const Part* left = part_named(now, "upper_teeth_maxilla_left");
  ASSERT_NE(left, nullptr);
  EXPECT_EQ(body_of(now, left->name), "maxilla_left");
  EXPECT_EQ(parent_of(now, "maxilla_left"), "maxilla");
  ASSERT_EQ(left->teeth.size(), 3u);
  for (const Tooth& tooth : left->teeth) {
    EXPECT_EQ(tooth.fdi / 10, 2);
    const auto& t = left->mesh.triangles[tooth.first_triangle];
    EXPECT_NEAR(left->mesh.vertices[t[0]].x(), 6.0 * (tooth.fdi % 10) - 3, 2.01);
  }
  EXPECT_TRUE(inspect(left->mesh).closed());
  EXPECT_EQ(part_named(now, "upper_teeth_maxilla_right")->teeth.size(), 3u);
  expect_has(
      plan_refusal(patient, plan_of(patient, {maxilla_step(),
                                              plane_cut("maxilla", disc({8, -92, -20}, {1, 0, 0}),
                                                        {"left", "right"})})),
      "tooth 22");
}

TEST(ApplyPlan, TheJawFollowsItsSegments) {
  const Case patient = operable_patient();
  const Operated operated =
      apply_plan(patient, plan_of(patient, {ramus_step({"proximal", "distal"}),
                                            MoveStep{"distal", ClinicalMove{.forward_mm = -5}}}));
  const Case& now = operated.patient;
  const auto name = [&](BodyId body) { return now.bodies[body].name; };
  EXPECT_EQ(name(now.jaw.lower_arch), "distal");
  EXPECT_EQ(name(now.jaw.left_condyle), "proximal");
  EXPECT_EQ(name(now.jaw.right_condyle), "proximal");
  EXPECT_EQ(now.jaw.upper_arch, cranium_body);
  EXPECT_EQ(part_named(now, "mandible"), nullptr);
  EXPECT_TRUE(now.bodies.find("mandible"));  // which a motion drives
  EXPECT_EQ(body_of(now, "lower_teeth"), "distal");
  EXPECT_EQ(body_of(now, "lower_gums"), "distal");
  EXPECT_EQ(name(operated.owners.at("lower_incisal_point")), "distal");
  EXPECT_EQ(rule_for(now, {}, *part_named(now, "proximal"), *part_named(now, "distal")).policy,
            PairPolicy::cut_face);
  EXPECT_EQ(rule_for(now, {}, *part_named(now, "skull"), *part_named(now, "distal")).policy,
            PairPolicy::forbidden);
}

TEST(ApplyPlan, AChinHasTheDistalSegmentAsParentInAnyOrder) {
  const Case patient = operable_patient();
  const MoveStep set_back{"distal", ClinicalMove{.forward_mm = -5}};
  const Operated chin_last = apply_plan(
      patient,
      plan_of(patient, {ramus_step({"proximal", "distal"}), chin_step("distal"), set_back}));
  EXPECT_EQ(parent_of(chin_last.patient, "chin"), "distal");
  const BodyId chin = *chin_last.patient.bodies.find("chin");
  EXPECT_NEAR(chin_last.poses[chin].t.y(), 5, 1e-9);  // it has no move of its own
  EXPECT_TRUE(bit_identical(chin_last.X_PB[index_of(chin)], {}));
  // A chin in front of the plane of the rami, cut first.
  CutStep front = plane_cut("mandible", disc({0, -60, -70}, {0, -1, 0}), {"chin"});
  CutStep rami = ramus_step({"proximal", "distal"});
  CutStep front_of_distal = front;
  front_of_distal.target = "distal";
  const Operated first = apply_plan(patient, plan_of(patient, {front, rami, set_back})),
                 last = apply_plan(patient, plan_of(patient, {rami, front_of_distal, set_back}));
  EXPECT_EQ(parent_of(first.patient, "chin"), "distal");
  for (const char* part : {"chin", "distal", "proximal"}) {
    EXPECT_GT(volume_of(first.patient, part), 1000);
    EXPECT_NEAR(volume_of(first.patient, part), volume_of(last.patient, part), 1e-6);
  }
  const auto pose = [](const Operated& operated, const char* body) {
    return operated.poses[*operated.patient.bodies.find(body)];
  };
  EXPECT_TRUE(bit_identical(pose(first, "chin"), pose(last, "chin")));
  EXPECT_EQ(first.owners.size(), last.owners.size());
}

TEST(ApplyPlan, RulesOfABoneHoldForItsPieces) {
  Case patient = operable_patient();
  patient.pair_rules = {{"mandible", "skull", PairPolicy::guided, std::nullopt, 1.5}};
  const Case now =
      apply_plan(patient, plan_of(patient, {ramus_step({"proximal"}), maxilla_step()})).patient;
  for (const char* lower : {"proximal", "mandible"})
    for (const char* upper : {"skull", "maxilla"}) {
      const PairRule rule = rule_for(now, {}, *part_named(now, lower), *part_named(now, upper));
      EXPECT_EQ(rule.policy, PairPolicy::guided) << lower << " " << upper;
      EXPECT_EQ(rule.gap_mm, 1.5);
    }
}

TEST(ApplyPlan, ACutThatEndsInBoneIsReportedWithWhatItPrevents) {
  const Case patient = operable_patient();
  CutStep cut = chin_step();
  cut.surfaces = {disc({0, -92, -70}, {0, 0, -1}, 40)};
  const Operated operated =
      apply_plan(patient, plan_of(patient, {cut, MoveStep{"chin", ClinicalMove{.forward_mm = 5}}}));
  ASSERT_EQ(operated.problems.size(), 2u);
  expect_has(operated.problems[0], "chin");
  expect_has(operated.problems[1], "step 2 (move chin)");
  EXPECT_FALSE(operated.cuts[0].outcomes[0].through);
  EXPECT_GT(operated.cuts[0].outcomes[0].left_mm, 1);
  EXPECT_FALSE(operated.patient.bodies.find("chin"));
  EXPECT_NEAR(volume_of(operated.patient, "mandible") + operated.cuts[0].kerf_volume_mm3,
              volume_of(patient, "mandible"), 1e-6);
}

TEST(ApplyPlan, OpenBoneIsClosedOrRefused) {
  Case patient = operable_patient();
  TriMesh& mandible = patient.parts[1].mesh;
  const TriMesh whole = mandible;
  // A hole of 0.1 mm in its upper side.
  mandible.vertices.insert(mandible.vertices.end(),
                           {{0, -10, -41}, {0.1, -10, -41}, {0, -9.9, -41}});
  const Eigen::Vector3i top = mandible.triangles[2];
  const int first = static_cast<int>(mandible.vertices.size()) - 3;
  mandible.triangles.erase(mandible.triangles.begin() + 2);
  EXPECT_EQ(top, Eigen::Vector3i(4, 5, 6));
  for (int k = 0; k < 3; ++k) {
    mandible.triangles.emplace_back(top[k], top[(k + 1) % 3], first + (k + 1) % 3);
    mandible.triangles.emplace_back(top[k], first + (k + 1) % 3, first + k);
  }
  const Operated operated = apply_plan(patient, plan_of(patient, {chin_step()}));
  ASSERT_FALSE(operated.cuts[0].notes.empty());
  expect_has(operated.cuts[0].notes[0], "1 hole closed");
  EXPECT_TRUE(inspect(part_named(operated.patient, "mandible")->mesh).closed());
  // A missing triangle of its upper side: a long flat rim.
  mandible = whole;
  mandible.triangles.erase(mandible.triangles.begin() + 2);
  const Operated capped = apply_plan(patient, plan_of(patient, {chin_step()}));
  expect_has(capped.cuts[0].notes[0], "1 flat rim");
  EXPECT_NEAR(capped.cuts[0].volume_mm3, signed_volume(whole), 1e-6);
}

TEST(ApplyPlan, BoneWithALongBentRimIsWrappedOrRefused) {
  Case patient = operable_patient();
  TriMesh& mandible = patient.parts[1].mesh;
  const double whole = signed_volume(mandible);
  // A triangle of the upper side, and one of the back that meets it.
  std::erase_if(mandible.triangles, [](const Eigen::Vector3i& t) {
    return t == Eigen::Vector3i(5, 7, 6) || t == Eigen::Vector3i(3, 6, 7);
  });
  ASSERT_EQ(mandible.triangles.size(), 10u);
  const Operated operated = apply_plan(patient, plan_of(patient, {chin_step()}));
  expect_has(operated.cuts[0].notes[0], "it was wrapped, within 0.");
  EXPECT_NEAR(operated.cuts[0].volume_mm3, whole, 0.2 * whole);
  for (const char* name : {"chin", "mandible"})
    EXPECT_TRUE(inspect(part_named(operated.patient, name)->mesh).closed());
  // Faces are traced to the triangles that they were wrapped about.
  const auto& origin = operated.origin.at("chin").triangle;
  EXPECT_GT(std::count_if(origin.begin(), origin.end(), [](int t) { return t >= 0; }),
            static_cast<int>(origin.size()) / 3);
  const TriMesh open = mandible;
  for (const auto& v : open.vertices) mandible.vertices.emplace_back(v.x(), v.y(), v.z() - 100);
  for (const auto& t : open.triangles) mandible.triangles.push_back(t.array() + 8);
  expect_has(plan_refusal(patient, plan_of(patient, {chin_step()})), "it is 2 solids");
}

TEST(ApplyPlan, AnotherCaseIsRefusedAndEditedLandmarksAreNamed) {
  const Case patient = operable_patient();
  const Plan plan = plan_of(patient, {chin_step()});
  Case other = patient;
  other.parts[1].mesh.vertices[0].x() += 1;
  expect_has(plan_refusal(other, plan), "mandible has another shape");
  Case edited = patient;
  edited.landmarks.points["pogonion"].y() += 1.25;
  const Operated operated = apply_plan(edited, plan);
  ASSERT_EQ(operated.notes.size(), 1u);
  expect_has(operated.notes[0], "pogonion moved by 1.25 mm");
  Plan wrong = plan;
  wrong.steps.push_back({9, MoveStep{"cranium", ClinicalMove{.up_mm = 1}}});
  expect_has(plan_refusal(patient, wrong), "step 9 (move cranium)");
  wrong.steps.back() = {9, MoveStep{"nose", ClinicalMove{.up_mm = 1}}};
  expect_has(plan_refusal(patient, wrong), "nose");
}

TEST(ApplyPlan, TheBuiltInPatientsChinIsReplayedToTheSameBits) {
  const Case& patient = builtin();
  const CutStep chin = plane_cut("mandible", disc({0, -80, -80}, {0, 0, -1}, 70), {"chin"}, 0.7);
  const CutStep vault = plane_cut("cranium", disc({0, 20, 70}, {0, 0, 1}, 130), {"vault"}, 1.2);
  const MoveStep move{"chin", ClinicalMove{.forward_mm = 6, .up_mm = 1, .pitch_deg = 3}};
  const Plan plan = plan_of(patient, {chin, vault, move});
  const Operated once = apply_plan(patient, plan), twice = apply_plan(patient, plan);
  EXPECT_TRUE(once.problems.empty()) << once.problems[0];
  expect_same_bits(once.patient, twice.patient);
  expect_same_bits(operated_case(once), operated_case(twice));
  EXPECT_EQ(body_of(once.patient, "lower_teeth"), "mandible");
  EXPECT_EQ(body_of(once.patient, "tongue"), "mandible");
  EXPECT_EQ(body_of(once.patient, "upper_teeth"), "cranium");
  const BodyId part = *once.patient.bodies.find("chin");
  for (const char* name : {"pogonion", "menton", "gnathion"})
    EXPECT_EQ(once.owners.at(name), part) << name;
  for (const char* name :
       {"b_point", "left_lingula", "left_gonion", "left_condyle", "lower_left_central_incisor_tip"})
    EXPECT_EQ(once.owners.at(name), mandible_body) << name;
  for (const char* name : {"soft_pogonion", "soft_menton", "stomion", "hyoid", "pronasale"})
    EXPECT_FALSE(once.owners.contains(name)) << name;
  for (const CutReport& cut : once.cuts) EXPECT_LT(cut.volume_error_percent(), 1e-6);
  // Steps that do not depend on each other, in another order.
  const Operated other = apply_plan(patient, plan_of(patient, {vault, chin, move}));
  for (const char* name : {"chin", "vault", "mandible", "skull"})
    EXPECT_EQ(mesh_hash(part_named(other.patient, name)->mesh),
              mesh_hash(part_named(once.patient, name)->mesh));
}
