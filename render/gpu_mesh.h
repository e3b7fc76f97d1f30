#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/gl_objects.h"

namespace condyle {

/// Directions within an angle of an axis.
struct DirectionCone {
  Eigen::Vector3f axis = Eigen::Vector3f::Zero();
  float sine = 2;  // of the angle; above 1: any direction
};

/// A triangle surface on the graphics card, in small pieces that lie close together and face nearly
/// the same way, so that those not seen can be left out. Attributes: 0 position, 1 normal, 2 colour
/// with occlusion, 3 extra (see the surface shaders). What is given for vertices is given in the
/// order of the positions; on the card they lie in the order in which they are drawn.
class GpuMesh {
 public:
  using Bytes = std::array<std::uint8_t, 4>;

  /// A run of triangles with the box around it, mm, and the directions that they face.
  struct Piece {
    int first_triangle, triangle_count;
    Eigen::AlignedBox3f box;
    DirectionCone normals;
  };

  /// Triangles on the mesh's points, and their pieces one after the other.
  struct Surface {
    std::vector<Eigen::Vector3i> triangles;
    std::vector<Piece> pieces;
    std::vector<int> corners;      // the points that it uses, ascending
    Eigen::AlignedBox3f box = {};  // around all pieces
  };

  /// `moving`: positions and normals will be sent again each frame.
  GpuMesh(std::span<const Eigen::Vector3f> positions, std::span<const Eigen::Vector3i> triangles,
          bool moving);

  /// The same triangles in another context; shape and colours are to be sent.
  GpuMesh twin() const;

  /// Makes the coarse surface of what the mesh was made of; before the shape is sent.
  void add_coarse(std::span<const Eigen::Vector3f> positions,
                  std::span<const Eigen::Vector3i> triangles);
  /// Positions as many as at the start.
  void send_shape(std::span<const Eigen::Vector3f> positions,
                  std::span<const Eigen::Vector3f> normals);
  void send_colors(std::span<const Bytes> colors);
  void send_extras(std::span<const Bytes> extras);
  /// Where the vertices are at rest, attribute 5: what detail of the surface is tied to.
  void send_rest(std::span<const Eigen::Vector3f> positions);
  /// One number per vertex, attribute 4; none: taken as 0.
  void send_values(std::span<const float> values);
  /// The same, how far each is from where a mesh of the same triangles has it, mm.
  void send_ways_to(const GpuMesh& other);

  /// Triangles that only `draw_cover` draws.
  void send_cover(std::span<const Eigen::Vector3i> triangles);

  void draw() const;
  /// Some of its triangles, fine or coarse.
  void draw(std::span<const Eigen::Vector3i> chosen) const;
  void draw_cover() const;

  // As on the card:
  const std::vector<Eigen::Vector3f>& points() const { return points_; }
  const Surface& fine() const;
  /// Where a vertex is, numbered as given; of one that has a triangle.
  const Eigen::Vector3f& point_of(int vertex) const {
    return points_[static_cast<std::size_t>(place_[static_cast<std::size_t>(vertex)])];
  }
  /// What is good enough to throw a shadow.
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
  Surface coarse_;  // none unless asked for
  mutable Surface fine_;
  mutable bool fine_measured_ = false;  // put off: pictures in motion may not need it
  std::vector<Eigen::Vector3f> points_;
  std::vector<int> order_, place_;  // vertex on the card -> as given, and back; -1: not used
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
