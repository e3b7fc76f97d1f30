#include "engine/tissue/front_tree.h"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <utility>

#include "engine/tissue/float_kernels.h"

namespace condyle {
namespace {

/// Rows below the diagonal of each column of the factor.
std::vector<std::vector<int>> rows_below(const std::vector<std::vector<int>>& ring,
                                         const std::vector<int>& at,
                                         const std::vector<int>& place) {
  const int count = static_cast<int>(at.size());
  std::vector<std::vector<int>> below(count), children(count);
  std::vector<int> merged;
  for (int j = 0; j < count; ++j) {
    std::vector<int> mine;
    for (int n : ring[at[j]])
      if (place[n] > j) mine.push_back(place[n]);
    std::sort(mine.begin(), mine.end());
    for (int child : children[j]) {
      merged.clear();
      std::set_union(mine.begin(), mine.end(), below[child].begin() + 1, below[child].end(),
                     std::back_inserter(merged));
      mine.swap(merged);
    }
    below[j] = std::move(mine);
    if (!below[j].empty()) children[below[j].front()].push_back(j);
  }
  return below;
}

std::vector<int> inverse_of(const std::vector<int>& at) {
  std::vector<int> place(at.size());
  for (std::size_t p = 0; p < at.size(); ++p) place[at[p]] = static_cast<int>(p);
  return place;
}

/// Postorder of each part with the largest child last: the same fill, with more columns that can be
/// merged in one front.
void postorder(const std::vector<std::vector<int>>& below, EliminationOrder& order) {
  const int count = static_cast<int>(below.size());
  std::vector<std::vector<int>> children(count);
  std::vector<int> old_at = std::move(order.at);
  order.at.clear();
  for (int p = 0; p < 3; ++p) {
    std::vector<int> roots;
    for (int j = order.part[p]; j < order.part[p + 1]; ++j) {
      const int parent = below[j].empty() ? count : below[j].front();
      (parent < order.part[p + 1] ? children[parent] : roots).push_back(j);
    }
    std::vector<std::pair<int, bool>> stack;  // place; whether its children are done
    const auto push = [&](std::vector<int>& list) {
      std::stable_sort(list.begin(), list.end(),
                       [&](int a, int b) { return below[a].size() > below[b].size(); });
      for (int j : list) stack.emplace_back(j, false);
    };
    push(roots);
    while (!stack.empty()) {
      auto& [j, done] = stack.back();
      if (done) {
        order.at.push_back(old_at[j]);
        stack.pop_back();
      } else {
        done = true;
        push(children[j]);
      }
    }
  }
}

/// First-fit allocation of offsets in a work space.
class Shelf {
 public:
  std::size_t take(std::size_t size) {
    std::size_t at = 0;
    auto it = used_.begin();
    for (; it != used_.end() && it->first < at + size; ++it) at = it->second;
    used_.insert(it, {at, at + size});
    most = std::max(most, at + size);
    return at;
  }
  void free(std::size_t at, std::size_t size) {
    if (size > 0) std::erase(used_, std::pair{at, at + size});
  }
  std::size_t most = 0;

