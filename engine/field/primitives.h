#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <span>
#include <vector>

namespace condyle {

/// Signed distance of a solid at a point, mm: negative inside. It is approximate: its gradient
/// stays between about 0.8 and 1.2 near the surface, so that smooth unions and clearances keep
/// their size.
using Distance = std::function<double(const Eigen::Vector3d&)>;

/// One solid, with its bounding box.
struct Primitive {
  Distance distance;
  Eigen::AlignedBox3d box;
};

/// Unbounded box, for primitives that act everywhere.
Eigen::AlignedBox3d unbounded_box();

/// Rotation by an angle in degrees about the x, y or z axis.
Eigen::Matrix3d axis_rotation(char axis, double angle_deg);

/// Ellipsoid whose semi-axes (mm) lie along the columns of `axes`.
Primitive ellipsoid(const Eigen::Vector3d& center, const Eigen::Vector3d& semi_axes,
                    const Eigen::Matrix3d& axes = Eigen::Matrix3d::Identity());

/// Box with edges rounded by `radius`; `half` is measured to the faces. mm.
Primitive rounded_box(const Eigen::Vector3d& center, const Eigen::Vector3d& half, double radius);

/// Round tube along a Catmull-Rom spline; one radius per point. The tube ends where the radius
/// falls below zero.
Primitive tube(const std::vector<Eigen::Vector3d>& points, const std::vector<double>& radii,
               int pieces_per_span = 5);

/// Tube of elliptic section: half-width `along` in the fixed direction, `across` at right angles.
Primitive flat_tube(const std::vector<Eigen::Vector3d>& points, const std::vector<double>& across,
                    const std::vector<double>& along, const Eigen::Vector3d& direction,
                    int pieces_per_span = 5);

/// Points of a Catmull-Rom spline through rows of `points` (any width), ends by reflection.
std::vector<Eigen::VectorXd> catmull_rom(const std::vector<Eigen::VectorXd>& points,
                                         int pieces_per_span);

/// Closed Catmull-Rom outline through the points, `pieces` per span.
std::vector<Eigen::Vector2d> closed_outline(const std::vector<Eigen::Vector2d>& points, int pieces);

/// Signed distance to a closed polygon, negative inside.
double polygon_distance(std::span<const Eigen::Vector2d> polygon, const Eigen::Vector2d& p);

}  // namespace condyle
