#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/gl_objects.h"

namespace condyle {

/// A triangle surface on the graphics card, in pieces that lie close together, so that hidden ones
/// can be left out. Attributes: 0 position, 1 normal, 2 colour with occlusion, 3 extra (see the
/// surface shaders).
class GpuMesh {
 public:
  using Bytes = std::array<std::uint8_t, 4>;

  /// A run of triangles and the box around it, mm.
  struct Piece {
    int first_triangle, triangle_count;
    Eigen::AlignedBox3f box;
  };

  /// `moving`: positions and normals will be sent again each frame.
  GpuMesh(std::span<const Eigen::Vector3f> positions, std::span<const Eigen::Vector3i> triangles,
          bool moving);

  /// Positions as many as at the start.
  void send_shape(std::span<const Eigen::Vector3f> positions,
                  std::span<const Eigen::Vector3f> normals);
  void send_colors(std::span<const Bytes> colors);
  void send_extras(std::span<const Bytes> extras);
  /// Where the vertices are at rest, attribute 5: what detail of the surface is tied to.
  void send_rest(std::span<const Eigen::Vector3f> positions);
  /// One number per vertex, attribute 4; none: taken as 0.
  void send_values(std::span<const float> values);

  /// Triangles that only `draw_cover` draws.
  void send_cover(std::span<const Eigen::Vector3i> triangles);

  void draw() const;
  void draw(const Piece& piece) const;
  void draw_cover() const;
  const std::vector<Piece>& pieces() const { return pieces_; }

 private:
  GlVertexArray array_;
  GlBuffer positions_, normals_, colors_, extras_, values_, rest_, indices_, cover_;
  GLsizei cover_count_ = 0;
  std::vector<Eigen::Vector3i> triangles_;  // in the order of the pieces
  std::vector<Piece> pieces_;
  GLenum usage_;
};

/// Lines on the graphics card, each drawn as an instance: attributes 0 from, 1 to, 2 colour.
class GpuLines {
 public:
  GpuLines();
  /// Two ends a line; one colour a line, sRGB.
  void send(std::span<const Eigen::Vector3f> ends, std::span<const Eigen::Vector3f> colors);
  void draw() const;
  bool empty() const { return count_ == 0; }

 private:
  GlVertexArray array_;
  GlBuffer ends_, colors_;
  GLsizei count_ = 0;
};

/// Points on the graphics card; attribute 0.
class GpuPoints {
 public:
  GpuPoints();
  void send(std::span<const Eigen::Vector3f> points);
  void draw() const;
  bool empty() const { return count_ == 0; }

 private:
  GlVertexArray array_;
  GlBuffer points_;
  GLsizei count_ = 0;
};

}  // namespace condyle
