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
  bool estimated = false;  // from the mandible's shape: the case has no such landmark
};

/// The landmark SIDE_coronoid_tip, else the highest point in front of the notch that follows the
/// condyle. `side` is "left" or "right". Absent without SIDE_condyle or without such a point.
std::optional<CoronoidTip> coronoid_tip(const Case& patient, const std::string& side);

/// Clinical names of regions on bones and teeth. Queries are const and thread-safe.
class AnatomicalRegions {
 public:
  /// The patient must outlive this.
  explicit AnatomicalRegions(const Case& patient);

  /// Midpoint of the condyles, else the centre of the mandible; x, mm.
  double midline_mm() const { return midline_mm_; }

  /// "tooth 26", "left condyle", "right body of the mandible", ... for a point of a part at rest;
  /// by default the part's name.
  std::string name(int part, const Eigen::Vector3d& p_rest) const;

 private:
  struct Anchor {
    std::string name;
    BodyId body;
    Eigen::Vector3d point;
    double reach_mm;  // range around it in which the name applies
  };
  struct Arch {
    TriangleTree tree;
    std::vector<Tooth> teeth;
  };
  void add_anchors();
  int tooth_at(int part, const Eigen::Vector3d& p) const;
  std::string side_of(const Eigen::Vector3d& p) const;
  std::string by_shape(const Part& part, const Eigen::Vector3d& p) const;

  const Case& patient_;
  double midline_mm_ = 0;
  std::vector<Anchor> anchors_;
  std::map<int, Arch> arches_;  // of parts with separate teeth
};

/// "teeth 26 and 36", "left joint fossa and left condyle": two names combined.
std::string join_regions(const std::string& a, const std::string& b);

}  // namespace condyle
