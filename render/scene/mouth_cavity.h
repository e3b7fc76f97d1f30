#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "engine/math/pose.h"
#include "render/face/mouth_lining.h"
#include "render/scene/drawable.h"

namespace condyle {

/// The lining of the mouth, drawn within an opaque face.
class MouthCavity {
 public:
  /// face: the displayed face that the lining was made for. At their rim both have the same
  /// appearance.
  MouthCavity(const MouthLining& lining, const Drawable& face);

  /// The drawable for the current face and mandible.
  Drawable& place(const GpuMesh& face, const Pose& X_CM);
  const GpuMesh& mesh() const { return drawable_->mesh; }
  /// The triangles that would close the face instead.
  std::vector<Eigen::Vector3i> fan() const { return rim_fan(lining_); }

 private:
  MouthLining lining_;
  std::vector<float> lip_;                   // blend factor of the lip for each vertex, 0 to 1
  std::vector<Eigen::Vector3i> beside_rim_;  // the face's triangles there
  Part part_;
  std::optional<Drawable> drawable_;
};

}  // namespace condyle
