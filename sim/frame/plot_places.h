#pragma once

#include <string>
#include <vector>

namespace condyle {

/// Round numbers from low to high: of the steps 1, 2, 5 times a power of ten the smallest that
/// gives no more than `most`, or a smaller one where that gives fewer than three.
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

/// Finds places for words between axes that no curve runs through.
class WordPlaces {
 public:
  struct Point {
    double x, y;
  };

  /// unit: about the width of a drawn line; how finely the drawing is looked at.
  WordPlaces(const DrawnArea& axes, double unit);

  /// Curves and words, which must not be covered.
  void add_curve(const std::vector<Point>& points);
  void add_words(const DrawnArea& words) { add_area(words, hard); }
  /// The inside of a convex outline: covered only where there is no room beside it.
  void add_outline(const std::vector<Point>& corners);

  /// Upper left corner of the place nearest to `near` where words of this size are clear, or else
  /// cover least; it is taken from now on.
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
  std::vector<float> cells_;  // what it costs to cover one, pixels of way
};

}  // namespace condyle
