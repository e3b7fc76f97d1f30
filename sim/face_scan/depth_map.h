#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// What a laser or structured-light scanner gives: a depth for each pixel, and a colour map. The
/// scanner's frame has the axes of LPS: -y is where the face looks, +z up; mm.
///
/// Cylinder: columns run about the z axis, the depth is the distance from it: x = r sin(a),
/// y = -r cos(a). Plane: the depth is towards the scanner, y = -depth. In both the rows run down,
/// and the middle of the map is at z = 0 (and x = 0).
struct FaceDepthMap {
  enum class Kind { cylinder, plane };

  Kind kind = Kind::cylinder;
  int width = 0, height = 0;
  std::vector<float> depth_mm;  // width x height, rows from the top; NaN: nothing was measured
  // Cylinder: angles of the left and the right border, and the height of the map.
  double angle_from_deg = -180, angle_to_deg = 180, height_mm = 300;
  double pixel_mm = 0.5;  // plane

  int colour_width = 0, colour_height = 0;
  std::vector<std::uint8_t> rgb;  // sRGB, rows from the top; empty: no colours

  float depth(int column, int row) const {
    return depth_mm[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(column)];
  }
  /// The last column neighbours the first.
  bool is_full_turn() const;
  double angle(double column) const;    // rad
  double row_height(double row) const;  // z, mm
  /// Place of a depth at a pixel; pixels are counted from the middle of the first one.
  Eigen::Vector3d place(double column, double row, double depth) const;
  /// Unit, from the place towards the scanner.
  Eigen::Vector3d towards_scanner(double column) const;
};

/// What was changed to make a surface of a depth map.
struct DepthMapRepair {
  int spikes = 0;           // samples dropped
  int holes = 0;            // filled
  int filled_samples = 0;   // in them
  int steep_triangles = 0;  // dropped, and those across a step in depth
};

/// The surface with the colours of the map. A sample that deviates by more than 3 mm from the
/// median of its 5 x 5 neighbours is dropped; holes up to 15 mm across are filled; triangles that
/// are longer than four pixels or steeper than 80 degrees to their ray are left out. Welded; empty
/// where the map holds no triangle.
TriMesh surface_of(FaceDepthMap map, DepthMapRepair& repair);

}  // namespace condyle
