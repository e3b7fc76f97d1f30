#include "render/window/input_replay.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/error.h"
#include "render/image/image.h"

namespace condyle {
namespace {

using Eigen::Vector2d;
namespace event = input_event;

constexpr double glide_s = 0.35, press_s = 0.08, letter_s = 0.03;
constexpr double settled_s =
    0.6;  // without background work, which may begin a turn after its cause

double elapsed_s(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

InputReplay::InputReplay(Window& window, std::vector<InputStep> steps,
                         std::filesystem::path pictures, double patience_s)
    : window_(window),
      steps_(steps.begin(), steps.end()),
      pictures_(std::move(pictures)),
      patience_s_(patience_s),
      began_(Clock::now()) {
  const ViewRect view = window.view_rect();
  pointer_ = glided_from_ = {view.x + view.width / 2, view.y + view.height / 2};
  window.begin_replay();
}

bool InputReplay::turn(bool busy) {
  if (!window_.replaying()) return false;
  if (busy) busy_at_ = Clock::now();
  while (actions_.empty()) {
    if (steps_.empty()) return false;
    present_ = std::move(steps_.front());
    steps_.pop_front();
    begin(present_);
    began_ = Clock::now();
    glided_from_ = pointer_;
  }
  while (!actions_.empty() && actions_.front()(busy)) {
    actions_.pop_front();
    began_ = Clock::now();
    glided_from_ = pointer_;
  }
  return true;
}

const DrawnItem* InputReplay::item(const std::string& name) const {
  const auto& items = window_.items();
  const auto found = std::find_if(items.begin(), items.end(),
                                  [&](const DrawnItem& one) { return one.name == name; });
  return found == items.end() ? nullptr : &*found;
}

double InputReplay::waited_s() const { return elapsed_s(std::max(began_, busy_at_)); }

void InputReplay::settle() {
  actions_.push_back([this](bool busy) { return !busy && waited_s() > settled_s; });
}

void InputReplay::await(const std::string& name) {
  actions_.push_back([this, name](bool busy) {
    if (item(name)) return true;
    if (busy || waited_s() < patience_s_) return false;
    const std::string trouble = window_.trouble();
    throw MachineError("line " + std::to_string(present_.line) + " of the list: \"" + name +
                       "\" is not in the window" +
                       (trouble.empty() ? "" : ", which reports: " + trouble));
  });
}

/// Moves the pointer over some turns, as a hand does.
void InputReplay::glide(const std::function<Vector2d()>& target) {
  actions_.push_back([this, target](bool) {
    const double fraction = std::min(1.0, elapsed_s(began_) / glide_s);
    const double eased = fraction * fraction * (3 - 2 * fraction);
    pointer_ = glided_from_ + eased * (target() - glided_from_);
    window_.handle(event::Pointer{pointer_.x(), pointer_.y()});
    return fraction >= 1;
  });
}

void InputReplay::point_at(const std::string& name) {
  await(name);
  glide([this, name]() -> Vector2d {
    const DrawnItem* there = item(name);
    if (!there) return pointer_;
    const ViewRect& rect = there->rect;
    return {rect.x + rect.width / 2, rect.y + rect.height / 2};
  });
}

void InputReplay::move_by(const Vector2d& offset) {
  glide([this, offset]() -> Vector2d { return glided_from_ + offset; });
}

void InputReplay::pause(double seconds) {
  actions_.push_back([this, seconds](bool) { return elapsed_s(began_) >= seconds; });
}

void InputReplay::send(const InputEvent& sent) {
  actions_.push_back([this, sent](bool) {
    window_.handle(sent);
    return true;
  });
}

void InputReplay::save_picture(const std::string& name) {
  actions_.push_back(
      [this](bool) { return waited_s() > settled_s && window_.pictures().finished; });
  actions_.push_back([this, name](bool) {
    write_png(pictures_ / (name + ".png"), window_.picture());
    return true;
  });
}

void InputReplay::begin(const InputStep& step) {
  using Kind = InputStep::Kind;
  const auto click = [&](const std::string& name) {
    point_at(name);
    send(event::Button{0, true});
    pause(press_s);
    send(event::Button{0, false});
    pause(press_s);
  };
  settle();
  switch (step.kind) {
    case Kind::say:
      actions_.push_back([this, words = step.words](bool) {
        window_.say(words);
        return true;
      });
      break;
    case Kind::click:
      click(step.item);
      break;
    case Kind::choose:
      click(step.item);
      click(step.item + ":" + step.words);
      break;
    case Kind::enter:
      click(step.item);
      await("writing");
      send(event::Key{named_key("ctrl+a")});
      for (const unsigned letter : letters_of(step.words)) {
        send(event::Letter{letter});
        pause(letter_s);
      }
      send(event::Key{named_key("Return")});
      pause(press_s);
      break;
    case Kind::drag:
      point_at(step.item);
      send(event::Button{0, true});
      pause(press_s);
      move_by({step.right, step.down});
      pause(press_s);
      send(event::Button{0, false});
      break;
    case Kind::wheel:
      point_at(step.item);
      for (int i = 0; i < std::abs(step.down); ++i) {
        send(event::Wheel{step.down > 0 ? -1.0 : 1.0});
        pause(press_s);
      }
      break;
    case Kind::key:
      send(event::Key{named_key(step.words)});
      break;
    case Kind::wait:
      await(step.item);
      settle();
      break;
    case Kind::picture:
      save_picture(step.words);
      break;
  }
}

}  // namespace condyle
