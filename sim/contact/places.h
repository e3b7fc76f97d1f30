#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/mesh/triangle_tree.h"
#include "sim/case/case.h"

namespace condyle {

/// Tip of a coronoid process.
struct CoronoidTip {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // at rest, mm
  bool estimated = false;  // from the mandible's shape: the case does not name it
};

/// The landmark SIDE_coronoid_tip, else the highest point in front of the notch that follows the
/// condyle. `side` is "left" or "right". Nothing without SIDE_condyle or without such a point.
std::optional<CoronoidTip> coronoid_tip(const Case& patient, const std::string& side);

/// Names places on bones and teeth as clinicians do. Queries are const and thread-safe.
class Places {
 public:
  /// The patient must outlive this.
  explicit Places(const Case& patient);

  /// Half way between the condyles, else the middle of the mandible; x, mm.
  double midline_mm() const { return midline_mm_; }

  /// "tooth 26", "left condyle", "right body of the mandible", ... of a point of a part, given at
  /// rest; the part's name where nothing better is known.
  std::string name(int part, const Eigen::Vector3d& p_rest) const;

 private:
  struct Anchor {
    std::string name;
    Body body;
    Eigen::Vector3d point;
    double reach_mm;  // how far from it the name holds
  };
  struct Arch {
    TriangleTree tree;
    std::vector<Tooth> teeth;
  };
  void add_anchors();
  int tooth_at(int part, const Eigen::Vector3d& p) const;
  std::string side_of(const Eigen::Vector3d& p) const;
  std::string by_shape(Role role, const Eigen::Vector3d& p) const;

  const Case& patient_;
  double midline_mm_ = 0;
  std::vector<Anchor> anchors_;
  std::map<int, Arch> arches_;  // of parts with separate teeth
};

/// "teeth 26 and 36", "left joint fossa and left condyle": two names as one.
std::string both_places(const std::string& a, const std::string& b);

}  // namespace condyle
