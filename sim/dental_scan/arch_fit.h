#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/registration/best_fit.h"
#include "sim/case/landmarks.h"
#include "sim/dental_scan/crown_points.h"
#include "sim/dental_scan/dental_scan.h"
#include "sim/frame/part.h"

namespace condyle {

/// The crowns of one arch of a case, prepared for registration.
class ArchTarget {
 public:
  /// teeth: of the role upper_teeth or lower_teeth. throws: InputError for a surface without area.
  explicit ArchTarget(const Part& teeth);

  bool upper() const { return upper_; }
  const std::string& name() const { return name_; }
  const SurfacePairs& pairs() const { return pairs_; }
  const Eigen::Vector3d& bite() const { return bite_; }  // unit, towards the opposing arch
  const Eigen::Vector3d& center() const { return center_; }
  /// Places at which errors are stated: between the central incisors, and the first molars left
  /// and right; by FDI number where teeth are separate, else by the shape of the arch.
  const std::array<Eigen::Vector3d, 3>& marks() const { return marks_; }

 private:
  void find_marks(const Part& teeth, const CrownPoints& crowns);

  bool upper_;
  std::string name_;
  SurfacePairs pairs_;
  Eigen::Vector3d bite_, center_;
  std::array<Eigen::Vector3d, 3> marks_;
};

/// Mean distances of the nearest four fifths of the crowns' points, mm.
inline constexpr double good_fit_mm = 0.25, noted_fit_mm = 0.3, refused_fit_mm = 0.5;
/// Difference of the fits of the halves of an arch above which a look is asked for, mm.
inline constexpr double noted_halves_mm = 0.3;

/// A scan registered to the crowns of a case.
struct ArchFit {
  Pose X_CS;                         // scan in the case
  int points = 0;                    // on the scan's crowns
  double mean_mm = 0;                // of the nearest four fifths
  double median_mm = 0, p95_mm = 0;  // of all points; at most 3 mm
  double left_out = 0;               // fraction of the points that were trimmed or have no partner
  double halves_mm = 0;  // greatest distance, at the marks, of the fits of the left and right
                         // half alone
  std::optional<double> mirrored_mm = {};   // mean_mm of the mirror image, where tested
  std::optional<double> exchanged_mm = {};  // mean_mm on the opposing arch, where this is not good
  double picks_mm = 0;                      // greatest distance of picked points
  std::vector<float> residual_mm = {};      // see crown_distances(); of a scan in a case
};

struct ArchFitRequest {
  Landmarks picks = {};      // on the scan, in its frame; three or more start the fit
  Landmarks landmarks = {};  // of the case, partners of the picks
  const ArchTarget* opposing = nullptr;
  bool mirror_test = true;  // not for the crowns of another person
  int threads = 2;
};

/// Registers a scan to crowns: rigid, never mirrored. Without picks it starts in every attitude
/// about the crowns. throws: InputError for picks without partners or that do not fit.
ArchFit fit_arch(const DentalScan& scan, const ArchTarget& target, const ArchFitRequest& request);

/// Distances of the vertices of a registered scan from the crowns of the case, mm, positive outside
/// them; NaN without a partner: more than 3 mm away, beyond a rim, or facing another direction.
std::vector<float> crown_distances(const DentalScan& scan, const ArchTarget& target,
                                   const Pose& X_CS, int threads);

/// Why the scan must not be used: mirrored, exchanged, or too far off; empty if it may.
std::string refusal(const ArchFit& fit, const DentalScan& scan, const ArchTarget& target,
                    bool accept_residual);

/// What a person should know about a fit, as sentences.
std::vector<std::string> fit_notes(const ArchFit& fit, const DentalScan& scan,
                                   const ArchTarget& target);

}  // namespace condyle
