#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "render/face/throat_section.h"
#include "render/gl/gpu_mesh.h"

namespace condyle {

/// A closed solid that only a section shows, where it cuts the face.
struct SectionSolid {
  GpuMesh mesh;
  Eigen::Vector3f color;     // sRGB, of its cut face
  bool with_tongue = false;  // shown where the tongue is shown
};

/// The soft parts of a ThroatSection as solids, in the cranium's frame.
class SectionAnatomy {
 public:
  explicit SectionAnatomy(std::span<const Part> parts) : throat_(parts) {}

  /// The solids for the present pose of the tongue's body; later ones lie over earlier ones.
  std::span<const SectionSolid> place(const Pose& X_CM);

 private:
  ThroatSection throat_;
  std::vector<SectionSolid> solids_;
};

}  // namespace condyle
