#pragma once

#include <cstdint>
#include <vector>

namespace condyle {

/// Diffuse light of skin by the light's cosine (columns, -1 to 1) and the curvature of the surface
/// (rows, 0 to `max_curvature`): light that enters the lit side of a round nose leaves, redder, on
/// its dark side. width x height x RGB, linear, 8 bit.
/// source: Penner, Pre-integrated skin shading, 2011, with the diffusion profile of d'Eon and
/// Luebke, GPU Gems 3, 2007 (sum of six Gaussians, variance in mm^2).
struct SkinTable {
  static constexpr int width = 64, height = 32;
  static constexpr float max_curvature = 0.3f;  // 1/mm
  std::vector<std::uint8_t> rgb;
};

SkinTable make_skin_table();

}  // namespace condyle
