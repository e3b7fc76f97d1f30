#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "engine/mesh/tri_mesh.h"
#include "render/life/life_signs.h"
#include "render/life/upper_lid.h"

namespace condyle {

/// Eyeballs and lashes of one part with the role eyes: the balls turn to a point that both look at,
/// pupils change their size, lashes go with the upper lids.
class LivingEyes {
 public:
  /// Mesh at rest. Pieces that are neither round nor lashes turn with the eyeball that they are on.
  explicit LivingEyes(const TriMesh& mesh);

  /// Round closed pieces of the size of an eyeball; none where eyes are shells or flat.
  const std::vector<Eyeball>& eyeballs() const { return eyeballs_; }
  /// Gives the lashes to the lids: each to the one whose eyeball it is next to.
  void grow_from(std::span<const UpperLid> lids);

  /// Unit gaze of an eyeball.
  Eigen::Vector3f gaze_of(std::size_t eyeball, const LifeSigns& signs) const;
  /// Moves the vertices, given at rest; normals: unit, one per vertex.
  void move(const LifeSigns& signs, std::span<const UpperLid> lids,
            std::span<Eigen::Vector3f> places, std::span<Eigen::Vector3f> normals) const;

 private:
  struct Lash {
    std::vector<int> vertices;
    Eigen::Vector3f root;
    int lid = -1;  // none: it is on a lower lid
  };
  std::vector<Eyeball> eyeballs_;
  std::vector<float> pupils_;         // radius at rest, mm; 0: without
  std::vector<std::vector<int>> on_;  // vertices of each eyeball
  std::vector<Lash> lashes_;
};

}  // namespace condyle
