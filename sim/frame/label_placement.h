#pragma once

#include <string>
#include <vector>

namespace condyle {

/// Round numbers from low to high: the smallest step of 1, 2 or 5 times a power of ten that gives
/// at most `most` values, or a smaller one where that gives fewer than three.
struct Ticks {
  double step = 1;
  std::vector<double> values;
};
Ticks ticks(double low, double high, int most);

/// A rectangle of a drawing; y grows downward.
struct DrawnArea {
  double left, top, right, bottom;
  double width() const { return right - left; }
  double height() const { return bottom - top; }
};

/// Finds positions for labels between axes that no curve crosses.
class LabelPlacement {
 public:
  struct Point {
    double x, y;
  };

  /// unit: about the width of a drawn line, the resolution of the search.
  LabelPlacement(const DrawnArea& axes, double unit);

  /// Curves and labels, which must not be covered.
  void add_curve(const std::vector<Point>& points);
  void add_words(const DrawnArea& words) { add_area(words, hard); }
  /// The interior of a convex outline: covered only where there is no space beside it.
  void add_outline(const std::vector<Point>& corners);

  /// Upper left corner of the position nearest to `near` where a label of this size covers nothing,
  /// or else covers least; it is reserved from now on.
  Point take(double width, double height, const DrawnArea& near);

 private:
  static constexpr float hard = 1000, soft = 0.5f;
  void add_area(const DrawnArea& area, float weight);
  float& cell(int column, int row) {
    return cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(column)];
  }
  DrawnArea axes_;
  double size_;  // of a cell
  int columns_, rows_;
  std::vector<float> cells_;  // cost of covering each cell, in pixels of distance
};

}  // namespace condyle
