#include "sim/plan/plan_history.h"

namespace condyle {

void PlanHistory::edit(Plan next, std::string edit) {
  if (next == plan()) return;
  plans_.erase(plans_.begin() + static_cast<std::ptrdiff_t>(now_ + 1), plans_.end());
  plans_.push_back({std::move(next), std::move(edit)});
  ++now_;
}

std::optional<std::string> PlanHistory::undoable() const {
  if (now_ == 0) return std::nullopt;
  return plans_[now_].edit;
}

std::optional<std::string> PlanHistory::redoable() const {
  if (now_ + 1 >= plans_.size()) return std::nullopt;
  return plans_[now_ + 1].edit;
}

std::optional<std::string> PlanHistory::undo() {
  const auto edit = undoable();
  if (edit) --now_;
  return edit;
}

std::optional<std::string> PlanHistory::redo() {
  const auto edit = redoable();
  if (edit) ++now_;
  return edit;
}

}  // namespace condyle
