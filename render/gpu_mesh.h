#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/gl_objects.h"

namespace condyle {

/// A triangle surface on the graphics card, drawn in one call.
/// Attributes: 0 position, 1 normal, 2 colour with occlusion, 3 extra (see the surface shaders).
class GpuMesh {
 public:
  using Bytes = std::array<std::uint8_t, 4>;

  /// `moving`: positions and normals will be sent again each frame.
  GpuMesh(std::span<const Eigen::Vector3i> triangles, bool moving);

  void send_shape(std::span<const Eigen::Vector3f> positions,
                  std::span<const Eigen::Vector3f> normals);
  void send_look(std::span<const Bytes> colors, std::span<const Bytes> extras);
  void draw() const;

 private:
  GlVertexArray array_;
  GlBuffer positions_, normals_, colors_, extras_, indices_;
  GLsizei index_count_ = 0;
  GLenum usage_;
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
