#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "engine/core/buffer_pool.h"
#include "engine/tissue/float_kernels.h"
#include "engine/tissue/front_tree.h"

namespace condyle {

/// Cholesky factor of a sparse symmetric matrix of dense blocks (multifrontal: see FrontTree). Made
/// in single precision and kept in half of it: a solve is as fast as the factor is read, and eight
/// bits point the way as well as 24 (the same iterations of a minimisation). Copies share the
/// pattern. Same bits for any number of threads.
class BlockCholesky {
 public:
  explicit BlockCholesky(std::shared_ptr<const FrontTree> tree);
  BlockCholesky(const BlockCholesky& other);
  BlockCholesky& operator=(const BlockCholesky& other);
  BlockCholesky(BlockCholesky&&) = default;
  BlockCholesky& operator=(BlockCholesky&&) = default;

  /// One of the same pattern, yet to be factored.
  BlockCholesky another() const { return {tree_, memory_}; }

  const FrontTree& tree() const { return *tree_; }

  /// Factors the matrix that assemble(part, values) adds up: the entries whose column is in one of
  /// the order's parts, in zeros, at FrontTree::find. Only the lower half is read. It is called
  /// once for each part, on some thread. Pivots that are not above `least` times the largest
  /// diagonal entry of their block are raised to it; gives how many were.
  int factorize(const std::function<void(int part, float* values)>& assemble, float least,
                int threads);

  /// b = A^-1 b, in the order of elimination, block by block.
  void solve(std::vector<float>& b, int threads) const;

  std::size_t bytes() const;

 private:
  struct Memory;
  BlockCholesky(std::shared_ptr<const FrontTree> tree, std::shared_ptr<const Memory> memory);
  int factorize_front(int front, float* panels, float* work, float least, int threads);
  void forward(int front, float* b, float* rest, float* y) const;
  void backward(int front, float* b, float* y) const;

  std::shared_ptr<const FrontTree> tree_;
  std::shared_ptr<const Memory> memory_;  // of all factors of the tree
  BufferPool<PairTile>::Buffer values_;
};

}  // namespace condyle
