#include "sim/session/plan_stages.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>

#include "sim/frame/state_hash.h"
#include "tests/support/builtin.h"
#include "tests/support/reconstruction.h"

namespace condyle {
namespace {

/// A stage of the patient, with the milliseconds that it took.
template <class Work>
auto timed_stage(const char* name, Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  auto made = work();
  std::printf(
      "%s: %.0f ms\n", name,
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  return made;
}

Plan split_plan(const Case& patient, double back_mm) {
  Plan plan = with_step(empty_plan(patient),
                        CutStep{.osteotomy = "sagittal_split",
                                .pieces = {"proximal_left", "proximal_right", "distal"}});
  return with_step(std::move(plan), MoveStep{"distal", ClinicalMove{.forward_mm = -back_mm}});
}

/// Plan after plan, with what is kept between them, leads to the patient that is made at once.
TEST(PlanStages, LeadToThePatientMadeAtOnce) {
  const Case& head = test::builtin();
  SimulatorSettings settings;
  const auto loaded = make_session_patient(head, {}, settings, {});
  PlanStages stages(*loaded, settings);
  auto earlier = loaded;
  for (const double back_mm : {3.0, 4.0}) {
    const Plan plan = split_plan(head, back_mm);
    const Operated operated = timed_stage("replay", [&] { return stages.replay(plan); });
    const auto pieces = timed_stage("pieces", [&] { return stages.pieces(plan, operated); });
    EXPECT_EQ(pieces->scene.patient.parts.size(), operated.patient.parts.size());
    EXPECT_TRUE(pieces->at_rest.contacts.pairs.empty());
    const auto bones =
        timed_stage("contact", [&] { return stages.with_contact(*pieces, plan, *earlier); });
    EXPECT_EQ(bones->scene.tissue, nullptr);
    const auto face = timed_stage("face", [&] { return stages.with_face(*bones, plan); });
    const auto at_once =
        timed_stage("at once", [&] { return make_session_patient(head, {}, settings, {}, plan); });
    EXPECT_EQ(face->trouble, "");
    EXPECT_EQ(state_hash(face->at_rest), state_hash(at_once->at_rest));
    EXPECT_EQ(face->findings.overlaps.size(), at_once->findings.overlaps.size());
    ASSERT_EQ(face->scene.patient.parts.size(), at_once->scene.patient.parts.size());
    for (std::size_t i = 0; i < face->scene.patient.parts.size(); ++i)
      EXPECT_EQ(face->scene.patient.parts[i].mesh.vertices,
                at_once->scene.patient.parts[i].mesh.vertices);
    earlier = bones;
  }
}

/// What is found on a graft is there with the pieces, and stays.
TEST(PlanStages, KeepTheFindingsOnGrafts) {
  const Case& head = test::builtin();
  SimulatorSettings settings;
  settings.tissue = false;
  const auto loaded = make_session_patient(head, {}, settings, {});
  PlanStages stages(*loaded, settings);
  const Plan plan = with_step(test::resection_plan(head, 44, 47), test::fibula_graft(1));
  const auto pieces = stages.pieces(plan, stages.replay(plan));
  const auto bones = stages.with_contact(*pieces, plan, *loaded);
  ASSERT_EQ(pieces->findings.grafts.size(), 1u);
  EXPECT_GT(pieces->findings.grafts.begin()->second.size(), 3u);
  EXPECT_EQ(bones->findings.grafts, pieces->findings.grafts);
}

/// Undoing all of a plan gives the uncut patient back.
TEST(PlanStages, OfAnEmptyPlanGiveTheUncutPatient) {
  const Case& head = test::builtin();
  SimulatorSettings settings;
  const auto loaded = make_session_patient(head, {}, settings, {});
  PlanStages stages(*loaded, settings);
  const Plan none = empty_plan(head);
  const auto pieces = stages.pieces(none, stages.replay(none));
  const auto face = stages.with_face(*stages.with_contact(*pieces, none, *loaded), none);
  EXPECT_EQ(state_hash(face->at_rest), state_hash(loaded->at_rest));
}

}  // namespace
}  // namespace condyle
