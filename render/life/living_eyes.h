#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "engine/mesh/tri_mesh.h"
#include "render/life/life_signs.h"
#include "render/life/lower_lid.h"
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
  /// A lash at rest.
  struct Lash {
    std::vector<int> vertices;
    Eigen::Vector3f root;
    std::optional<std::size_t> lid = {};  // index of the lids that it grows from; none: it stays
    bool upper = true;
  };
  /// A rotation about a centre.
  struct Turn {
    Eigen::Matrix3f R;
    Eigen::Vector3f about;
  };
  /// Gives the lashes to the lids: each to one whose eyeball it is next to; others stay. upper,
  /// lower: of the same eyes.
  void grow_from(std::span<const UpperLid> upper, std::span<const LowerLid> lower);

  /// Unit gaze of an eyeball.
  Eigen::Vector3f gaze_of(std::size_t eyeball, const LifeSigns& signs) const;
  /// Turns the eyeballs, given at rest; normals: unit, one per vertex.
  void move(const LifeSigns& signs, std::span<Eigen::Vector3f> places,
            std::span<Eigen::Vector3f> normals) const;
  /// Turns the lashes that grow from lids, given at rest.
  void turn_lashes(const std::function<Turn(const Lash&)>& turn, std::span<Eigen::Vector3f> places,
                   std::span<Eigen::Vector3f> normals) const;

 private:
  std::vector<Eyeball> eyeballs_;
  std::vector<float> pupils_;         // radius at rest, mm; 0: without
  std::vector<std::vector<int>> on_;  // vertices of each eyeball
  std::vector<Lash> lashes_;
};

}  // namespace condyle
