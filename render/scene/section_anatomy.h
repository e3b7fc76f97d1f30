#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "render/gl/gpu_mesh.h"
#include "sim/frame/part.h"

namespace condyle {

/// A closed solid that only a section shows, where it cuts the face.
struct SectionSolid {
  GpuMesh mesh;              // at rest
  Eigen::Vector3f color;     // sRGB, of its cut face
  bool with_tongue = false;  // moves with it; else with the cranium
};

/// Schematic soft parts inside a face that has a tongue: airway from the choanae to the trachea,
/// soft palate, epiglottis, root of the tongue, hyoid. Placed and scaled by the box of the tongue;
/// none without one. Later ones lie over earlier ones.
/// source: proportions of a median section, Gray's Anatomy, 41st ed.
std::vector<SectionSolid> section_solids(std::span<const Part> parts);

}  // namespace condyle
