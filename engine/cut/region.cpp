#include "engine/cut/region.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cassert>
#include <cmath>
#include <utility>

#include "engine/core/error.h"

namespace condyle {

Plane plane_through(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  assert(normal.norm() > 0);
  const Eigen::Vector3d unit = normal.normalized();
  return {unit, unit.dot(point)};
}

Region Region::above(const Plane& plane, int wall) {
  Region region;
  region.leaves_.push_back({plane, wall});
  region.nodes_.push_back({.kind = Kind::leaf, .leaf = 0});
  return region;
}

int Region::append(const Region& other) {
  const int nodes = static_cast<int>(nodes_.size()), leaves = static_cast<int>(leaves_.size());
  for (Node node : other.nodes_) {
    if (node.leaf >= 0) node.leaf += leaves;
    if (node.first >= 0) node.first += nodes;
    if (node.second >= 0) node.second += nodes;
    nodes_.push_back(node);
  }
  leaves_.insert(leaves_.end(), other.leaves_.begin(), other.leaves_.end());
  return static_cast<int>(nodes_.size()) - 1;
}

Region Region::combined(Kind kind, Region a, Region b) {
  const int first = static_cast<int>(a.nodes_.size()) - 1;
  const int second = a.append(b);
  a.nodes_.push_back({.kind = kind, .first = first, .second = second});
  return a;
}

Region Region::choose(const Plane& plane, Region upper, Region lower) {
  Region region;
  region.leaves_.push_back({plane, -1});
  const int first = region.append(upper), second = region.append(lower);
  region.nodes_.push_back({.kind = Kind::choose, .leaf = 0, .first = first, .second = second});
  return region;
}

Region both(Region a, Region b) {
  return Region::combined(Region::Kind::both, std::move(a), std::move(b));
}
Region either(Region a, Region b) {
  return Region::combined(Region::Kind::either, std::move(a), std::move(b));
}

Region opposite(Region region) {
  using Kind = Region::Kind;
  for (Region::Node& node : region.nodes_) {
    if (node.kind == Kind::leaf) {
      Plane& plane = region.leaves_[node.leaf].plane;
      plane = {-plane.normal, -plane.offset_mm};
    } else if (node.kind != Kind::choose) {
      node.kind = node.kind == Kind::both ? Kind::either : Kind::both;
    }
  }
  return region;
}

Region Region::with_planes(const std::function<Plane(const Leaf&)>& plane) const {
  Region region = *this;
  for (Leaf& leaf : region.leaves_) leaf.plane = plane(leaf);
  return region;
}

Region::Answer Region::evaluate(std::span<const Side> sides) const {
  assert(sides.size() == leaves_.size());
  return evaluate(static_cast<int>(nodes_.size()) - 1, sides);
}

Region::Answer Region::evaluate(int index, std::span<const Side> sides) const {
  const Node& node = nodes_[index];
  if (node.kind == Kind::leaf || node.kind == Kind::choose) {
    const Side side = sides[node.leaf];
    if (side == Side::unknown) return {.leaf = node.leaf};
    if (node.kind == Kind::leaf) return {.known = true, .inside = side == Side::upper};
    return evaluate(side == Side::upper ? node.first : node.second, sides);
  }
  const Answer first = evaluate(node.first, sides);
  const bool decides = node.kind == Kind::either;  // the value of one that decides for both
  if (!first.known || first.inside == decides) return first;
  return evaluate(node.second, sides);
}

Region beyond_sheet(std::span<const Eigen::Vector3d> polyline, const Eigen::Vector3d& direction,
                    const Eigen::Vector3d& side, int first_wall) {
  if (polyline.size() < 2)
    throw InputError(fmt::format("a sheet needs two points, not {}", polyline.size()));
  const Eigen::Vector3d along = direction.normalized();
  const int count = static_cast<int>(polyline.size()) - 1;
  std::vector<Eigen::Vector3d> steps(count), normals(count);
  for (int i = 0; i < count; ++i) {
    Eigen::Vector3d step = polyline[i + 1] - polyline[i];
    step -= step.dot(along) * along;
    if (!(step.norm() > 1e-3))
      throw InputError(
          fmt::format("points {} and {} of the sheet coincide along its direction", i + 1, i + 2));
    steps[i] = step.normalized();
    normals[i] = along.cross(steps[i]);
    if (i > 0 && steps[i].dot(steps[i - 1]) < -0.5)
      throw InputError(fmt::format(
          "the sheet bends by {:.0f} degrees at point {}; at most 120",
          std::acos(std::max(-1., steps[i].dot(steps[i - 1]))) * 180 / 3.14159265358979323846,
          i + 1));
  }
  // Left of the polyline is one side all along it.
  const double sign = normals[0].dot(side) < 0 ? -1 : 1;
  const auto segment = [&](int i) {
    return Region::above(plane_through(polyline[i], sign * normals[i]), first_wall + i);
  };
  Region region = segment(count - 1);
  for (int i = count - 1; i > 0; --i)
    region = Region::choose(plane_through(polyline[i], steps[i - 1] + steps[i]), std::move(region),
                            segment(i - 1));
  return region;
}

std::vector<Plane> box_planes(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  std::vector<Plane> planes;
  for (int axis = 0; axis < 3; ++axis) {
    planes.push_back({Eigen::Vector3d::Unit(axis), high[axis]});
    planes.push_back({-Eigen::Vector3d::Unit(axis), -low[axis]});
  }
  return planes;
}

}  // namespace condyle
