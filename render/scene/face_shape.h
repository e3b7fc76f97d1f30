#pragma once

#include <Eigen/Core>
#include <map>
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
/// Why an expression does not move the lids of the patient, or those of one eye, as a sentence;
/// empty: it moves both.
std::string lids_note(std::span<const Part> parts);

/// Vertices of a mesh.
std::vector<Eigen::Vector3f> float_positions(const TriMesh& mesh);

/// What moves a drawn face besides the simulation.
struct FaceMoment {
  double time_s = 0;
  Pose X_CM = {};        // of the lower jaw
  LidClosure lids = {};  // by the expression
};

/// Shape of the first face of a scene, and of the eyes, as a picture shows it: with folds, the lids
/// that an expression moves, their lashes, and life.
class FaceShape {
 public:
  /// Sets the vertices of the displayed face, without folds and life.
  void place(std::vector<Eigen::Vector3f> places);
  /// Sends what differs from the last picture. drawables: of the parts.
  void send(std::span<const Part> parts, std::span<Drawable> drawables,
            const PictureSettings& settings, const FaceMoment& moment);
  /// Sends the last shape of the eyes of a drawable to another mesh of it. `sent`: the number of
  /// the shape that the mesh has; of a new one 0.
  void send_eyes_again(std::size_t drawable, GpuMesh& mesh, long& sent) const;

 private:
  /// What was sent beside the vertices.
  struct Look {
    bool folds = true;
    std::optional<Life> life = {};
    std::optional<LifeSigns> signs = {};  // none: eyes and lids as the face has them
    bool operator==(const Look&) const = default;
  };
  LivingFace& living(std::span<const Part> parts, const Drawable& face, const Look& look);
  void send_eyes(std::span<Drawable> drawables, const LifeSigns& signs,
                 std::span<const std::vector<Eigen::Vector3f>> lashes);

  std::vector<Eigen::Vector3f> places_;      // empty: at rest
  std::optional<Look> sent_;                 // none: the places were not sent yet
  std::optional<LivingFace> living_;         // from the first picture that needs it on
  std::optional<Eigen::Vector3d> nose_tip_;  // that it was made for
  struct EyesShape {
    std::vector<Eigen::Vector3f> places, normals;
  };
  std::map<std::size_t, EyesShape> eyes_;  // by drawable; of the last picture that moved them
  long eyes_number_ = 0;                   // counts their shapes
  bool eyes_moved_ = false;
  std::vector<Eigen::Vector3f> normals_;  // reused between frames
};

}  // namespace condyle
