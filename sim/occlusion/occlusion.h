#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "engine/math/pose.h"
#include "sim/case/case.h"

namespace condyle {

struct OcclusionSettings {
  double film_mm = 0.1;          // thickness of the articulating film; a mark on it is a contact
  double closing_force_N = 200;  // both sides together, at the first molars
  double joint_N_per_mm = 20;    // stiffness of the spring at each condyle's rest position
  double layer_stiffness_MPa = 200;      // pressure that halves the film's thickness
  double search_mm = 2, search_deg = 2;  // range of restarts about a bite
  double max_overlap_mm = 0.05;          // largest overlap in a valid bite
  std::filesystem::path cache;           // folder for distance fields; empty: none
  int threads = 1;                       // bit-identical for any number
};

/// One mark on the articulating film.
struct ToothContact {
  int upper_fdi = 0, lower_fdi = 0;  // 0: the teeth are not separate
  bool left = false;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();   // on the upper arch, cranium, mm
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit, out of the upper arch
  double area_mm2 = 0;                               // surface of the lower arch
  double gap_mm = 0;                                 // least
  double load_fraction = 0;                          // of the load of all contacts
};

/// Load of one tooth.
struct ToothLoad {
  int fdi = 0;
  int contacts = 0;
  double area_mm2 = 0, load_fraction = 0;
};

/// Overjet and overbite of the incisal edges relative to the plane of the upper teeth. Negative
/// overjet: reverse; negative overbite: open.
struct IncisorOverlap {
  double overjet_mm = 0, overbite_mm = 0;
};

/// An equilibrium of the closed arches.
struct RestingPose {
  Pose X_CM;
  double work = 0;  // potential energy of closing force, film and joint springs, N mm
  bool converged = false;
  double residual_N = 0;  // residual force
};

struct Bite {
  std::string upper, lower;                       // names of the parts that form the arches
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // normal of the upper teeth's occlusal plane
  double midline_mm = 0;                          // x
  Eigen::Vector3d upper_edge = Eigen::Vector3d::Zero();  // middle of the upper incisal edge
  RestingPose rest;
  bool stable = false;
  std::string unstable_because;        // if not stable
  std::vector<ToothContact> contacts;  // in order of decreasing load
  std::vector<ToothLoad> teeth;        // of both arches by FDI number, where they are separate
  double left_fraction = 0, front_fraction = 0;  // of the load: left half, incisors and canines
  bool front_known = false;                      // teeth are separate
  Eigen::Vector3d load_center = Eigen::Vector3d::Zero();  // cranium, mm
  double joint_fraction = 0;     // force of the joints over the closing force
  double gap_mm = 0;             // exact least distance of the arches
  double overlap_mm = 0;         // deepest overlap of the arches, 0 when apart
  IncisorOverlap before, after;  // at rest and in the bite
  double moved_from_start_mm = 0, moved_from_rest_mm = 0;       // largest over the lower crowns
  double rotation_deg = 0;                                      // from rest
  std::optional<std::array<Eigen::Vector3d, 2>> condyle_moved;  // from rest: left, right
  std::vector<RestingPose> others;  // other equilibria, lowest energy first
  int starts = 0;                   // number of closings
  std::vector<std::string> notes;
};

/// The rest pose of the case displaced along its axes and rotated by a rotation vector about the
/// centre of the lower crowns. throws: InputError when the case has no arches.
Pose displaced_from_rest(const Case& patient, const Eigen::Vector3d& moved_mm,
                         const Eigen::Vector3d& turned_deg);

/// Finds maximum intercuspation of a patient, from one or several starts.
class BiteFinder {
 public:
  /// The patient must outlive this. throws: InputError when an arch is missing.
  explicit BiteFinder(const Case& patient, const OcclusionSettings& settings = {},
                      const Progress& progress = {});
  ~BiteFinder();
  BiteFinder(BiteFinder&&) noexcept;

  /// The bite found from a pose of the mandible: opened until the arches are apart and closed on an
  /// elastic film by an upward force at the first molars, with springs at the condyles; then closed
  /// again from displaced poses until no lower energy is found. Thread-safe.
  /// throws: InputError when the start is not finite or out of reach (25 mm).
  Bite find(const Pose& start, const Progress& progress = {}) const;

  /// Bites found from a grid of starts about one: displaced sideways and forward and turned about
  /// the vertical axis. At most three, more than 0.1 mm apart; the first has the least work, with a
  /// charge for uneven load on both sides. throws: InputError as find().
  std::vector<Bite> find_from_grid(const Pose& start, const Progress& progress = {}) const;

 private:
  struct State;
  void check_start(const Pose& start) const;
  Bite measured(const RestingPose& rest, const Pose& start) const;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
