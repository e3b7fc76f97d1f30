#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "sim/plan/plan_history_file.h"

namespace condyle {

/// A plan that is being edited, with its history, and its file once it has one: each edit is saved
/// there at once. Before that it is saved as a draft, which outlives a crash.
class PlanDocument {
 public:
  /// `draft`: file of the draft; empty, or one that cannot be written: there is none.
  explicit PlanDocument(Plan start, std::filesystem::path draft = {})
      : history_(std::move(start)), draft_(std::move(draft)) {}
  /// Of a plan's file, with the history beside it. throws: InputError as load_plan().
  explicit PlanDocument(const std::filesystem::path& file);

  const Plan& plan() const { return history_.plan(); }
  const std::filesystem::path& file() const { return file_; }
  const PlanHistory& history() const { return history_; }
  /// The history as the file has it, which another program may have changed.
  PlanHistory saved_history() const;
  /// Notes of the last edit for people: what was set aside, or could not be saved.
  const std::vector<std::string>& notes() const { return notes_; }

  /// Makes `next` the present plan; `what` says what was done, such as "move maxilla". The plan
  /// stays as it was where it cannot be saved. throws: InputError, MachineError as save_edit().
  void edit(Plan next, const std::string& what);
  /// The plan before the last edit, or after the one undone last. throws: InputError if there is
  /// none; MachineError where it cannot be saved.
  void undo();
  void redo();
  /// Saves the plan with its history in a file, where later edits go too, and removes the draft.
  /// throws: InputError where the file exists and holds anything but this plan; MachineError.
  void save_as(const std::filesystem::path& file);

 private:
  void save_draft() const;
  void take(ReversedEdit edit);  // of the file, which another program may have changed

  PlanHistory history_;
  std::filesystem::path file_, draft_;
  std::vector<std::string> notes_;
};

/// Whether a file holds this plan.
bool is_plan_in(const std::filesystem::path& file, const Plan& plan);

/// Where the draft of a case's plan is kept, by the case's geometry; empty where the user has no
/// folder of settings.
std::filesystem::path draft_file(const CaseGeometry& geometry);

}  // namespace condyle
