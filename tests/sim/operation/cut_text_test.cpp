#include "sim/operation/cut_text.h"

#include <gtest/gtest.h>

#include "tests/sim/operation/box_operation.h"

using namespace condyle;
using namespace condyle::test;

namespace {

std::string all_sentences(const Operated& operated) {
  std::string text;
  for (const CutReport& cut : operated.cuts)
    for (const auto& sentence : cut_sentences(cut, operated.patient.landmarks))
      text += sentence + "\n";
  return text;
}

void expect_sentence(const std::string& text, const std::string& words) {
  EXPECT_NE(text.find(words), std::string::npos) << text;
}

}  // namespace

TEST(CutText, StatesWhatEachCutDid) {
  const Case patient = operable_patient();
  const Operated through = apply_plan(patient, plan_of(patient, {chin_step()}));
  expect_sentence(all_sentences(through), "goes through, 18400 mm² of cut faces");
  expect_sentence(all_sentences(through), "mandible: 264.5 cm³, stays\nchin: 89.7 cm³\n");
  expect_sentence(all_sentences(through), "the saw removes 4.6 cm³");
  CutStep slot = chin_step(), miss = chin_step();
  slot.surfaces = {disc({0, -92, -70}, {0, 0, -1}, 40)};
  const std::string ends = all_sentences(apply_plan(patient, plan_of(patient, {slot})));
  expect_sentence(ends, "does not go through: ");
  expect_sentence(ends, " mm from ");
  miss.surfaces = {disc({0, -92, -170}, {0, 0, -1}, 40)};
  expect_sentence(all_sentences(apply_plan(patient, plan_of(patient, {miss}))),
                  "does not meet the bone");
}

TEST(CutText, SummarizesTheBonesOfEachBody) {
  const Case patient = operable_patient();
  const Operated operated = apply_plan(
      patient, plan_of(patient, {ramus_step({"proximal", "distal"}), chin_step("distal")}));
  const auto bones = operated_bones(operated);
  ASSERT_EQ(bones.size(), 3u);
  EXPECT_EQ(bones[0].name, "proximal");
  EXPECT_EQ(bones[0].parent, "mandible");
  EXPECT_EQ(bones[2].name, "chin");
  EXPECT_EQ(bones[2].parent, "distal");
  double sum = operated.cuts[1].kerf_volume_mm3;
  for (const BoneSummary& bone : bones) {
    EXPECT_TRUE(bone.is_segment);
    EXPECT_TRUE(bone.closed);
    sum += bone.volume_mm3;
  }
  EXPECT_NEAR(sum, 100 * 92 * 39, 1e-5);
  EXPECT_EQ(operated_segments(operated), (std::vector<std::string>{"proximal", "distal", "chin"}));
}

TEST(CutText, ListsSteps) {
  const Case patient = operable_patient();
  const std::string text =
      steps_text(plan_of(patient, {chin_step(), MoveStep{"chin", ClinicalMove{.forward_mm = 5}}}));
  expect_sentence(text, "  1  cut mandible: makes chin; kerf 0.5 mm\n");
  expect_sentence(text, "  2  move chin: forward 5.0 mm; about pogonion\n");
}

TEST(CutText, SaysOfACutBelowTheMarginsWhetherItWasRequested) {
  const Case patient = operable_patient();
  CutStep near = chin_step(), far = chin_step();
  near.surfaces = {disc({0, -92, -60}, {0, 0, -1})};  // through the mental foramen
  Operated operated = apply_plan(patient, plan_of(patient, {near}));
  EXPECT_TRUE(operated.cuts[0].is_dangerous());
  expect_sentence(all_sentences(operated), "although the step does not ask for it");
  near.below_margins = far.below_margins = true;
  operated = apply_plan(patient, plan_of(patient, {near}));
  expect_sentence(all_sentences(operated), "lies below the least margins, on request\n");
  expect_sentence(steps_text(plan_of(patient, {near})), "below the least margins on request");
  operated = apply_plan(patient, plan_of(patient, {far}));
  EXPECT_FALSE(operated.cuts[0].is_dangerous());
  expect_sentence(all_sentences(operated), "keeps the least margins");
  far.below_margins = false;
  EXPECT_EQ(all_sentences(apply_plan(patient, plan_of(patient, {far}))).find("margins"),
            std::string::npos);
}
