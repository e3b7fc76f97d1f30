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
  double paper_mm = 0.1;                 // foil that is bitten on; what it marks is a contact
  double closing_force_N = 200;          // of both sides together, at the first molars
  double joint_N_per_mm = 20;            // holds each condyle's centre where it is at rest
  double foil_MPa = 200;                 // pressure that halves the foil
  double search_mm = 2, search_deg = 2;  // how far about a bite others are looked for
  double most_overlap_mm = 0.05;         // of a bite that counts
  std::filesystem::path cache;           // folder for distance fields; empty: none
  int threads = 1;                       // same bits for any number
};

/// One place where the paper is marked.
struct ToothContact {
  int upper_fdi = 0, lower_fdi = 0;  // 0: the teeth are not separate
  bool left = false;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();   // on the upper arch, cranium, mm
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit, out of the upper arch
  double area_mm2 = 0;                               // of the lower arch's surface
  double gap_mm = 0;                                 // least
  double load_share = 0;                             // of what all contacts bear
};

/// What one tooth bears.
struct ToothLoad {
  int fdi = 0;
  int contacts = 0;
  double area_mm2 = 0, load_share = 0;
};

/// Overlap of the incisors: of their edges, in the plane of the upper teeth. Negative overjet:
/// reverse; negative overbite: open.
struct IncisorOverlap {
  double overjet_mm = 0, overbite_mm = 0;
};

/// A pose in which the arches came to rest.
struct RestingPose {
  Pose X_CM;
  double work = 0;  // N mm, spent by what closes less what foil and joints hold; least is best
  bool converged = false;
  double residual_N = 0;  // force that is left
};

struct Bite {
  std::string upper, lower;                       // parts that are the arches
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // normal of the upper teeth's occlusal plane
  double midline_mm = 0;                          // x
  Eigen::Vector3d upper_edge = Eigen::Vector3d::Zero();  // middle of the upper incisal edge
  RestingPose rest;
  bool stable = false;
  std::string unstable_because;            // when it is not
  std::vector<ToothContact> contacts;      // largest share of the load first
  std::vector<ToothLoad> teeth;            // of both arches by FDI number, where they are separate
  double left_share = 0, front_share = 0;  // of the load: left half, incisors and canines
  bool front_known = false;                // teeth are separate
  Eigen::Vector3d load_center = Eigen::Vector3d::Zero();  // cranium, mm
  double joint_share = 0;        // force of the joints over the closing force
  double gap_mm = 0;             // exact least distance of the arches
  double overlap_mm = 0;         // deepest overlap of the arches, 0 when apart
  IncisorOverlap before, after;  // at rest and in the bite
  double moved_from_start_mm = 0, moved_from_rest_mm = 0;  // farthest point of the lower crowns
  double rotation_deg = 0;                                 // from rest
  std::optional<std::array<Eigen::Vector3d, 2>> condyle_moved;  // from rest: left, right
  std::vector<RestingPose> others;  // other poses in which the arches rest, least work first
  int starts = 0;                   // closings that were tried
  std::vector<std::string> notes;
};

/// The rest pose of the case moved by millimetres along its axes and turned by a rotation vector
/// about the middle of the lower crowns. throws: InputError when the case has no arches.
Pose pose_beside_rest(const Case& patient, const Eigen::Vector3d& moved_mm,
                      const Eigen::Vector3d& turned_deg);

/// A patient made ready to have his bite settled, from one start or several.
class BiteFinder {
 public:
  /// The patient must outlive this. throws: InputError when an arch is missing.
  explicit BiteFinder(const Case& patient, const OcclusionSettings& settings = {},
                      const Progress& progress = {});
  ~BiteFinder();
  BiteFinder(BiteFinder&&) noexcept;

  /// The bite found from a pose of the mandible: opened until the arches are apart, closed on a
  /// foil by a force upward at the first molars, while springs hold the condyles' centres; then
  /// closed anew from beside each bite found, until none does more work. May be asked on several
  /// threads at once.
  /// throws: InputError when the start is not finite or out of reach (25 mm).
  Bite find(const Pose& start, const Progress& progress = {}) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
