#include "engine/registration/deformation.h"

#include <algorithm>
#include <cmath>

#include "engine/core/parallel.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Kernel of bounded reach; r from 0 to 1. source: Wendland, Adv. Comput. Math. 4, 1995 (C2)
double bump(double r) {
  const double s = 1 - r;
  return s * s * s * s * (4 * r + 1);
}

std::int64_t key_of(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::int64_t half = std::int64_t{1} << 20;
  return ((x + half) << 42) | ((y + half) << 21) | (z + half);
}

double dot(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

}  // namespace

std::int64_t DisplacementLayer::cell_of(const Vector3d& p, int dx, int dy, int dz) const {
  const double size = reach_ / 2;
  const auto at = [&](double x) { return static_cast<std::int64_t>(std::floor(x / size)); };
  return key_of(at(p.x()) + dx, at(p.y()) + dy, at(p.z()) + dz);
}

void DisplacementLayer::add_center(const Vector3d& p) {
  for (int dx = -2; dx <= 2; ++dx)
    for (int dy = -2; dy <= 2; ++dy)
      for (int dz = -2; dz <= 2; ++dz)
        cells_[cell_of(p, dx, dy, dz)].push_back(static_cast<int>(centers_.size()));
  centers_.push_back(p);
}

/// Calls visit(control, kernel value) for every control point that moves p.
template <class Visit>
void DisplacementLayer::visit_near(const Vector3d& p, const Visit& visit) const {
  const auto cell = cells_.find(cell_of(p, 0, 0, 0));
  if (cell == cells_.end()) return;
  for (const int c : cell->second) {
    const double square = (p - centers_[static_cast<std::size_t>(c)]).squaredNorm();
    if (square < reach_ * reach_) visit(c, bump(std::sqrt(square) / reach_));
  }
}

DisplacementLayer::Row DisplacementLayer::row_of(const Vector3d& p) const {
  Row row;
  row.reserve(64);
  visit_near(p, [&](int c, double value) { row.emplace_back(c, value); });
  return row;
}

DisplacementLayer::DisplacementLayer(std::span<const Pull> pulls, const LayerSettings& settings)
    : reach_(settings.reach_mm) {
  choose_centers(pulls, settings);
  solve(pulls, settings);
}

void DisplacementLayer::choose_centers(std::span<const Pull> pulls, const LayerSettings& settings) {
  // A stride coprime to the count visits the points in a scattered order.
  const std::size_t count = pulls.size();
  const double nearest = settings.spacing_mm * settings.spacing_mm;
  std::size_t at = 0;
  for (std::size_t k = 0; k < count; ++k) {
    at = (at + 7919) % count;
    const Vector3d& p = pulls[count % 7919 == 0 ? k : at].point;
    const auto cell = cells_.find(cell_of(p, 0, 0, 0));
    const bool apart =
        cell == cells_.end() || std::none_of(cell->second.begin(), cell->second.end(), [&](int c) {
          return (p - centers_[static_cast<std::size_t>(c)]).squaredNorm() < nearest;
        });
    if (!apart) continue;
    add_center(p);
    if (static_cast<int>(centers_.size()) >= settings.max_controls) break;
  }
  moves_.assign(centers_.size(), Vector3d::Zero());
}

void DisplacementLayer::solve(std::span<const Pull> pulls, const LayerSettings& settings) {
  constexpr int most_iterations = 30;
  constexpr double small = 1e-4;
  const std::size_t controls = centers_.size();
  if (controls == 0) return;
  std::vector<Row> rows(pulls.size()), kernel(controls);
  double weight = 0;
  for (std::size_t i = 0; i < pulls.size(); ++i) {
    rows[i] = row_of(pulls[i].point);
    weight += pulls[i].weight;
  }
  for (std::size_t c = 0; c < controls; ++c) kernel[c] = row_of(centers_[c]);
  const double stiffness = settings.stiffness * weight / static_cast<double>(controls);
  const auto weighted = [&](const Pull& pull, const Vector3d& d) {
    return Vector3d(pull.weight * (settings.tangential * d +
                                   (1 - settings.tangential) * pull.normal.dot(d) * pull.normal));
  };
  const auto add_to = [](std::vector<Vector3d>& sum, const Row& row, const Vector3d& d) {
    for (const auto& [c, value] : row) sum[static_cast<std::size_t>(c)] += value * d;
  };
  const auto displaced = [](const std::vector<Vector3d>& moves, const Row& row) {
    Vector3d d = Vector3d::Zero();
    for (const auto& [c, value] : row) d += value * moves[static_cast<std::size_t>(c)];
    return d;
  };
  const auto multiply = [&](const std::vector<Vector3d>& moves) {
    std::vector<Vector3d> product(controls, Vector3d::Zero());
    for (std::size_t i = 0; i < pulls.size(); ++i)
      add_to(product, rows[i], weighted(pulls[i], displaced(moves, rows[i])));
    for (std::size_t c = 0; c < controls; ++c)
      product[c] += stiffness * (displaced(moves, kernel[c]) + 1e-3 * moves[c]);
    return product;
  };
  std::vector<Vector3d> residual(controls, Vector3d::Zero());
  std::vector<double> diagonal(controls, 1.001 * stiffness);
  for (std::size_t i = 0; i < pulls.size(); ++i) {
    add_to(residual, rows[i], weighted(pulls[i], pulls[i].target - pulls[i].point));
    for (const auto& [c, value] : rows[i])
      diagonal[static_cast<std::size_t>(c)] += 0.4 * pulls[i].weight * value * value;
  }
  const auto preconditioned = [&](std::vector<Vector3d> v) {
    for (std::size_t c = 0; c < controls; ++c) v[c] /= diagonal[c];
    return v;
  };
  std::vector<Vector3d> step = preconditioned(residual);
  double size = dot(residual, step);
  const double enough = small * size;
  for (int k = 0; k < most_iterations && size > enough; ++k) {
    const std::vector<Vector3d> product = multiply(step);
    const double along = size / dot(step, product);
    for (std::size_t c = 0; c < controls; ++c) {
      moves_[c] += along * step[c];
      residual[c] -= along * product[c];
    }
    const std::vector<Vector3d> next = preconditioned(residual);
    const double next_size = dot(residual, next);
    for (std::size_t c = 0; c < controls; ++c) step[c] = next[c] + next_size / size * step[c];
    size = next_size;
  }
}

Vector3d DisplacementLayer::operator()(const Vector3d& p) const {
  Vector3d moved = p;
  visit_near(p, [&](int c, double value) { moved += value * moves_[static_cast<std::size_t>(c)]; });
  return moved;
}

std::vector<Vector3d> Deformation::carried(std::span<const Vector3d> points, int threads) const {
  std::vector<Vector3d> moved(points.size());
  parallel_for(points.size(), threads, [&](std::size_t i) { moved[i] = (*this)(points[i]); });
  return moved;
}

}  // namespace condyle
