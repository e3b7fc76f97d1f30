#pragma once

#include <utility>
#include <vector>

namespace condyle {

/// The state before and after each edit.
template <class State>
class EditHistory {
 public:
  void remember(const State& before) {
    if (!before_.empty() && before_.back() == before) return;
    before_.push_back(before);
    after_.clear();
  }
  /// Both replace `now`; false if there is no edit.
  bool undo(State& now) {
    // An edit without a change is ignored.
    while (!before_.empty() && before_.back() == now) before_.pop_back();
    return exchange(before_, after_, now);
  }
  bool redo(State& now) { return exchange(after_, before_, now); }
  bool can_undo() const { return !before_.empty(); }
  bool can_redo() const { return !after_.empty(); }

 private:
  static bool exchange(std::vector<State>& from, std::vector<State>& to, State& now) {
    if (from.empty()) return false;
    to.push_back(std::exchange(now, std::move(from.back())));
    from.pop_back();
    return true;
  }
  std::vector<State> before_, after_;
};

}  // namespace condyle
