#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

namespace condyle {

/// A piece of a surface whose vertices are held at its border. Vertices that move come first.
struct SurfacePiece {
  std::vector<Eigen::Vector3f> rest = {};       // mm
  std::vector<Eigen::Vector3i> triangles = {};  // numbers of vertices
  std::size_t moving = 0;                       // vertices that move
  std::size_t bending = 0;  // of all: those at which it bends, the moving ones among them
  double stiff_mm = 25;     // bending matters at smaller scales than this, tension at greater ones
};

/// The smooth surface that spans the border of a piece: least tension and bending, with the
/// weights (cotangents) of the piece at rest. Deterministic.
class SpanningSurface {
 public:
  explicit SpanningSurface(const SurfacePiece& piece);
  SpanningSurface(SpanningSurface&&) noexcept;
  ~SpanningSurface();

  /// Positions of the moving vertices for those of all; of the moving ones none is read.
  std::vector<Eigen::Vector3f> across(std::span<const Eigen::Vector3f> places) const;
  /// What the piece at rest differs by from the surface, mm; of the moving vertices.
  const std::vector<Eigen::Vector3f>& rest_offset() const { return rest_offset_; }

 private:
  struct Equations;
  std::unique_ptr<const Equations> equations_;
  std::vector<Eigen::Vector3f> rest_offset_;
};

}  // namespace condyle
