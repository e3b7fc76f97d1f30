#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace condyle {

/// Where a graft lies, and what bounds its path out.
struct Seat {
  std::string name;                 // of the graft
  std::vector<std::string> bodies;  // its pieces, which move together; the first carries the others
  std::vector<Eigen::Vector3d> face_normals;  // of the bone's faces at its ends, out of that bone
  Eigen::Vector3d approach = -Eigen::Vector3d::UnitZ();  // towards the surgeon's hands
};

}  // namespace condyle
