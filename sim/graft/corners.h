#pragma once

#include <Eigen/Core>
#include <vector>

namespace condyle {

/// Corners of a polyline of `pieces` straight pieces along a curve: its ends and points on it, such
/// that the mean squared distance of the curve from the pieces is least. Pieces are at least
/// `least_mm` long where the curve is long enough. A curve of pieces + 1 points has its own.
std::vector<Eigen::Vector3d> corners_on_curve(const std::vector<Eigen::Vector3d>& curve, int pieces,
                                              double least_mm);

/// Largest distance of the points of a curve from a polyline along it.
double deviation_of(const std::vector<Eigen::Vector3d>& corners,
                    const std::vector<Eigen::Vector3d>& curve);

}  // namespace condyle
