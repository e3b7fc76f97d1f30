#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

namespace condyle {

/// The points p with normal · p = offset_mm. The normal has unit length; it points to the upper
/// side.
struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset_mm = 0;

  double distance(const Eigen::Vector3d& p) const { return normal.dot(p) - offset_mm; }
};
/// The normal may have any length but 0.
Plane plane_through(const Eigen::Vector3d& point, const Eigen::Vector3d& normal);

/// A region of space bounded by planes: half-spaces combined by `both`, `either` and `choose`.
class Region {
 public:
  /// The upper side of a plane; the plane is a wall of the saw cut, marked by a number of the
  /// caller's. A kerf moves it.
  static Region above(const Plane& plane, int wall = 0);
  /// `upper` on the upper side of a plane, `lower` on its lower side. The plane itself does not
  /// bound the region.
  static Region choose(const Plane& plane, Region upper, Region lower);
  friend Region both(Region a, Region b);
  friend Region either(Region a, Region b);
  /// All that is not in the region. Walls keep their marks.
  friend Region opposite(Region region);

  /// A plane of the region.
  struct Leaf {
    Plane plane;
    int wall = -1;  // -1: of `choose`
  };
  const std::vector<Leaf>& leaves() const { return leaves_; }
  /// The region with other planes in the place of its own, such as moved ones.
  Region with_planes(const std::function<Plane(const Leaf&)>& plane) const;

  /// State of a plane in a part of space: on its upper side, its lower side, or not known.
  enum class Side : signed char { lower = 0, upper = 1, unknown = -1 };
  /// Whether a part of space is in the region, or the plane that must be known first.
  struct Answer {
    bool known = false;
    bool inside = false;
    int leaf = -1;
  };
  /// shape: one side per leaf.
  Answer evaluate(std::span<const Side> sides) const;

 private:
  enum class Kind { leaf, both, either, choose };
  struct Node {
    Kind kind;
    int leaf = -1;                // of leaf and choose
    int first = -1, second = -1;  // children; of choose: upper, lower
  };
  static Region combined(Kind kind, Region a, Region b);
  /// Appends another's nodes and leaves; returns its root's new number.
  int append(const Region& other);
  Answer evaluate(int node, std::span<const Side> sides) const;

  std::vector<Node> nodes_;  // the last is the root
  std::vector<Leaf> leaves_;
};

/// The region on one side of a sheet: a polyline extruded in both senses along a direction, its
/// first and last segments extended without end. `side` points to the region at the first segment.
/// Segments become the walls first_wall, first_wall + 1, ...
/// throws: InputError for fewer than two points, a segment shorter than 1e-3 mm seen along the
/// direction, or a bend of more than 120 degrees.
Region beyond_sheet(std::span<const Eigen::Vector3d> polyline, const Eigen::Vector3d& direction,
                    const Eigen::Vector3d& side, int first_wall = 0);

/// Planes of a box, outward normals.
std::vector<Plane> box_planes(const Eigen::Vector3d& low, const Eigen::Vector3d& high);

}  // namespace condyle
