#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "engine/collide/distance_field.h"
#include "engine/collide/surface_samples.h"
#include "engine/core/progress.h"
#include "engine/math/pose.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// A surface made ready to slide: its distance field and its samples, in its own coordinates.
struct SlideBody {
  DistanceField field;
  SurfaceSamples samples;
};

struct SlideBodySettings {
  FieldSettings field;
  SampleSettings samples;
  std::filesystem::path cache;  // folder for the field; empty: none
};

/// The mesh must be welded. Where the field has a region the samples keep to it too: outside,
/// nothing is ever touched. Throwing from the progress gives up.
SlideBody make_slide_body(const TriMesh& mesh, const SlideBodySettings& settings = {},
                          int threads = 1, const Progress& progress = {});

struct SlideSettings {
  double friction = 0;     // Coulomb coefficient; 0 slides freely
  double slop_mm = 0.02;   // depth that is let be
  int max_contacts = 64;   // that push at once
  double thinning_mm = 1;  // between contacts that join together
  // What a radian costs against a millimetre when the nearest pose is looked for; 0: the moving
  // body's radius of gyration.
  double rotation_length_mm = 0;
  std::optional<Eigen::Vector3d> pivot;  // moving body's coordinates; else its samples' centroid
};

class SlideProbe;

/// One place where the moving body is held.
struct SlideContact {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // fixed body's coordinates
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, from the fixed to the moving body
  double gap_mm = 0;                                  // beyond the one kept; negative: too deep
  double push_mm = 0;                                 // its share in what keeps off the wanted pose
};

struct SlideResult {
  Pose X_FM;                           // moving in fixed
  bool touching = false;               // held by at least one contact
  bool settled = false;                // the nearest pose was found within the tolerance
  double depth_mm = 0;                 // by the fields, beyond the baseline
  std::vector<SlideContact> contacts;  // that hold it
  int steps = 0;
  // The body got there from `from` in steps so short that nothing can lie between: on the way no
  // sample was deeper than one step, a quarter of the band, or where its depth is not known.
  bool reached = false;
};

/// What one slide collected for the next. It saves time where poses are near each other and changes
/// no bit of any answer. A copy starts empty.
class SlideMemory {
 public:
  SlideMemory();
  ~SlideMemory();
  SlideMemory(const SlideMemory&) : SlideMemory() {}
  SlideMemory& operator=(const SlideMemory&) { return *this; }

  struct State;

 private:
  friend class SlidingContact;
  std::unique_ptr<State> state_;
};

/// Two surfaces that stop each other, and the gap that they keep.
struct SlidePair {
  int fixed = 0, moving = 0;  // indices of the surfaces
  double gap_mm = 0;          // 0: they touch; at most half the narrower band of the two
};

/// Sliding contact of a moving body (of several surfaces) on a fixed one.
class SlidingContact {
 public:
  /// Every fixed surface stops every moving one.
  SlidingContact(std::vector<std::shared_ptr<const SlideBody>> fixed,
                 std::vector<std::shared_ptr<const SlideBody>> moving,
                 const SlideSettings& settings = {});

  /// Only these pairs stop each other. throws: std::invalid_argument for an index or a gap out of
  /// range.
  SlidingContact(std::vector<std::shared_ptr<const SlideBody>> fixed,
                 std::vector<std::shared_ptr<const SlideBody>> moving,
                 const std::vector<SlidePair>& pairs, const SlideSettings& settings = {});

  /// Overlap at this pose is allowed from now on: each sample may go as deep as it is there, or as
  /// near where its pair keeps a gap. Samples deeper than the band no longer count. What is allowed
  /// fades as the surfaces of a pair leave that place, and ends `fade_mm` from it.
  void allow_overlap_at(const Pose& rest, double fade_mm = std::numeric_limits<double>::infinity());

  /// Where the surfaces lie in the fixed and in the moving frame from now on; at first they lie in
  /// their own coordinates. Pivot and rotation length stay, and what pairs may overlap goes with
  /// them. throws: std::invalid_argument for another number of surfaces.
  void place(const std::vector<Pose>& X_FS, const std::vector<Pose>& X_MS);

  /// The pose near the wanted one (least squares of the pivot's way and the rotation times its
  /// length) that touches and does not overlap. Without friction it depends on the wanted pose
  /// alone: the body slides to it from where it gets to at the nearest place of a lattice, and
  /// there from a neighbour nearer to freedom, or to rest. The memory keeps these places: without
  /// one each call finds them anew. That answer counts where the body reaches it from `from`
  /// without passing through anything; where it does not, or with friction, the answer is where the
  /// body gets to as it slides from `from`. All motion goes in steps of a quarter of the band. A
  /// start that overlaps is moved out, an answer is its own answer. Poses that are not finite move
  /// nothing and are not settled. Same bits for any number of threads.
  SlideResult slide(const Pose& from, const Pose& wanted, SlideMemory* memory = nullptr,
                    int threads = 1) const;

  /// Deepest overlap beyond the baseline, by the fields; 0 when free.
  double depth(const Pose& X_FM, int threads = 1) const;

  double rotation_length_mm() const { return rotation_length_mm_; }
  const Eigen::Vector3d& pivot() const { return pivot_; }

 private:
  friend class SlideNodes;
  friend class SlideProbe;
  friend class SlideWalk;
  struct Pair {  // samples of one body in the field of the other
    const SlideBody* samples;
    const SlideBody* field;
    bool samples_move = false;
    double gap_mm = 0;
    int fixed = 0, moving = 0;        // surfaces
    Pose X_FS = {}, X_MS = {};        // where they lie
    Pose rest = {};                   // moving surface in the fixed one where overlap is allowed
    bool overlaps = false;            // there
    std::vector<float> allowed = {};  // of each sample there, mm, at most 0; empty: 0

    Pose between(const Pose& X_FM) const { return X_FS.inverse() * X_FM * X_MS; }
    /// Samples in the field's coordinates.
    Pose to_field(const Pose& X_FM) const {
      return samples_move ? between(X_FM) : between(X_FM).inverse();
    }
    const SlideBody& mover() const { return samples_move ? *samples : *field; }
  };

  /// Of what a pair allows, at a pose.
  double allowed_share(const Pair& pair, const Pose& X_FM) const;

  std::vector<std::shared_ptr<const SlideBody>> fixed_, moving_;
  SlideSettings settings_;
  std::vector<Pair> pairs_;
  Eigen::Vector3d pivot_ = Eigen::Vector3d::Zero();
  double rotation_length_mm_ = 1;
  double radius_mm_ = 0;      // of the moving samples about the pivot
  double band_mm_ = 1;        // the narrowest that is left beyond a gap
  std::optional<Pose> rest_;  // where overlap is allowed
  double fade_mm_ = std::numeric_limits<double>::infinity();
  std::uint64_t id_ = 0;  // another one for each model and baseline
};

}  // namespace condyle
