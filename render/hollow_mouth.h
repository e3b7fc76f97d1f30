#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "engine/math/pose.h"
#include "render/drawable.h"
#include "render/mouth_lining.h"

namespace condyle {

/// The lining of the mouth, to be drawn where a section opens the face. The parts must outlive it.
class HollowMouth {
 public:
  explicit HollowMouth(std::span<const Part> parts);

  /// False where the face has no rim between the lips: its section is closed there.
  bool known() const { return lining_.has_value(); }
  /// The rest only where it is known. What is drawn, with face and mandible where they are now.
  Drawable& place(const GpuMesh& face, const Pose& X_CM);
  const GpuMesh& mesh() const { return drawable_->mesh; }
  /// What would close the face in its stead.
  std::vector<Eigen::Vector3i> fan() const { return rim_fan(*lining_); }

 private:
  std::optional<MouthLining> lining_;
  Part part_;
  std::optional<Drawable> drawable_;
};

}  // namespace condyle
