#include "engine/tissue/block_cholesky.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "engine/core/parallel.h"
#include "engine/tissue/float_kernels.h"

namespace condyle {
namespace {

using BlockBuffer = std::array<float, largest_block * largest_block>;

/// subtract_product with its columns distributed over threads where worthwhile. Where a division
/// would change the rounding, it is also made with one thread.
void subtract_product(const FloatKernels::Product& p, int threads) {
  constexpr int width = 48;
  constexpr double min_products = 2e6;  // products
  const double size = static_cast<double>(p.rows) * p.columns * p.depth;
  if (size < min_products || (threads < 2 && p.depth <= FloatKernels::max_whole_depth))
    return float_kernels().subtract_product(p);
  parallel_for((p.columns + width - 1) / width, threads, [&](std::size_t chunk) {
    FloatKernels::Product part = p;
    const int first = static_cast<int>(chunk) * width;
    part.columns = std::min(width, p.columns - first);
    const int above = p.lower ? first : 0;
    part.rows -= above;
    part.A += above;
    part.B += first;
    part.C += static_cast<std::ptrdiff_t>(first) * p.ldc + above;
    float_kernels().subtract_product(part);
  });
}

/// Number of floats of a front's rows, in whole tiles.
struct alignas(64) RowTile {
  float row[16];
};

using Quarter = float __attribute__((vector_size(4 * sizeof(float))));
void copy(const float* from, int count, float* to) {
  int i = 0;
  for (; i + 4 <= count; i += 4) std::memcpy(to + i, from + i, sizeof(Quarter));
  for (; i < count; ++i) to[i] = from[i];
}
void add(const float* from, int count, float* to) {
  int i = 0;
  for (; i + 4 <= count; i += 4) {
    Quarter a, b;
    std::memcpy(&a, to + i, sizeof a);
    std::memcpy(&b, from + i, sizeof b);
    a += b;
    std::memcpy(to + i, &a, sizeof a);
  }
  for (; i < count; ++i) to[i] += from[i];
}

}  // namespace

/// Factors are recomputed from frame to frame.
struct BlockCholesky::Memory {
  explicit Memory(const FrontTree& tree)
      : values(tree.tiles), panels(tree.panel_floats), work(tree.work_floats) {}
  BufferPool<PairTile> values;
  BufferPool<float> panels, work;
};

BlockCholesky::BlockCholesky(std::shared_ptr<const FrontTree> tree)
    : BlockCholesky(tree, std::make_shared<const Memory>(*tree)) {}

BlockCholesky::BlockCholesky(std::shared_ptr<const FrontTree> tree,
                             std::shared_ptr<const Memory> memory)
    : tree_(std::move(tree)), memory_(std::move(memory)), values_(memory_->values.take()) {}

BlockCholesky::BlockCholesky(const BlockCholesky& other)
    : BlockCholesky(other.tree_, other.memory_) {
  std::copy_n(other.values_.get(), memory_->values.length(), values_.get());
}

BlockCholesky& BlockCholesky::operator=(const BlockCholesky& other) {
  return *this = BlockCholesky(other);
}

int BlockCholesky::factorize_front(int index, float* panels, float* work, float least,
                                   int threads) {
  const FrontTree& tree = *tree_;
  const FrontTree::Front& front = tree.fronts[index];
  const int size = tree.block, height = tree.height(front), width = front.pivots * size;
  const int left = tree.update_height(front);
  float* panel = panels + front.panel;
  float* update = work + front.update;
  const FloatKernels& kernels = float_kernels();
  /// Sum of the children's updates for the pivots, or for the rows below.
  const auto add_children = [&](bool for_pivots) {
    for (int c : front.children) {
      const FrontTree::Front& child = tree.fronts[c];
      const int count = child.rows_end - child.rows_begin, from_height = tree.update_height(child);
      const int* seat = &tree.seat[child.rows_begin];  // rising
      const int others =
          static_cast<int>(std::lower_bound(seat, seat + count, front.pivots) - seat);
      for (int k = for_pivots ? 0 : others; k < (for_pivots ? others : count); ++k)
        for (int column = 0; column < size; ++column) {
          const float* from =
              work + child.update + static_cast<std::size_t>(k * size + column) * from_height;
          float* to =
              for_pivots
                  ? panel + static_cast<std::size_t>(seat[k] * size + column) * height
                  : update +
                        static_cast<std::size_t>((seat[k] - front.pivots) * size + column) * left -
                        width;
          for (int r = k; r < count;) {
            const int end = tree.run_end[child.rows_begin + r] - child.rows_begin;
            kernels.add(to + seat[r] * size, from + r * size, (end - r) * size);
            r = end;
          }
        }
    }
  };
  add_children(true);

  int raised = 0;
  const int group = 8 * size;  // columns
  std::vector<float> copy(static_cast<std::size_t>(height) * size + FrontTree::beyond);
  for (int c = 0; c < width; c += size) {
    float* diagonal = panel + static_cast<std::size_t>(c) * height + c;
    raised += kernels.invert_diagonal(diagonal, height, size, least);
    const int below = height - c - size;
    if (below == 0) continue;
    // The rows below, multiplied by the transposed inverse.
    BlockBuffer negative;
    for (int j = 0; j < size; ++j) {
      for (int i = 0; i < size; ++i) negative[j * size + i] = -diagonal[j * height + i];
      float* column = diagonal + j * height + size;
      std::memcpy(&copy[static_cast<std::size_t>(j) * below], column, below * sizeof(float));
    }
    subtract_product({diagonal + size, copy.data(), negative.data(), below, size, size, height,
                      below, size, false, true},
                     threads);
    // Remaining columns of this front: the nearest ones immediately, the others in one product.
    const int done = c + size, group_end = std::min(group + c / group * group, width);
    const auto take_from = [&](int first, int last, int depth) {
      float* to = panel + static_cast<std::size_t>(first) * height + first;
      const float* by = panel + static_cast<std::size_t>(done - depth) * height + first;
      if (last > first)
        subtract_product(
            {to, by, by, height - first, last - first, depth, height, height, height, true},
            threads);
    };
    take_from(done, group_end, size);
    if (done >= group_end) take_from(done, width, done - c / group * group);
  }
  if (left > 0)
    subtract_product(
        {update, panel + width, panel + width, left, left, width, left, height, height, true, true},
        threads);
  add_children(false);
  front_kernels(size).pack(panel, front.pivots, height, &values_[front.tiles]);
  return raised;
}

int BlockCholesky::factorize(const std::function<void(int part, float* values)>& assemble,
                             float least, int threads) {
  const FrontTree& tree = *tree_;
  const auto panels = memory_->panels.take();
  const auto work = memory_->work.take();
  std::array<int, 3> raised{};
  const auto do_part = [&](int part, int inner_threads) {
    const auto& part_of_fronts = tree.part;
    const auto from = [&](int f) {
      return panels.get() +
             (f < static_cast<int>(tree.fronts.size()) ? tree.fronts[f].panel : tree.panel_floats);
    };
    std::fill(from(part_of_fronts[part]), from(part_of_fronts[part + 1]), 0.0f);
    assemble(part, panels.get());
    for (int f = part_of_fronts[part]; f < part_of_fronts[part + 1]; ++f)
      raised[part] += factorize_front(f, panels.get(), work.get(), least, inner_threads);
  };
  parallel_for(2, threads, [&](std::size_t half) { do_part(static_cast<int>(half), 1); });
  do_part(2, threads);
  return raised[0] + raised[1] + raised[2];
}

void BlockCholesky::forward(int index, float* b, float* rest, float* y) const {
  const FrontTree& tree = *tree_;
  const FrontTree::Front& front = tree.fronts[index];
  const int width = front.pivots * tree.block;
  float* pivots = b + static_cast<std::size_t>(front.first) * tree.block;
  copy(pivots, width, y);
  front_kernels(tree.block).forward(&values_[front.tiles], front.pivots, tree.height(front), y);
  copy(y, width, pivots);
  const int shared = tree.order.part[2];
  y += width;
  for (int r = front.rows_begin; r < front.rows_end; r = tree.row_end[r]) {
    const int row = tree.rows[r], count = (tree.row_end[r] - r) * tree.block;
    add(y, count,
        row < shared ? b + static_cast<std::size_t>(row) * tree.block
                     : rest + static_cast<std::size_t>(row - shared) * tree.block);
    y += count;
  }
}

void BlockCholesky::backward(int index, float* b, float* y) const {
  const FrontTree& tree = *tree_;
  const FrontTree::Front& front = tree.fronts[index];
  const int width = front.pivots * tree.block;
  float* pivots = b + static_cast<std::size_t>(front.first) * tree.block;
  copy(pivots, width, y);
  float* to = y + width;
  for (int r = front.rows_begin; r < front.rows_end; r = tree.row_end[r]) {
    const int count = (tree.row_end[r] - r) * tree.block;
    copy(b + static_cast<std::size_t>(tree.rows[r]) * tree.block, count, to);
    to += count;
  }
  for (float* end = y + (to - y + 15) / 16 * 16; to < end; ++to) *to = 0;
  front_kernels(tree.block).backward(&values_[front.tiles], front.pivots, tree.height(front), y);
  copy(y, width, pivots);
}

void BlockCholesky::solve(std::vector<float>& b, int threads) const {
  const FrontTree& tree = *tree_;
  const std::size_t shared = static_cast<std::size_t>(tree.order.part[2]) * tree.block;
  const std::size_t longest = tree.most_height / 16 + 1;  // tiles
  std::array<std::vector<float>, 2> rest;  // contributions of the last part to each half
  parallel_for(2, threads, [&](std::size_t half) {
    rest[half].assign(b.size() - shared, 0.0f);
    std::vector<RowTile> rows(longest);
    for (int f = tree.part[half]; f < tree.part[half + 1]; ++f)
      forward(f, b.data(), rest[half].data(), rows[0].row);
  });
  for (std::size_t i = shared; i < b.size(); ++i) b[i] += rest[0][i - shared] + rest[1][i - shared];
  std::vector<RowTile> rows(longest);
  for (int f = tree.part[2]; f < tree.part[3]; ++f)
    forward(f, b.data(), b.data() + shared, rows[0].row);
  for (int f = tree.part[3] - 1; f >= tree.part[2]; --f) backward(f, b.data(), rows[0].row);
  parallel_for(2, threads, [&](std::size_t half) {
    std::vector<RowTile> own_rows(longest);
    for (int f = tree.part[half + 1] - 1; f >= tree.part[half]; --f)
      backward(f, b.data(), own_rows[0].row);
  });
}

std::size_t BlockCholesky::bytes() const {
  const std::size_t order = tree_->order.at.size() * tree_->block;
  return memory_->values.length() * sizeof(PairTile) + 2 * order * sizeof(float) +
         (tree_->rows.capacity() + tree_->seat.capacity() + tree_->run_end.capacity() +
          tree_->row_end.capacity()) *
             sizeof(int);
}

std::size_t BlockCholesky::pooled_bytes() const {
  return memory_->values.pooled_bytes() + memory_->panels.pooled_bytes() +
         memory_->work.pooled_bytes();
}

}  // namespace condyle
