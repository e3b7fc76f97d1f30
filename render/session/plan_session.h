#pragma once

#include <deque>
#include <memory>
#include <optional>

#include "render/session/session_state.h"
#include "sim/session/plan_editing.h"

namespace condyle {

/// The plan of the session's patient. An edit is replayed and checked in the background; then the
/// bones are shown as planned, and the face as soon as it is predicted.
class PlanSession {
 public:
  /// A patient after an edit of its plan.
  struct Planned {
    std::shared_ptr<const SessionPatient> patient;
    bool predicted = false;  // with the face; its parts are then those shown
  };

  explicit PlanSession(SessionState& state)
      : state_(state),
        checking_(state.retired, state.waker()),
        predicting_(state.retired, state.waker()) {}

  /// Begins with the plan of a patient just loaded, or an empty one.
  void begin(std::optional<PlanDocument> document);
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
  /// Whether the plan has any step.
  bool has_steps() const { return document_ && !document_->plan().steps.empty(); }
  /// The patient after the last edit, once it is ready; questions and failures are reported.
  std::optional<Planned> take();

  const auto& checking() const { return checking_; }
  const auto& predicting() const { return predicting_; }
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
  /// The bones of a changed plan, or what the user is asked before.
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
  void predict(const SessionPatient& bones);
  HeldSegments held() const;

  SessionState& state_;
  std::filesystem::path draft_;  // of the patient's plan before it has a file
  std::optional<PlanDocument> document_;
  std::deque<request::EditPlan> waiting_;
  std::optional<Hands> hands_;  // before the preview
  bool face_due_ = false;       // the patient is shown with the face of an earlier plan
  Job<Checked> checking_;
  Job<Patient> predicting_;
};

}  // namespace condyle
