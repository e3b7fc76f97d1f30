#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/plan/plan.h"

namespace condyle {

/// The plans before and after each edit: of more than `max_plans` the oldest are forgotten.
class PlanHistory {
 public:
  static constexpr std::size_t max_plans = 100;

  struct Entry {
    Plan plan;
    std::string edit;  // that led to it

    bool operator==(const Entry&) const = default;
  };

  explicit PlanHistory(Plan start) : entries_{{std::move(start), ""}} {}
  /// The last max_plans entries, of which `now` is the present one. throws: InputError if there is
  /// no such entry.
  PlanHistory(std::vector<Entry> entries, std::size_t now);

  const Plan& plan() const { return entries_[now_].plan; }
  const std::vector<Entry>& entries() const { return entries_; }
  std::size_t now() const { return now_; }

  /// Makes `next` the present plan; `edit` says what was done, such as "move maxilla". Undone edits
  /// are forgotten. An edit that changes nothing is ignored.
  void edit(Plan next, std::string edit);

  /// Whether the plan is the present one, or the one before or after it. It becomes the present
  /// one, and nothing is forgotten.
  bool step_to(const Plan& plan);

  /// What undo() or redo() would reverse or repeat; absent if there is nothing.
  std::optional<std::string> undoable() const;
  std::optional<std::string> redoable() const;
  /// Each returns the edit that it undid or repeated; absent if there was none.
  std::optional<std::string> undo();
  std::optional<std::string> redo();

 private:
  void forget_oldest();

  std::vector<Entry> entries_;
  std::size_t now_ = 0;
};

}  // namespace condyle
