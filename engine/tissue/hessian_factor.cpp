#include "engine/tissue/hessian_factor.h"

namespace condyle {

HessianFactor::HessianFactor(std::shared_ptr<const HessianPattern> pattern, BlockCholesky factor)
    : pattern_(std::move(pattern)), factor_(std::move(factor)) {}

HessianFactor::HessianFactor(const SpringPrismNet& net, const NetLoads& loads, int nodes_per_column,
                             const Nodes& x, int threads)
    : threads_(threads),
      pattern_(std::make_shared<const HessianPattern>(net, nodes_per_column, x)),
      factor_(pattern_->tree) {
  refactor(net, loads, x, threads);
}

int HessianFactor::refactor(const SpringPrismNet& net, const NetLoads& loads, const Nodes& x,
                            int threads, Curvatures curvatures) {
  HessianAssembly assembly(*pattern_, net, loads, x, curvatures);
  constexpr float least = 1e-6f;
  return factor_.factorize([&](int part, float* panels) { assembly.add(part, panels); }, least,
                           threads);
}

HessianFactor HessianFactor::anew(const SpringPrismNet& net, const NetLoads& loads, const Nodes& x,
                                  int threads) const {
  HessianFactor made = another();
  made.set_threads(threads_);
  if (made.refactor(net, loads, x, threads, Curvatures::exact) > 0)
    made.refactor(net, loads, x, threads);
  return made;
}

void HessianFactor::solve(const Nodes& g, Nodes& z) const {
  const auto& at = pattern_->tree->order.at;
  const int nodes = pattern_->nodes_per_column;
  std::vector<float> b(g.size() * 3);
  std::size_t i = 0;
  for (int column : at)
    for (int n = column * nodes; n < (column + 1) * nodes; ++n)
      for (int k = 0; k < 3; ++k) b[i++] = static_cast<float>(g[n][k]);
  factor_.solve(b, threads_);
  z.resize(g.size());
  i = 0;
  for (int column : at)
    for (int n = column * nodes; n < (column + 1) * nodes; ++n)
      for (int k = 0; k < 3; ++k) z[n][k] = static_cast<double>(b[i++]);
}

std::size_t HessianFactor::bytes() const { return factor_.bytes(); }

}  // namespace condyle
