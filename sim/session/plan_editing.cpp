#include "sim/session/plan_editing.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/error.h"
#include "sim/frame/part_names.h"
#include "sim/graft/donor.h"
#include "sim/operation/cut_text.h"
#include "sim/operation/edit_cut.h"
#include "sim/operation/graft_steps.h"
#include "sim/operation/trim_segments.h"
#include "sim/osteotomy/osteotomy.h"
#include "sim/osteotomy/osteotomy_label.h"
#include "sim/plan/cephalometry.h"
#include "sim/plan/clinical_frame.h"
#include "sim/session/drawn_cut.h"
#include "sim/session/session_splint.h"

namespace condyle {
namespace {

constexpr const char* kerf_number = "kerf_mm";
constexpr const char* depth_number = "depth_mm";  // of a drawn cut
constexpr double max_depth_mm = 200;

const PlanStep* move_of(const Plan& plan, const std::string& segment) {
  for (auto step = plan.steps.rbegin(); step != plan.steps.rend(); ++step)  // the last one counts
    if (const auto* move = std::get_if<MoveStep>(&step->action))
      if (move->segment == segment) return &*step;
  return nullptr;
}

double* number_of(ClinicalMove& move, const std::string& name) {
  const std::map<std::string, double*> numbers = {
      {"forward_mm", &move.forward_mm}, {"up_mm", &move.up_mm},       {"left_mm", &move.left_mm},
      {"pitch_deg", &move.pitch_deg},   {"roll_deg", &move.roll_deg}, {"yaw_deg", &move.yaw_deg}};
  const auto found = numbers.find(name);
  return found == numbers.end() ? nullptr : found->second;
}

/// A move as a clinical one: of a pose, that with this pose about the segment's usual point.
ClinicalMove in_clinical_words(const Operated& operated, const Plan& plan, const MoveStep& step) {
  if (const auto* move = std::get_if<ClinicalMove>(&step.move)) return *move;
  const Landmarks& landmarks = operated.patient.landmarks;
  ClinicalMove usual;
  usual.about = point_name(usual, step.segment);
  if (!landmarks.find(usual.about)) usual.about = "centroid";
  return clinical_move(std::get<ExplicitMove>(step.move).X_CS,
                       clinical_frame(landmarks, plan.reference),
                       rotation_point(operated, step.segment, usual), usual.about);
}

EditedPlan add_osteotomy(const Plan& plan, const Operated& operated, const std::string& name) {
  CutStep cut{.osteotomy = name, .kerf_mm = default_kerf_mm(name)};
  cut.pieces = segment_names(operated.patient, cut);
  EditedPlan edited{with_step(plan, cut), step_title(cut)};
  edited.step = edited.plan.steps.back().id;
  return edited;
}

EditedPlan add_drawn_cut(const Plan& plan, const Operated& operated,
                         const plan_edit::DrawCut& drawing) {
  const CutStep cut = drawn_cut(operated, drawing);
  EditedPlan edited{with_step(plan, cut), "draw a cut of " + readable_name(drawing.part)};
  edited.step = edited.plan.steps.back().id;
  return edited;
}

EditedPlan move_point(const Case& uncut, const Plan& plan, const Operated& operated,
                      const plan_edit::MovePoint& edit) {
  const PlanStep& step = step_of(plan, edit.step);
  const auto* cut = std::get_if<CutStep>(&step.action);
  if (!cut) throw InputError(step_name(step) + " has no points");
  CutStep changed = with_point(operated, *cut, edit);
  changed.below_margins = false;  // asked anew
  return {with_changed_cut(uncut, plan, edit.step, changed), "edit " + step_name(step), edit.step};
}

/// The sheet of a cut that was drawn; null of others.
template <class Cut>
auto* drawn_sheet(Cut& cut) {
  return cut.surfaces.size() == 1 ? std::get_if<BentSheet>(&cut.surfaces.front()) : nullptr;
}

EditedPlan edited_move(const Plan& plan, const MoveStep& move) {
  EditedPlan edited{with_move(plan, move), step_title(move)};
  edited.step = move_of(edited.plan, move.segment)->id;
  return edited;
}

EditedPlan set_graft_number(const Plan& plan, const PlanStep& step, GraftStep graft,
                            const plan_edit::SetNumber& edit) {
  const std::map<std::string, double*> numbers = {{"roll_deg", &graft.roll_deg},
                                                  {"kerf_mm", &graft.kerf_mm},
                                                  {"spacing_mm", &graft.spacing_mm},
                                                  {"clearance_mm", &graft.clearance_mm}};
  const auto number = numbers.find(edit.name);
  if (edit.name == "pieces") {
    graft.pieces = static_cast<int>(std::lround(edit.value));
    graft.starts_mm.clear();  // they were those of other pieces
  } else if (number != numbers.end()) {
    *number->second = edit.value;
  } else {
    throw InputError(step_name(step) + " has no " + edit.name);
  }
  return {with_replaced(plan, step.id, graft), "edit " + step_name(step), step.id};
}

EditedPlan set_number(const Case& uncut, const Plan& plan, const Operated& operated,
                      const plan_edit::SetNumber& edit) {
  const PlanStep& step = step_of(plan, edit.step);
  if (const auto* move = std::get_if<MoveStep>(&step.action)) {
    ClinicalMove changed = in_clinical_words(operated, plan, *move);
    double* number = number_of(changed, edit.name);
    if (!number) throw InputError(step_name(step) + " has no " + edit.name);
    *number = edit.value;
    const MoveStep next{move->segment, changed};
    return {with_replaced(plan, edit.step, next), step_title(next), edit.step};
  }
  if (const auto* graft = std::get_if<GraftStep>(&step.action))
    return set_graft_number(plan, step, *graft, edit);
  const auto* before = std::get_if<CutStep>(&step.action);
  if (!before) throw InputError(step_name(step) + " has no " + edit.name);
  CutStep cut = *before;
  cut.below_margins = false;  // asked anew
  BentSheet* sheet = drawn_sheet(cut);
  if (edit.name == kerf_number)
    cut.kerf_mm = edit.value;
  else if (edit.name == depth_number && sheet)
    sheet->depth_mm = edit.value;
  else
    cut.parameters[edit.name] = edit.value;
  return {with_changed_cut(uncut, plan, edit.step, cut), "edit " + step_name(step), edit.step};
}

EditedPlan shifted(const Plan& plan, const plan_edit::Shift& edit) {
  const PlanStep& step = step_of(plan, edit.step);
  const auto at = static_cast<std::size_t>(&step - plan.steps.data());
  if (edit.later ? at + 1 == plan.steps.size() : at == 0)
    throw InputError(step_name(step) + (edit.later ? " is the last step" : " is the first step"));
  return {with_reordered(plan, edit.step, edit.later ? at + 1 : at - 1),
          "reorder " + step_name(step)};
}

/// By how much the hands displace a body from its planned position; none where they do not.
std::optional<Pose> hand_displacement(const BodyTree& bodies, BodyId body,
                                      const HeldSegments& held) {
  std::optional<Pose> X;
  for (BodyId each = body; each != cranium_body; each = bodies[each].parent)
    if (const auto hand = held.find(bodies[each].name); hand != held.end())
      X = X ? hand->second * *X : hand->second;
  return X;
}

EditedPlan take_positions(Plan plan, const Operated& operated, const HeldSegments& held) {
  const BodyTree& bodies = operated.patient.bodies;
  const ClinicalFrame frame = clinical_frame(operated.patient.landmarks, plan.reference);
  std::vector<std::string> moved;
  // From the root outward, so that a segment that is itself held goes along with its parent first.
  for (int b = 1; b < bodies.size(); ++b) {
    const std::string& name = bodies[BodyId{b}].name;
    const auto X = hand_displacement(bodies, BodyId{b}, held);
    if (!X || (!held.contains(name) && !move_of(plan, name))) continue;
    MoveStep step{name, ExplicitMove{*X * operated.poses[BodyId{b}]}};
    step.move = in_clinical_words(operated, plan, step);
    plan = with_move(std::move(plan), step);
    if (held.contains(name)) moved.push_back(name);
  }
  if (moved.empty()) throw InputError("no segment is held by hand");
  return {std::move(plan), fmt::format("move {} by hand", fmt::join(moved, ", "))};
}

EditedPlan add_trim(const Plan& plan, const Operated& operated, const std::string& segment) {
  TrimStep trim{segment, trimming_segments(operated, segment)};
  if (trim.of.empty())
    throw InputError(segment + " overlaps no other segment of its bone: there is nothing to trim");
  for (const PlanStep& step : plan.steps) {
    const auto* known = std::get_if<TrimStep>(&step.action);
    if (!known || known->segment != segment) continue;
    for (const std::string& other : known->of)
      if (std::find(trim.of.begin(), trim.of.end(), other) == trim.of.end())
        trim.of.push_back(other);
    return {with_replaced(plan, step.id, trim), step_title(trim), step.id};
  }
  EditedPlan edited{with_step(plan, trim), step_title(trim)};
  edited.step = edited.plan.steps.back().id;
  return edited;
}

EditedPlan add_step(const Plan& plan, const PlanAction& action) {
  EditedPlan edited{with_step(plan, action), step_title(action)};
  edited.step = edited.plan.steps.back().id;
  return edited;
}

EditedPlan add_graft(const Plan& plan, const plan_edit::Graft& edit) {
  GraftStep graft{.donor = edit.donor, .replaces = edit.segment};
  const auto is_taken = [&](const std::string& name) {
    return std::any_of(plan.steps.begin(), plan.steps.end(), [&](const PlanStep& step) {
      const auto* known = std::get_if<GraftStep>(&step.action);
      return known && known->name == name;
    });
  };
  for (int i = 2; is_taken(graft.name); ++i) graft.name = fmt::format("graft{}", i);
  return add_step(plan, graft);
}

std::vector<PlanNumber> numbers_of(const GraftStep& graft) {
  const GraftStep standard;
  std::vector<PlanNumber> numbers = {
      {"pieces", "Pieces", "", "Separate pieces with mitred faces", 1, max_graft_pieces,
       double(standard.pieces), double(graft.pieces)},
      {"roll_deg", "Roll", "deg", "Of the donor about its own axis", -180, 180, standard.roll_deg,
       graft.roll_deg},
      {"kerf_mm", "Kerf", "mm", "Of the saw on the donor", 0, max_kerf_mm, standard.kerf_mm,
       graft.kerf_mm},
      {"spacing_mm", "Spacing", "mm", "Between neighbouring saw cuts on the donor", 0, 30,
       standard.spacing_mm, graft.spacing_mm},
      {"clearance_mm", "Clearance", "mm", "Between the graft's end faces and the bone", 0, 5,
       standard.clearance_mm, graft.clearance_mm}};
  return numbers;
}

std::vector<PlanNumber> numbers_of(const CutStep& cut) {
  std::vector<PlanNumber> numbers;
  if (const BentSheet* sheet = drawn_sheet(cut)) {
    numbers.push_back(
        {depth_number, "Depth", "mm",
         "Of the saw cut, from its deepest drawn point along the direction of the view "
         "in which it was drawn",
         0.5, max_depth_mm, sheet->depth_mm, sheet->depth_mm});
    numbers.push_back(
        {kerf_number, "Kerf", "mm", "Thickness of the saw cut", 0, max_kerf_mm, 0, cut.kerf_mm});
  }
  if (cut.osteotomy.empty() || !cut.surfaces.empty()) return numbers;
  for (const OsteotomyParameter& known : osteotomy_parameters(cut.osteotomy)) {
    const auto set = cut.parameters.find(known.name);
    std::string label = known.name;
    for (const char* unit : {"_mm", "_deg"})
      if (label.ends_with(unit)) label.resize(label.size() - std::string(unit).size());
    numbers.push_back({known.name, display_name(label), known.unit, known.meaning, known.low,
                       known.high, known.standard,
                       set == cut.parameters.end() ? known.standard : set->second});
  }
  numbers.push_back({kerf_number, "Kerf", "mm", "Thickness of the saw cut", 0, max_kerf_mm,
                     default_kerf_mm(cut.osteotomy), cut.kerf_mm});
  return numbers;
}

std::vector<PlanNumber> numbers_of(const Operated& operated, const Plan& plan,
                                   const MoveStep& step) {
  ClinicalMove move;
  try {
    move = in_clinical_words(operated, plan, step);
  } catch (const InputError&) {  // no directions, or the segment no longer exists
    return {};
  }
  const std::string about = readable_name(point_name(move, step.segment));
  std::vector<PlanNumber> numbers = {
      {"forward_mm", "Forward", "mm", "Advancement of the " + about + "; negative: setback"},
      {"up_mm", "Up", "mm", "Impaction at the " + about + "; negative: down"},
      {"left_mm", "Left", "mm", "To the patient's left, of the " + about + "; negative: right"},
      {"pitch_deg", "Pitch", "deg", "Front down, back up; about the " + about},
      {"roll_deg", "Roll", "deg", "Cant: the left side down; about the " + about},
      {"yaw_deg", "Yaw", "deg", "The front to the patient's left; about the " + about}};
  for (PlanNumber& number : numbers) {
    number.high = number.unit == "mm" ? max_move_mm : max_turn_deg;
    number.low = -number.high;
    number.value = *number_of(move, number.name);
    if (std::abs(number.value) < 1e-6) number.value = 0;  // of a pose, up to rounding
  }
  return numbers;
}

PlanStepView step_view(const Plan& plan, const Operated& operated,
                       const OperationFindings& findings, const PlanStep& step) {
  PlanStepView view{.id = step.id, .title = step_title(step.action)};
  view.details = step_details(step.action);
  if (const auto* cut = std::get_if<CutStep>(&step.action)) {
    view.title = cut->osteotomy.empty() ? "Cut of " + readable_name(cut->target)
                                        : osteotomy_label(cut->osteotomy);
    view.numbers = numbers_of(*cut);
    view.is_cut = true;
    for (const CutReport& report : operated.cuts) {
      if (report.step != step.id) continue;
      view.findings = cut_sentences(report, operated.patient.landmarks);
      view.warns = report.needs_attention();
    }
  } else if (const auto* resection = std::get_if<ResectStep>(&step.action)) {
    view.title = "Resect " + readable_name(resection->segment);
  } else if (const auto* graft = std::get_if<GraftStep>(&step.action)) {
    view.title = "Graft " + readable_name(graft->name);
    view.numbers = numbers_of(*graft);
    if (const auto found = findings.grafts.find(graft->name); found != findings.grafts.end())
      view.findings = found->second;
  } else if (std::holds_alternative<NoteStep>(step.action)) {
    view.title = "Note";
  } else if (const auto* move = std::get_if<MoveStep>(&step.action)) {
    view.title = "Move " + readable_name(move->segment);
    view.numbers = numbers_of(operated, plan, *move);
  } else if (const auto* trim = std::get_if<TrimStep>(&step.action)) {
    view.title = "Trim " + readable_name(trim->segment);
    for (const TrimReport& report : operated.trims) {
      if (report.step != step.id) continue;
      view.findings = trim_sentences(report);
      view.warns = report.is_dangerous();
    }
  }
  return view;
}

std::string millimetres(double value, const char* positive, const char* negative) {
  return std::abs(value) < 0.05 ? std::string() : in_words(value, positive, negative);
}

/// What can be resected, and replaced by a graft.
void add_graft_choices(PlanView& view, const Plan& plan, const Operated& operated) {
  for (const std::string& segment : operated_segments(operated))
    if (!move_of(plan, segment)) view.resectable.push_back({segment, display_name(segment)});
  for (const Resection& resection : operated.resections)
    if (std::none_of(operated.grafts.begin(), operated.grafts.end(), [&](const GraftLayout& graft) {
          return graft.step.replaces == resection.segment;
        }))
      view.replaceable.push_back({resection.segment, display_name(resection.segment)});
  for (const std::string& donor : donor_names())
    view.donors.push_back({donor, display_name(donor)});
}

EditedPlan unchecked_edit(const Case& uncut, const Plan& plan, const Operated& operated,
                          const PlanEdit& edit, const HeldSegments& held) {
  if (const auto* add = std::get_if<plan_edit::AddOsteotomy>(&edit))
    return add_osteotomy(plan, operated, add->name);
  if (const auto* drawing = std::get_if<plan_edit::DrawCut>(&edit))
    return add_drawn_cut(plan, operated, *drawing);
  if (const auto* move = std::get_if<plan_edit::MovePoint>(&edit))
    return move_point(uncut, plan, operated, *move);
  if (const auto* add = std::get_if<plan_edit::AddMove>(&edit))
    return edited_move(plan, {add->segment, ClinicalMove{}});
  if (const auto* set = std::get_if<plan_edit::SetNumber>(&edit))
    return set_number(uncut, plan, operated, *set);
  if (const auto* remove = std::get_if<plan_edit::Remove>(&edit))
    return {without_step(plan, remove->step), "remove " + step_name(step_of(plan, remove->step))};
  if (const auto* shift = std::get_if<plan_edit::Shift>(&edit)) return shifted(plan, *shift);
  if (const auto* resect = std::get_if<plan_edit::Resect>(&edit))
    return add_step(plan, ResectStep{resect->segment});
  if (const auto* graft = std::get_if<plan_edit::Graft>(&edit)) return add_graft(plan, *graft);
  if (const auto* trim = std::get_if<plan_edit::Trim>(&edit))
    return add_trim(plan, operated, trim->segment);
  if (std::holds_alternative<plan_edit::TakePositions>(edit))
    return take_positions(plan, operated, held);
  throw InputError("this edit needs more than the plan");
}

}  // namespace

EditedPlan edited_plan(const Case& uncut, const Plan& plan, const Operated& operated,
                       const PlanEdit& edit, const HeldSegments& held) {
  EditedPlan edited = unchecked_edit(uncut, plan, operated, edit, held);
  check_segments(edited.plan, uncut.bodies);
  return edited;
}

std::vector<std::optional<Pose>> changed_positions(const Operated& operated, const Plan& before,
                                                   const Plan& after) {
  const auto cuts_of = [](const Plan& plan) {
    std::vector<PlanAction> cuts;
    for (const PlanStep& step : plan.steps)
      if (!std::holds_alternative<MoveStep>(step.action) &&
          !std::holds_alternative<NoteStep>(step.action))
        cuts.push_back(step.action);
    return cuts;
  };
  if (cuts_of(before) != cuts_of(after)) return {};
  const BodyTree& bodies = operated.patient.bodies;
  const auto count = static_cast<std::size_t>(bodies.size());
  std::vector<Pose> moved(count);  // from the planned positions, in the cranium's frame
  std::vector<std::optional<Pose>> changed(count);
  for (std::size_t b = 1; b < count; ++b) {
    const BodyId body{static_cast<int>(b)};
    const std::size_t parent = index_of(bodies[body].parent);
    if (const PlanStep* step = move_of(after, bodies[body].name))
      moved[b] = planned_pose(operated, after, std::get<MoveStep>(step->action)) *
                 operated.poses[body].inverse();
    else if (move_of(before, bodies[body].name))
      moved[b] =
          moved[parent] * operated.poses[bodies[body].parent] * operated.poses[body].inverse();
    else
      moved[b] = moved[parent];
    const Pose X_PB = moved[parent].inverse() * moved[b];
    if (X_PB.t.norm() > 1e-6 || X_PB.R.angularDistance(Eigen::Quaterniond::Identity()) > 1e-9)
      changed[b] = X_PB;
  }
  return changed;
}

void show_tables(PlanView& view, const Plan& plan, const Operated& operated,
                 const HeldSegments& held) {
  const Landmarks& before = operated.patient.landmarks;
  const BodyTree& bodies = operated.patient.bodies;
  view.displacements.clear();
  view.cephalometry.clear();
  ClinicalFrame frame;
  try {
    frame = clinical_frame(before, plan.reference);
  } catch (const InputError&) {
    return;
  }
  BodyPoses at = completed(bodies, operated.poses);
  for (int b = 1; b < bodies.size() && !held.empty(); ++b)
    if (const auto X = hand_displacement(bodies, BodyId{b}, held))
      at[BodyId{b}] = *X * at[BodyId{b}];
  for (const MovementRow& row : movements_at(operated, frame, at).rows) {
    if (row.distance_mm() < 0.05) continue;
    std::string words;
    for (const std::string& each :
         {millimetres(-row.back_mm, "forward", "back"), millimetres(row.up_mm, "up", "down"),
          millimetres(row.left_mm, "left", "right")})
      if (!each.empty()) words += (words.empty() ? "" : ", ") + each;
    view.displacements.push_back({row.label, "", words, ""});
  }
  for (const CephalometricMeasure& measure :
       cephalometry(frame, before, landmarks_at(operated, at))) {
    if (!measure.before) continue;
    const auto number = [&](const std::optional<double>& value) {
      return value ? fmt::format("{:.1f}{}", *value, measure.unit == "deg" ? "\u00b0" : "")
                   : std::string("-");
    };
    view.cephalometry.push_back(
        {measure.name, number(measure.before), number(measure.after), norm_text(measure.norm)});
  }
}

PlanView plan_view(const PlanDocument& document, const Operated& operated,
                   const OperationFindings& findings) {
  const Plan& plan = document.plan();
  PlanView view{.name = plan.name, .file = document.file()};
  for (const PlanStep& step : plan.steps)
    view.steps.push_back(step_view(plan, operated, findings, step));
  for (const std::string& name : osteotomy_names())
    view.osteotomies.push_back({name, osteotomy_label(name)});
  const BodyTree& bodies = operated.patient.bodies;
  for (const std::string& segment : operated_segments(operated))
    if (!move_of(plan, segment)) view.segments.push_back({segment, display_name(segment)});
  const JawBodies& jaw = operated.patient.jaw;
  for (const BodyId arch : {jaw.upper_arch, jaw.lower_arch})
    if (arch != cranium_body && arch != jaw.left_condyle && arch != jaw.right_condyle)
      view.arches.push_back({bodies[arch].name, display_name(bodies[arch].name)});
  view.undo = document.history().undoable().value_or("");
  view.redo = document.history().redoable().value_or("");
  for (const SegmentOverlap& overlap : findings.overlaps) {
    view.findings.push_back(overlap_text(overlap, present_landmarks(operated)));
    if (overlap.kind != SegmentOverlap::Kind::trimmed) continue;
    for (const std::string& body : {overlap.body_a, overlap.body_b})
      if (std::none_of(view.trimmed.begin(), view.trimmed.end(),
                       [&](const NamedItem& item) { return item.name == body; }))
        view.trimmed.push_back({body, display_name(body)});
  }
  add_graft_choices(view, plan, operated);
  view.splints = splint_choices(operated);
  view.findings.insert(view.findings.end(), operated.problems.begin(), operated.problems.end());
  try {
    clinical_frame(operated.patient.landmarks, plan.reference);
  } catch (const InputError& error) {
    view.findings.push_back(fmt::format("no tables: {}", error.what()));
    return view;
  }
  show_tables(view, plan, operated);
  return view;
}

}  // namespace condyle
