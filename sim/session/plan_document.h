#pragma once

#include <filesystem>
#include <string>

#include "sim/plan/plan_history.h"

namespace condyle {

/// A plan that is being edited, with its history, and its file once it has one: each edit is saved
/// there at once.
class PlanDocument {
 public:
  explicit PlanDocument(Plan start) : history_(std::move(start)) {}
  /// Of a plan's file, with the history beside it. throws: InputError as load_plan().
  explicit PlanDocument(const std::filesystem::path& file);

  const Plan& plan() const { return history_.plan(); }
  const std::filesystem::path& file() const { return file_; }
  const PlanHistory& history() const { return history_; }

  /// Makes `next` the present plan; `what` says what was done, such as "move maxilla". The plan
  /// stays as it was where it cannot be saved. throws: InputError, MachineError as save_edit().
  void edit(Plan next, const std::string& what);
  /// The plan before the last edit, or after the one undone last. throws: InputError if there is
  /// none; MachineError where it cannot be saved.
  void undo();
  void redo();
  /// Saves the plan in a new file, where later edits go too.
  /// throws: InputError, MachineError as save_edit().
  void save_as(const std::filesystem::path& file);

 private:
  void take(const Plan& plan);  // of the file, which another program may have changed

  PlanHistory history_;
  std::filesystem::path file_;
};

}  // namespace condyle
