#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "render/face/skin_folds.h"
#include "sim/frame/part.h"

namespace condyle {

/// Cheeks get thinner or thicker, in pictures alone. As an opening jaw stretches a cheek over the
/// buccal space, it sinks in: its width is held by the masseter and the lips, so its thickness
/// falls in inverse proportion to its height. As a smile gathers the skin between the nasolabial
/// fold and the eye, the cheek bulges there: the volume below that skin gathers in a third of its
/// area, at most 4 mm high. At rest and where these change by less than a few hundredths, nothing
/// changes, bit for bit. Deterministic.
class CheekThickness {
 public:
  /// rest: displayed vertices of the face at rest, mm, LPS. normals: unit, one per vertex. rim: of
  /// the mouth. parts: of the patient; the thickness of a cheek is its distance from their jaws and
  /// teeth. Without a rim or jaws nothing changes.
  CheekThickness(std::span<const Eigen::Vector3f> rest, std::span<const Eigen::Vector3f> normals,
                 std::span<const int> rim, std::span<const Part* const> parts);

  /// Displaces the current positions, mm. Returns the darker vertices; empty if no cheek sinks in.
  std::vector<SkinFolds::Shade> apply(std::vector<Eigen::Vector3f>& places) const;

  /// Where and how the thickness changes. Lengths are those of an adult, mm from the corner of the
  /// mouth: backward along the skin, and upward.
  struct Region {
    float front, full_from, full_to, back;   // full change between, none outside
    float height, scale_above, scale_below;  // of the full change; distances to 1/e of it
    float gauge_back, gauge_up;              // foremost, lowest vertex that measures the skin
    float slack;                             // change without effect, a fraction
    float gain;                              // skin that is measured, over skin that is displaced
    bool sinks;  // where its height grows; or bulges where its area falls
  };

 private:
  static constexpr std::size_t columns = 4, rows = 7;  // of a gauge; hollows use three
  /// A vertex that is displaced.
  struct Member {
    int vertex;
    float weight;    // 0 to 1
    float limit_mm;  // largest displacement: a hollow stays clear of the teeth
  };
  struct Cheek {
    const Region* region;
    std::array<std::array<int, rows>, columns> gauge = {};  // vertices, upward; forward first
    std::vector<float> rest = {};                           // extents
    float thickness_mm = 0;
    float shade_per_mm = 0;  // darkening over the depth
    float outward = 1;       // sign of the normal that the gauge gives
    std::vector<Member> members = {};
    /// Present position of a vertex of the gauge.
    const Eigen::Vector3f& at(std::span<const Eigen::Vector3f> places, std::size_t column,
                              std::size_t row) const {
      return places[static_cast<std::size_t>(gauge[column][row])];
    }
  };
  static Eigen::Vector3f gauge_normal(const Cheek& cheek, std::span<const Eigen::Vector3f> places);
  /// Heights of columns, or areas between them.
  static std::vector<float> extents(const Cheek& cheek, std::span<const Eigen::Vector3f> places);

  std::vector<Cheek> cheeks_;
};

}  // namespace condyle
