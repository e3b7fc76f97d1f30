#include "engine/field/primitives.h"

#include <cassert>
#include <cmath>
#include <numbers>

namespace condyle {
namespace {

using Eigen::Vector3d;

/// One straight piece of a tube, with the precomputed terms of its distance.
struct Piece {
  Vector3d start, edge;
  double inverse_length2;
  double across, across_step, along, along_step;  // half-widths at the start and their change
  double reach;                                   // largest half-width
};

std::vector<Piece> pieces_of(const std::vector<Vector3d>& points, const std::vector<double>& across,
                             const std::vector<double>& along, int pieces_per_span) {
  assert(points.size() == across.size() && points.size() == along.size());
  std::vector<Eigen::VectorXd> rows;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Eigen::VectorXd row(5);
    row << points[i], across[i], along[i];
    rows.push_back(row);
  }
  const auto curve = catmull_rom(rows, pieces_per_span);
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
    const auto &a = curve[i], &b = curve[i + 1];
    Piece piece{a.head<3>(), b.head<3>() - a.head<3>(),         0, a[3], b[3] - a[3], a[4],
                b[4] - a[4], std::max({a[3], a[4], b[3], b[4]})};
    piece.inverse_length2 = 1 / piece.edge.squaredNorm();
    pieces.push_back(piece);
  }
  return pieces;
}

Eigen::AlignedBox3d box_of(const std::vector<Piece>& pieces) {
  Eigen::AlignedBox3d box;
  double reach = 0;
  for (const auto& piece : pieces) {
    box.extend(piece.start);
    box.extend(piece.start + piece.edge);
    reach = std::max(reach, piece.reach);
  }
  return {box.min().array() - reach, box.max().array() + reach};
}

}  // namespace

Eigen::AlignedBox3d unbounded_box() { return {Vector3d::Constant(-1e6), Vector3d::Constant(1e6)}; }

Eigen::Matrix3d axis_rotation(char axis, double angle_deg) {
  const Vector3d unit = axis == 'x'   ? Vector3d::UnitX()
                        : axis == 'y' ? Vector3d::UnitY()
                                      : Vector3d::UnitZ();
  return Eigen::AngleAxisd(angle_deg * std::numbers::pi / 180, unit).toRotationMatrix();
}

Primitive ellipsoid(const Vector3d& center, const Vector3d& semi_axes,
                    const Eigen::Matrix3d& axes) {
  assert(semi_axes.minCoeff() > 0);
  const Eigen::Matrix3d to_unit = semi_axes.cwiseInverse().asDiagonal() * axes.transpose();
  const Vector3d inverse = semi_axes.cwiseInverse();
  const double deep = -semi_axes.minCoeff();
  Vector3d half;  // of the rotated ellipsoid's box
  for (int i = 0; i < 3; ++i) half[i] = axes.row(i).transpose().cwiseProduct(semi_axes).norm();
  return {[=](const Vector3d& p) {
            const Vector3d q = to_unit * (p - center);
            const double k0 = q.norm();
            if (k0 < 0.05) return deep;
            return k0 * (k0 - 1) / q.cwiseProduct(inverse).norm();
          },
          {center - half, center + half}};
}

Primitive rounded_box(const Vector3d& center, const Vector3d& half, double radius) {
  assert(radius >= 0 && half.minCoeff() >= radius);
  const Vector3d core = half.array() - radius;
  return {[=](const Vector3d& p) {
            const Vector3d q = (p - center).cwiseAbs() - core;
            return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - radius;
          },
          {center - half, center + half}};
}

Primitive tube(const std::vector<Vector3d>& points, const std::vector<double>& radii,
               int pieces_per_span) {
  const auto pieces = pieces_of(points, radii, radii, pieces_per_span);
  const auto box = box_of(pieces);
  return {[pieces](const Vector3d& p) {
            double best = 1e9;
            for (const auto& piece : pieces) {
              const Vector3d from = p - piece.start;
              const double t = std::clamp(from.dot(piece.edge) * piece.inverse_length2, 0.0, 1.0);
              const double w2 = (from - t * piece.edge).squaredNorm(), near = best + piece.reach;
              if (near <= 0 || w2 >= near * near) continue;
              best = std::min(best, std::sqrt(w2) - (piece.across + piece.across_step * t));
            }
            return best;
          },
          box};
}

