#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/math/pose.h"
#include "sim/case/case.h"
#include "sim/contact/seat.h"

namespace condyle {

/// The path of a graft into its seat. Positions are along the path out, of the graft's middle.
struct InsertionPath {
  enum class State { free, tight, blocked };
  State state = State::blocked;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // out of the seat, unit
  double length_mm = 0;                                  // that was examined
  // Least distance of the graft from all else, beyond the first 2 mm; where along the path, at
  // which place and of which part.
  double margin_mm = 0, margin_after_mm = 0;
  Eigen::Vector3d margin_at = Eigen::Vector3d::Zero();  // cranium
  std::string margin_part = {};
  // Of a blocked path: how far the graft comes, and the part that stops it, at margin_at.
  double blocked_after_mm = 0;
  std::string blocked_by = {};
  int directions = 0;  // examined
  // Of a path on which the graft turns: its displacements from the seat, the first none. Empty: the
  // path is straight.
  std::vector<Pose> poses = {};
  double turn_deg = 0;  // the largest
  // Of the search for such a path, 0 where a straight one was found: poses examined, and how far
  // the graft's middle came.
  int poses_examined = 0;
  double searched_mm = 0;

  bool turns() const { return !poses.empty(); }
};

constexpr double tight_margin_mm = 0.3;
constexpr double path_length_mm = 60;

/// The path out of a seat. First the straight path along which the graft keeps the largest
/// distance. A graft between plane faces can only leave along directions that point out of each
/// face or along it; examined are the approach brought into this cone, the middle of the cone and
/// directions around both, in steps of 0.25 mm over the first 10 mm and 1 mm after, against all
/// bone and teeth of other bodies at rest. Surfaces are compared by exact distances of samples of
/// the graft (0.8 mm) and of corners of the others. Where all straight paths are blocked, a path
/// with turns is searched (find_turned_path()). Bit-identical for any number of threads. throws:
/// InputError for a body that the patient lacks.
InsertionPath find_insertion_path(const Case& patient, const Seat& seat, int threads = 1);

/// "insertion path of graft: free, straight (out of its seat down and to the left); least distance
/// 0.80 mm, ...".
std::string insertion_path_text(const InsertionPath& path, const Seat& seat);

/// "free", "tight", "blocked".
std::string state_name(InsertionPath::State state);

}  // namespace condyle
