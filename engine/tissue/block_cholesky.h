#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "engine/core/buffer_pool.h"
#include "engine/tissue/float_kernels.h"
#include "engine/tissue/front_tree.h"

namespace condyle {

/// Cholesky factor of a sparse symmetric matrix of dense blocks (multifrontal: see FrontTree).
/// Computed in single precision and stored in half of it (bfloat16): a solve is limited by memory
/// bandwidth, and 8 significant bits give the same iteration counts of the minimisation as 24.
/// Copies share the pattern. Deterministic for any number of threads.
class BlockCholesky {
 public:
  explicit BlockCholesky(std::shared_ptr<const FrontTree> tree);
  BlockCholesky(const BlockCholesky& other);
  BlockCholesky& operator=(const BlockCholesky& other);
  BlockCholesky(BlockCholesky&&) = default;
  BlockCholesky& operator=(BlockCholesky&&) = default;

  /// An unfactored matrix of the same pattern.
  BlockCholesky another() const { return {tree_, memory_}; }

  const FrontTree& tree() const { return *tree_; }

  /// Factors the matrix assembled by assemble(part, values), which adds the entries with columns in
  /// one part of the order to zeroed storage at FrontTree::find. Only the lower triangle is read.
  /// It is called once per part, on any thread. Pivots not above `least` times the largest diagonal
  /// entry of their block are raised to that value; returns their number.
  int factorize(const std::function<void(int part, float* values)>& assemble, float least,
                int threads);

  /// b = A^-1 b, in the order of elimination, block by block.
  void solve(std::vector<float>& b, int threads) const;

  std::size_t bytes() const;
  /// Arrays of factors and factorizations that are kept for the next one.
  std::size_t pooled_bytes() const;

 private:
  struct Memory;
  BlockCholesky(std::shared_ptr<const FrontTree> tree, std::shared_ptr<const Memory> memory);
  int factorize_front(int front, float* panels, float* work, float least, int threads);
  void forward(int front, float* b, float* rest, float* y) const;
  void backward(int front, float* b, float* y) const;

  std::shared_ptr<const FrontTree> tree_;
  std::shared_ptr<const Memory> memory_;  // common to all factors of the tree
  BufferPool<PairTile>::Buffer values_;
};

}  // namespace condyle