Primitive flat_tube(const std::vector<Vector3d>& points, const std::vector<double>& across,
                    const std::vector<double>& along, const Vector3d& direction,
                    int pieces_per_span) {
  const auto pieces = pieces_of(points, across, along, pieces_per_span);
  const auto box = box_of(pieces);
  const Vector3d n = direction.normalized();
  return {[pieces, n](const Vector3d& p) {
            double best = 1e9;
            for (const auto& piece : pieces) {
              const Vector3d from = p - piece.start;
              const double t = std::clamp(from.dot(piece.edge) * piece.inverse_length2, 0.0, 1.0);
              const Vector3d w = from - t * piece.edge;
              const double w2 = w.squaredNorm(), near = best + 1.5 * piece.reach;
              if (near > 0 && w2 >= near * near) continue;
              const double a = piece.across + piece.across_step * t;
              const double b = piece.along + piece.along_step * t;
              const double s = w.dot(n), s2 = s * s, o = std::max(w2 - s2, 0.0);
              const double a2 = a * a, b2 = b * b;
              const double k0 = std::sqrt(o / a2 + s2 / b2);
              const double d = k0 < 0.05
                                   ? -std::min(a, b)
                                   : k0 * (k0 - 1) / std::sqrt(o / (a2 * a2) + s2 / (b2 * b2));
              best = std::min(best, d);
            }
            return best;
          },
          box};
}

std::vector<Eigen::VectorXd> catmull_rom(const std::vector<Eigen::VectorXd>& points,
                                         int pieces_per_span) {
  const std::size_t n = points.size();
  assert(n >= 2);
  if (n == 2) return points;
  const auto at = [&](std::size_t i) -> Eigen::VectorXd {  // i counts from one before the first
    if (i == 0) return 2 * points[0] - points[1];
    if (i == n + 1) return 2 * points[n - 1] - points[n - 2];
    return points[i - 1];
  };
  std::vector<Eigen::VectorXd> curve;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const Eigen::VectorXd a = at(i), b = at(i + 1), c = at(i + 2), d = at(i + 3);
    for (int j = 0; j < pieces_per_span; ++j) {
      const double t = static_cast<double>(j) / pieces_per_span;
      curve.push_back(0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t * t +
                             (3 * b - a - 3 * c + d) * t * t * t));
    }
  }
  curve.push_back(points.back());
  return curve;
}

std::vector<Eigen::Vector2d> closed_outline(const std::vector<Eigen::Vector2d>& points,
                                            int pieces) {
  const std::size_t n = points.size();
  std::vector<Eigen::Vector2d> outline;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d &a = points[(i + n - 1) % n], &b = points[i], &c = points[(i + 1) % n],
                          &d = points[(i + 2) % n];
    for (int j = 0; j < pieces; ++j) {
      const double t = static_cast<double>(j) / pieces;
      outline.push_back(0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t * t +
                               (3 * b - a - 3 * c + d) * t * t * t));
    }
  }
  return outline;
}

double polygon_distance(std::span<const Eigen::Vector2d> polygon, const Eigen::Vector2d& p) {
  assert(polygon.size() >= 3);
  double best = 1e18;
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[i + 1 == polygon.size() ? 0 : i + 1];
    const Eigen::Vector2d e = b - a, w = p - a;
    const double t = std::clamp(w.dot(e) / e.squaredNorm(), 0.0, 1.0);
    best = std::min(best, (w - t * e).squaredNorm());
    if ((a.y() > p.y()) != (b.y() > p.y()) && w.x() < e.x() * w.y() / e.y()) inside = !inside;
  }
  return inside ? -std::sqrt(best) : std::sqrt(best);
}

}  // namespace condyle
