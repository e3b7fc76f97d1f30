#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "engine/mesh/loop_subdivision.h"
#include "engine/mesh/tri_mesh.h"
#include "render/face/mouth_lining.h"
#include "sim/frame/part.h"

namespace condyle {

/// The displayed mesh of a face. A coarse face is subdivided onto a smooth surface. Openings left
/// by a segmentation are closed: those of eyes by plain lids where no eye is near, nostrils by dark
/// cavities.
class DrawnFace {
 public:
  /// eyes: their vertices. color: for a mesh without colours, sRGB.
  DrawnFace(const TriMesh& face, std::span<const Eigen::Vector3d> eyes,
            const Eigen::Vector3f& color);

  /// Whether a face is subdivided, so that its displayed vertices differ.
  static bool smooths(const TriMesh& face);

  /// Colours lips and cheeks; rim: of its mouth (see skin_tint.h).
  void tint(std::span<const int> rim, const Eigen::Vector3f& skin);

  /// Adds brows over eyes that were closed.
  void draw_brows();

  /// Whether it differs from the original face.
  bool changed() const { return changed_; }
  const TriMesh& mesh() const { return mesh_; }
  /// Number of vertices of the original face.
  std::size_t given() const { return given_; }
  /// Positions of its vertices for the given positions of the original vertices.
  std::vector<Eigen::Vector3f> places(std::span<const Eigen::Vector3f> face) const;
  /// The same for its original vertices only.
  std::vector<Eigen::Vector3f> places_of_given(std::span<const Eigen::Vector3f> face) const;
  /// Interpolates values of the original vertices to its own.
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
  VertexSums covers_;                     // of openings, as sums of the original vertices
  std::vector<Eigen::Vector3f> offsets_;  // and relative to those, mm
  VertexSums smooth_;                     // of the original vertices and the covers
  std::vector<ClosedEye> closed_eyes_;
  bool changed_ = false, divided_ = false;
};

/// A patient's parts, which must outlive it, as they are displayed: the first face may be replaced.
class PreparedParts {
 public:
  explicit PreparedParts(std::span<const Part> patient);
  PreparedParts(const PreparedParts&) = delete;
  PreparedParts& operator=(const PreparedParts&) = delete;

  std::span<const Part> patient() const { return patient_; }
  const Part& drawn(const Part& part) const { return &part == replaced_ ? own_ : part; }
  /// The lining of the mouth of the first face as displayed; null if there is none.
  const MouthLining* lining() const { return lining_ ? &*lining_ : nullptr; }
  /// For a displayed part; null if it is the patient's own.
  const DrawnFace* face_of(const Part& drawn) const { return &drawn == &own_ ? &*face_ : nullptr; }

 private:
  std::span<const Part> patient_;
  const Part* replaced_ = nullptr;
  Part own_;
  std::optional<DrawnFace> face_;
  std::optional<MouthLining> lining_;
};

}  // namespace condyle
