#pragma once

#include <deque>
#include <memory>
#include <optional>

#include "render/session/cut_preview_session.h"
#include "render/session/session_state.h"
#include "sim/session/plan_editing.h"
#include "sim/session/plan_stages.h"

namespace condyle {

/// The plan of the session's patient. An edit is replayed and checked in the background; then the
/// pieces are shown as planned, collide as soon as their models are built, and have a face as soon
/// as it is predicted.
class PlanSession {
 public:
  /// What a patient after an edit of its plan consists of so far.
  enum class Stage { pieces, contact, face };
  struct Planned {
    std::shared_ptr<const SessionPatient> patient;
    Stage stage = Stage::pieces;
  };

  explicit PlanSession(SessionState& state)
      : state_(state),
        checking_(state.retired, state.waker()),
        colliding_(state.retired, state.waker()),
        predicting_(state.retired, state.waker()),
        splinting_(state.retired, state.waker()),
        cutting_(state) {}

  /// Begins with the plan of a patient just loaded, or an empty one. `stored`: a plan without a
  /// file, of a session.
  void begin(std::optional<PlanDocument> document, const std::optional<Plan>& stored = {});
  /// Requests an edit; one that comes while another is being checked follows it.
  /// throws: InputError for an edit that is impossible.
  void edit(const request::EditPlan& request);
  /// throws: InputError, MachineError as PlanDocument::save_as().
  void save(const std::filesystem::path& file);
  /// Replays the plan of a file on the session's patient. throws: InputError as load_plan().
  void open(const std::filesystem::path& file);
  void drop();
  /// Ends what is under way: the plan, and the segments, are as before the edit.
  void cancel();
  /// Shows what an edit of a cut would do, until there is none.
  void preview_cut(const std::optional<PlanEdit>& edit);
  void show_handles(int step);
  /// Takes finished previews and handles; returns whether the scene has changed.
  bool take_preview() { return cutting_.take(); }
  /// Makes a splint at the planned positions, saves and shows it.
  void make_splint(const std::string& choice);
  void hide_splint();
  bool take_splint();  // returns whether there is a new one
  /// Shows displacements and cephalometry of segments that a hand moves; returns whether they have
  /// changed.
  bool follow_hand();
  /// After the patient was replaced.
  void renew_handles();
  /// Predicts the planned patient's face again, with the settings of the soft tissue as they now
  /// are.
  void renew_face();
  /// Whether the plan has any step.
  bool has_steps() const { return document_ && !document_->plan().steps.empty(); }
  /// The patient after the last edit, once it is ready; questions and failures are reported.
  std::optional<Planned> take();

  const auto& checking() const { return checking_; }
  const auto& colliding() const { return colliding_; }
  const auto& predicting() const { return predicting_; }
  const auto& splinting() const { return splinting_; }
  HeadReference reference() const {
    return document_ ? document_->plan().reference : HeadReference{};
  }
  const PlanDocument* document() const { return document_ ? &*document_ : nullptr; }
  /// What a hand held before segments were moved to preview an edit; none: there is no preview.
  const std::optional<Hands>& hands_before_preview() const { return hands_; }
  /// What the front end shows of the plan.
  PlanView view() const;

 private:
  using Patient = std::shared_ptr<const SessionPatient>;
  /// A change of the plan under way.
  struct Change {
    enum class Kind { edit, undo, redo, open };
    Kind kind = Kind::edit;
    EditedPlan edited;
    std::optional<PlanDocument> opened;
  };
  /// The pieces of a changed plan, or what the user is asked before.
  struct Checked {
    Change change;
    Patient patient;
    std::optional<Question> question;
  };

  void refuse();
  void preview(const Plan& plan);
  void end_preview();
  void start(Change change, const request::EditPlan& request);
  void accept(Change change);
  void collide(Patient pieces);
  void predict(Patient bones);
  /// The stages of the session's patient.
  std::shared_ptr<PlanStages> stages();
  HeldSegments held() const;

  SessionState& state_;
  std::filesystem::path draft_;  // of the patient's plan before it has a file
  std::optional<PlanDocument> document_;
  std::shared_ptr<PlanStages> stages_;  // null before the first edit
  Patient collides_;                    // the last patient with contact, whose models are reused
  std::deque<request::EditPlan> waiting_;
  std::optional<Hands> hands_;  // before the preview
  HeldSegments tabulated_;      // what a hand holds in the tables shown
  Stage stage_ = Stage::face;   // of the session's patient
  Job<Checked> checking_;
  Job<Patient> colliding_, predicting_;
  Job<std::shared_ptr<const SessionSplint>> splinting_;
  CutPreviewSession cutting_;
};

}  // namespace condyle
