#include "render/session/cut_preview_session.h"

#include <array>
#include <utility>

#include "engine/core/error.h"
#include "sim/session/drawn_cut.h"
#include "sim/session/plan_editing.h"

namespace condyle {
namespace {

using Eigen::Vector3f;

// Okabe-Ito: bluish green, orange, sky blue, reddish purple.
constexpr std::array<std::array<float, 3>, 4> piece_colours = {
    {{0.0f, 0.62f, 0.45f}, {0.90f, 0.62f, 0.0f}, {0.34f, 0.71f, 0.91f}, {0.80f, 0.47f, 0.65f}}};
constexpr std::array<float, 3> rim_colour = {0.94f, 0.89f, 0.26f},
                               warning_colour = {0.84f, 0.37f, 0.0f};

Vector3f colour(const std::array<float, 3>& c) { return {c[0], c[1], c[2]}; }

/// Pieces tinted, with the lines along which the bone is cut.
std::shared_ptr<const CutOverlay> overlay_of(const CutPreview& preview, const Operated& operated) {
  const auto body = operated.patient.bodies.find(preview.body);
  if (!body) return nullptr;
  const Pose& X_CB = operated.poses[*body];
  auto overlay = std::make_shared<CutOverlay>();
  overlay->body = *body;
  LineSet rims{.color = colour(preview.words.warns ? warning_colour : rim_colour),
               .width_px = 3,
               .through = 0.6f};
  std::size_t count = 0;
  for (const CutPreview::Piece& piece : preview.pieces) {
    for (const auto& p : piece.rims) rims.ends.push_back((X_CB * p).cast<float>());
    if (piece.stays) continue;
    GlassSheet sheet{.color = colour(piece_colours[count % piece_colours.size()]),
                     .opacity = 0.45f};
    for (const auto& p : piece.mesh.vertices) sheet.positions.push_back((X_CB * p).cast<float>());
    sheet.triangles = piece.mesh.triangles;
    overlay->sheets.emplace("cut piece " + std::to_string(++count), std::move(sheet));
  }
  overlay->rims = std::move(rims);
  return overlay;
}

}  // namespace

void CutPreviewSession::preview(const Plan& plan, const std::optional<PlanEdit>& edit) {
  previewing_ = edit.has_value();
  preview_.reset();
  if (previewing_) {
    preview_ = Work{plan, edit, 0};
    return start_waiting();
  }
  state_.cut_overlay.reset();
  if (std::exchange(state_.scene.plan.preview, std::nullopt)) state_.show_changes();
}

void CutPreviewSession::show_handles(const Plan& plan, int step) {
  shown_step_ = step;
  handles_.reset();
  if (step != state_.scene.plan.handles_of) {
    state_.scene.plan.handles.clear();
    state_.scene.plan.handles_of = 0;
    state_.show_changes();
  }
  if (step == 0) return;
  handles_ = Work{plan, std::nullopt, step};
  start_waiting();
}

void CutPreviewSession::renew(const Plan& plan) {
  if (!state_.patient || operated_ == state_.patient->operated) return;
  const int shown = shown_step_;
  drop();
  for (const PlanStep& step : plan.steps)
    if (step.id == shown && std::holds_alternative<CutStep>(step.action)) show_handles(plan, shown);
}

void CutPreviewSession::drop() {
  job_.drop();  // it may still run, with its previewer
  previewer_.reset();
  operated_.reset();
  shown_step_ = 0;
  state_.scene.plan.handles_of = 0;
  state_.scene.plan.handles.clear();
  preview_.reset();
  handles_.reset();
  previewing_ = false;
  state_.cut_overlay.reset();
  state_.scene.plan.preview.reset();
}

void CutPreviewSession::start_waiting() {
  if (job_.active()) return;
  if (preview_)
    start(*std::exchange(preview_, std::nullopt));
  else if (handles_)
    start(*std::exchange(handles_, std::nullopt));
}

void CutPreviewSession::start(Work work) {
  if (!state_.patient) return;
  if (!previewer_) previewer_ = std::make_shared<CutPreviewer>(state_.patient->uncut);
  operated_ = state_.patient->operated;
  job_.start([work = std::move(work), previewer = previewer_, uncut = state_.patient->uncut,
              operated = operated_](const Progress&) {
    return make(work, *previewer, *uncut, *operated);
  });
}

CutPreviewSession::Done CutPreviewSession::make(const Work& work, CutPreviewer& previewer,
                                                const Case& uncut, const Operated& operated) {
  Done done;
  if (!work.edit) {
    done.handles_of = work.step;
    const auto& cut = std::get<CutStep>(step_of(work.plan, work.step).action);
    done.handles = point_handles(operated, cut);
    std::string name;
    for (PlanHandle handle : previewer.number_handles(work.plan, work.step, name)) {
      const auto body = operated.patient.bodies.find(name);
      if (!body) break;
      handle.body = *body;
      // It was found at the uncut rest.
      const Pose& X_CB = operated.poses[handle.body];
      handle.at = X_CB * handle.at;
      handle.per_unit = X_CB.R * handle.per_unit;
      done.handles.push_back(std::move(handle));
    }
    return done;
  }
  done.is_preview = true;
  try {
    const EditedPlan edited = edited_plan(uncut, work.plan, operated, *work.edit);
    const CutPreview preview = previewer.preview(edited.plan, edited.step);
    done.words = preview.words;
    done.overlay = overlay_of(preview, operated);
  } catch (const InputError& error) {
    done.words.problem = error.what();
  }
  return done;
}

bool CutPreviewSession::take() {
  if (!job_.done()) return false;
  bool changed = false;
  state_.try_or_report("Cannot preview the cut", [&] {
    auto done = job_.take();
    if (!done) return;
    PlanView& plan = state_.scene.plan;
    if (!done->is_preview) {
      if (done->handles_of != shown_step_) return;
      plan.handles_of = done->handles_of;
      plan.handles = std::move(done->handles);
      changed = true;
    } else if (previewing_) {
      for (std::string& finding : done->words.findings)
        finding = state_.in_words(std::move(finding));
      done->words.problem = state_.in_words(std::move(done->words.problem));
      plan.preview = std::move(done->words);
      state_.cut_overlay = std::move(done->overlay);
      changed = true;
    }
  });
  start_waiting();
  return changed;
}

}  // namespace condyle
