#include "engine/tissue/hessian_assembly.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>

#include "engine/tissue/prism_forms.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Spot = HessianPattern::Spot;

std::shared_ptr<const FrontTree> make_tree(const SpringPrismMesh& mesh, int nodes_per_column,
                                           const Nodes& x) {
  const int columns = mesh.node_count / nodes_per_column;
  std::vector<std::vector<int>> ring(columns);
  const auto couple = [&](int a, int b) {
    a /= nodes_per_column;
    b /= nodes_per_column;
    if (a == b) return;
    ring[a].push_back(b);
    ring[b].push_back(a);
  };
  for (std::size_t s = 0; s < mesh.spring_a.size(); ++s) couple(mesh.spring_a[s], mesh.spring_b[s]);
  for (const auto& prism : mesh.prisms)
    for (int a = 0; a < 6; ++a)
      for (int b = 0; b < a; ++b) couple(prism[a], prism[b]);
  for (const auto& [a, b] : mesh.may_touch) couple(a, b);
  for (auto& r : ring) {
    std::sort(r.begin(), r.end());
    r.erase(std::unique(r.begin(), r.end()), r.end());
  }
  std::vector<Vector3d> position;
  for (int c = 0; c < columns; ++c) position.push_back(x[c * nodes_per_column]);
  return std::make_shared<const FrontTree>(ring, elimination_order(ring, position),
                                           3 * nodes_per_column);
}

typedef float Column __attribute__((vector_size(4 * sizeof(float))));
inline Column column_of(const Vector3d& v) {
  return Column{static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0};
}
/// The element below the column is unchanged: the fourth number is 0.
inline void add_column(float* to, const Column& column) {
  Column sum;
  std::memcpy(&sum, to, sizeof sum);
  sum += column;
  std::memcpy(to, &sum, sizeof sum);
}
inline Column cross(const Column& a, const Column& b) {
  const Column a1 = __builtin_shufflevector(a, a, 1, 2, 0, 3),
               b1 = __builtin_shufflevector(b, b, 1, 2, 0, 3);
  const Column c = a * b1 - a1 * b;
  return __builtin_shufflevector(c, c, 1, 2, 0, 3);
}
inline float dot(const Column& a, const Column& b) {
  const Column c = a * b;
  return c[0] + c[1] + c[2];
}
template <class Columns>
inline void add_product(Columns& to, const Column& a, const Column& b) {  // += a b^T
  for (int k = 0; k < 3; ++k) to[k] += b[k] * a;
}

/// Corners of each pair, in the order of HessianPattern::prism.
constexpr std::array<std::pair<int, int>, HessianPattern::corner_pairs> corners_of = [] {
  std::array<std::pair<int, int>, HessianPattern::corner_pairs> corners{};
  for (int a = 0, pair = 0; a < 6; ++a)
    for (int b = 0; b < a; ++b) corners[pair++] = {a, b};
  return corners;
}();

}  // namespace

HessianPattern::HessianPattern(const SpringPrismMesh& mesh, int nodes, const Nodes& x)
    : tree(make_tree(mesh, nodes, x)), nodes_per_column(nodes) {
  for (int n = 0; n < mesh.node_count; ++n)
    seats.push_back(tree->place[n / nodes] * nodes + n % nodes);
  diagonal.resize(mesh.node_count);
  for (int n = 0; n < mesh.node_count; ++n) diagonal[seats[n]] = spot(n, n);
  const auto pair_part = [&](int a, int b) { return std::min(part_of(a), part_of(b)); };
  for (std::size_t s = 0; s < mesh.spring_a.size(); ++s) {
    const int a = mesh.spring_a[s], b = mesh.spring_b[s];
    spring.push_back(spot(a, b));
    elements[pair_part(a, b)].springs.push_back(static_cast<int>(s));
  }
  for (std::size_t i = 0; i < mesh.anchor_node.size(); ++i)
    elements[part_of(mesh.anchor_node[i])].anchors.push_back(static_cast<int>(i));
  for (std::size_t p = 0; p < mesh.prisms.size(); ++p) {
    const auto& corner = mesh.prisms[p];
    std::map<int, std::uint16_t> pairs;
    for (int corner_a = 0, bit = 0; corner_a < 6; ++corner_a)
      for (int corner_b = 0; corner_b < corner_a; ++corner_b, ++bit) {
        prism.push_back(spot(corner[corner_a], corner[corner_b]));
        pairs[pair_part(corner[corner_a], corner[corner_b])] |=
            static_cast<std::uint16_t>(1u << bit);
      }
    for (const auto& [part, bits] : pairs)
      elements[part].prisms.push_back({static_cast<int>(p), bits, part == pairs.begin()->first});
  }
}

