#include "sim/plan/plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "engine/core/error.h"
#include "sim/plan/plan_history.h"
#include "tests/sim/plan/plans.h"

using namespace condyle;
using namespace condyle::test;
using Eigen::Vector3d;

namespace {

std::string edit_refusal(const std::function<Plan()>& edit) {
  try {
    edit();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "the edit was accepted";
  return "";
}

std::string step_refusal(const PlanAction& action) {
  return edit_refusal([&] { return with_step(sample_plan(), action); });
}

void expect_says(const std::string& text, const std::string& words) {
  EXPECT_NE(text.find(words), std::string::npos) << text;
}

std::vector<int> ids_of(const Plan& plan) {
  std::vector<int> ids;
  for (const auto& step : plan.steps) ids.push_back(step.id);
  return ids;
}

}  // namespace

TEST(Plan, EditsAreNewPlansAndStepsKeepTheirNumbers) {
  const Plan plan = sample_plan();
  EXPECT_EQ(ids_of(plan), (std::vector<int>{1, 2, 3, 4, 5}));
  const Plan shorter = without_step(plan, 2);
  EXPECT_EQ(ids_of(shorter), (std::vector<int>{1, 3, 4, 5}));
  EXPECT_EQ(plan, sample_plan());
  const Plan longer = with_step(shorter, NoteStep{"more"});
  EXPECT_EQ(ids_of(longer), (std::vector<int>{1, 3, 4, 5, 6}));
  const Plan changed = with_replaced(plan, 2, MoveStep{"maxilla", ClinicalMove{.forward_mm = 5}});
  EXPECT_EQ(ids_of(changed), ids_of(plan));
  EXPECT_NE(changed, plan);
  EXPECT_EQ(changed.steps[0], plan.steps[0]);
  const Plan other = with_reordered(plan, 5, 0);
  EXPECT_EQ(ids_of(other), (std::vector<int>{5, 1, 2, 3, 4}));
  EXPECT_EQ(with_reordered(other, 5, 4), plan);
  EXPECT_EQ(ids_of(with_reordered(plan, 1, 1 - 1)), ids_of(plan));
}

TEST(Plan, UnknownStepsAreNamed) {
  const std::string message = edit_refusal([] { return without_step(sample_plan(), 9); });
  expect_says(message, "no step 9");
  expect_says(message, "1, 2, 3, 4, 5");
  expect_says(edit_refusal([] { return without_step({}, 1); }), "empty");
  expect_says(edit_refusal([] { return with_reordered(sample_plan(), 5, 5); }), "number 6 of 5");
}

TEST(Plan, SegmentsAreMovedAfterTheyAreCut) {
  // The move of the maxilla before its cut.
  expect_says(edit_refusal([] { return with_reordered(sample_plan(), 2, 0); }),
              "step 2 (move maxilla): needs \"maxilla\", which only step 1 (cut le_fort_1) makes");
  // A second cut that makes the same piece.
  expect_says(step_refusal(le_fort()), "already made by step 1");
  // A piece is cut again.
  CutStep split{.osteotomy = "two_piece", .target = "maxilla", .pieces = {"left", "right"}};
  const Plan plan = with_step(sample_plan(), split);
  expect_says(edit_refusal([&] { return with_reordered(plan, 6, 0); }), "\"maxilla\"");
  // A piece that keeps the name of the body that is cut.
  CutStep chin = chin_cut();
  chin.pieces = {"mandible", "chin"};
  EXPECT_NO_THROW(with_replaced(sample_plan(), 3, chin));
}

TEST(Plan, RemovedCutsLeaveMovesThatAreReported) {
  const BodyTree bodies = native_bodies();
  EXPECT_NO_THROW(check_segments(sample_plan(), bodies));
  const Plan plan = without_step(sample_plan(), 1);
  try {
    check_segments(plan, bodies);
    ADD_FAILURE();
  } catch (const InputError& error) {
    expect_says(error.what(), "step 2 (move maxilla): \"maxilla\" is neither");
  }
}

TEST(Plan, ImpossibleStepsAreRefusedWithItemAndValue) {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  expect_says(step_refusal(MoveStep{"maxilla", ClinicalMove{.forward_mm = 200}}),
              "step 6 (move maxilla): forward_mm is 200");
  expect_says(step_refusal(MoveStep{"", ClinicalMove{}}), "segment is \"\"");
  expect_says(step_refusal(NoteStep{}), "0 characters");
  expect_says(step_refusal(CutStep{}), "osteotomy is empty");
  const auto cut_with = [](const std::function<void(CutStep&)>& change) {
    CutStep cut = chin_cut();
    cut.pieces = {"a", "b"};
    change(cut);
    return step_refusal(cut);
  };
  const auto sheet = [](CutStep& cut) -> BentSheet& {
    return std::get<BentSheet>(cut.surfaces[0]);
  };
  const auto plane = [](CutStep& cut, std::size_t i) -> PlanePatch& {
    return std::get<PlanePatch>(cut.surfaces[i]);
  };
  expect_says(cut_with([](CutStep& cut) { cut.kerf_mm = 2.5; }), "kerf_mm is 2.5");
  expect_says(cut_with([](CutStep& cut) { cut.kerf_mm = nothing; }), "kerf_mm is nan");
  expect_says(cut_with([](CutStep& cut) { cut.pieces.clear(); }), "pieces is empty");
  expect_says(cut_with([](CutStep& cut) { cut.target.clear(); }), "target is empty");
  expect_says(cut_with([](CutStep& cut) { cut.parameters["tilt"] = nothing; }),
              "parameters.tilt is nan");
  expect_says(cut_with([&](CutStep& cut) { plane(cut, 1).normal.setZero(); }),
              "surfaces[1].normal is (0, 0, 0)");
  expect_says(cut_with([&](CutStep& cut) { plane(cut, 1).reach = -3.0; }),
              "surfaces[1].radius_mm is -3");
  expect_says(cut_with([&](CutStep& cut) { plane(cut, 1).point.x() = nothing; }),
              "surfaces[1].point is (nan, 2, 3)");
  expect_says(cut_with([&](CutStep& cut) {
                plane(cut, 2).normal = {-2, 0, 0};
              }),
              "surfaces[2].axis is parallel");
  expect_says(cut_with([&](CutStep& cut) { sheet(cut).polyline.resize(1); }),
              "surfaces[0].polyline has 1 points");
  expect_says(cut_with([&](CutStep& cut) { sheet(cut).polyline[2] = sheet(cut).polyline[1]; }),
              "surfaces[0].polyline[2] repeats");
  expect_says(cut_with([&](CutStep& cut) { sheet(cut).depth_mm = 0; }),
              "surfaces[0].depth_mm is 0");
}

TEST(Plan, ACutIsChangedWhereItStands) {
  Plan plan = sample_plan();
  CutStep cut = le_fort();
  cut.kerf_mm = 1;
  Plan changed = with_recut(plan, 1, cut);
  EXPECT_EQ(std::get<CutStep>(changed.steps[0].action), cut);
  EXPECT_EQ(changed, with_replaced(plan, 1, cut));
  // Other steps follow the new names of segments; a move keeps its point.
  cut.pieces = {"upper jaw"};
  changed = with_recut(plan, 1, cut);
  const auto& move = std::get<MoveStep>(changed.steps[1].action);
  EXPECT_EQ(move.segment, "upper jaw");
  EXPECT_EQ(std::get<ClinicalMove>(move.move),
            (ClinicalMove{.about = "upper_incisal_point", .forward_mm = 4, .up_mm = 2}));
  CutStep chin = chin_cut();
  chin.pieces = {"chin", "mandible rest"};
  changed = with_recut(plan, 3, chin);
  EXPECT_EQ(std::get<MoveStep>(changed.steps[3].action).segment, "mandible rest");
  EXPECT_EQ(std::get<MoveStep>(changed.steps[3].action).move,
            std::get<MoveStep>(plan.steps[3].action).move);
  // With another number of segments they keep the names that they have.
  cut.pieces = {"left", "right"};
  EXPECT_EQ(std::get<MoveStep>(with_recut(plan, 1, cut).steps[1].action).segment, "maxilla");
  expect_says(edit_refusal([&] { return with_recut(plan, 2, cut); }),
              "step 2 (move maxilla) is no cut");
  cut.pieces = {"chin"};
  expect_says(edit_refusal([&] { return with_recut(plan, 1, cut); }), "already made by step 1");
  expect_says(edit_refusal([&] { return with_recut(plan, 9, cut); }), "no step 9");
}

TEST(PlanHistory, UndoAndRedoNameTheEdit) {
  PlanHistory history{Plan{.name = "p"}};
  EXPECT_FALSE(history.undo());
  EXPECT_FALSE(history.redo());
  std::vector<Plan> plans = {history.plan()};
  const std::vector<PlanAction> actions = {le_fort(), MoveStep{"maxilla", ClinicalMove{.up_mm = 2}},
                                           NoteStep{"done"}};
  for (const auto& action : actions) {
    history.edit(with_step(history.plan(), action), step_title(action));
    plans.push_back(history.plan());
  }
  history.edit(history.plan(), "nothing");  // is ignored
  EXPECT_EQ(history.undoable(), "note");
  EXPECT_EQ(history.undo(), "note");
  EXPECT_EQ(history.undo(), "move maxilla");
  EXPECT_EQ(history.plan(), plans[1]);
  EXPECT_EQ(history.redoable(), "move maxilla");
  EXPECT_EQ(history.redo(), "move maxilla");
  EXPECT_EQ(history.plan(), plans[2]);
  EXPECT_EQ(history.undo(), "move maxilla");
  history.edit(with_step(history.plan(), NoteStep{"other"}), "another note");
  EXPECT_FALSE(history.redo());  // the undone edits are forgotten
  EXPECT_EQ(history.undo(), "another note");
  EXPECT_EQ(history.undo(), "cut le_fort_1");
  EXPECT_FALSE(history.undo());
  EXPECT_EQ(history.plan(), plans[0]);
}

TEST(CaseGeometry, OtherCasesAndEditedLandmarksAreToldApart) {
  const Case patient = box_patient();
  const CaseGeometry planned = geometry_of(patient);
  EXPECT_EQ(planned.parts.size(), 2u);  // eyes are only drawn
  EXPECT_EQ(compare_geometry(planned, geometry_of(patient)).match, CaseMatch::same);

  Case painted = patient;
  painted.name = "renamed";
  painted.parts[0].mesh.colors.assign(4, Eigen::Vector3f(1, 0, 0));
  painted.parts[2].mesh.vertices[0].x() += 1;
  EXPECT_EQ(compare_geometry(planned, geometry_of(painted)).match, CaseMatch::same);

  Case edited = patient;
  edited.landmarks.points["pogonion"] += Vector3d(0, 0.6, 0.8);
  edited.landmarks.points["menton"] = {0, 0, 0};
  edited.landmarks.points.erase("pns");
  const CaseComparison marks = compare_geometry(planned, geometry_of(edited));
  EXPECT_EQ(marks.match, CaseMatch::landmarks_edited);
  EXPECT_EQ(marks.differences, (std::vector<std::string>{"pns is missing", "pogonion moved by 1 mm",
                                                         "menton is new"}));

  Case other = edited;
  other.parts[1].mesh.vertices[3].z() = std::nextafter(other.parts[1].mesh.vertices[3].z(), 99);
  const CaseComparison shape = compare_geometry(planned, geometry_of(other));
  EXPECT_EQ(shape.match, CaseMatch::other_case);
  EXPECT_EQ(shape.differences, (std::vector<std::string>{"mandible has another shape"}));
  Case turned = patient;
  std::swap(turned.parts[0].mesh.triangles[0][0], turned.parts[0].mesh.triangles[0][1]);
  EXPECT_EQ(compare_geometry(planned, geometry_of(turned)).differences,
            (std::vector<std::string>{"skull has another shape"}));
  other.parts.erase(other.parts.begin());
  EXPECT_EQ(compare_geometry(planned, geometry_of(other)).differences.front(), "skull is missing");
}
