#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/life/living_face.h"
#include "render/scene/drawable.h"

namespace condyle {

struct PictureSettings;

/// An opacity above it counts as opaque.
inline constexpr double nearly_opaque = 0.999;

/// Whether a picture of the parts shows life: with an opaque, uncut face.
bool shows_life(std::span<const Part> parts, const PictureSettings& settings);
/// For a report of pictures with life switched on: that it is for looks alone, and what of it is
/// not shown.
std::string life_note(std::span<const Part> parts, const PictureSettings& settings);

/// Vertices of a mesh.
std::vector<Eigen::Vector3f> float_positions(const TriMesh& mesh);

/// Shape of the first face of a scene, and of the eyes, as a picture shows it: with folds and life.
class FaceShape {
 public:
  /// Sets the vertices of the displayed face, without folds and life.
  void place(std::vector<Eigen::Vector3f> places);
  /// Sends what differs from the last picture. drawables: of the parts. X_CM: pose of the lower
  /// jaw.
  void send(std::span<const Part> parts, std::span<Drawable> drawables,
            const PictureSettings& settings, double time_s, const Pose& X_CM);

 private:
  /// What was sent beside the vertices.
  struct Look {
    bool folds = true;
    std::optional<Life> life = {};
    LifeSigns signs = {};
    bool operator==(const Look&) const = default;
  };
  void send_eyes(std::span<Drawable> drawables, const LifeSigns* signs);

  std::vector<Eigen::Vector3f> places_;      // empty: at rest
  std::optional<Look> sent_;                 // none: the places were not sent yet
  std::optional<LivingFace> living_;         // from the first picture with life on
  std::optional<Eigen::Vector3d> nose_tip_;  // that it was made for
  bool eyes_moved_ = false;
  std::vector<Eigen::Vector3f> normals_;  // reused between frames
};

}  // namespace condyle
