#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "render/gl/gl_objects.h"

namespace condyle {

/// 0 to 1 as a byte of a vertex attribute, 0 to 255; values beyond are clamped.
inline std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.f, 1.f)));
}

/// Directions within an angle of an axis.
struct DirectionCone {
  Eigen::Vector3f axis = Eigen::Vector3f::Zero();
  float sine = 2;  // of the angle; above 1: any direction
};

/// A triangle surface on the graphics card, in small compact pieces of nearly the same facing
/// direction, so that hidden ones can be culled. Attributes: 0 position, 1 normal, 2 colour with
/// occlusion, 3 extra (see the surface shaders). Values of vertices are given in the order of the
/// positions; on the card they are in the order of drawing.
class GpuMesh {
 public:
  using Bytes = std::array<std::uint8_t, 4>;

  /// A range of triangles with its bounding box, mm, and its facing directions.
  struct Piece {
    int first_triangle, triangle_count;
    Eigen::AlignedBox3f box;
    DirectionCone normals;
  };

  /// Triangles on the mesh's points, and their pieces in order.
  struct Surface {
    std::vector<Eigen::Vector3i> triangles;
    std::vector<Piece> pieces;
    std::vector<int> corners;      // the points that it uses, ascending
    Eigen::AlignedBox3f box = {};  // around all pieces
  };

  /// `still` and `moving`: from its shape at rest, whose pieces are stored on disk; positions and
  /// normals of a moving one are sent again each frame. `overlay`: moving, from any shape; has no
  /// pieces.
  enum class Use { still, moving, overlay };
  GpuMesh(std::span<const Eigen::Vector3f> positions, std::span<const Eigen::Vector3i> triangles,
          Use use);

  /// The same triangles in another context; shape and colours have to be sent.
  GpuMesh twin() const;

  /// Makes the coarse surface of the original mesh; before the shape is sent.
  void add_coarse(std::span<const Eigen::Vector3f> positions,
                  std::span<const Eigen::Vector3i> triangles);
  /// As many positions as at the start.
  void send_shape(std::span<const Eigen::Vector3f> positions,
                  std::span<const Eigen::Vector3f> normals);
  void send_colors(std::span<const Bytes> colors);
  void send_extras(std::span<const Bytes> extras);
  /// Rest positions of the vertices, attribute 5: the detail of the surface is tied to them.
  void send_rest(std::span<const Eigen::Vector3f> positions);
  /// One value per vertex, attribute 4; empty: 0.
  void send_values(std::span<const float> values);
  /// The same with the distance of each vertex from its position in a mesh of the same triangles,
  /// mm.
  void send_displacements_to(const GpuMesh& other);

  /// Triangles that only `draw_cover` draws.
  void send_cover(std::span<const Eigen::Vector3i> triangles);

  void draw() const;
  /// Some of its triangles, fine or coarse.
  void draw(std::span<const Eigen::Vector3i> chosen) const;
  void draw_cover() const;

  // In the order on the card:
  const std::vector<Eigen::Vector3f>& points() const { return points_; }
  const Surface& fine() const;
  /// Position of a vertex of at least one triangle, in the original numbering.
  const Eigen::Vector3f& point_of(int vertex) const {
    return points_[static_cast<std::size_t>(card_vertex_[static_cast<std::size_t>(vertex)])];
  }
  /// The surface that is accurate enough to cast a shadow.
  const Surface& coarse() const { return coarse_.triangles.empty() ? fine() : coarse_; }

 private:
  GpuMesh(Surface fine, Surface coarse, GLenum usage)
      : coarse_(std::move(coarse)), fine_(std::move(fine)), usage_(usage) {}
  void describe();

  template <class T>
  std::vector<T> ordered(std::span<const T> values) const;
  void use_values();
  template <class T>
  void send_ordered(GLuint buffer, std::span<const T> values, GLenum usage);

  GlVertexArray array_;
  GlBuffer positions_, normals_, colors_, extras_, values_, rest_, indices_, cover_, chosen_;
  GLsizei cover_count_ = 0;
  Surface coarse_;  // empty unless requested
  mutable Surface fine_;
  mutable bool fine_measured_ = false;  // lazy: pictures in motion may not need it
  std::vector<Eigen::Vector3f> points_;
  std::vector<int> order_, card_vertex_;  // vertex on the card -> original, and inverse; -1: unused
  GLenum usage_;
};

/// Lines on the graphics card, each drawn as an instance: attributes 0 from, 1 to, 2 colour.
class GpuLines {
 public:
  GpuLines();
  /// Two ends per line; one colour per line, sRGB.
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
