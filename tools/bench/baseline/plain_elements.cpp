#include "tools/bench/baseline/plain_elements.h"

#include <algorithm>
#include <cmath>
#include <limits>

// CMakeLists.txt has the options with which the compiler vectorises these loops.
#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__)
#define FOR_EACH_PROCESSOR \
  __attribute__((target_clones("arch=skylake-avx512", "arch=haswell", "default")))
#else
#define FOR_EACH_PROCESSOR
#endif

namespace condyle {
namespace {

constexpr int block = 128;  // elements; their arrays stay in the first cache

struct SpringBlock {
  double x[block], y[block], z[block];  // from a to b; then the force
};

FOR_EACH_PROCESSOR
double evaluate(SpringBlock& s, const double* rest, const double* stiffness, double ratio,
                int count) {
  double energy = 0;
#pragma omp simd reduction(+ : energy)
  for (int i = 0; i < count; ++i) {
    const double square = s.x[i] * s.x[i] + s.y[i] * s.y[i] + s.z[i] * s.z[i];
    const double inverse = 1 / std::sqrt(square > 1e-30 ? square : 1e-30);
    const double tension = 1 - rest[i] * inverse;
    const double force = 2 * stiffness[i] * (tension < 0 ? ratio : 1.0) * tension;
    energy += 0.5 * tension * force * square;
    s.x[i] *= force;
    s.y[i] *= force;
    s.z[i] *= force;
  }
  return energy;
}

struct PrismBlock {
  double at[15][block];     // corners 1 to 5 relative to corner 0, x y z each
  double slope[15][block];  // the gradient by them
  double rest[block], weight[block];
  double least;  // fraction of the rest volume
};

struct Point {
  double x, y, z;
};
inline Point operator+(const Point& a, const Point& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Point operator*(double s, const Point& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Point cross(const Point& a, const Point& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

FOR_EACH_PROCESSOR
double evaluate(PrismBlock& p, double barrier_fraction, double barrier_weight, double scale,
                int count) {
  double energy = 0, least = 1;
#pragma omp simd reduction(+ : energy) reduction(min : least)
  for (int i = 0; i < count; ++i) {
    const Point c1{p.at[0][i], p.at[1][i], p.at[2][i]}, c2{p.at[3][i], p.at[4][i], p.at[5][i]},
        c3{p.at[6][i], p.at[7][i], p.at[8][i]}, c4{p.at[9][i], p.at[10][i], p.at[11][i]},
        c5{p.at[12][i], p.at[13][i], p.at[14][i]};
    // See prism_volume_slopes.
    const Point c45 = cross(c4, c5), c12 = cross(c1, c2), sum = c4 + c5, lean = c1 + c2 - 2 * c3;
    const Point g1 = cross(c3, c4) + cross(sum, c2) + c45,
                g2 = cross(c1, sum) + c45 + cross(c5, c3),
                g3 = cross(c4, c1) + cross(c2, c5) - 2 * c45,
                g4 = cross(c5, lean) + cross(c1, c3) - c12,
                g5 = cross(lean, c4) + cross(c3, c2) - c12;
    const double volume =
        (dot(g1, c1) + dot(g2, c2) + dot(g3, c3) + dot(g4, c4) + dot(g5, c5)) / 36;
    const double j = volume / p.rest[i];
    least = j < least ? j : least;
    const double u = barrier_fraction > j ? barrier_fraction - j : 0.0, r = u / j;
    const double law = (j - 1) * (j - 1) + barrier_weight * u * u * r;
    const double slope = 2 * (j - 1) - barrier_weight * (3 * u * r + u * r * r);
    energy += p.weight[i] * p.rest[i] * p.rest[i] * law;
    const double pressure = scale / 12 * p.weight[i] * p.rest[i] * slope;
    const Point f1 = pressure * g1, f2 = pressure * g2, f3 = pressure * g3, f4 = pressure * g4,
                f5 = pressure * g5;
    p.slope[0][i] = f1.x, p.slope[1][i] = f1.y, p.slope[2][i] = f1.z;
    p.slope[3][i] = f2.x, p.slope[4][i] = f2.y, p.slope[5][i] = f2.z;
    p.slope[6][i] = f3.x, p.slope[7][i] = f3.y, p.slope[8][i] = f3.z;
    p.slope[9][i] = f4.x, p.slope[10][i] = f4.y, p.slope[11][i] = f4.z;
    p.slope[12][i] = f5.x, p.slope[13][i] = f5.y, p.slope[14][i] = f5.z;
  }
  p.least = least;
  return energy;
}

double springs(const SpringPrismMesh& mesh, const AxisRows& x, const AxisRows& gradient) {
  double energy = 0;
  SpringBlock s;
  for (std::size_t first = 0; first < mesh.spring_a.size(); first += block) {
    const int count = static_cast<int>(std::min<std::size_t>(block, mesh.spring_a.size() - first));
    const int *a = &mesh.spring_a[first], *b = &mesh.spring_b[first];
    for (int i = 0; i < count; ++i) {
      s.x[i] = x.x[b[i]] - x.x[a[i]];
      s.y[i] = x.y[b[i]] - x.y[a[i]];
      s.z[i] = x.z[b[i]] - x.z[a[i]];
    }
    energy += evaluate(s, &mesh.rest_length[first], &mesh.stiffness[first], mesh.compression_ratio,
                       count);
    for (int i = 0; i < count; ++i) {
      gradient.x[a[i]] -= s.x[i];
      gradient.y[a[i]] -= s.y[i];
      gradient.z[a[i]] -= s.z[i];
      gradient.x[b[i]] += s.x[i];
      gradient.y[b[i]] += s.y[i];
      gradient.z[b[i]] += s.z[i];
    }
  }
  return energy;
}

double prisms(const SpringPrismMesh& mesh, const AxisRows& x, double scale,
              const AxisRows& gradient) {
  double energy = 0;
  PrismBlock p;
  double* const rows[] = {x.x, x.y, x.z};
  double* const slopes[] = {gradient.x, gradient.y, gradient.z};
  for (std::size_t first = 0; first < mesh.prisms.size(); first += block) {
    const int count = static_cast<int>(std::min<std::size_t>(block, mesh.prisms.size() - first));
    const std::array<int, 6>* prism = &mesh.prisms[first];
    std::copy_n(&mesh.rest_volume[first], count, p.rest);
    std::copy_n(&mesh.volume_weight[first], count, p.weight);
    for (int i = 0; i < count; ++i)
      for (int k = 0; k < 5; ++k)
        for (int axis = 0; axis < 3; ++axis)
          p.at[3 * k + axis][i] = rows[axis][prism[i][k + 1]] - rows[axis][prism[i][0]];
    energy += evaluate(p, mesh.barrier_fraction, mesh.barrier_weight, scale, count);
    if (!(p.least > 1e-3)) return std::numeric_limits<double>::infinity();
    for (int i = 0; i < count; ++i)
      for (int axis = 0; axis < 3; ++axis) {
        double sum = 0;
        for (int k = 0; k < 5; ++k) {
          const double slope = p.slope[3 * k + axis][i];
          slopes[axis][prism[i][k + 1]] += slope;
          sum += slope;
        }
        slopes[axis][prism[i][0]] -= sum;
      }
  }
  return energy;
}

}  // namespace

double PlainElements::value_and_gradient(const AxisRows& x, double scale,
                                         const AxisRows& gradient) const {
  const double of_springs = springs(mesh_, x, gradient);
  return of_springs + scale * prisms(mesh_, x, scale, gradient);
}

}  // namespace condyle
