#include "engine/tissue/hessian_factor.h"

namespace condyle {
namespace {

/// Conversion to another precision.
template <class To, class From>
void convert(const From* from, Eigen::Index count, To* to) {
  using Eigen::Dynamic, Eigen::Map, Eigen::Vector;
  Map<Vector<To, Dynamic>>(to, count) =
      Map<const Vector<From, Dynamic>>(from, count).template cast<To>();
}

}  // namespace

HessianFactor::HessianFactor(std::shared_ptr<const HessianPattern> pattern, BlockCholesky factor)
    : pattern_(std::move(pattern)), factor_(std::move(factor)) {}

HessianFactor::HessianFactor(const SpringPrismMesh& mesh, const MeshLoads& loads,
                             int nodes_per_column, const Nodes& x, int threads)
    : threads_(threads),
      pattern_(std::make_shared<const HessianPattern>(mesh, nodes_per_column, x)),
      factor_(pattern_->tree) {
  refactor(mesh, loads, x, threads);
}

int HessianFactor::refactor(const SpringPrismMesh& mesh, const MeshLoads& loads, const Nodes& x,
                            int threads, HessianKind curvatures) {
  HessianAssembly assembly(*pattern_, mesh, loads, x, curvatures);
  constexpr float least = 1e-6f;
  return factor_.factorize([&](int part, float* panels) { assembly.add(part, panels); }, least,
                           threads);
}

HessianFactor HessianFactor::anew(const SpringPrismMesh& mesh, const MeshLoads& loads,
                                  const Nodes& x, int threads) const {
  HessianFactor made = another();
  made.set_threads(threads_);
  if (made.refactor(mesh, loads, x, threads, HessianKind::exact) > 0)
    made.refactor(mesh, loads, x, threads);
  return made;
}

void HessianFactor::solve(const Nodes& g, Nodes& z) const {
  const auto& at = pattern_->tree->order.at;
  const std::size_t nodes = pattern_->nodes_per_column, size = 3 * nodes;
  std::vector<float> b(g.size() * 3);
  for (std::size_t i = 0; i < at.size(); ++i) convert(g[at[i] * nodes].data(), size, &b[i * size]);
  factor_.solve(b, threads_);
  z.resize(g.size());
  for (std::size_t i = 0; i < at.size(); ++i) convert(&b[i * size], size, z[at[i] * nodes].data());
}

double HessianFactor::iterations_per_factorization() const {
  // Measured on 2,000 to 100,000 nodes: 13 to 61 iterations, about proportional to multiplications
  // over numbers in the factor, of which a solve reads each twice.
  constexpr double least = 8, per_multiplication = 0.1;
  const FrontTree& tree = *pattern_->tree;
  return least +
         per_multiplication * tree.multiplications() / static_cast<double>(tree.panel_floats);
}

std::size_t HessianFactor::bytes() const { return factor_.bytes(); }

std::size_t HessianFactor::shared_bytes() const {
  const auto held = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
  std::size_t sum = held(pattern_->seats) + held(pattern_->diagonal) + held(pattern_->spring) +
                    held(pattern_->prism);
  for (const auto& part : pattern_->elements)
    sum += held(part.springs) + held(part.anchors) + held(part.prisms);
  return sum + factor_.pooled_bytes();
}

}  // namespace condyle
