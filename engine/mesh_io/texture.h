#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// A picture mapped onto a surface.
struct Texture {
  TriMesh surface;                       // as in the file, in its unit and axes
  std::vector<Eigen::Vector2f> corners;  // three per triangle: position in the picture, 0 to 1,
                                         // from the left and from the top
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // sRGB, rows from the top
};

/// The colour picture (JPEG or PNG) of a GLB with one surface, within the file, or of an OBJ, by
/// its `mtllib` and `map_Kd` beside it. None where there is no picture, or where nodes are moved.
/// throws: InputError when the picture is damaged or larger than 16384 a side.
std::optional<Texture> read_texture(const std::filesystem::path& file);

/// Gives each vertex the colour of the nearest point of the textured surface, after `to_mesh`.
void paint(TriMesh& mesh, const Texture& texture, const Eigen::Affine3d& to_mesh);

}  // namespace condyle
