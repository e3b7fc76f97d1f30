#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/math/pchip.h"
#include "sim/motion/bite_guide.h"
#include "sim/motion/condylar_path.h"
#include "sim/motion/jaw_joints.h"
#include "sim/motion/motion.h"
#include "sim/motion/motion_script.h"

namespace condyle {

/// How a jaw opens: which rotation goes with which forward travel, and how far.
struct OpeningLimits {
  Coupling coupling;
  double widest_theta = 0;  // rad, at maximum opening
};

/// Puts movements in a row, each from where the one before ended, and makes a motion of them.
/// Where teeth come into the way the jaw opens so far that they glide on each other; contact
/// movements keep them touching.
class Movements {
 public:
  /// Whether bones other than teeth are apart at a pose.
  using BonesFree = std::function<bool(const Pose& X_CM)>;

  /// `guide` and `free` are asked while movements are added; not afterwards.
  Movements(std::shared_ptr<const JawJoints> joints, std::shared_ptr<BiteGuide> guide,
            const OpeningLimits& limits, const MotionParameters& parameters, BonesFree free);

  void add(const Statement& statement);
  /// Back to the case's own pose.
  void back(const std::string& phase, std::optional<double> duration_s);

  /// Border movements without their time, for what is measured by them.
  MotionBorders borders();

  Motion finish(const std::string& name);

 private:
  using Path = std::function<JawInputs(double)>;  // by progress from 0 to 1
  struct Leg {
    Path at;
    std::optional<Pchip> closed;  // least rotation by progress, where teeth may meet
    bool on_teeth = false;        // they are kept touching
    bool eased = true;            // starts and ends at rest, with least jerk
    double start_s = 0, duration_s = 0;

    JawInputs resolved(double progress) const;
  };
  struct Pace {
    std::optional<double> duration_s, speed_mm_s;
  };

  Leg leg(Path at, bool on_teeth);
  /// Condyles go straight on while the teeth are kept touching.
  Leg straight_glide(double left0, double right0, double left1, double right1);
  double way_mm(const Leg& leg) const;
  void append(Leg leg, const Pace& pace);
  void say(const std::string& note);
  void hold(double seconds);
  void swing(const JawInputs& target, const Pace& pace);
  void glide(double left_mm, double right_mm, const Pace& pace);
  void open_to(double drop_mm, const Pace& pace);
  void close(const Pace& pace);
  void posselt(const Pace& pace);
  void chew(bool to_left, const Statement& statement);

  JawInputs at_condyles(double left_mm, double right_mm) const;
  JawInputs biting(double left_mm, double right_mm);
  JawInputs opened(double theta) const;
  JawInputs chewing_inputs(double drop_mm, double aside_mm, const JawInputs& guess) const;
  bool in_contact();
  double forward_for(double protrusion_mm, const std::string& where, bool asked);
  double forward_aside_for(double aside_mm, bool to_left, const std::string& where, bool asked);
  double reach_for(double wanted_mm, const std::function<double(double)>& reached_mm,
                   const std::string& what, bool asked);
  double free_aside(bool to_left, double forward_mm, bool whole_border);
  JawInputs lateral_border(bool to_left, double forward_mm, double bite, double progress) const;
  double retruded_mm();
  Coupling hinge_border() const;
  /// The legs of the border movements: sagittal, then frontal.
  std::vector<std::pair<std::string, Leg>> border_legs();
  void begin(const std::string& phase);

  std::shared_ptr<const JawJoints> joints_;
  std::shared_ptr<BiteGuide> guide_;
  OpeningLimits limits_;
  MotionParameters parameters_;
  BonesFree free_;
  JawInputs here_;
  double now_s_ = 0;
  bool wants_borders_ = false;
  std::vector<Leg> legs_;
  std::vector<MotionPhase> phases_;
  std::vector<std::string> notes_;
};

/// 0 to 1 with neither speed nor acceleration at the ends (least jerk).
double least_jerk(double u);

}  // namespace condyle
