#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "engine/math/pose.h"
#include "render/drawable.h"
#include "render/mouth_lining.h"

namespace condyle {

/// The lining of the mouth, to be drawn within an opaque face.
class HollowMouth {
 public:
  /// face: what the lining was made for, as it is drawn. At their rim both look alike.
  HollowMouth(const MouthLining& lining, const Drawable& face);

  /// What is drawn, with face and mandible where they are now.
  Drawable& place(const GpuMesh& face, const Pose& X_CM);
  const GpuMesh& mesh() const { return drawable_->mesh; }
  /// What would close the face in its stead.
  std::vector<Eigen::Vector3i> fan() const { return rim_fan(lining_); }

 private:
  MouthLining lining_;
  std::vector<float> lip_;                   // how much of the lip each vertex still has, 0 to 1
  std::vector<Eigen::Vector3i> beside_rim_;  // the face's triangles there
  Part part_;
  std::optional<Drawable> drawable_;
};

}  // namespace condyle
