#include "render/mesh/spanning_surface.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

namespace condyle {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Matrix = Eigen::SparseMatrix<double>;

struct SpanningSurface::Equations {
  Eigen::SimplicialLDLT<Matrix> moving;
  Matrix held;  // rows of the moving vertices, columns of the others
};

namespace {

constexpr double greatest_cotangent = 20;  // of slivers

struct Weights {
  Matrix laplacian;
  Eigen::VectorXd area;  // mm², of a vertex
};

Weights cotangent_weights(const SurfacePiece& piece) {
  const auto count = static_cast<int>(piece.rest.size());
  Weights weights{Matrix(count, count), Eigen::VectorXd::Zero(count)};
  std::vector<Eigen::Triplet<double>> entries;
  for (const Eigen::Vector3i& t : piece.triangles)
    for (int k = 0; k < 3; ++k) {
      const int at = t[k], a = t[(k + 1) % 3], b = t[(k + 2) % 3];
      const auto place = [&](int v) {
        return Vector3d(piece.rest[static_cast<std::size_t>(v)].cast<double>());
      };
      const Vector3d to_a = place(a) - place(at), to_b = place(b) - place(at);
      const double twice_area = std::max(to_a.cross(to_b).norm(), 1e-9);
      const double weight =
          std::clamp(to_a.dot(to_b) / twice_area, -greatest_cotangent, greatest_cotangent) / 2;
      entries.emplace_back(a, a, weight);
      entries.emplace_back(b, b, weight);
      entries.emplace_back(a, b, -weight);
      entries.emplace_back(b, a, -weight);
      weights.area[at] += twice_area / 6;
    }
  weights.laplacian.setFromTriplets(entries.begin(), entries.end());
  return weights;
}

}  // namespace

SpanningSurface::SpanningSurface(const SurfacePiece& piece) {
  const auto moving = static_cast<int>(piece.moving);
  const auto others = static_cast<int>(piece.rest.size()) - moving;
  const auto [laplacian, area] = cotangent_weights(piece);
  Eigen::VectorXd bends = Eigen::VectorXd::Zero(area.size());
  for (std::size_t v = 0; v < piece.bending; ++v) {
    const auto row = static_cast<int>(v);
    if (area[row] > 0) bends[row] = piece.stiff_mm * piece.stiff_mm / area[row];
  }
  const Matrix energy = laplacian + Matrix(laplacian * bends.asDiagonal() * laplacian);
  auto equations = std::make_unique<Equations>();
  equations->moving.compute(energy.topLeftCorner(moving, moving));
  equations->held = energy.topRightCorner(moving, others);
  equations_ = std::move(equations);
  rest_offset_ = across(piece.rest);
  for (std::size_t v = 0; v < piece.moving; ++v) rest_offset_[v] = piece.rest[v] - rest_offset_[v];
}

SpanningSurface::SpanningSurface(SpanningSurface&&) noexcept = default;
SpanningSurface::~SpanningSurface() = default;

std::vector<Vector3f> SpanningSurface::across(std::span<const Vector3f> places) const {
  const auto moving = static_cast<std::size_t>(equations_->held.rows());
  Eigen::MatrixX3d held(equations_->held.cols(), 3);
  for (std::size_t v = moving; v < places.size(); ++v)
    held.row(static_cast<int>(v - moving)) = places[v].cast<double>().transpose();
  const Eigen::MatrixX3d found = equations_->moving.solve(-(equations_->held * held));
  std::vector<Vector3f> spanned(moving);
  for (std::size_t v = 0; v < moving; ++v)
    spanned[v] = found.row(static_cast<int>(v)).transpose().cast<float>();
  return spanned;
}

}  // namespace condyle
