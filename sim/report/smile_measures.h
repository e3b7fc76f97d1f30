#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/case/case.h"
#include "sim/tissue/lips.h"

namespace condyle {

/// Triangles of the two lips of a face, near the opening between them.
struct LipSurfaces {
  int right_corner = -1, left_corner = -1;  // vertices
  std::vector<Eigen::Vector3i> upper = {}, lower = {};
};

/// `face` at rest; `mouth`: its opening. The lips reach up to 8 mm from it, along the surface.
LipSurfaces lip_surfaces(const TriMesh& face, const MouthOutline& mouth);

/// Margins of the lips seen from the front: the lowest height of the upper lip and the highest of
/// the lower one, mm along z, at equal steps of x from the right corner of the mouth to the left.
struct LipMargins {
  double right_x = 0, left_x = 0;  // of the corners
  std::vector<double> upper_z, lower_z;

  bool spans(double x) const { return x > right_x && x < left_x; }
  double upper_at(double x) const;  // constant beyond the corners
  double lower_at(double x) const;
};

/// shape: `face` has a vertex for each of the mesh, mm, in the cranium's frame.
LipMargins lip_margins(const LipSurfaces& lips, std::span<const Eigen::Vector3f> face);

/// Show of an upper tooth below the upper lip, at the middle of its edge.
struct ToothShow {
  int fdi = 0;
  double show_mm = 0;  // height of its edge or tip below the lip's margin; negative: covered
  // From the edge to the gum at the middle of the tooth; none without gums.
  std::optional<double> crown_mm = std::nullopt;

  /// Height of the gum below the lip's margin; 0: covered.
  std::optional<double> gum_mm() const;
  /// Part of the crown's height below the lip's margin, 0 to 1.
  std::optional<double> crown_fraction() const;
};

/// Smile line. source: Tjan, Miller and The 1984, by the central incisors: low, less than three
/// quarters of the crown; average, up to the whole crown; high, with a continuous band of gum.
enum class SmileLine { low, average, high };
std::string name_of(SmileLine line);

/// What the lips show of the upper teeth. Empty where the case has none.
struct SmileMeasures {
  std::vector<ToothShow> teeth;  // 15 to 25 from right to left, where teeth are separate
  std::optional<double> incisor_show_mm = {};  // central incisors, else at the upper incisal point
  std::optional<double> gum_show_mm = {}, crown_fraction = {};  // of the central incisors
  std::optional<SmileLine> line = {};
  // Gap between the visible teeth and the corners, both sides, over the mouth's width, seen from
  // the front; none where no tooth is visible. source: Frush and Fisher 1958.
  std::optional<double> buccal_corridor = {};
};

/// Of a patient with the bodies at X_CB, each from rest to now.
SmileMeasures smile_measures(const Case& patient, const LipMargins& lips,
                             std::span<const Pose> X_CB);

}  // namespace condyle
