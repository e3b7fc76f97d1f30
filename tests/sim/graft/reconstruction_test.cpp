// A segment of the built-in jaw is resected, and a fibula takes its place.
#include "tests/support/reconstruction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"
#include "sim/graft/graft.h"
#include "sim/operation/graft_steps.h"
#include "sim/operation/operation.h"
#include "sim/plan/cephalometry.h"
#include "sim/plan/plan_file.h"
#include "tests/support/builtin.h"

using namespace condyle;
using condyle::test::builtin;
using condyle::test::fibula_graft;

namespace {

Plan resected(int from_tooth = 34, int to_tooth = 37) {
  return condyle::test::resection_plan(builtin(), from_tooth, to_tooth);
}

TEST(Reconstruction, removes_the_segment_with_its_teeth_and_leaves_two_hosts) {
  const Operated operated = apply_plan(builtin(), resected());
  ASSERT_TRUE(operated.problems.empty()) << operated.problems[0];
  ASSERT_EQ(operated.resections.size(), 1u);
  EXPECT_EQ(operated.resections[0].teeth, (std::vector<int>{34, 35, 36, 37}));
  EXPECT_GT(operated.resections[0].volume_mm3, 3000);
  EXPECT_FALSE(operated.patient.bodies.find("tumour"));
  std::set<int> teeth;
  for (const Part& part : operated.patient.parts) {
    for (const Tooth& tooth : part.teeth) teeth.insert(tooth.fdi);
    if (part.name == "mandible") {
      const Topology found = inspect(part.mesh);
      EXPECT_TRUE(found.closed());
      EXPECT_EQ(found.components, 2);
    }
  }
  const auto gums = [](const Case& patient) {
    return surface_area(patient.find(Role::lower_gums)->mesh);
  };
  EXPECT_LT(gums(operated.patient), 0.85 * gums(builtin()));  // four of fourteen teeth
  EXPECT_GT(gums(operated.patient), 0.5 * gums(builtin()));
  EXPECT_FALSE(teeth.contains(35));
  EXPECT_TRUE(teeth.contains(33));
  EXPECT_TRUE(teeth.contains(45));
}

TEST(Reconstruction, leaves_out_landmarks_and_dangers_of_what_was_resected) {
  const Operated operated = apply_plan(builtin(), resected(43, 36));
  const Landmarks planned = planned_landmarks(operated);
  for (const char* gone :
       {"pogonion", "menton", "b_point", "lower_incisal_point", "lower_left_canine_tip"})
    EXPECT_FALSE(planned.find(gone)) << gone;
  for (const char* there : {"left_gonion", "upper_incisal_point", "soft_pogonion",
                            "lower_right_first_molar_mesiobuccal_cusp"})
    EXPECT_TRUE(planned.find(there)) << there;
  const ClinicalFrame frame = clinical_frame(builtin().landmarks);
  const MovementTable table = planned_movements(operated, frame);
  const auto has_row = [&](const char* label) {
    return std::any_of(table.rows.begin(), table.rows.end(),
                       [&](const MovementRow& row) { return row.label == label; });
  };
  EXPECT_FALSE(has_row("L1"));
  EXPECT_FALSE(has_row("Pog"));
  EXPECT_TRUE(has_row("U1"));
  EXPECT_TRUE(has_row("L6 right"));
  for (const MidlineRow& row : table.midlines) EXPECT_NE(row.label, "lower midline");
  for (const CephalometricMeasure& measure :
       cephalometry(frame, operated.patient.landmarks, planned)) {
    if (measure.name == "SNA") {
      EXPECT_TRUE(measure.after);
    }
    if (measure.name == "SNB" || measure.name == "overjet") {
      EXPECT_TRUE(measure.before) << measure.name;
      EXPECT_FALSE(measure.after) << measure.name;
    }
  }
  std::set<std::string> zones;
  for (const DangerFinding& finding : operated.cuts[0].dangers) zones.insert(finding.zone);
  EXPECT_FALSE(zones.contains("tooth 43"));
  EXPECT_FALSE(zones.contains("tooth 36"));
  EXPECT_FALSE(zones.contains("left mental foramen"));
  EXPECT_TRUE(zones.contains("tooth 37"));
  EXPECT_TRUE(zones.contains("left mandibular canal"));
  const Case after = operated_case(operated);
  EXPECT_FALSE(after.landmarks.find("pogonion"));
  EXPECT_TRUE(after.landmarks.find("lower_incisal_point"));  // motions are measured by it
}

TEST(Reconstruction, keeps_own_zones_and_drops_attachments_of_resected_bone) {
  Case patient = builtin();
  patient.tissue.attachments = {{.bone = mandible_body, .landmark = "pogonion"},
                                {.bone = mandible_body, .landmark = "left_gonion"}};
  Plan plan = resected(44, 36);
  plan.geometry = geometry_of(patient);
  PlanZone own;
  own.name = "tooth 44";  // as the user calls it
  own.kind = ZoneKind::tooth;
  own.points = {patient.landmarks.points.at("lower_right_canine_apex")};
  own.radius_mm = 20;
  plan.zones.push_back(own);
  const Operated operated = apply_plan(patient, plan);
  const auto& dangers = operated.cuts.at(0).dangers;
  EXPECT_TRUE(std::any_of(dangers.begin(), dangers.end(), [](const DangerFinding& finding) {
    return finding.zone == "tooth 44" && finding.distance_mm < 0;
  }));
  const Case after = operated_case(operated);
  ASSERT_EQ(after.tissue.attachments.size(), 1u);
  EXPECT_EQ(after.tissue.attachments[0].landmark, "left_gonion");
}

TEST(Reconstruction, follows_the_border_around_the_chin) {
  // Planes near one face of these defects meet the other limb, too.
  for (const auto& [from, to] : {std::pair{44, 36}, std::pair{43, 37}, std::pair{45, 36}}) {
    const Operated operated = apply_plan(builtin(), with_step(resected(from, to), fibula_graft(3)));
    ASSERT_TRUE(operated.problems.empty()) << operated.problems[0];
    const GraftLayout& graft = operated.grafts.at(0);
    for (const int i : {0, 1}) {
      const Eigen::Vector3d& end = i == 0 ? graft.curve.front() : graft.curve.back();
      EXPECT_LT((end - graft.defect.faces[i].point).norm(), 20) << from << " to " << to;
    }
    double longest = 0;
    for (std::size_t i = 1; i < graft.curve.size(); ++i)
      longest = std::max(longest, (graft.curve[i] - graft.curve[i - 1]).norm());
    EXPECT_LT(longest, 5) << from << " to " << to;
  }
}

TEST(Reconstruction, lays_pieces_that_meet_the_jaw_and_each_other) {
  const Plan plan = with_step(resected(), fibula_graft(2));
  const Operated operated = apply_plan(builtin(), plan);
  ASSERT_TRUE(operated.problems.empty()) << operated.problems[0];
  ASSERT_EQ(operated.grafts.size(), 1u);
  const GraftLayout& graft = operated.grafts[0];
  const BodyTree& bodies = operated.patient.bodies;
  const BodyId first = *bodies.find("fibula_1"), second = *bodies.find("fibula_2");
  EXPECT_EQ(bodies[bodies[first].parent].name, "mandible");
  EXPECT_EQ(bodies[second].parent, first);
  for (const Part& part : operated.patient.parts)
    if (part.role == Role::transplant) {
      EXPECT_TRUE(inspect(part.mesh).closed()) << part.name;
    }
  const auto faces = graft_faces(operated, graft);
  ASSERT_EQ(faces.size(), 3u);
  for (const GraftFaceReport& face : faces) {
    EXPECT_EQ(face.level, GraftFaceReport::Level::good) << face.piece << " to " << face.other;
    EXPECT_GT(face.share, 0.8) << face.piece << " to " << face.other;
  }
  // The clearance at the jaw, more beside the rim of its face; none between the mitred faces.
  EXPECT_GT(faces[0].contact.mean_gap_mm, 0.2 - 1e-6);
  EXPECT_LT(faces[0].contact.mean_gap_mm, 0.3);
  EXPECT_NEAR(faces[1].contact.mean_gap_mm, 0, 1e-3);
  EXPECT_NEAR(faces[1].share, 1, 0.02);
  EXPECT_EQ(faces[2].other, "mandible");
  EXPECT_LT(graft.curve_deviation_mm, 3);
}

TEST(Reconstruction, reports_the_gap_where_a_piece_is_moved_away) {
  Plan plan = with_step(resected(), fibula_graft(1));
  const GraftLayout graft = apply_plan(builtin(), plan).grafts[0];
  const Pose shift{Eigen::Quaterniond::Identity(), 1.6 * graft.defect.faces[0].normal};
  plan = with_step(std::move(plan), MoveStep{.segment = "fibula", .move = ExplicitMove{shift}});
  const Operated operated = apply_plan(builtin(), plan);
  const auto faces = graft_faces(operated, operated.grafts[0]);
  EXPECT_GT(faces[0].contact.mean_gap_mm, 1.8 - 1e-6);
  EXPECT_LT(faces[0].contact.mean_gap_mm, 1.9);
  EXPECT_EQ(faces[0].level, GraftFaceReport::Level::wide);
  EXPECT_EQ(faces[0].share, 0);
}

TEST(Reconstruction, warns_where_the_gap_is_one_at_which_bone_does_not_unite) {
  using Level = GraftFaceReport::Level;
  const Plan plan = with_step(resected(), fibula_graft(1));
  const GraftLayout graft = apply_plan(builtin(), plan).grafts[0];
  for (const auto& [shift_mm, level, words] :
       {std::tuple(2.8, Level::very_wide, "bone is not expected to unite"),
        std::tuple(9.0, Level::open, "not united")}) {
    const Pose shift{Eigen::Quaterniond::Identity(), shift_mm * graft.defect.faces[0].normal};
    const Operated operated = apply_plan(
        builtin(), with_step(plan, MoveStep{.segment = "fibula", .move = ExplicitMove{shift}}));
    EXPECT_EQ(graft_faces(operated, operated.grafts[0])[0].level, level) << shift_mm;
    const auto sentences = graft_sentences(operated, operated.grafts[0]);
    EXPECT_TRUE(std::any_of(sentences.begin(), sentences.end(), [&](const std::string& sentence) {
      return sentence.find(words) != std::string::npos;
    })) << shift_mm;
  }
}

TEST(Reconstruction, is_read_back_from_its_file_and_needs_its_resection) {
  GraftStep step = fibula_graft(3);
  step.curve = {{1, 2, 3.25}, {4, 5, 6}, {7, 8, 9}};
  step.height_mm = 8.5;
  step.starts_mm = {70, 100, 130};
  step.approach = "intraoral";
  const Plan plan = with_step(resected(), step);
  EXPECT_EQ(parse_plan("plan.json", plan_json(plan)), plan);
  EXPECT_THROW(without_step(plan, 2), InputError);
  EXPECT_THROW(with_reordered(plan, 3, 0), InputError);
  step.pieces = 5;
  EXPECT_THROW(with_replaced(plan, 3, step), InputError);
  EXPECT_THROW(with_step(plan, ResectStep{"tumour"}), InputError);
}

}  // namespace
