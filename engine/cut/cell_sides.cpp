#include "engine/cut/cell_sides.h"

#include <utility>

namespace condyle {
namespace {

using Side = Region::Side;

/// What is known of the cells with respect to one cut: a row of sides per cell, of the planes of
/// its reach and of both walls of its leaves.
class CutCells {
 public:
  CutCells(CellComplex& complex, const Cut& cut) : complex_(complex), cut_(cut) {
    leaves_ = cut.above.leaves().size();
    width_ = cut.reach.size() + 2 * leaves_;
    rows_.assign(width_ * static_cast<std::size_t>(complex.cells()), Side::unknown);
  }

  void divide() {
    for (std::size_t i = 0; i < cut_.reach.size(); ++i)
      split(cut_.reach[i], slot_end, i, [&](int cell) { return in_reach(cell, i); });
    // The upper wall of each plane, then the lower one: without kerf they are the same.
    for (const bool upper : {true, false})
      for (std::size_t i = 0; i < leaves_; ++i) divide_by_leaf(i, upper);
  }

  CellSide side(int cell) const {
    if (!in_reach(cell, cut_.reach.size())) return CellSide::outside;
    if (cut_.above.evaluate(walls(cell, true)).inside) return CellSide::above;
    return cut_.above.evaluate(walls(cell, false)).inside ? CellSide::kerf : CellSide::below;
  }

  /// Cells were divided by another cut: a new cell has the sides of the one it was part of.
  void copy_row(int from) {
    for (std::size_t k = 0; k < width_; ++k) rows_.push_back(rows_[from * width_ + k]);
  }

 private:
  std::span<Side> row(int cell) { return {&rows_[cell * width_], width_}; }
  std::span<const Side> row(int cell) const { return {&rows_[cell * width_], width_}; }
  std::span<const Side> walls(int cell, bool upper) const {
    return row(cell).subspan(cut_.reach.size() + (upper ? 0 : leaves_), leaves_);
  }
  bool in_reach(int cell, std::size_t planes) const {
    for (std::size_t i = 0; i < planes; ++i)
      if (row(cell)[i] != Side::lower) return false;
    return true;
  }

  void divide_by_leaf(std::size_t leaf, bool upper) {
    const auto& [plane, wall] = cut_.above.leaves()[leaf];
    const std::size_t column = cut_.reach.size() + (upper ? 0 : leaves_) + leaf;
    const bool moved = wall >= 0 && cut_.kerf_mm > 0;
    const auto needs = [&](int cell) {
      if (!in_reach(cell, cut_.reach.size())) return false;
      if (!upper && cut_.above.evaluate(walls(cell, true)).inside) return false;
      const auto answer = cut_.above.evaluate(walls(cell, upper));
      return !answer.known && answer.leaf == static_cast<int>(leaf);
    };
    if (!upper && !moved) {  // the plane has divided the cells already, where they needed it
      for (int cell = 0; cell < complex_.cells(); ++cell)
        row(cell)[column] = row(cell)[column - leaves_];
    }
    const double shift = !moved ? 0 : (upper ? 0.5 : -0.5) * cut_.kerf_mm;
    split({plane.normal, plane.offset_mm + shift}, wall < 0 ? slot_end : wall, column, needs);
    if (upper && moved) {
      // What is above the upper wall is above the lower one.
      for (int cell = 0; cell < complex_.cells(); ++cell)
        if (row(cell)[column] == Side::upper) row(cell)[column + leaves_] = Side::upper;
    }
  }

  template <class Active>
  void split(const Plane& plane, int wall, std::size_t column, const Active& active) {
    std::vector<char> flags(complex_.cells());
    for (int cell = 0; cell < complex_.cells(); ++cell) flags[cell] = active(cell);
    const auto splits = complex_.split(plane, wall, flags);
    for (std::size_t cell = 0; cell < splits.size(); ++cell) {
      if (splits[cell].side == Side::unknown) continue;
      rows_[cell * width_ + column] = splits[cell].side;
      if (splits[cell].lower < 0) continue;
      parents_.push_back(static_cast<int>(cell));
      copy_row(static_cast<int>(cell));
      rows_[static_cast<std::size_t>(splits[cell].lower) * width_ + column] = Side::lower;
    }
  }

 public:
  /// The cell that each new cell was part of, in order of their numbers.
  const std::vector<int>& parents() const { return parents_; }

 private:
  CellComplex& complex_;
  const Cut& cut_;
  std::size_t leaves_ = 0, width_ = 0;
  std::vector<Side> rows_;
  std::vector<int> parents_;
};

}  // namespace

CellSides divide_cells(CellComplex& complex, std::span<const Cut> cuts) {
  std::vector<CutCells> all;
  all.reserve(cuts.size());
  for (const Cut& cut : cuts) {
    all.emplace_back(complex, cut);
    all.back().divide();
    for (std::size_t earlier = 0; earlier + 1 < all.size(); ++earlier)
      for (const int parent : all.back().parents()) all[earlier].copy_row(parent);
  }
  CellSides sides{static_cast<int>(cuts.size()), {}};
  for (int cell = 0; cell < complex.cells(); ++cell)
    for (const CutCells& cut : all) sides.sides.push_back(cut.side(cell));
  return sides;
}

}  // namespace condyle
