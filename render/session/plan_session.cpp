#include "render/session/plan_session.h"

#include <utility>

#include "engine/collide/distance_field.h"
#include "engine/core/error.h"
#include "engine/core/user_cache.h"
#include "sim/operated/segment_bite.h"
#include "sim/operation/edit_cut.h"
#include "sim/operation/move_collision.h"
#include "sim/plan/plan_file.h"

namespace condyle {
namespace {

using Consent = request::EditPlan::Consent;

Question question(std::string title, std::string words, const request::EditPlan& request,
                  std::vector<std::pair<const char*, Consent>> answers) {
  Question asked{std::move(title), std::move(words), {{"plan-leave", "Leave the plan as it is"}}};
  for (const auto& [label, consent] : answers) {
    request::EditPlan again = request;
    again.consent = consent;
    asked.answers.push_back(
        {consent == Consent::free_part ? "plan-free-part" : "plan-agree", label, again});
  }
  return asked;
}

/// Whether the edit takes long to make, as it places cuts or the bite.
bool needs_replay(const PlanEdit& edit, const Plan& plan) {
  if (const auto* set = std::get_if<plan_edit::SetNumber>(&edit))
    return !std::holds_alternative<MoveStep>(step_of(plan, set->step).action);
  return std::holds_alternative<plan_edit::Occlude>(edit) ||
         std::holds_alternative<plan_edit::AddOsteotomy>(edit) ||
         std::holds_alternative<plan_edit::DrawCut>(edit) ||
         std::holds_alternative<plan_edit::MovePoint>(edit) ||
         std::holds_alternative<plan_edit::Resect>(edit) ||
         std::holds_alternative<plan_edit::Graft>(edit) ||
         std::holds_alternative<plan_edit::Trim>(edit);
}

/// Changes the edit as the user has agreed, or returns what to ask first. `operated`: by the edit.
std::optional<Question> objection(EditedPlan& edited, Operated& operated, PlanStages& stages,
                                  const request::EditPlan& request) {
  if (edited.step == 0) return std::nullopt;
  PlanAction action = step_of(edited.plan, edited.step).action;
  const PlanStep& step = step_of(edited.plan, edited.step);
  auto* cut = std::get_if<CutStep>(&action);
  auto* trim = std::get_if<TrimStep>(&action);
  if (cut || trim) {
    for (const std::string& problem : operated.problems)
      if (problem.starts_with(step_name(step))) throw InputError(problem);
    const std::string dangers = dangers_below_margins(operated, edited.step);
    if (dangers.empty()) return std::nullopt;
    if (request.consent != Consent::below_margins)
      return question("The cut lies below the safety margin", dangers + ".", request,
                      {{"Cut anyway", Consent::below_margins}});
    (cut ? cut->below_margins : trim->below_margins) = true;
  } else if (auto* move = std::get_if<MoveStep>(&action)) {
    if (request.consent == Consent::whole_move) return std::nullopt;
    const auto collision = move_collision(operated, edited.plan, *move);
    if (!collision) return std::nullopt;
    if (request.consent != Consent::free_part)
      return question("The segment collides", collision->words + ".", request,
                      {{"Make the collision-free part", Consent::free_part},
                       {"Move anyway", Consent::whole_move}});
    move->move = collision->free;
  } else {
    return std::nullopt;
  }
  edited.plan = with_replaced(std::move(edited.plan), edited.step, std::move(action));
  operated = stages.replay(edited.plan);
  return std::nullopt;
}

}  // namespace

void PlanSession::begin(std::optional<PlanDocument> document, const std::optional<Plan>& stored) {
  drop();
  const Plan none = empty_plan(*state_.patient->uncut);
  draft_ = state_.settings.keeps_files ? draft_file(none.geometry) : std::filesystem::path{};
  document_ = document ? std::move(*document) : PlanDocument(stored.value_or(none), draft_);
  std::error_code ignored;
  if (document || draft_.empty() || !std::filesystem::exists(draft_, ignored)) return;
  if (stored && is_plan_in(draft_, *stored)) return;
  state_.front_end.ask(
      {.title = "A plan of this patient was not saved",
       .words = stored ? "It was kept as a draft, which differs from the plan of the session. The "
                         "next edit replaces it."
                       : "It was kept as a draft, which the next edit replaces.",
       .answers = {{"plan-continue", stored ? "Open the draft" : "Continue the plan",
                    request::Open{{draft_}}},
                   {"plan-forget", stored ? "Keep the session's plan" : "Begin anew", {}}}});
}

void PlanSession::drop() {
  checking_.drop();
  colliding_.drop();
  predicting_.drop();
  splinting_.drop();
  state_.splint.reset();
  cutting_.drop();
  waiting_.clear();
  hands_.reset();
  tabulated_.clear();
  stages_.reset();
  collides_.reset();
  stage_ = Stage::face;
}

void PlanSession::cancel() {
  if (!checking_.active()) return predicting_.drop();
  checking_.drop();
  refuse();
}

/// The edit is not made: all is as before it.
void PlanSession::refuse() {
  waiting_.clear();
  end_preview();
  if (stage_ == Stage::pieces) collide(state_.patient);
  if (stage_ == Stage::contact) predict(state_.patient);
}

std::shared_ptr<PlanStages> PlanSession::stages() {
  if (!stages_) {
    stages_ = std::make_shared<PlanStages>(*state_.patient, state_.settings.simulator);
    collides_ = state_.patient;
  }
  return stages_;
}

HeldSegments PlanSession::held() const {
  HeldSegments held;
  if (!state_.newest) return held;
  const Hands& hands = state_.front_end.view().hands;
  for (const MovableBody& body : state_.scene.bodies)
    if (body.roams() && hands.at(body.body))
      held[state_.patient->scene.patient.bodies[body.body].name] =
          pose_in(body.parent, body.body, state_.newest->poses);
  return held;
}

bool PlanSession::follow_hand() {
  if (!document_ || !state_.patient || hands_ || checking_.active()) return false;
  HeldSegments now = held();
  const auto same = [](const auto& a, const auto& b) {
    return a.first == b.first && bit_identical(a.second, b.second);
  };
  if (std::equal(now.begin(), now.end(), tabulated_.begin(), tabulated_.end(), same)) return false;
  tabulated_ = std::move(now);
  show_tables(state_.scene.plan, document_->plan(), *state_.patient->operated, tabulated_);
  return true;
}

void PlanSession::edit(const request::EditPlan& request) {
  if (!state_.patient || !document_) return;
  if (checking_.active()) return waiting_.push_back(request);
  Change change;
  PlanHistory history = document_->saved_history();
  if (std::holds_alternative<plan_edit::Undo>(request.edit)) {
    change.kind = Change::Kind::undo;
    change.edited.what = history.undoable().value_or("");
    if (!history.undo()) throw InputError("there is no edit of the plan to undo");
    change.edited.plan = history.plan();
  } else if (std::holds_alternative<plan_edit::Redo>(request.edit)) {
    change.kind = Change::Kind::redo;
    change.edited.what = history.redoable().value_or("");
    if (!history.redo()) throw InputError("there is no edit of the plan to redo");
    change.edited.plan = history.plan();
  } else if (!needs_replay(request.edit, document_->plan())) {
    change.edited = edited_plan(*state_.patient->uncut, document_->plan(),
                                *state_.patient->operated, request.edit, held());
  }
  if (!change.edited.plan.geometry.parts.empty()) preview(change.edited.plan);
  start(std::move(change), request);
}

/// Until the patient is replaced, segments go to their new positions as if moved by hand: at once,
/// along contact, with the face.
void PlanSession::preview(const Plan& plan) {
  const auto changed = changed_positions(*state_.patient->operated, document_->plan(), plan);
  if (changed.empty()) return;
  hands_ = state_.front_end.view().hands;
  state_.front_end.change([&](ViewState& view) {
    for (const MovableBody& body : state_.scene.bodies)
      if (body.roams() && changed[index_of(body.body)])
        view.hands.set(body.body, changed[index_of(body.body)]);
  });
}

void PlanSession::end_preview() {
  if (!hands_) return;
  state_.front_end.change([&](ViewState& view) { view.hands = *hands_; });
  hands_.reset();
}

void PlanSession::open(const std::filesystem::path& file) {
  Change change{
      .kind = Change::Kind::open,
      .edited = {},
      .opened = file == draft_ ? PlanDocument(load_plan(file), draft_) : PlanDocument(file)};
  change.edited.plan = change.opened->plan();
  start(std::move(change), {});
}

void PlanSession::start(Change change, const request::EditPlan& request) {
  colliding_.drop();
  predicting_.drop();
  checking_.start([change = std::move(change), request, stages = stages(),
                   uncut = state_.patient->uncut, before = state_.patient->operated,
                   plan = document_->plan(),
                   threads = state_.threads()](const Progress& progress) mutable {
    report(progress, "replaying the plan", 0.2);
    EditedPlan& edited = change.edited;
    if (const auto* bite = std::get_if<plan_edit::Occlude>(&request.edit)) {
      OcclusionSettings settings;
      settings.threads = threads;
      settings.cache = user_cache_folder();
      const SegmentBite found = find_segment_bite(*uncut, plan, bite->segment, settings, progress);
      if (!found.bite.stable)
        throw InputError(bite->segment + " is not placed: no stable bite, " +
                         found.bite.unstable_because);
      edited = {with_segment_bite(plan, bite->segment, found), "occlude " + bite->segment};
    } else if (change.kind == Change::Kind::edit && needs_replay(request.edit, plan)) {
      edited = edited_plan(*uncut, plan, *before, request.edit);
    }
    Operated operated = stages->replay(edited.plan);
    if (change.kind == Change::Kind::edit) {
      if (auto asked = objection(edited, operated, *stages, request))
        return Checked{std::move(change), nullptr, std::move(asked)};
    }
    Patient pieces = stages->pieces(edited.plan, std::move(operated));
    return Checked{std::move(change), std::move(pieces), {}};
  });
}

void PlanSession::accept(Change change) {
  splinting_.drop();  // splints are of the plan as it was
  state_.splint.reset();
  switch (change.kind) {
    case Change::Kind::edit:
      return document_->edit(std::move(change.edited.plan), change.edited.what);
    case Change::Kind::undo:
      document_->undo();
      return state_.front_end.say("Undone: " + state_.in_words(change.edited.what));
    case Change::Kind::redo:
      document_->redo();
      return state_.front_end.say("Redone: " + state_.in_words(change.edited.what));
    case Change::Kind::open:
      document_ = std::move(change.opened);
  }
}

void PlanSession::collide(Patient pieces) {
  colliding_.start([stages = stages(), pieces = std::move(pieces), earlier = collides_,
                    plan = document_->plan()](const Progress& progress) {
    return stages->with_contact(*pieces, plan, *earlier, progress);
  });
}

void PlanSession::predict(Patient bones) {
  if (!state_.settings.simulator.tissue || !bones->uncut->find(Role::face)) {
    stage_ = Stage::face;
    return;
  }
  predicting_.start([stages = stages(), bones = std::move(bones),
                     plan = document_->plan()](const Progress& progress) {
    report(progress, "predicting the face", 0);
    return stages->with_face(*bones, plan, progress);
  });
}

void PlanSession::renew_face() {
  stages_.reset();
  predict(state_.patient);
}

std::optional<PlanSession::Planned> PlanSession::take() {
  std::optional<Planned> planned;
  if (!checking_.active() && !waiting_.empty()) {
    const request::EditPlan next = std::move(waiting_.front());
    waiting_.pop_front();
    state_.try_or_report("Cannot edit the plan", [&] { edit(next); });
  } else if (checking_.done()) {
    state_.try_or_report("Cannot edit the plan", [&] {
      auto checked = checking_.take();
      if (!checked) return;
      if (checked->question) return state_.front_end.ask(std::move(*checked->question));
      accept(std::move(checked->change));
      for (const std::string& note : document_->notes()) state_.front_end.say(note);
      hands_.reset();
      tabulated_.clear();
      collide(checked->patient);
      planned = Planned{std::move(checked->patient), Stage::pieces};
    });
    if (!planned) refuse();
  } else if (colliding_.done()) {
    bool failed = true;
    state_.try_or_report("Cannot build the collision models", [&] {
      auto patient = colliding_.take();
      failed = false;
      if (!patient) return;
      collides_ = *patient;
      planned = Planned{*patient, Stage::contact};
      predict(std::move(*patient));
    });
    if (failed) predict(state_.patient);
  } else if (predicting_.done()) {
    state_.try_or_report("Cannot predict the face", [&] {
      if (auto patient = predicting_.take()) planned = Planned{std::move(*patient), Stage::face};
    });
  }
  if (planned) stage_ = planned->stage;
  return planned;
}

void PlanSession::preview_cut(const std::optional<PlanEdit>& edit) {
  if (state_.patient && document_) cutting_.preview(document_->plan(), edit);
}

void PlanSession::show_handles(int step) {
  if (state_.patient && document_) cutting_.show_handles(document_->plan(), step);
}

void PlanSession::make_splint(const std::string& choice) {
  if (!state_.patient || !document_) return;
  if (splinting_.active()) return state_.front_end.say("A splint is being made");
  if (document_->file().empty())
    throw InputError("save the plan first: the splint is saved beside it");
  const auto folder = std::filesystem::absolute(document_->file()).parent_path();
  splinting_.start([choice, folder, operated = state_.patient->operated,
                    threads = state_.threads()](const Progress& progress) {
    report(progress, "making the splint", 0);
    return make_session_splint(*operated, choice, folder, threads, progress);
  });
}

bool PlanSession::take_splint() {
  if (!splinting_.done()) return false;
  bool is_new = false;
  state_.try_or_report("Cannot make the splint", [&] {
    auto made = splinting_.take();
    if (!made) return;
    state_.splint = std::move(*made);
    state_.front_end.say("Saved " + state_.splint->file.lexically_normal().string());
    is_new = true;
  });
  return is_new;
}

void PlanSession::hide_splint() {
  state_.splint.reset();
  state_.scene.plan.splint_findings.clear();
  state_.show_changes();
}

void PlanSession::renew_handles() {
  if (document_) cutting_.renew(document_->plan());
}

void PlanSession::save(const std::filesystem::path& file) {
  if (document_) document_->save_as(file);
}

PlanView PlanSession::view() const {
  if (!document_ || !state_.patient) return {};
  PlanView view = plan_view(*document_, *state_.patient->operated, state_.patient->findings);
  if (!tabulated_.empty())
    show_tables(view, document_->plan(), *state_.patient->operated, tabulated_);
  for (PlanStepView& step : view.steps) {
    step.details = state_.in_words(std::move(step.details));
    for (std::string& finding : step.findings) finding = state_.in_words(std::move(finding));
  }
  if (state_.splint) view.splint_findings = state_.splint->findings;
  view.handles_of = state_.scene.plan.handles_of;
  view.handles = state_.scene.plan.handles;
  view.preview = state_.scene.plan.preview;
  for (std::string& finding : view.findings) finding = state_.in_words(std::move(finding));
  return view;
}

}  // namespace condyle
