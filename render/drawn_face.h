#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "engine/mesh/loop_subdivision.h"
#include "engine/mesh/tri_mesh.h"
#include "sim/frame/part.h"

namespace condyle {

/// What stands behind the eyes' openings of a face.
enum class EyesBehind { none, eyes };

/// A face as it is drawn. A coarse one gets smaller triangles on a smooth surface. Openings that a
/// segmentation left are not seen through: those of eyes without eyes are closed as by plain lids,
/// nostrils go on into the dark.
class DrawnFace {
 public:
  /// color: of a mesh without colours, sRGB.
  DrawnFace(const TriMesh& face, EyesBehind behind, const Eigen::Vector3f& color);

  /// Whether it differs from the face that it was made of.
  bool changed() const { return changed_; }
  const TriMesh& mesh() const { return mesh_; }
  /// How many vertices that face has.
  std::size_t given() const { return given_; }
  /// Where its vertices are with the face's where these are now.
  std::vector<Eigen::Vector3f> places(std::span<const Eigen::Vector3f> face) const;
  /// What is known of the face's vertices, of its own.
  std::vector<float> values(std::span<const float> face) const;

 private:
  void close_openings(const TriMesh& face, EyesBehind behind, const Eigen::Vector3f& color);
  void divide();
  void place(const TriMesh& face);

  std::size_t given_;
  TriMesh mesh_;
  VertexSums closed_;                     // of the face's vertices
  std::vector<Eigen::Vector3f> offsets_;  // and from there, mm
  VertexSums smooth_;                     // of those
  bool changed_ = false, divided_ = false;
};

/// A patient's parts as they are drawn: the face may be another.
class DrawnParts {
 public:
  explicit DrawnParts(std::span<const Part> patient);
  DrawnParts(const DrawnParts&) = delete;
  DrawnParts& operator=(const DrawnParts&) = delete;

  std::span<const Part> parts() const { return shown_; }
  /// None if it is drawn as it is.
  const std::optional<DrawnFace>& face() const { return face_; }

 private:
  std::span<const Part> shown_;
  std::vector<Part> own_;
  std::optional<DrawnFace> face_;
};

}  // namespace condyle