 private:
  std::vector<std::pair<std::size_t, std::size_t>> used_;  // rising
};

}  // namespace

FrontTree::FrontTree(const std::vector<std::vector<int>>& ring, EliminationOrder given, int size)
    : block(size), order(std::move(given)) {
  assert(block > 0 && order.at.size() == ring.size());
  postorder(rows_below(ring, order.at, inverse_of(order.at)), order);
  place = inverse_of(order.at);
  const auto below = rows_below(ring, order.at, place);
  make_fronts(merge_columns(below), below);
  link_to_parents();
  place_updates();
}

std::vector<FrontTree::ColumnRange> FrontTree::merge_columns(
    const std::vector<std::vector<int>>& below) {
  constexpr double zeros_fraction = 0.1;
  std::vector<ColumnRange> ranges;
  for (int p = 0; p < 3; ++p) {
    for (int j = order.part[p]; j < order.part[p + 1]; ++j) {
      ColumnRange now{j, j, static_cast<long>(below[j].size()) + 1};
      while (!ranges.empty()) {
        const ColumnRange& before = ranges.back();
        if (before.first < order.part[p] || below[before.last].empty() ||
            below[before.last].front() > j)
          break;
        const long width = j - before.first + 1, entries = now.entries + before.entries;
        const long stored = width * (width + 1) / 2 + width * static_cast<long>(below[j].size());
        if (static_cast<double>(stored - entries) > zeros_fraction * static_cast<double>(stored))
          break;
        now = {before.first, j, entries};
        ranges.pop_back();
      }
      ranges.push_back(now);
    }
    part[p + 1] = static_cast<int>(ranges.size());
  }
  return ranges;
}

void FrontTree::make_fronts(const std::vector<ColumnRange>& ranges,
                            const std::vector<std::vector<int>>& below) {
  front_of.resize(order.at.size());
  for (const ColumnRange& range : ranges) {
    if (range.first == order.part[1] || range.first == order.part[2]) panel_floats += beyond;
    Front front;
    front.first = range.first;
    front.pivots = range.last - range.first + 1;
    front.rows_begin = static_cast<int>(rows.size());
    rows.insert(rows.end(), below[range.last].begin(), below[range.last].end());
    front.rows_end = static_cast<int>(rows.size());
    front.panel = panel_floats;
    most_height = std::max(most_height, height(front));
    panel_floats += static_cast<std::size_t>(height(front)) * front.pivots * block;
    front.tiles = tiles;
    for (int p = 0; p < front.pivots; ++p) tiles += front_tiles(p * block, height(front), block);
    for (int j = range.first; j <= range.last; ++j) front_of[j] = static_cast<int>(fronts.size());
    fronts.push_back(std::move(front));
  }
  panel_floats += beyond;
}

void FrontTree::link_to_parents() {
  seat.resize(rows.size());
  run_end.resize(rows.size());
  row_end.resize(rows.size());
  for (std::size_t f = 0; f < fronts.size(); ++f) {
    Front& front = fronts[f];
    if (front.rows_begin == front.rows_end) continue;
    for (int r = front.rows_end - 1; r >= front.rows_begin; --r)
      row_end[r] =
          r + 1 < front.rows_end && rows[r + 1] == rows[r] + 1 && rows[r + 1] != order.part[2]
              ? row_end[r + 1]
              : r + 1;
    front.parent = front_of[rows[front.rows_begin]];
    Front& parent = fronts[front.parent];
    parent.children.push_back(static_cast<int>(f));
    for (int r = front.rows_begin; r < front.rows_end; ++r) {
      const int row = rows[r];
      seat[r] = row < parent.first + parent.pivots
                    ? row - parent.first
                    : parent.pivots +
                          static_cast<int>(std::lower_bound(rows.begin() + parent.rows_begin,
                                                            rows.begin() + parent.rows_end, row) -
                                           (rows.begin() + parent.rows_begin));
    }
    for (int r = front.rows_end - 1; r >= front.rows_begin; --r)
      run_end[r] = r + 1 < front.rows_end && seat[r + 1] == seat[r] + 1 ? run_end[r + 1] : r + 1;
  }
}

void FrontTree::place_updates() {
  std::array<Shelf, 3> shelves;
  const auto update_floats = [&](const Front& f) {
    return static_cast<std::size_t>(update_height(f)) * update_height(f);
  };
  for (int p = 0; p < 3; ++p)
    for (int f = part[p]; f < part[p + 1]; ++f) {
      Front& front = fronts[f];
      if (update_floats(front) > 0) front.update = shelves[p].take(update_floats(front));
      for (int c : front.children)
        if (c >= part[p]) shelves[p].free(fronts[c].update, update_floats(fronts[c]));
    }
  for (int p = 0; p < 3; ++p) {
    for (int f = part[p]; f < part[p + 1]; ++f) fronts[f].update += work_floats;
    work_floats += shelves[p].most + beyond;
  }
}

std::ptrdiff_t FrontTree::find(int row, int column) const {
  const Front& front = fronts[front_of[column]];
  int in_rows = row - front.first;
  if (in_rows >= front.pivots) {
    const auto begin = rows.begin() + front.rows_begin, end = rows.begin() + front.rows_end;
    const auto it = std::lower_bound(begin, end, row);
    if (it == end || *it != row) return -1;
    in_rows = front.pivots + static_cast<int>(it - begin);
  }
  return static_cast<std::ptrdiff_t>(front.panel) +
         static_cast<std::ptrdiff_t>(column - front.first) * block * height(front) +
         static_cast<std::ptrdiff_t>(in_rows) * block;
}

double FrontTree::multiplications() const {
  double sum = 0;
  for (const Front& front : fronts) {
    const double high = height(front), pivots = front.pivots * block, low = high - pivots;
    sum += (high * high * high - low * low * low) / 3;
  }
  return sum / 2;  // the lower triangle
}

}  // namespace condyle
