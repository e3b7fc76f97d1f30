#include "sim/session/plan_document.h"

#include <fmt/format.h>

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "engine/core/settings_file.h"
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

bool is_plan_in(const std::filesystem::path& file, const Plan& plan) {
  try {
    return load_plan(file) == plan;
  } catch (const InputError&) {
    return false;
  }
}

PlanDocument::PlanDocument(const std::filesystem::path& file)
    : history_(history_beside(file)), file_(file) {}

void PlanDocument::edit(Plan next, const std::string& what) {
  notes_.clear();
  if (!file_.empty()) notes_ = save_edit(next, file_, what);
  history_.edit(std::move(next), what);
  save_draft();
}

void PlanDocument::undo() {
  if (!file_.empty()) return take(undo_edit(file_));
  if (!history_.undo()) throw InputError("there is no edit of the plan to undo");
  save_draft();
}

void PlanDocument::redo() {
  if (!file_.empty()) return take(redo_edit(file_));
  if (!history_.redo()) throw InputError("there is no edit of the plan to redo");
  save_draft();
}

void PlanDocument::take(ReversedEdit edit) {
  notes_ = std::move(edit.notes);
  history_ = saved_history();
}

PlanHistory PlanDocument::saved_history() const {
  return file_.empty() ? history_ : history_beside(file_);
}

void PlanDocument::save_as(const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::exists(file, ignored) && !is_plan_in(file, history_.plan()))
    throw InputError(file, "", "exists and is not this plan: choose another name");
  const std::string plan = checked_plan_json(history_.plan(), file);
  if (file.has_parent_path()) make_folder(file.parent_path());
  write_file(history_file_of(file), history_json(history_));
  write_file(file, plan);
  file_ = file;
  if (!draft_.empty()) std::filesystem::remove(draft_, ignored);
}

void PlanDocument::save_draft() const {
  if (!file_.empty() || draft_.empty()) return;
  try {
    make_folder(draft_.parent_path());
    save_plan(history_.plan(), draft_);
  } catch (const std::exception&) {  // no draft
  }
}

std::filesystem::path draft_file(const CaseGeometry& geometry) {
  std::vector<std::uint64_t> parts;
  for (const PartGeometry& part : geometry.parts) parts.push_back(part.hash);
  const std::uint64_t hash = hash_values(std::span<const std::uint64_t>(parts));
  return settings_file(fmt::format("plan-{:016x}.json", hash));
}

}  // namespace condyle
