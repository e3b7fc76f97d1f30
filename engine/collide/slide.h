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

/// A surface prepared for contact: its distance field and its samples, in its own coordinates.
struct ContactSurface {
  DistanceField field;
  SurfaceSamples samples;
};

struct ContactSurfaceSettings {
  FieldSettings field;
  SampleSettings samples;
  std::filesystem::path cache;  // folder for the field; empty: none
};

/// The mesh must be welded. Where the field has a region the samples are limited to it as well:
/// there is no contact outside. An exception from the progress callback cancels the work.
ContactSurface make_contact_surface(const TriMesh& mesh,
                                    const ContactSurfaceSettings& settings = {}, int threads = 1,
                                    const Progress& progress = {});

struct SlideSettings {
  double friction = 0;     // Coulomb coefficient; 0 slides freely
  double slop_mm = 0.02;   // tolerated penetration depth
  int max_contacts = 64;   // active at the same time
  double thinning_mm = 1;  // least distance between contacts that are activated together
  // Weight of rotation: a radian counts as this length in the distance between poses; 0: the moving
  // body's radius of gyration.
  double rotation_length_mm = 0;
  std::optional<Eigen::Vector3d> pivot;  // moving body's coordinates; else its samples' centroid
};

class SlideProbe;

/// One contact that constrains the moving body.
struct SlideContact {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // fixed body's coordinates
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, from the fixed to the moving body
  double gap_mm = 0;   // beyond the gap to be kept; negative: overlap
  double push_mm = 0;  // its contribution to the deviation from the target pose
};

struct SlideResult {
  Pose X_FM;                           // moving in fixed
  bool touching = false;               // constrained by at least one contact
  bool settled = false;                // the nearest pose was found within the tolerance
  double depth_mm = 0;                 // measured by the fields, beyond the baseline
  std::vector<SlideContact> contacts;  // active contacts
  int steps = 0;
  // The body moved there from `from` in steps too short to pass through anything: along the path no
  // sample was deeper than one step, a quarter of the band, or at an unknown depth.
  bool reached = false;
};

/// Results of one call that accelerate the next. It saves time where poses are near each other and
/// never changes an answer. A copy starts empty.
class SlideCache {
 public:
  SlideCache();
  ~SlideCache();
  SlideCache(const SlideCache&) : SlideCache() {}
  SlideCache& operator=(const SlideCache&) { return *this; }

  struct State;

 private:
  friend class SlidingContact;
  std::unique_ptr<State> state_;
};

/// Two surfaces in contact with each other, and the gap between them.
struct SlidePair {
  int fixed = 0, moving = 0;    // indices of the surfaces
  double gap_mm = 0;            // 0: they touch; at most half the narrower band of the two
  bool proves_overlap = false;  // both are closed: see surely_overlaps()
};

/// Sliding contact of a moving body (of several surfaces) with a fixed one.
class SlidingContact {
 public:
  /// Every fixed surface is in contact with every moving one.
  SlidingContact(std::vector<std::shared_ptr<const ContactSurface>> fixed,
                 std::vector<std::shared_ptr<const ContactSurface>> moving,
                 const SlideSettings& settings = {});

  /// Only these pairs are in contact. throws: std::invalid_argument for an index or a gap out of
  /// range.
  SlidingContact(std::vector<std::shared_ptr<const ContactSurface>> fixed,
                 std::vector<std::shared_ptr<const ContactSurface>> moving,
                 const std::vector<SlidePair>& pairs, const SlideSettings& settings = {});

  /// Overlap at this pose is allowed from now on: each sample may be as deep as it is there, or as
  /// near where its pair keeps a gap. Samples deeper than the band are ignored. The allowance
  /// decreases as the surfaces of a pair leave that pose, to zero at a distance of `fade_mm`.
  void allow_overlap_at(const Pose& rest, double fade_mm = std::numeric_limits<double>::infinity());

  /// Sets the poses of the surfaces in the fixed and in the moving frame; initially the identity.
  /// Pivot and rotation length are unchanged, and the allowed overlap moves with the surfaces.
  /// throws: std::invalid_argument for another number of surfaces.
  void place(const std::vector<Pose>& X_FS, const std::vector<Pose>& X_MS);

  /// The pose near the target (least squares of the pivot's displacement and the rotation times
  /// its length) without overlap. Without friction it depends on the target pose alone: the body
  /// slides to it from the solution at the nearest node of a lattice of poses, which is itself
  /// reached from a neighbouring node nearer to a free pose, or to rest. The cache keeps these
  /// nodes; without it each call computes them again. That answer is used where the body reaches it
  /// from `from` without passing through anything; otherwise, and with friction, the answer is
  /// where the body arrives as it slides from `from`. All motion is in steps of a quarter of the
  /// band. A start with overlap is moved out; an answer maps to itself. Poses that are not finite
  /// leave the body in place and are not settled. Deterministic: bit-identical for any number of
  /// threads.
  SlideResult slide(const Pose& from, const Pose& target, SlideCache* memory = nullptr,
                    int threads = 1) const;

  /// Whether the fields prove that the surfaces of some pair overlap, among those that may prove it
  /// and do not overlap at rest: a sample is deeper than the error of the field. False: undecided.
  bool surely_overlaps(const Pose& X_FM, SlideCache& memory, int threads = 1) const;

  /// Largest penetration depth beyond the baseline, measured by the fields; 0 when free.
  double depth(const Pose& X_FM, int threads = 1) const;

  double rotation_length_mm() const { return rotation_length_mm_; }
  const Eigen::Vector3d& pivot() const { return pivot_; }

 private:
  friend class SlideLattice;
  friend class SlideProbe;
  friend class SlideWalk;
  struct Pair {  // the samples of one body in the field of the other
    const ContactSurface* samples;
    const ContactSurface* field;
    bool samples_move = false;
    double gap_mm = 0;
    bool proves_overlap = false;
    int fixed = 0, moving = 0;  // surfaces
    Pose X_FS = {}, X_MS = {};  // poses of the surfaces
    Pose rest = {};  // pose of the moving surface in the fixed one at which overlap is allowed
    bool overlaps = false;            // there
    std::vector<float> allowed = {};  // per sample, mm, at most 0; empty: 0

    Pose between(const Pose& X_FM) const { return X_FS.inverse() * X_FM * X_MS; }
    /// Samples in the field's coordinates.
    Pose to_field(const Pose& X_FM) const {
      return samples_move ? between(X_FM) : between(X_FM).inverse();
    }
    const ContactSurface& mover() const { return samples_move ? *samples : *field; }
  };

  /// What the cache keeps of this model.
  SlideCache::State& kept_in(SlideCache& memory, int threads) const;

  /// Fraction of a pair's allowance that remains at a pose.
  double allowed_fraction(const Pair& pair, const Pose& X_FM) const;

  std::vector<std::shared_ptr<const ContactSurface>> fixed_, moving_;
  SlideSettings settings_;
  std::vector<Pair> pairs_;
  Eigen::Vector3d pivot_ = Eigen::Vector3d::Zero();
  double rotation_length_mm_ = 1;
  double radius_mm_ = 0;      // radius of the moving samples about the pivot
  double band_mm_ = 1;        // the narrowest band beyond a gap
  std::optional<Pose> rest_;  // pose at which overlap is allowed
  double fade_mm_ = std::numeric_limits<double>::infinity();
  std::uint64_t id_ = 0;  // unique for each model and baseline
};

}  // namespace condyle
