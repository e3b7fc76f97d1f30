#pragma once

#include <map>
#include <optional>
#include <vector>

#include "engine/cut/cut.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/osteotomy/surgical_anatomy.h"

namespace condyle {

/// The brain case, probed by rays from outside to its middle. Places on it are given by `along`,
/// the distance from nasion along the midline, and `beside`, the distance from the midline along
/// the bone, to the left positive; both in mm, over gaps in the bone as if they were filled.
class Vault {
 public:
  /// Bregma and lambda are landmarks, else at 0.45 and 0.89 of the midline from nasion to the
  /// rearmost point (arcs of 128 and 127 mm of some 285, as on adult skulls), with a note.
  /// throws: InputError where the bone has no vault.
  explicit Vault(SurgicalAnatomy& skull);

  double bregma() const { return bregma_; }
  double lambda() const { return lambda_; }

  struct Spot {
    Eigen::Vector3d at;  // on the outer surface
    double thickness_mm = 0;
    bool has_bone = false;  // false: in a gap
  };
  Spot spot(double along, double beside);
  /// From the middle of the brain case to a point.
  Eigen::Vector3d outward(const Eigen::Vector3d& p) const { return (p - middle_).normalized(); }
  /// The last distance from the midline, on one side and up to a limit, at which bone is missing.
  std::optional<double> last_gap(double along, Side side, double limit_mm);

 private:
  struct Station {
    double distance = 0;
    Spot spot = {};
  };
  Spot probe(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const;
  void fill_gaps(std::vector<Station>& stations, const Eigen::Vector3d& from,
                 const std::vector<Eigen::Vector3d>& directions) const;
  void find_middle(const SurgicalAnatomy& skull);
  void find_midline(SurgicalAnatomy& skull);
  const std::vector<Station>& arch(double along, Side side);
  static Spot at_distance(const std::vector<Station>& stations, double distance);

  TriangleTree tree_;
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();
  std::vector<Station> midline_;
  std::map<std::pair<double, Side>, std::vector<Station>> arches_;
  double bregma_ = 0, lambda_ = 0;
};

/// How far a cut of the vault reaches to each side of the bone.
constexpr double vault_reach_mm = 15;

/// A straight border of a panel of bone, perpendicular to the bone at its middle.
struct VaultBorder {
  Eigen::Vector3d point, inward;
  bool is_shared = false;  // an earlier cut's wall: this one ends in the middle of its kerf
};
VaultBorder vault_border(const Vault& vault, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                         const Eigen::Vector3d& inside);

/// The cut around a panel within its borders, of which the spots are samples: above is the panel.
Cut panel_cut(const SurgicalAnatomy& skull, const Vault& vault, const std::string& name,
              const std::vector<VaultBorder>& borders, const std::vector<Vault::Spot>& spots);

}  // namespace condyle
