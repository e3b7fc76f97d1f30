#include "sim/session/plan_document.h"

#include <utility>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "sim/plan/plan_file.h"
#include "sim/plan/plan_history_file.h"

namespace condyle {
namespace {

/// The history beside a plan's file, where it can be read and knows the plan.
PlanHistory history_beside(const std::filesystem::path& file) {
  Plan plan = load_plan(file);
  const auto beside = history_file_of(file);
  try {
    PlanHistory history = parse_history(beside, read_file(beside));
    if (history.step_to(plan)) return history;
  } catch (const InputError&) {  // there is none, or save_edit() sets it aside
  }
  return PlanHistory(std::move(plan));
}

}  // namespace

PlanDocument::PlanDocument(const std::filesystem::path& file)
    : history_(history_beside(file)), file_(file) {}

void PlanDocument::edit(Plan next, const std::string& what) {
  if (!file_.empty()) save_edit(next, file_, what);
  history_.edit(std::move(next), what);
}

void PlanDocument::undo() {
  if (!file_.empty()) return take(undo_edit(file_).plan);
  if (!history_.undo()) throw InputError("there is no edit of the plan to undo");
}

void PlanDocument::redo() {
  if (!file_.empty()) return take(redo_edit(file_).plan);
  if (!history_.redo()) throw InputError("there is no edit of the plan to redo");
}

void PlanDocument::take(const Plan& plan) {
  if (!history_.step_to(plan)) history_ = history_beside(file_);
}

void PlanDocument::save_as(const std::filesystem::path& file) {
  save_edit(history_.plan(), file, "new plan");
  file_ = file;
}

}  // namespace condyle
