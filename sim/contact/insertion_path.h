#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/math/pose.h"
#include "sim/case/case.h"

namespace condyle {

/// Where a graft lies, and what bounds its path out.
struct Seat {
  std::string name;                 // of the graft
  std::vector<std::string> bodies;  // its pieces, which move together; the first carries the others
  std::vector<Eigen::Vector3d> face_normals;  // of the bone's faces at its ends, out of that bone
  Eigen::Vector3d approach = -Eigen::Vector3d::UnitZ();  // towards the surgeon's hands
};

/// The straight path of a graft into its seat. Positions are along the path out.
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
};

constexpr double tight_margin_mm = 0.3;
constexpr double path_length_mm = 60;

/// The straight path out of a seat along which the graft keeps the largest distance. A graft
/// between plane faces can only leave along directions that point out of each face or along it;
/// examined are the approach brought into this cone, the middle of the cone and directions around
/// both, in steps of 0.25 mm over the first 10 mm and 1 mm after, against all bone and teeth of
/// other bodies at rest. Surfaces are compared by exact distances of samples of the graft (0.8 mm)
/// and of corners of the others. Bit-identical for any number of threads. throws: InputError for a
/// body that the patient lacks.
InsertionPath find_insertion_path(const Case& patient, const Seat& seat, int threads = 1);

/// "graft: free, straight out down and to the left; at least 0.8 mm from mandible".
std::string insertion_path_text(const InsertionPath& path, const Seat& seat);

/// "free", "tight", "blocked".
std::string state_name(InsertionPath::State state);

}  // namespace condyle
