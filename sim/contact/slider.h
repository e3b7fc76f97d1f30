#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "engine/collide/slide.h"
#include "engine/core/progress.h"
#include "sim/contact/constrained_motion.h"
#include "sim/contact/contact_state.h"
#include "sim/contact/field_coverage.h"

namespace condyle {

/// Sliding of a contact model's bodies on distance fields. The fields are computed at first use,
/// near where bones can meet: within 20 mm of the boxes of the bodies that each surface can touch,
/// about 10 MB per bone.
class Slider {
 public:
  /// Keeps copies of the surfaces until the fields exist. `earlier`: its fields of the same
  /// surfaces in the same regions are reused.
  Slider(const Case& patient, const ContactModel::State& state, Slider* earlier = nullptr);

  /// Computes the fields, or reads them from the cache, unless they exist. An exception from
  /// `progress` cancels; the next call starts again.
  void prepare(const Progress& progress, int threads);

  /// Whether the fields cover all that the move may meet: not one wall thinner than their spacing
  /// against another, nor surfaces more than 20 mm from the other body's box at rest.
  bool covers(const BodyMove& move) const;

  /// Whether the fields exist and prove that the body would cross another at the target, which the
  /// two do not at rest. False: undecided.
  bool surely_crosses(const BodyMove& move, int threads) const;

  /// By the fields alone, all other bodies at their poses in the move. prepare() must have been
  /// called. Independent of earlier calls.
  SlideResult slide(const BodyMove& move, const Pose& from, const Pose& target, int threads) const;

  /// A free pose near rest of a body that overlaps deeply at rest, and may be held there. None
  /// without such overlap, or where others have been moved.
  std::optional<Pose> outside(const BodyMove& move) const;

  /// Weight of a radian of a move relative to a millimetre, and its centre of rotation.
  double rotation_length_mm(BodyId body) const { return contact(body).rotation_length_mm(); }
  const Eigen::Vector3d& pivot(BodyId body) const { return contact(body).pivot(); }

 private:
  struct Surface {
    int collider = 0;
    TriMesh mesh;
    ContactSurfaceSettings settings;
    std::shared_ptr<const ContactSurface> body;
    FieldCoverage coverage;
  };
  /// A driven body among others at given poses, with its slide cache.
  struct Setting {
    BodyId body = cranium_body;
    std::vector<Pose> X_FS, X_MS;
    SlidingContact contact;
    SlideCache memory;
  };
  void take_over(Slider& earlier);
  std::unique_ptr<Setting> take_setting(const BodyMove& move) const;
  void keep_setting(std::unique_ptr<Setting> setting) const;
  const SlidingContact& contact(BodyId body) const { return *contacts_[index_of(body)]; }
  std::unique_ptr<SlidingContact> make_contact(BodyId body) const;
  std::optional<Pose> find_outside(BodyId body) const;

  const ContactModel::State& state_;
  std::vector<Surface> surfaces_;                          // in the order of the first colliders
  std::vector<std::unique_ptr<SlidingContact>> contacts_;  // of each driven body
  std::vector<std::optional<Pose>> outside_;               // of each driven body
  std::mutex mutex_;
  std::atomic<bool> ready_ = false;
  mutable std::mutex settings_mutex_;
  // not in use by a thread, the latest last
  mutable std::vector<std::unique_ptr<Setting>> settings_;
};

}  // namespace condyle
