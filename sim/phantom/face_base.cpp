#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "engine/field/smooth.h"
#include "engine/math/pchip.h"
#include "sim/phantom/soft_shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr double axis_y = -25;  // the vertical axis the radii are measured from
const std::vector<double> azimuth = {0, 10, 20, 30, 40, 50, 60, 75, 90, 105, 120, 150, 180};
struct TableRow {
  double z;
  std::array<double, 13> radius;
};
const std::array<TableRow, 24> radius_table = {{
    {-125, {32, 32, 31.5, 31, 30.5, 30.3, 31, 33, 38, 45, 60, 80, 88}},
    {-112, {37, 36.7, 36, 35, 34, 33.4, 33.2, 35.5, 39.5, 45, 62, 80, 88}},
    {-104, {46, 45.5, 43.5, 41, 39, 37.5, 37, 38, 41, 46, 63, 80, 88}},
    {-99, {60, 58, 53, 48.5, 45.5, 43.3, 42, 41, 43.5, 48, 64, 80, 88}},
    {-94, {71, 68.5, 62.5, 57.5, 53.6, 50.6, 48.3, 44.5, 46, 50, 65, 80, 88}},
    {-88, {74, 71.8, 66.8, 62, 58.2, 55.2, 51.6, 48, 49.5, 52.5, 66, 80, 88}},
    {-80, {74, 72.6, 69, 65, 61.7, 58.6, 54.8, 51.3, 52.6, 55.8, 68, 80, 88}},
    {-72, {73, 72, 69.4, 66.9, 64, 61, 58.2, 54.8, 54.7, 57.6, 69, 80, 88}},
    {-64, {74.5, 73.4, 71, 68.6, 66, 63.2, 61.2, 57.8, 57.8, 62, 70, 80, 88}},
    {-56, {77, 75.6, 72.4, 70.2, 67.6, 65.2, 63.3, 60.4, 59.6, 63, 71, 81, 88}},
    {-50, {77.6, 76.6, 73.6, 71.2, 69, 67, 64.9, 62.0, 60.8, 64, 72, 82, 88}},
    {-44, {79, 77.3, 74.2, 72.3, 70.2, 68.3, 66.3, 63.5, 62.4, 65.6, 74, 84, 90}},
    {-36, {79.2, 77.3, 74, 72.8, 71.3, 69.8, 68.2, 65.6, 64.7, 67.5, 76, 88, 96}},
    {-27, {78.8, 76.5, 73, 72.8, 72.3, 71.4, 70.0, 67.8, 67.5, 71, 78, 94, 103}},
    {-18, {77.5, 75, 71.5, 71.8, 72.5, 72.4, 71.7, 69.5, 69.5, 73, 80, 100, 110}},
    {-9, {75.5, 73.2, 70.1, 70.5, 71.9, 73.3, 73.1, 72.0, 72.2, 75, 82, 106, 116}},
    {0, {72.5, 70.4, 67.1, 67.7, 70.6, 73.2, 73.7, 73.1, 73.2, 76, 84, 110, 120}},
    {9, {70, 67.8, 63.9, 65.3, 68.1, 71.4, 72.9, 72.9, 73.2, 76, 85, 113, 123}},
    {18, {68, 65.8, 63.9, 66.7, 69.4, 71.4, 71.9, 71.9, 72.7, 77, 87, 115, 125}},
    {27, {69, 68.3, 68.4, 70.5, 71.6, 72.2, 71.5, 70.9, 72.4, 77, 88, 116, 126}},
    {36, {71.5, 72.5, 72.9, 73.0, 72.8, 71.7, 70.3, 69.7, 71.4, 77, 88, 116, 126}},
    {46, {72, 72.2, 72.4, 72, 71, 69.8, 69, 68.7, 70.5, 77, 89, 116, 125}},
    {60, {69.5, 69.6, 69.8, 69.3, 68.3, 67.7, 67.5, 67.7, 70, 77, 89, 115, 123}},
    {75, {66, 66, 66, 66, 65.5, 65.5, 66, 66.5, 69, 76, 90, 112, 117}},
}};

/// Cubic spline through (x, y) with flat ends, at x = 0, 1, ... 180.
std::vector<double> flat_ended_spline(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t n = x.size();
  std::vector<double> slope(n, 0), diagonal(n, 1), upper(n, 0);
  for (std::size_t i = 1; i + 1 < n; ++i) {  // continuous second derivative
    const double h0 = x[i] - x[i - 1], h1 = x[i + 1] - x[i];
    const double right =
        3 * ((y[i] - y[i - 1]) / h0 * h1 + (y[i + 1] - y[i]) / h1 * h0) - h1 * slope[i - 1];
    diagonal[i] = 2 * (h0 + h1) - h1 * upper[i - 1];
    upper[i] = h0 / diagonal[i];
    slope[i] = right / diagonal[i];
  }
  for (std::size_t i = n - 1; i-- > 1;) slope[i] -= upper[i] * slope[i + 1];
  std::vector<double> out;
  std::size_t i = 0;
  for (int degree = 0; degree <= 180; ++degree) {
    while (i + 2 < n && x[i + 1] <= degree) ++i;
    const double h = x[i + 1] - x[i], t = (degree - x[i]) / h, t2 = t * t, t3 = t2 * t;
    out.push_back((2 * t3 - 3 * t2 + 1) * y[i] + (t3 - 2 * t2 + t) * h * slope[i] +
                  (3 * t2 - 2 * t3) * y[i + 1] + (t3 - t2) * h * slope[i + 1]);
  }
  return out;
}

