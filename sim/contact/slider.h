#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "engine/collide/slide.h"
#include "engine/core/progress.h"
#include "sim/contact/contact_state.h"
#include "sim/contact/drive.h"
#include "sim/contact/field_sight.h"

namespace condyle {

/// Sliding of a contact model's bodies on distance fields. The fields are made when they are first
/// needed, near where bones can meet: each surface's within 20 mm of the boxes of the bodies that
/// it can touch, so that they take some 10 MB a bone.
class Slider {
 public:
  /// Keeps copies of the surfaces until the fields are there.
  Slider(const Case& patient, const ContactModel::State& state);

  /// Makes the fields, or reads them from the cache, unless they are there. Throwing from the
  /// progress gives up; the next call starts anew.
  void prepare(const Progress& progress, int threads);

  /// Whether fields see all that the drive may meet: they do not see one wall thinner than their
  /// spacing from another, nor what lay more than 20 mm from the other body's box at rest.
  bool sees(const Drive& drive) const;

  /// By the fields alone, all other bodies where the drive has them. prepare() must have been
  /// called. Same bits whatever was asked before.
  SlideResult slide(const Drive& drive, const Pose& from, const Pose& wanted, int threads) const;

  /// A free pose beside rest of a body that lies deep in others at rest, and may be held there.
  /// None where it does not, or where others have been moved.
  std::optional<Pose> outside(const Drive& drive) const;

  /// What a radian of a drive costs against a millimetre, and the point it turns about.
  double rotation_length_mm(int body) const { return contact(body).rotation_length_mm(); }
  const Eigen::Vector3d& pivot(int body) const { return contact(body).pivot(); }

 private:
  struct Surface {
    int collider = 0;
    TriMesh mesh;
    SlideBodySettings settings;
    std::shared_ptr<const SlideBody> body;
    FieldSight sight;
  };
  /// A driven body among others that lie somewhere, and what it remembers of its last slide there.
  struct Setting {
    int body = 0;
    std::vector<Pose> X_FS, X_MS;
    SlidingContact contact;
    SlideMemory memory;
  };
  std::unique_ptr<Setting> take_setting(const Drive& drive) const;
  void keep_setting(std::unique_ptr<Setting> setting) const;
  const SlidingContact& contact(int body) const {
    return *contacts_[static_cast<std::size_t>(body)];
  }
  std::unique_ptr<SlidingContact> make_contact(int body) const;
  std::optional<Pose> find_outside(int body) const;

  const ContactModel::State& state_;
  std::vector<Surface> surfaces_;                          // in the order of the first colliders
  std::vector<std::unique_ptr<SlidingContact>> contacts_;  // of each driven body
  std::vector<std::optional<Pose>> outside_;               // of each driven body
  std::mutex mutex_;
  bool ready_ = false;
  mutable std::mutex settings_mutex_;
  mutable std::vector<std::unique_ptr<Setting>> settings_;  // that no thread has, the latest last
};

}  // namespace condyle
