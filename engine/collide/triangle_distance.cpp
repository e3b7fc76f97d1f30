#include "engine/collide/triangle_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace condyle {
namespace {

using Vector = Eigen::Vector3d;

constexpr double narrowest = 1e-10;  // of a triangle with a normal: its height over its length
constexpr double touch_mm2 = 1e-24;  // rounding of coordinates of some 100 mm

Vector nearest_on_segment(const Vector& p, const Vector& a, const Vector& b) {
  const Vector ab = b - a;
  const double length2 = ab.squaredNorm();
  if (length2 <= 0) return a;
  const double t = (p - a).dot(ab) / length2;
  if (t <= 0) return a;
  if (t >= 1) return b;
  return a + t * ab;
}

/// A triangle with the data that its tests have in common.
struct Prepared {
  const Triangle& corner;
  std::array<Vector, 3> edge;
  std::array<double, 3> length2;
  Vector normal;  // not unit; zero without area
  double normal2;

  explicit Prepared(const Triangle& t) : corner(t), edge{t[1] - t[0], t[2] - t[1], t[0] - t[2]} {
    for (int k = 0; k < 3; ++k) length2[k] = edge[k].squaredNorm();
    normal = edge[0].cross(edge[1]);
    normal2 = normal.squaredNorm();
    const double longest2 = std::max({length2[0], length2[1], length2[2]});
    if (normal2 > narrowest * narrowest * longest2 * longest2) return;
    normal.setZero();  // of rounding alone
    normal2 = 0;
  }

  double height(const Vector& p) const { return normal.dot(p - corner[0]); }

  /// p is assumed to lie in the plane, or is projected along the normal.
  bool covers(const Vector& p) const {
    for (int k = 0; k < 3; ++k)
      if (normal.dot(edge[k].cross(p - corner[k])) < 0) return false;
    return normal2 > 0;
  }

  Vector nearest(const Vector& p) const {
    if (covers(p)) return p - normal * (height(p) / normal2);
    Vector best = corner[0];
    double best2 = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      const Vector q = nearest_on_segment(p, corner[k], corner[(k + 1) % 3]);
      const double d2 = (q - p).squaredNorm();
      if (d2 < best2) best2 = d2, best = q;
    }
    return best;
  }
};

/// Least height of a triangle that lies on one side of the plane; 0 where it does not.
double height_over_plane(const std::array<double, 3>& height) {
  const double least = std::min({height[0], height[1], height[2]});
  const double most = std::max({height[0], height[1], height[2]});
  return least > 0 ? least : (most < 0 ? -most : 0);
}

/// All of the triangle lies on one side of the plane of `plane`, farther away than the bound.
bool beyond_plane(const Prepared& plane, const std::array<double, 3>& height, double bound_mm2) {
  const double gap = height_over_plane(height);
  return gap * gap >= bound_mm2 * plane.normal2 && gap > 0;
}

/// Points where the edges of `t` pierce `face`; at most three, appended.
int pierce(const Prepared& t, const std::array<double, 3>& height, const Prepared& face,
           std::array<Vector, 6>& points, int count) {
  for (int k = 0; k < 3; ++k) {
    const double h0 = height[k], h1 = height[(k + 1) % 3];
    if ((h0 > 0) == (h1 > 0) && h0 != 0 && h1 != 0) continue;
    if (h0 == 0 && h1 == 0) continue;  // in the plane: the adjacent edges decide
    const Vector x = t.corner[k] + t.edge[k] * (h0 / (h0 - h1));
    if (face.covers(x)) points[count++] = x;
  }
  return count;
}

std::array<double, 3> heights(const Prepared& plane, const Triangle& t) {
  return {plane.height(t[0]), plane.height(t[1]), plane.height(t[2])};
}

}  // namespace

