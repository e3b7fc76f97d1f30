#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "engine/mesh/tri_mesh.h"
#include "render/life/life_signs.h"
#include "render/life/upper_lid.h"

namespace condyle {

/// Eyeballs and lashes of one part with the role eyes: the balls turn to a point that both look at,
/// pupils change their size, lashes go with the lids.
class LivingEyes {
 public:
  /// Mesh at rest. Pieces that are neither round nor lashes turn with the eyeball that they are on.
  explicit LivingEyes(const TriMesh& mesh);

  /// Round closed pieces of the size of an eyeball; none where eyes are shells or flat.
  const std::vector<Eyeball>& eyeballs() const { return eyeballs_; }
  /// Roots the lashes in the skin beside the eyeballs of lids; those with no skin beside them stay.
  /// rest, triangles: of the face.
  void root_lashes(std::span<const UpperLid> lids, std::span<const Eigen::Vector3f> rest,
                   std::span<const Eigen::Vector3i> triangles);

  /// Unit gaze of an eyeball.
  Eigen::Vector3f gaze_of(std::size_t eyeball, const LifeSigns& signs) const;
  /// Turns the eyeballs, given at rest; normals: unit, one per vertex.
  void move(const LifeSigns& signs, std::span<Eigen::Vector3f> places,
            std::span<Eigen::Vector3f> normals) const;
  /// By how much the present face has moved the root of each lash, mm; empty where none has moved
  /// visibly.
  std::vector<Eigen::Vector3f> root_shifts(std::span<const Eigen::Vector3f> face) const;
  /// Moves the lashes, given at rest, with their roots, and turns them about these as the lids turn
  /// about the eyeballs. shifts: of root_shifts, or empty.
  void move_lashes(std::span<const Eigen::Vector3f> shifts, std::span<const UpperLid> lids,
                   std::span<Eigen::Vector3f> places, std::span<Eigen::Vector3f> normals) const;

 private:
  /// A lash at rest, and the triangle of the skin that it grows from.
  struct Lash {
    std::vector<int> vertices;
    Eigen::Vector3f root;
    std::optional<std::size_t> lid = {};  // beside whose eyeball; none: it stays
    std::array<int, 3> skin = {};
    std::array<Eigen::Vector3f, 3> skin_rest = {};
    Eigen::Vector3f weight = Eigen::Vector3f::Zero();
  };
  std::vector<Eyeball> eyeballs_;
  std::vector<float> pupils_;         // radius at rest, mm; 0: without
  std::vector<std::vector<int>> on_;  // vertices of each eyeball
  std::vector<Lash> lashes_;
};

}  // namespace condyle
