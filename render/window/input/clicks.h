#pragma once

#include <Eigen/Core>
#include <optional>

namespace condyle {

/// Distinguishes clicks from drags: a button that is released within `reach_px` of where it was
/// pressed is a click, and a second one there within `double_s` a double click.
class ClickDetector {
 public:
  static constexpr double reach_px = 4, double_s = 0.4;

  struct Click {
    int button = 0;
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    bool is_double = false;
  };

  void press(int button, const Eigen::Vector2d& at) { pressed_ = {button, at}; }
  /// The mouse has moved: what went farther than a click is a drag, even if it comes back.
  void moved(const Eigen::Vector2d& at) {
    if (pressed_ && (at - pressed_->at).norm() > reach_px) pressed_.reset();
  }
  std::optional<Click> release(int button, const Eigen::Vector2d& at, double time_s) {
    moved(at);
    if (!pressed_ || pressed_->button != button) return std::nullopt;
    Click click{button, at};
    click.is_double = last_ && last_->button == button && time_s - last_s_ <= double_s &&
                      (at - last_->at).norm() <= reach_px;
    pressed_.reset();
    // A third click begins anew.
    if (click.is_double)
      last_.reset();
    else
      last_ = click;
    last_s_ = time_s;
    return click;
  }

 private:
  struct Press {
    int button = 0;
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
  };
  std::optional<Press> pressed_;
  std::optional<Click> last_;
  double last_s_ = 0;
};

}  // namespace condyle
