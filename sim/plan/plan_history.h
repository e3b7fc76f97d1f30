#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/plan/plan.h"

namespace condyle {

/// The plans before and after each edit.
class PlanHistory {
 public:
  explicit PlanHistory(Plan start) : plans_{{std::move(start), ""}} {}

  const Plan& plan() const { return plans_[now_].plan; }

  /// Makes `next` the present plan; `edit` says what was done, such as "move maxilla". Undone edits
  /// are forgotten. An edit that changes nothing is ignored.
  void edit(Plan next, std::string edit);

  /// What undo() or redo() would reverse or repeat; absent if there is nothing.
  std::optional<std::string> undoable() const;
  std::optional<std::string> redoable() const;
  /// Each returns the edit that it undid or repeated; absent if there was none.
  std::optional<std::string> undo();
  std::optional<std::string> redo();

 private:
  struct Entry {
    Plan plan;
    std::string edit;  // that led to it
  };
  std::vector<Entry> plans_;
  std::size_t now_ = 0;
};

}  // namespace condyle
