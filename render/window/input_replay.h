#pragma once

#include <Eigen/Core>
#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "render/window/input/input_steps.h"
#include "render/window/window.h"

namespace condyle {

/// Performs a list of steps in a window: events of the mouse and keyboard, at a speed that the eye
/// can follow. A step waits until no background work runs and its item is in the window.
///
///     InputReplay replay(window, parse_input_steps(text, name), folder);
///     while (window.open() && replay.turn(busy)) ...
class InputReplay {
 public:
  /// `pictures`: folder of the saved pictures; it exists. `patience_s`: how long an item may take
  /// to appear while no background work runs.
  InputReplay(Window& window, std::vector<InputStep> steps, std::filesystem::path pictures,
              double patience_s = 30);
  ~InputReplay() { window_.end_replay(); }
  InputReplay(const InputReplay&) = delete;
  InputReplay& operator=(const InputReplay&) = delete;

  /// Once a turn of the window; `busy`: background work runs. Returns false once the list is done,
  /// or the user has pressed Esc. throws: MachineError for an item that does not appear.
  bool turn(bool busy);
  /// Whether every step was performed.
  bool done() const { return steps_.empty() && actions_.empty(); }

 private:
  using Clock = std::chrono::steady_clock;
  /// Part of a step; called each turn until it returns true.
  using Action = std::function<bool(bool busy)>;

  void begin(const InputStep& step);
  void settle();
  void await(const std::string& item);
  void point_at(const std::string& item);
  void move_by(const Eigen::Vector2d& offset);
  void glide(const std::function<Eigen::Vector2d()>& target);
  void pause(double seconds);
  void send(const InputEvent& event);
  void save_picture(const std::string& name);
  const DrawnItem* item(const std::string& name) const;
  double waited_s() const;

  Window& window_;
  std::deque<InputStep> steps_;
  std::deque<Action> actions_;  // of the present step
  InputStep present_;
  std::filesystem::path pictures_;
  double patience_s_;
  Eigen::Vector2d pointer_;
  Eigen::Vector2d glided_from_;
  Clock::time_point began_;                   // the present action
  Clock::time_point busy_at_ = Clock::now();  // last
};

}  // namespace condyle