Spot HessianPattern::spot(int a, int b) const {
  const int row = seats[a] > seats[b] ? a : b, column = row == a ? b : a;
  const int at_row = tree->place[row / nodes_per_column];
  const int at_column = tree->place[column / nodes_per_column];
  const std::ptrdiff_t block = tree->find(at_row, at_column);
  const int stride = tree->height(tree->fronts[tree->front_of[at_column]]);
  Spot spot;
  spot.stride = static_cast<std::uint32_t>(stride);
  if (block >= 0)
    spot.at = static_cast<std::uint32_t>(
        block + static_cast<std::ptrdiff_t>(3 * (column % nodes_per_column)) * stride +
        3 * (row % nodes_per_column));
  spot.swapped = row == b && a != b;
  return spot;
}

HessianAssembly::HessianAssembly(const HessianPattern& pattern, const SpringPrismMesh& mesh,
                                 const MeshLoads& loads, const Nodes& x, HessianKind curvatures)
    : pattern_(pattern),
      mesh_(mesh),
      loads_(loads),
      x_(x),
      exact_(curvatures == HessianKind::exact) {
  for (auto& own : own_) own.resize(pattern.diagonal.size(), Own{});
  for (const ContactSpring& row : loads.contacts)
    if (row.gap(x) < 0)
      couple({row.node.data(), static_cast<std::size_t>(row.count)},
             {row.weight.data(), static_cast<std::size_t>(row.count)},
             row.normal * row.normal.transpose() * (2 * mesh.lambda * row.stiffness));
  for (const MuscleLine& muscle : loads.muscles) add_line(muscle);
}

/// Without the term of the law's rise, which couples all points of the line.
void HessianAssembly::add_line(const MuscleLine& muscle) {
  const double tension = muscle.law(muscle.length(x_)).tension;
  if (tension <= 0) return;
  std::vector<int> node;
  std::vector<double> weight;
  for (std::size_t i = 1; i < muscle.points.size(); ++i) {
    const MuscleLine::Direction along = muscle.direction(i, x_);
    if (along.length <= 0) continue;
    node.clear();
    weight.clear();
    for (const auto& [point, sign] : {std::pair(i, 1.0), std::pair(i - 1, -1.0)})
      for (std::size_t k = 0; k < muscle.points[point].node.size(); ++k) {
        node.push_back(muscle.points[point].node[k]);
        weight.push_back(sign * muscle.points[point].weight[k]);
      }
    couple(node, weight,
           mesh_.lambda * tension / along.length *
               (Matrix3d::Identity() - along.unit * along.unit.transpose()));
  }
}

/// Contact of two surfaces, or a muscle, may couple columns without a common spring. Each side is
/// then added separately (weights of one sign); where its own nodes have no common spring, as the
/// diagonal that bounds it. Both keep the matrix positive definite.
void HessianAssembly::couple(std::span<const int> node, std::span<const double> weight,
                             const Matrix3d& matrix) {
  const int number = static_cast<int>(matrices_.size());
  matrices_.push_back(matrix);
  const auto add = [&](std::size_t a, std::size_t b, double product) {
    const int part = std::min(pattern_.part_of(node[a]), pattern_.part_of(node[b]));
    couplings_[part].push_back({pattern_.spot(node[a], node[b]), number, product});
  };
  bool whole = true, sides_whole = true;
  std::array<double, 2> sum{};  // of the weights of each side
  for (std::size_t a = 0; a < node.size(); ++a) {
    sum[weight[a] > 0] += weight[a];
    for (std::size_t b = 0; b < a; ++b) {
      const bool stored = pattern_.spot(node[a], node[b]).stored();
      whole = whole && stored;
      sides_whole = sides_whole && (stored || weight[a] * weight[b] <= 0);
    }
  }
  for (std::size_t a = 0; a < node.size(); ++a) {
    if (!whole && !sides_whole) {
      add(a, a, weight[a] * sum[weight[a] > 0]);
      continue;
    }
    for (std::size_t b = 0; b <= a; ++b)
      if (whole || weight[a] * weight[b] > 0) add(a, b, weight[a] * weight[b]);
  }
}

void HessianAssembly::add(int part, float* panels) {
  add_springs(part, panels);
  add_anchors(part);
  add_couplings(part, panels);
  add_prisms(part, panels);
  add_diagonal(part, panels);
}

void HessianAssembly::add_springs(int part, float* panels) {
  auto& own = own_[part];
  for (int s : pattern_.elements[part].springs) {
    const int a = mesh_.spring_a[s], b = mesh_.spring_b[s];
    const Vector3d d = x_[b] - x_[a];
    const double inverse = 1 / d.norm();
    const double strain = 1 - mesh_.rest_length[s] * inverse;
    const double tension = exact_ ? strain : std::max(0.0, strain);
    // At its rest length a spring counts as stretched.
    const double k =
        2 * mesh_.lambda * mesh_.stiffness[s] * (strain < -1e-9 ? mesh_.compression_ratio : 1.0);
    const auto across = static_cast<float>(k * tension);
    Own m{Column{across, 0, 0, 0}, Column{0, across, 0, 0}, Column{0, 0, across, 0}};
    add_product(m, column_of(d), column_of((k * (1 - tension) * inverse * inverse) * d));
    const Spot& spot = pattern_.spring[s];
    float* to = panels + spot.at;
    Own &own_a = own[pattern_.seats[a]], &own_b = own[pattern_.seats[b]];
    for (int j = 0; j < 3; ++j) {
      add_column(to + j * spot.stride, -m[j]);
      own_a[j] += m[j];
      own_b[j] += m[j];
    }
  }
}