/// Gaussian blur of a row, continued beyond its ends by its mirror image or by its end value.
std::vector<double> blurred(const std::vector<double>& row, double sigma, bool mirror_ends) {
  const int n = static_cast<int>(row.size()), reach = static_cast<int>(4 * sigma + 0.5);
  std::vector<double> out(row.size());
  for (int i = 0; i < n; ++i) {
    double sum = 0, weight = 0;
    for (int j = -reach; j <= reach; ++j) {
      int at = i + j;
      if (mirror_ends) at = at < 0 ? -1 - at : at >= n ? 2 * n - 1 - at : at;
      at = std::clamp(at, 0, n - 1);
      const double w = std::exp(-0.5 * j * j / (sigma * sigma));
      sum += w * row[static_cast<std::size_t>(at)];
      weight += w;
    }
    out[static_cast<std::size_t>(i)] = sum / weight;
  }
  return out;
}

/// Radii on a grid of 1 mm by 1 degree, with their slopes.
struct RadiusMap {
  static constexpr int columns = 181;
  double low = radius_table.front().z;
  int rows = static_cast<int>(radius_table.back().z - radius_table.front().z) + 1;
  std::vector<double> radius, by_z, by_azimuth;  // mm, mm/mm, mm/rad

  double& at(std::vector<double>& map, int row, int column) const {
    return map[static_cast<std::size_t>(row * columns + column)];
  }
  double at(const std::vector<double>& map, int row, int column) const {
    return map[static_cast<std::size_t>(row * columns + column)];
  }
  void blur_columns(std::vector<double>& map, double sigma) const {
    for (int c = 0; c < columns; ++c) {
      std::vector<double> line;
      for (int r = 0; r < rows; ++r) line.push_back(at(map, r, c));
      line = blurred(line, sigma, false);
      for (int r = 0; r < rows; ++r) at(map, r, c) = line[static_cast<std::size_t>(r)];
    }
  }

  RadiusMap() {
    std::vector<double> heights;
    for (const auto& row : radius_table) heights.push_back(row.z);
    std::vector<Pchip> by_height;
    for (std::size_t c = 0; c < azimuth.size(); ++c) {
      std::vector<double> column;
      for (const auto& row : radius_table) column.push_back(row.radius[c]);
      by_height.emplace_back(heights, column);
    }
    radius.resize(static_cast<std::size_t>(rows * columns));
    for (int r = 0; r < rows; ++r) {
      std::vector<double> knots;
      for (const auto& curve : by_height) knots.push_back(curve(low + r));
      const auto line = flat_ended_spline(azimuth, knots);
      for (int c = 0; c < columns; ++c) at(radius, r, c) = line[static_cast<std::size_t>(c)];
    }
    blur_columns(radius, 2.5);
    for (int r = 0; r < rows; ++r) {
      const auto row = radius.begin() + r * columns;
      const auto line = blurred({row, row + columns}, 3.5, true);
      std::copy(line.begin(), line.end(), row);
    }
    auto smoother = radius;
    blur_columns(smoother, 6);
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) {
        const double w = smooth_step((c - 55) / 30.0), z = low + r;
        double& v = at(radius, r, c);
        v = v * (1 - w) + at(smoother, r, c) * w;
        // Shrunk above and behind, where the vault determines the shape.
        v -= 9 * smooth_step((z - 34) / 34) +
             7 * smooth_step((c - 95) / 30.0) * smooth_step((z + 30) / 20);
      }
    by_z.resize(radius.size());
    by_azimuth.resize(radius.size());
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) {
        const int r0 = std::max(r - 1, 0), r1 = std::min(r + 1, rows - 1);
        const int c0 = std::max(c - 1, 0), c1 = std::min(c + 1, columns - 1);
        at(by_z, r, c) = (at(radius, r1, c) - at(radius, r0, c)) / (r1 - r0);
        at(by_azimuth, r, c) = (at(radius, r, c1) - at(radius, r, c0)) / (c1 - c0) * 180 / pi;
      }
  }
};

}  // namespace

Primitive face_base() {
  const auto map = std::make_shared<const RadiusMap>();
  return {[map](const Vector3d& p) {
            const double py = p.y() - axis_y;
            const double rho = std::sqrt(p.x() * p.x() + py * py) + 1e-3;
            const double degrees = std::atan2(p.x(), -py) * 180 / pi;
            const double g = std::clamp(p.z() - map->low, 0.0, map->rows - 1.0);
            const double h = std::clamp(degrees, 0.0, RadiusMap::columns - 1.0);
            const int r = std::min(static_cast<int>(g), map->rows - 2);
            const int c = std::min(static_cast<int>(h), RadiusMap::columns - 2);
            const double s = g - r, t = h - c;
            const auto read = [&](const std::vector<double>& m) {
              return (1 - s) * ((1 - t) * map->at(m, r, c) + t * map->at(m, r, c + 1)) +
                     s * ((1 - t) * map->at(m, r + 1, c) + t * map->at(m, r + 1, c + 1));
            };
            const double a = read(map->by_z), b = read(map->by_azimuth) / rho;
            const double d = (rho - read(map->radius)) /
                             std::sqrt(1 + std::min(a * a, 9.0) + std::min(b * b, 4.0));
            return smooth_max(d, std::max(p.z() - 66, -118 - p.z()), 14);
          },
          {Vector3d(0, -125, -125), Vector3d(90, 110, 75)}};
}

}  // namespace condyle
