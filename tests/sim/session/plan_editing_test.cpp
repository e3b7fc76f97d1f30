// Edits of a plan in a session: what each does to the plan, its file, and what is shown.
#include "sim/session/plan_editing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "engine/core/error.h"
#include "sim/phantom/phantom.h"
#include "sim/plan/plan_file.h"
#include "sim/session/session_patient.h"
#include "tests/support/program.h"

namespace condyle {
namespace {

/// The built-in patient, whose plan is edited as a session edits it.
struct PlanEditing : testing::Test {
  static const Case& uncut() {
    static const Case patient = builtin_patient();
    return patient;
  }
  PlanDocument document{empty_plan(uncut())};

  Operated operated() const { return apply_plan(uncut(), document.plan()); }
  void edit(const PlanEdit& edit, const HeldSegments& held = {}) {
    EditedPlan edited = edited_plan(uncut(), document.plan(), operated(), edit, held);
    document.edit(std::move(edited.plan), edited.what);
  }
  void chin_forward(double mm) {
    edit(plan_edit::AddOsteotomy{"genioplasty"});
    edit(plan_edit::AddMove{"chin"});
    edit(plan_edit::SetNumber{2, "forward_mm", mm});
  }
  PlanView view() const { return plan_view(document, operated(), {}); }
};

const PlanNumber& number_named(const PlanStepView& step, const std::string& name) {
  const auto at = std::find_if(step.numbers.begin(), step.numbers.end(),
                               [&](const PlanNumber& number) { return number.name == name; });
  if (at == step.numbers.end()) throw std::runtime_error("no number " + name);
  return *at;
}

TEST_F(PlanEditing, StepsAreAddedAndTheirNumbersSet) {
  EXPECT_TRUE(view().steps.empty());
  EXPECT_TRUE(view().segments.empty());
  edit(plan_edit::AddOsteotomy{"genioplasty"});
  ASSERT_EQ(view().segments.size(), 1u);
  EXPECT_EQ(view().segments[0].name, "chin");
  edit(plan_edit::AddMove{"chin"});
  edit(plan_edit::SetNumber{2, "forward_mm", 6});
  edit(plan_edit::SetNumber{1, "height_mm", 13});
  edit(plan_edit::SetNumber{1, "kerf_mm", 0.5});
  const PlanView shown = view();
  ASSERT_EQ(shown.steps.size(), 2u);
  EXPECT_EQ(shown.steps[0].title, "Genioplasty");
  EXPECT_EQ(number_named(shown.steps[0], "height_mm").value, 13);
  EXPECT_EQ(number_named(shown.steps[0], "kerf_mm").value, 0.5);
  EXPECT_EQ(number_named(shown.steps[1], "forward_mm").value, 6);
  EXPECT_TRUE(shown.segments.empty()) << "the chin has its move";
  const auto pogonion = std::find_if(shown.displacements.begin(), shown.displacements.end(),
                                     [](const PlanMeasure& row) { return row.label == "Pog"; });
  ASSERT_NE(pogonion, shown.displacements.end());
  EXPECT_EQ(pogonion->after, "6.0 forward");
  EXPECT_THROW(edit(plan_edit::SetNumber{1, "height_mm", 500}), InputError);
  EXPECT_THROW(edit(plan_edit::SetNumber{2, "height_mm", 5}), InputError);
  EXPECT_THROW(edit(plan_edit::Shift{1, false}), InputError) << "it is the first step";
  EXPECT_THROW(edit(plan_edit::Remove{1}), InputError) << "the chin would not exist";
  edit(plan_edit::Remove{2});
  EXPECT_EQ(view().steps.size(), 1u);
}

TEST_F(PlanEditing, APositionByHandIsAddedToThePlannedOne) {
  chin_forward(4);
  Pose up;
  up.t = clinical_frame(uncut().landmarks, {}).up * 2;
  edit(plan_edit::TakePositions{}, {{"chin", up}});
  const PlanStepView move = view().steps[1];
  EXPECT_NEAR(number_named(move, "forward_mm").value, 4, 1e-9);
  EXPECT_NEAR(number_named(move, "up_mm").value, 2, 1e-9);
  EXPECT_THROW(edit(plan_edit::TakePositions{}), InputError) << "nothing is held";
}

TEST_F(PlanEditing, AnOtherMoveIsADisplacementFromThePlannedPosition) {
  chin_forward(4);
  const Operated now = operated();
  const Plan before = document.plan();
  edit(plan_edit::SetNumber{2, "forward_mm", 7});
  const auto changed = changed_positions(now, before, document.plan());
  const auto chin = now.patient.bodies.find("chin");
  ASSERT_TRUE(chin);
  ASSERT_EQ(changed.size(), static_cast<std::size_t>(now.patient.bodies.size()));
  for (std::size_t b = 0; b < changed.size(); ++b)
    EXPECT_EQ(changed[b].has_value(), b == index_of(*chin)) << b;
  EXPECT_NEAR(changed[index_of(*chin)]->t.norm(), 3, 1e-9);
  edit(plan_edit::SetNumber{1, "height_mm", 13});
  EXPECT_TRUE(changed_positions(now, before, document.plan()).empty()) << "another cut";
}

TEST_F(PlanEditing, APlanWithoutAFileIsKeptAsADraft) {
  const test::Folder folder;
  const std::filesystem::path draft = folder / "drafts/plan.json";
  document = PlanDocument(empty_plan(uncut()), draft);
  edit(plan_edit::AddOsteotomy{"genioplasty"});
  edit(plan_edit::AddMove{"chin"});
  EXPECT_EQ(load_plan(draft), document.plan());
  document.undo();
  EXPECT_EQ(load_plan(draft), document.plan());
  document.save_as(folder / "plan.json");
  EXPECT_FALSE(std::filesystem::exists(draft));
}

TEST_F(PlanEditing, UndoGoesBackBeyondTheFirstSave) {
  const test::Folder folder;
  const std::filesystem::path file = folder / "plan.json", other = folder / "other.json";
  edit(plan_edit::AddOsteotomy{"genioplasty"});
  const Plan first = document.plan();
  edit(plan_edit::AddMove{"chin"});
  document.save_as(file);
  document.undo();
  EXPECT_EQ(document.plan(), first);
  EXPECT_EQ(load_plan(file), first);
  document.undo();
  EXPECT_TRUE(load_plan(file).steps.empty());
  document.redo();
  document.redo();
  EXPECT_EQ(document.plan().steps.size(), 2u);

  // Nothing else is overwritten.
  test::write_text(other, "{}");
  EXPECT_THROW(document.save_as(other), InputError);
  EXPECT_EQ(test::read_text(other), "{}");
  save_plan(first, other);
  EXPECT_THROW(document.save_as(other), InputError);
  EXPECT_EQ(load_plan(other), first);
}

TEST_F(PlanEditing, AnOverlapIsTrimmed) {
  edit(plan_edit::AddOsteotomy{"sagittal_split"});
  edit(plan_edit::AddMove{"distal"});
  edit(plan_edit::SetNumber{2, "forward_mm", -4});
  const auto overlap = [&] { return segment_overlaps(operated(), "distal"); };
  ASSERT_FALSE(overlap().empty());
  edit(plan_edit::Trim{"distal"});
  // A trim removes bone; roots that reach into the other segment stay.
  const auto& bones = operated().origin;
  for (const SegmentOverlap& each : overlap())
    EXPECT_FALSE(each.kind == SegmentOverlap::Kind::trimmed && bones.contains(each.a) &&
                 bones.contains(each.b))
        << overlap_text(each, uncut().landmarks);
  EXPECT_EQ(view().steps[2].title, "Trim distal");
  EXPECT_FALSE(view().steps[2].findings.empty());
}

TEST_F(PlanEditing, OfTwoMovesTheLastIsEdited) {
  chin_forward(4);
  Plan plan = with_step(document.plan(), document.plan().steps[1].action);
  document.edit(plan, "second move");
  edit(plan_edit::SetNumber{3, "forward_mm", 7});
  const auto forward = [&](std::size_t i) { return number_named(view().steps[i], "forward_mm"); };
  EXPECT_EQ(forward(1).value, 4);
  EXPECT_EQ(forward(2).value, 7);
  EXPECT_NEAR(changed_positions(apply_plan(uncut(), plan), plan,
                                document.plan())[index_of(*operated().patient.bodies.find("chin"))]
                  ->t.norm(),
              3, 1e-9);
}

TEST_F(PlanEditing, EveryEditIsSavedAndUndoneInTheFile) {
  const test::Folder folder;
  const std::filesystem::path file = folder / "plan.json";
  edit(plan_edit::AddOsteotomy{"genioplasty"});
  document.save_as(file);
  edit(plan_edit::AddMove{"chin"});
  edit(plan_edit::SetNumber{2, "up_mm", 3});
  EXPECT_EQ(load_plan(file), document.plan());
  const Plan last = document.plan();
  document.undo();
  EXPECT_EQ(load_plan(file), document.plan());
  EXPECT_FALSE(document.plan() == last);
  document.redo();
  EXPECT_EQ(load_plan(file), last);

  PlanDocument again(file);
  EXPECT_EQ(again.plan(), last);
  EXPECT_EQ(again.history().undoable(), "move chin");
  again.undo();
  document.undo();
  EXPECT_EQ(load_plan(file), document.plan()) << "the file decides where two programs edit it";
}

}  // namespace
}  // namespace condyle
