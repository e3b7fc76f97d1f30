#include "sim/frame/label_placement.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace condyle {

Ticks ticks(double low, double high, int most) {
  constexpr int least = 3;
  const double span = high - low;
  // In units of a step, so that the third tick is 0.3 and not 0.30000000000000004.
  const auto first = [&](double step) { return std::ceil(low / step - 1e-9); };
  const auto count = [&](double step) {
    return static_cast<int>(std::floor(high / step + 1e-9) - first(step)) + 1;
  };
  Ticks found;
  if (!(span > 0) || !std::isfinite(span)) return {1, {low}};
  int power = static_cast<int>(std::ceil(std::log10(span)));
  constexpr double factors[] = {5, 2, 1};
  found.step = std::pow(10, power);
  for (int k = 0; k < 12; ++k) {
    if (k % 3 == 0) --power;
    const double step = factors[k % 3] * std::pow(10, power);
    if (count(step) > most && count(found.step) >= least) break;
    found.step = step;
  }
  for (int i = 0; i < count(found.step); ++i)
    found.values.push_back((first(found.step) + i) * found.step);
  return found;
}

LabelPlacement::LabelPlacement(const DrawnArea& axes, double unit)
    : axes_(axes),
      size_(2 * unit),
      columns_(std::max(1, static_cast<int>(axes.width() / size_))),
      rows_(std::max(1, static_cast<int>(axes.height() / size_))),
      cells_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0.f) {}

void LabelPlacement::add_area(const DrawnArea& area, float weight) {
  const auto clamped = [](double v, int most) {
    return std::clamp(static_cast<int>(std::floor(v)), 0, most);
  };
  const int left = clamped((area.left - axes_.left) / size_, columns_),
            right = clamped((area.right - axes_.left) / size_ + 1, columns_),
            top = clamped((area.top - axes_.top) / size_, rows_),
            bottom = clamped((area.bottom - axes_.top) / size_ + 1, rows_);
  for (int row = top; row < bottom; ++row)
    for (int column = left; column < right; ++column)
      cell(column, row) = std::max(cell(column, row), weight);
}

void LabelPlacement::add_curve(const std::vector<Point>& points) {
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Point &a = points[i], &b = points[i + 1];
    const double dx = b.x - a.x, dy = b.y - a.y;
    const int steps =
        1 + static_cast<int>(std::min(1e4, std::max(std::abs(dx), std::abs(dy)) / size_));
    for (int k = 0; k <= steps; ++k) {
      const double x = a.x + dx * k / steps, y = a.y + dy * k / steps;
      if (x < axes_.left || x > axes_.right || y < axes_.top || y > axes_.bottom) continue;
      add_area({x - size_, y - size_, x + size_, y + size_}, hard);
    }
  }
}

void LabelPlacement::add_outline(const std::vector<Point>& corners) {
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const double x = axes_.left + (column + 0.5) * size_, y = axes_.top + (row + 0.5) * size_;
      bool any_left = false, any_right = false;
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const Point &a = corners[i], &b = corners[(i + 1) % corners.size()];
        const double side = (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
        any_left |= side > 0;
        any_right |= side < 0;
      }
      if (!(any_left && any_right)) cell(column, row) = std::max(cell(column, row), soft);
    }
}

LabelPlacement::Point LabelPlacement::take(double width, double height, const DrawnArea& near) {
  // Total cost of the cells above and to the left of a corner.
  const auto across = static_cast<std::size_t>(columns_) + 1;
  std::vector<double> sums(across * (static_cast<std::size_t>(rows_) + 1), 0.0);
  const auto sum = [&](int column, int row) -> double& {
    return sums[static_cast<std::size_t>(row) * across + static_cast<std::size_t>(column)];
  };
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column)
      sum(column + 1, row + 1) =
          cell(column, row) + sum(column, row + 1) + sum(column + 1, row) - sum(column, row);
  const int wide = std::min(columns_, static_cast<int>(std::ceil(width / size_))),
            high = std::min(rows_, static_cast<int>(std::ceil(height / size_)));
  double least = std::numeric_limits<double>::infinity();
  Point best{axes_.left, axes_.top};
  for (int row = 0; row + high <= rows_; ++row)
    for (int column = 0; column + wide <= columns_; ++column) {
      const double x = axes_.left + column * size_, y = axes_.top + row * size_;
      const double covered = sum(column + wide, row + high) - sum(column, row + high) -
                             sum(column + wide, row) + sum(column, row);
      const double dx = std::max({0.0, x - near.right, near.left - x - width});
      const double dy = std::max({0.0, y - near.bottom, near.top - y - height});
      // Among equally near positions, the one whose centre is nearest.
      const double off = std::hypot(x + width / 2 - (near.left + near.right) / 2,
                                    y + height / 2 - (near.top + near.bottom) / 2);
      const double cost = covered + std::hypot(dx, dy) / size_ + 0.05 * off / size_;
      if (cost < least - 1e-9) {
        least = cost;
        best = {x, y};
      }
    }
  add_area({best.x, best.y, best.x + width, best.y + height}, hard);
  return best;
}

}  // namespace condyle