TriangleGap triangle_distance(const Triangle& ta, const Triangle& tb, double bound_mm2) {
  const Prepared a(ta), b(tb);
  const auto b_over_a = heights(a, tb);
  TriangleGap gap;
  gap.squared_mm2 = bound_mm2;
  if (beyond_plane(a, b_over_a, bound_mm2)) return gap;
  const auto a_over_b = heights(b, ta);
  if (beyond_plane(b, a_over_b, bound_mm2)) return gap;

  std::array<Vector, 6> points;
  if (pierce(b, b_over_a, a, points, 0) > 0 || pierce(a, a_over_b, b, points, 0) > 0) {
    gap.squared_mm2 = 0;
    gap.p = gap.q = points[0];
    return gap;
  }

  const auto offer = [&gap](const Vector& p, const Vector& q) {
    const double d2 = (p - q).squaredNorm();
    if (d2 < gap.squared_mm2) gap = {d2, p, q};
  };
  for (int k = 0; k < 3; ++k) {
    offer(a.nearest(tb[k]), tb[k]);
    offer(ta[k], b.nearest(ta[k]));
  }
  // Interior points of two edges. With the cross product the parameters stay accurate for nearly
  // parallel edges (the standard determinant a e - b^2 loses all digits at 1e-8 rad). For parallel
  // edges the corners above give the answer.
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Vector n = a.edge[i].cross(b.edge[j]);
      const double n2 = n.squaredNorm();
      if (n2 <= 0) continue;
      const Vector w = tb[j] - ta[i];
      const double h = w.dot(n);
      // Even the lines are farther apart, including the rounding of h (1e-15 of its factors).
      const double doubt2 = 1e-30 * w.squaredNorm() * a.length2[i] * b.length2[j];
      if (h * h >= 2 * (gap.squared_mm2 * n2 + doubt2)) continue;
      const double s = w.cross(b.edge[j]).dot(n) / n2, t = w.cross(a.edge[i]).dot(n) / n2;
      if (s <= 0 || s >= 1 || t <= 0 || t >= 1) continue;
      // s and t have independent errors along the edges: each point is projected on the other edge.
      const Vector p = ta[i] + s * a.edge[i];
      offer(p, nearest_on_segment(p, tb[j], tb[(j + 1) % 3]));
    }
  if (gap.squared_mm2 <= touch_mm2) gap.squared_mm2 = 0;
  return gap;
}

// source: Ericson, Real-Time Collision Detection, 5.1.5; an order of tests that needs no normal.
Vector nearest_point(const Vector& p, const Triangle& t) {
  const Vector ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return t[0];
  const Vector bp = p - t[1];
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return t[1];
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return t[0] + ab * (d1 / (d1 - d3));
  const Vector cp = p - t[2];
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return t[2];
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return t[0] + ac * (d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return t[1] + (t[2] - t[1]) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const double sum = va + vb + vc;
  if (!(sum > 0)) return Prepared(t).nearest(p);  // without area
  return t[0] + ab * (vb / sum) + ac * (vc / sum);
}

TriangleCrossing triangle_crossing(const Triangle& ta, const Triangle& tb) {
  const Prepared a(ta), b(tb);
  TriangleCrossing crossing;
  const auto b_over_a = heights(a, tb);
  const auto apart = [&](const Prepared& plane, const std::array<double, 3>& height) {
    const double gap = height_over_plane(height);
    if (gap > 0) crossing.apart_mm = gap / std::sqrt(plane.normal2);
    return gap > 0;
  };
  if (apart(a, b_over_a)) return crossing;
  const auto a_over_b = heights(b, ta);
  if (apart(b, a_over_b)) return crossing;
  std::array<Vector, 6> points;
  int count = pierce(b, b_over_a, a, points, 0);
  count = pierce(a, a_over_b, b, points, count);
  if (count == 0) return crossing;
  crossing.crosses = true;
  double longest = -1;
  for (int i = 0; i < count; ++i)
    for (int j = i; j < count; ++j) {
      const double d2 = (points[i] - points[j]).squaredNorm();
      if (d2 > longest) longest = d2, crossing.from = points[i], crossing.to = points[j];
    }
  return crossing;
}

double triangle_overlap(const Triangle& ta, const Triangle& tb) {
  const Prepared a(ta), b(tb);
  double least = std::numeric_limits<double>::infinity();
  const auto along = [&](const Vector& axis) {
    const double length = axis.norm();
    if (length < 1e-9) return;
    double low_a = axis.dot(ta[0]), high_a = low_a, low_b = axis.dot(tb[0]), high_b = low_b;
    for (int k = 1; k < 3; ++k) {
      const double pa = axis.dot(ta[k]), pb = axis.dot(tb[k]);
      low_a = std::min(low_a, pa), high_a = std::max(high_a, pa);
      low_b = std::min(low_b, pb), high_b = std::max(high_b, pb);
    }
    least = std::min(least, std::min(high_a - low_b, high_b - low_a) / length);
  };
  along(a.normal);
  along(b.normal);
  for (const auto& u : a.edge)
    for (const auto& v : b.edge) along(u.cross(v));
  return std::isfinite(least) ? std::max(least, 0.0) : 0.0;
}

}  // namespace condyle