void HessianAssembly::add_anchors(int part) {
  for (int i : pattern_.elements[part].anchors) {
    Own& own = own_[part][pattern_.seats[mesh_.anchor_node[i]]];
    const double stiffness = anchor_stiffness(mesh_, loads_, static_cast<std::size_t>(i));
    for (int k = 0; k < 3; ++k) own[k][k] += static_cast<float>(2 * mesh_.lambda * stiffness);
  }
}

void HessianAssembly::add_couplings(int part, float* panels) const {
  for (const auto& [spot, number, weight] : couplings_[part]) {
    const Matrix3d& m = matrices_[number];
    float* to = panels + spot.at;
    for (int j = 0; j < 3; ++j) add_column(to + j * spot.stride, column_of(weight * m.col(j)));
  }
}

void HessianAssembly::add_prisms(int part, float* panels) {
  auto& own = own_[part];
  const double lambda = mesh_.lambda;
  for (const auto& [p, pairs, first] : pattern_.elements[part].prisms) {
    const auto& prism = mesh_.prisms[p];
    std::array<Column, 6> c, slope;  // corners, from corner 0; gradient of the volume
    for (int k = 1; k < 6; ++k) c[k] = column_of(x_[prism[k]] - x_[prism[0]]);
    prism_volume_slopes(
        c, [](const Column& u, const Column& v) { return cross(u, v); }, slope);
    float volume = 0;
    for (int k = 1; k < 6; ++k) volume += dot(slope[k], c[k]);
    const double j = static_cast<double>(volume) / 3 / mesh_.rest_volume[p];
    const auto weight =
        static_cast<float>((1 - lambda) * mesh_.volume_weight[p] *
                           volume_stiffness(j, mesh_.barrier_fraction, mesh_.barrier_weight));
    std::array<Column, 6> weighted;
    for (int a = 0; a < 6; ++a) weighted[a] = weight * slope[a];
    if (first)
      for (int a = 0; a < 6; ++a) add_product(own[pattern_.seats[prism[a]]], slope[a], weighted[a]);

    std::array<Column, HessianPattern::corner_pairs> bend;
    if (exact_) {
      constexpr float scale = 1.0f / 12.0f;
      const auto pressure =
          scale *
          static_cast<float>((1 - lambda) * mesh_.volume_weight[p] * mesh_.rest_volume[p] *
                             volume_pressure(j, mesh_.barrier_fraction, mesh_.barrier_weight));
      bend = prism_volume_bends(c, pressure);
    }
    const Spot* spots = &pattern_.prism[static_cast<std::size_t>(p) * HessianPattern::corner_pairs];
    for (unsigned left = pairs; left != 0; left &= left - 1) {
      const int pair = std::countr_zero(left);
      const Spot& spot = spots[pair];
      const auto [a, b] = corners_of[pair];
      float* to = panels + spot.at;
      const Column &steep = slope[spot.swapped ? b : a], &along = weighted[spot.swapped ? a : b];
      if (exact_) {
        // The matrix of the product u x v.
        const Column u = spot.swapped ? -bend[pair] : bend[pair];
        add_column(to, along[0] * steep + Column{0, u[2], -u[1], 0});
        add_column(to + spot.stride, along[1] * steep + Column{-u[2], 0, u[0], 0});
        add_column(to + 2 * spot.stride, along[2] * steep + Column{u[1], -u[0], 0, 0});
      } else {
        for (int k = 0; k < 3; ++k) add_column(to + k * spot.stride, along[k] * steep);
      }
    }
  }
}

void HessianAssembly::add_diagonal(int part, float* panels) const {
  const auto& order = pattern_.tree->order.part;
  const int end = order[part + 1] * pattern_.nodes_per_column;
  for (int seat = order[part] * pattern_.nodes_per_column; seat < end; ++seat) {
    const Spot& spot = pattern_.diagonal[seat];
    float* to = panels + spot.at;
    Own own = own_[part][seat];
    if (part == 2)
      for (int k = 0; k < 3; ++k) own[k] += own_[0][seat][k] + own_[1][seat][k];
    for (int k = 0; k < 3; ++k)
      for (int row = k; row < 3; ++row) to[k * spot.stride + row] += own[k][row];
    // Regularisation for nodes without stiffness in some direction.
    const float most = std::max({to[0], to[spot.stride + 1], to[2 * spot.stride + 2]});
    for (int k = 0; k < 3; ++k) to[k * (spot.stride + 1)] += 1e-5f * most + 1e-12f;
  }
}

}  // namespace condyle
