#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/life/life_signs.h"
#include "render/life/living_eyes.h"
#include "render/life/lower_lid.h"
#include "render/life/upper_lid.h"
#include "sim/frame/part.h"

namespace condyle {

/// A drawn face and its eyes, moved by signs of life. Deterministic.
class LivingFace {
 public:
  /// parts: of the patient, at rest. rest, triangles: of the drawn face. nose_tip: see Life.
  LivingFace(std::span<const Part> parts, std::span<const Eigen::Vector3f> rest,
             std::span<const Eigen::Vector3i> triangles,
             const std::optional<Eigen::Vector3d>& nose_tip);

  /// Results of move_face besides the vertices.
  struct Moved {
    std::vector<SkinFolds::Shade> shades = {};              // of the lids' creases
    std::vector<std::vector<Eigen::Vector3f>> lashes = {};  // of each part: LivingEyes::root_shifts
  };
  /// Moves the present vertices of the drawn face. raises: lower lids, with the cheeks below them.
  Moved move_face(const Life& life, const LifeSigns& signs, bool raises,
                  std::span<Eigen::Vector3f> places) const;
  /// Moves the vertices of the lids alone: first the lower ones, which the upper ones meet.
  std::vector<LidPose> move_lids(const LifeSigns& signs, bool raises,
                                 std::span<Eigen::Vector3f> places) const;
  /// Whether move_eyes moves any vertex of the part with this number.
  bool has_eyes(std::size_t part) const { return part < eyes_.size() && eyes_[part].has_value(); }
  /// By how much the present face has moved the roots of the lashes of each part.
  std::vector<std::vector<Eigen::Vector3f>> lash_shifts(
      std::span<const Eigen::Vector3f> places) const;
  /// Moves vertices and normals of a part, given at rest. lashes: the element of
  /// lash_shifts for this part.
  void move_eyes(std::size_t part, const LifeSigns& signs, std::span<const Eigen::Vector3f> lashes,
                 std::span<Eigen::Vector3f> places, std::span<Eigen::Vector3f> normals) const;

  /// What of it the patient lacks, as text; empty for nothing.
  std::string shortfall() const;
  /// Why lids do not move, or those of one eye, as text; empty where both do.
  std::string lids_shortfall() const;
  /// "left" or "right": the side whose lids alone do not move; empty: neither or both.
  std::string open_side() const;

 private:
  struct Member {
    int vertex;
    float still;               // 1: it does not follow the head's extension
    Eigen::Vector3f breathes;  // displacement after inspiration, mm
  };
  /// What was found on a side.
  struct EyeParts {
    bool eyeball = false, lid = false;
  };
  void find_lids(std::span<const Eigen::Vector3f> rest, std::span<const Eigen::Vector3i> triangles);
  void breathe(const Life& life, const LifeSigns& signs, std::span<Eigen::Vector3f> places) const;
  void find_neck(std::span<const Part> parts, std::span<const Eigen::Vector3f> rest);
  void find_nostrils(std::span<const Eigen::Vector3f> rest, const Eigen::Vector3f& nose_tip);

  std::vector<std::optional<LivingEyes>> eyes_;  // by part
  std::vector<UpperLid> lids_;
  std::vector<LowerLid> lower_lids_;                           // of the same eyes
  std::vector<std::pair<std::size_t, std::size_t>> lid_eyes_;  // part and eyeball of each lid
  std::vector<Member> neck_, nostrils_;
  EyeParts left_, right_;
};

}  // namespace condyle
