#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "engine/mesh/loop_subdivision.h"
#include "engine/mesh/tri_mesh.h"
#include "render/mouth_lining.h"
#include "sim/frame/part.h"

namespace condyle {

/// A face as it is drawn. A coarse one gets smaller triangles on a smooth surface. Openings that a
/// segmentation left are not seen through: those of eyes are closed as by
/// plain lids where no eye is near, nostrils go on into the dark.
class DrawnFace {
 public:
  /// eyes: vertices of theirs. color: of a mesh without colours, sRGB.
  DrawnFace(const TriMesh& face, std::span<const Eigen::Vector3d> eyes,
            const Eigen::Vector3f& color);

  /// Whether a face is drawn smooth, elsewhere than its vertices are.
  static bool smooths(const TriMesh& face);

  /// Gives it the colours of lips and cheeks; rim: of its mouth (see skin_tint.h).
  void tint(std::span<const int> rim, const Eigen::Vector3f& skin);

  /// Gives it brows, over eyes that it closes.
  void draw_brows();

  /// Whether it differs from the face that it was made of.
  bool changed() const { return changed_; }
  const TriMesh& mesh() const { return mesh_; }
  /// How many vertices that face has.
  std::size_t given() const { return given_; }
  /// Where its vertices are with the face's where these are now.
  std::vector<Eigen::Vector3f> places(std::span<const Eigen::Vector3f> face) const;
  /// Where it has the face's own vertices.
  std::vector<Eigen::Vector3f> places_of_given(std::span<const Eigen::Vector3f> face) const;
  /// What is known of the face's vertices, of its own.
  std::vector<float> values(std::span<const float> face) const;

 private:
  std::vector<Eigen::Vector3f> closed(std::span<const Eigen::Vector3f> face) const;
  void close_openings(std::span<const Eigen::Vector3d> eyes, const Eigen::Vector3f& color);
  void divide();
  void draw_lashes();
  void place(const TriMesh& face);

  /// A closed eye at rest: its corners, and how far below the line between them its lids meet.
  struct ClosedEye {
    Eigen::Vector3d right, left;
    double below_mm;
  };

  std::size_t given_;
  TriMesh mesh_;
  VertexSums covers_;                     // of openings, of the face's vertices
  std::vector<Eigen::Vector3f> offsets_;  // and from there, mm
  VertexSums smooth_;                     // of the face's vertices and those
  std::vector<ClosedEye> closed_eyes_;
  bool changed_ = false, divided_ = false;
};

/// A patient's parts, which must outlive it, as they are drawn: the first face may be another.
class PreparedParts {
 public:
  explicit PreparedParts(std::span<const Part> patient);
  PreparedParts(const PreparedParts&) = delete;
  PreparedParts& operator=(const PreparedParts&) = delete;

  std::span<const Part> patient() const { return patient_; }
  const Part& drawn(const Part& part) const { return &part == replaced_ ? own_ : part; }
  /// What lines the mouth of the first face as it is drawn; null if nothing does.
  const MouthLining* lining() const { return lining_ ? &*lining_ : nullptr; }
  /// Of a part that is drawn; null if it is the patient's.
  const DrawnFace* face_of(const Part& drawn) const { return &drawn == &own_ ? &*face_ : nullptr; }

 private:
  std::span<const Part> patient_;
  const Part* replaced_ = nullptr;
  Part own_;
  std::optional<DrawnFace> face_;
  std::optional<MouthLining> lining_;
};

}  // namespace condyle
