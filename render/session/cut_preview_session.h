#pragma once

#include <memory>
#include <optional>

#include "render/session/session_state.h"
#include "sim/session/cut_preview.h"

namespace condyle {

/// Previews of a cut that is being drawn or dragged, and the handles of a selected step, made in
/// the background: of edits that come meanwhile only the last one counts.
class CutPreviewSession {
 public:
  explicit CutPreviewSession(SessionState& state)
      : state_(state), job_(state.retired, state.waker()) {}

  /// Requests the preview of an edit of the plan; none: it ends.
  void preview(const Plan& plan, const std::optional<PlanEdit>& edit);
  /// Requests the handles of a step; 0: none are shown.
  void show_handles(const Plan& plan, int step);
  /// Another patient may be in place: if it was operated otherwise, ends the preview and looks for
  /// the handles anew.
  void renew(const Plan& plan);
  void drop();
  /// Takes finished work into the scene of the state. Returns whether it has changed.
  bool take();

 private:
  struct Work {
    Plan plan;
    std::optional<PlanEdit> edit;  // to preview; none: handles of the step
    int step = 0;
  };
  struct Done {
    CutPreviewView words;
    std::shared_ptr<const CutOverlay> overlay;
    int handles_of = 0;
    std::vector<PlanHandle> handles;
    bool is_preview = false;
  };
  void start(Work work);
  void start_waiting();
  static Done make(const Work& work, CutPreviewer& previewer, const Case& uncut,
                   const Operated& operated);

  SessionState& state_;
  Job<Done> job_;
  std::shared_ptr<CutPreviewer> previewer_;   // of the patient's case; one job at a time uses it
  std::shared_ptr<const Operated> operated_;  // on whom cuts are drawn
  std::optional<Work> preview_, handles_;     // waiting
  bool previewing_ = false;                   // whether the front end still asks for a preview
  int shown_step_ = 0;                        // whose handles are asked for
};

}  // namespace condyle
