#include "sim/plan/plan_history.h"

#include <fmt/format.h>

#include <utility>

#include "engine/core/error.h"

namespace condyle {

PlanHistory::PlanHistory(std::vector<Entry> entries, std::size_t now)
    : entries_(std::move(entries)), now_(now) {
  if (now_ >= entries_.size())
    throw InputError(fmt::format("the history has {} plans; the present one is number {}",
                                 entries_.size(), now_ + 1));
  forget_oldest();
}

void PlanHistory::forget_oldest() {
  while (entries_.size() > max_plans) {
    // The present plan stays: where it is the oldest, the last undone one goes.
    if (now_ == 0) {
      entries_.pop_back();
      continue;
    }
    entries_.erase(entries_.begin());
    --now_;
  }
}

bool PlanHistory::step_to(const Plan& plan) {
  for (const std::size_t i : {now_, now_ - 1, now_ + 1})
    if (i < entries_.size() && entries_[i].plan == plan) {
      now_ = i;
      return true;
    }
  return false;
}

void PlanHistory::edit(Plan next, std::string edit) {
  if (next == plan()) return;
  entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(now_ + 1), entries_.end());
  entries_.push_back({std::move(next), std::move(edit)});
  ++now_;
  forget_oldest();
}

std::optional<std::string> PlanHistory::undoable() const {
  if (now_ == 0) return std::nullopt;
  return entries_[now_].edit;
}

std::optional<std::string> PlanHistory::redoable() const {
  if (now_ + 1 >= entries_.size()) return std::nullopt;
  return entries_[now_ + 1].edit;
}

std::optional<std::string> PlanHistory::undo() {
  auto edit = undoable();
  if (edit) --now_;
  return edit;
}

std::optional<std::string> PlanHistory::redo() {
  auto edit = redoable();
  if (edit) ++now_;
  return edit;
}

}  // namespace condyle
