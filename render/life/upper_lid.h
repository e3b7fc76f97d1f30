#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "engine/mesh/tri_mesh.h"
#include "render/face/skin_folds.h"
#include "render/life/life_signs.h"

namespace condyle {

/// An eyeball at rest, looking ahead (-y), mm.
struct Eyeball {
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  float radius = 12;
  /// Largest distance of its surface from the centre, by the angle from the gaze in steps of
  /// `step_rad`: the cornea bulges.
  std::vector<float> profile = {};
  static constexpr float step_rad = 0.05f;

  /// Distance of the surface from the centre in a unit direction, for a unit gaze.
  float reach(const Eigen::Vector3f& direction, const Eigen::Vector3f& gaze) const;
};

/// A side of the patient.
enum class FaceSide { left, right };

/// Where the lids of one eye are.
struct LidPose {
  double lowered = 0;  // of the upper one: fraction of the way to the lower one
  float raised = 0;    // of the lower one, rad
};

/// The upper lid of one eye, which slides on the eyeball: it turns about the line between the
/// canthi through the eyeball's centre, so that each point keeps its distance from the latter.
/// The skin between the lid's edge and the fold above it stretches.
class UpperLid {
 public:
  /// rest: vertices of a face that is open at the eye, mm. Null where no opening of more than 10
  /// degrees lies before the eyeball.
  static std::optional<UpperLid> find(std::span<const Eigen::Vector3f> rest,
                                      std::span<const Eigen::Vector3i> triangles,
                                      const Eyeball& eyeball, FaceSide side);

  const Eyeball& eyeball() const { return eyeball_; }

  /// A point seen from the eyeball's centre: mm `along` the axis and `away` from it, and rad `up`
  /// about the axis from straight ahead.
  struct Place {
    double along, away, up;
  };
  /// The opening at one place along the axis, rad, and the distance of its edges from the axis, mm.
  struct Gap {
    double bottom = 0, top = 0, away = 0;
  };
  Place place_of(const Eigen::Vector3d& p) const;
  /// The opening at rest; empty beyond the canthi.
  Gap gap_at(double along) const;
  /// Its largest height, rad.
  double widest() const { return widest_; }
  /// A point that slides on the eyeball by an angle upward, rad, then rises by `off` mm, and does
  /// not enter the eyeball. gaze: unit.
  Eigen::Vector3f slid(const Eigen::Vector3f& p, float angle, const Eigen::Vector3f& gaze,
                       float off = 0) const;
  /// Rotation upward about the axis, rad.
  Eigen::Matrix3f turned(double angle) const;

  /// Fraction of the way to the lower lid by the closure of this side, below 0 above rest. A living
  /// lid follows the gaze, and is lowered a little where it shows all of the iris: the eye would
  /// stare.
  double lowered(const LifeSigns& signs) const;

  /// Moves the lid's vertices by a fraction of the way to the lower lid, from where the face's
  /// expression has both lids; none enters the eyeball. gaze: unit.
  void move(double lowered, const Eigen::Vector3f& gaze, std::span<Eigen::Vector3f> places) const;
  /// Adds the shade of the crease above the tarsus, which a lowered lid has.
  void shade(double lowered, std::vector<SkinFolds::Shade>& shades) const;

 private:
  struct Member {
    int vertex;
    float turn;   // rad, when the lid is closed
    float share;  // of the turn of the lid's edge
    float along;
    float crease, raised;  // depth of the crease of a closed lid, 0 to 1; displacement by it, mm
  };
  /// A vertex beside the edge of a lid, at rest.
  struct EdgeVertex {
    int vertex;
    double along, up;
  };
  UpperLid(const Eyeball& eyeball, FaceSide side) : eyeball_(eyeball), side_(side) {}
  Eigen::Vector3d point_at(const Place& place) const;
  double way_at(double along) const;      // of the edge down to the lower lid, rad
  double spread_way(double along) const;  // the same with that of its neighbours
  void scan(const TriMesh& near);
  void taper();
  bool lean_on_canthi();
  void collect(std::span<const Eigen::Vector3f> rest);
  void collect_edge(int vertex, const Place& at, const Gap& gap);
  std::vector<float> widening(std::span<const Eigen::Vector3f> places) const;

  Eyeball eyeball_;
  FaceSide side_;
  Eigen::Vector3d axis_ = {1, 0, 0}, ahead_ = {0, -1, 0}, up_ = {0, 0, 1};
  std::vector<Gap> gaps_;        // by place along the axis
  double first_ = 0, last_ = 0;  // the canthi, mm along the axis
  double widest_ = 0, staring_ = 0;
  std::vector<Member> members_;
  std::vector<EdgeVertex> upper_edge_, lower_edge_;
};

}  // namespace condyle
