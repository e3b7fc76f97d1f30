#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/math/pchip.h"
#include "sim/motion/bite_guide.h"
#include "sim/motion/condylar_kinematics.h"
#include "sim/motion/jaw_joints.h"
#include "sim/motion/motion.h"
#include "sim/motion/motion_script.h"

namespace condyle {

/// Opening of a jaw: the coupling of rotation and forward travel, and its limit.
struct OpeningLimits {
  Coupling coupling;
  double widest_theta = 0;  // rad, at maximum opening
};

/// Builds a motion from a sequence of movements, each starting where the previous one ends. Where
/// teeth would collide, the jaw opens until they glide on each other; contact movements keep them
/// touching.
class Movements {
 public:
  /// Whether bones other than teeth are free of contact at a pose.
  using BonesFree = std::function<bool(const Pose& X_CM)>;

  /// `guide` and `free` are called only while movements are added.
  Movements(std::shared_ptr<const JawJoints> joints, std::shared_ptr<BiteGuide> guide,
            const OpeningLimits& limits, const MotionParameters& parameters, BonesFree free);

  void add(const Statement& statement);
  /// Holds the pose until a time; earlier times change nothing.
  void wait_until(double time_s);
  double now_s() const { return now_s_; }
  /// Returns to the rest pose of the case.
  void back(const std::string& phase, std::optional<double> duration_s);

  /// Curves of the border movements, as the reference for measures.
  MotionBorders borders();

  Motion finish(const std::string& name);

 private:
  using Path = std::function<JawInputs(double)>;  // by progress, 0 to 1
  struct Leg {
    Path at;
    std::optional<Pchip> closed;  // minimum rotation by progress, where teeth may meet
    bool on_teeth = false;        // the teeth are kept in contact
    bool eased = true;            // starts and ends at rest, with minimum jerk
    double start_s = 0, duration_s = 0;

    JawInputs resolved(double progress) const;
  };
  struct Pace {
    std::optional<double> duration_s, speed_mm_s;
  };

  Leg leg(Path at, bool on_teeth);
  /// Linear condylar travel with the teeth in contact.
  Leg straight_glide(double left0, double right0, double left1, double right1);
  double path_length_mm(const Leg& leg) const;
  void append(Leg leg, const Pace& pace);
  void add_note(const std::string& note);
  void hold(double seconds);
  void swing(const JawInputs& target, const Pace& pace);
  void glide(double left_mm, double right_mm, const Pace& pace);
  void open_to(double opening_mm, const Pace& pace);
  void close(const Pace& pace);
  void posselt(const Pace& pace);
  void chew(bool to_left, const Statement& statement);

  JawInputs at_condyles(double left_mm, double right_mm) const;
  JawInputs biting(double left_mm, double right_mm);
  JawInputs opened(double theta) const;
  JawInputs chewing_inputs(double opening_mm, double aside_mm, const JawInputs& guess) const;
  bool in_contact();
  double forward_for(double protrusion_mm, const std::string& where, bool asked);
  double forward_aside_for(double aside_mm, bool to_left, const std::string& where, bool asked);
  double reach_for(double target_mm, const std::function<double(double)>& reached_mm,
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
  bool traces_borders_ = false;
  std::vector<Leg> legs_;
  std::vector<MotionPhase> phases_;
  std::vector<std::string> notes_;
};

/// Minimum-jerk profile from 0 to 1: zero speed and acceleration at both ends.
double minimum_jerk(double u);

}  // namespace condyle
