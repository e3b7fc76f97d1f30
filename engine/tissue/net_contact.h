#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <vector>

#include "engine/collide/distance_field.h"
#include "engine/math/pose.h"
#include "engine/mesh/triangle_tree.h"
#include "engine/tissue/near_points.h"
#include "engine/tissue/net_point.h"
#include "engine/tissue/net_surface.h"
#include "engine/tissue/spring_prism.h"

namespace condyle {

/// A body that a net slides on and does not enter, in its own coordinates: a field near its surface
/// within a region, exact triangles where the field says nothing.
class NetObstacle {
 public:
  /// The mesh must be welded, with valid indices. The field is kept in the cache folder, when one
  /// is given.
  NetObstacle(const TriMesh& mesh, const Box& region, const std::filesystem::path& cache,
              int threads = 1);

  struct Near {
    double distance = 0;     // mm, negative inside
    Eigen::Vector3d normal;  // unit, away from the body; near its surface the mean of a patch
  };
  /// Whether p is nearer than `reach` (mm, below 2), and how near. Nothing beyond the region. Where
  /// it is not, it is no nearer than `near.distance`.
  bool near(const Eigen::Vector3d& p, double reach, Near& near) const;
  /// The shortest way out for a point inside, mm; zero outside.
  Eigen::Vector3d way_out(const Eigen::Vector3d& p) const;

 private:
  /// Turns what was found at p to the mean direction there, where something may press.
  void feel_patch(const Eigen::Vector3d& p, Near& near) const;
  /// The mean direction about p, which goes over from place to place without a jump; `own` where
  /// none can be told.
  Eigen::Vector3d patch_normal(const Eigen::Vector3d& p, const Eigen::Vector3d& own) const;

  DistanceField field_;
  TriangleTree surface_;
};

/// A point of the net near something it must not enter.
struct Touch {
  int point = 0;  // of the points given
  /// Distance (mm, negative inside) plus what the point was allowed: the gap of `row` at the nodes'
  /// places. Elsewhere the row's plane stands for the surface, whose nearest point it touches.
  double gap = 0;
  ContactRow row;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // where the point was when the plane was laid
  /// What it pressed with before, as mm of the row's spring: that much it presses at a gap of 0, so
  /// a soft row holds a point out as a hard one would (augmented Lagrangian).
  double push = 0;

  /// What it presses with at x, mm of its spring.
  double pressed(const Nodes& x) const { return std::max(0.0, push - row.gap(x)); }
};

struct TouchSettings {
  double reach_mm = 1.5;   // points farther than this have no row; below 2
  double stiffness = 3.0;  // N/mm: a tenfold of the tissue's own; tissue presses with up to 4 N
};

/// Appends the points that are near the obstacle at pose X_WO. `allowance` (mm, one per point) is
/// how deep each may be: that of overlap at rest; negative where one keeps a distance. `shift`:
/// where each is felt, from where it is, mm in the obstacle's coordinates; one per point, or none.
/// A point deep inside at rest is better felt where its way out ends: from deep inside an edge more
/// than one way leads out. `known`: kept by the caller from look to look, of the same points,
/// obstacle and shifts; or none.
void touch_obstacle(const std::vector<NetPoint>& points, const std::vector<double>& allowance,
                    const NetObstacle& obstacle, const Pose& X_WO, const Nodes& x,
                    const TouchSettings& settings, std::vector<Touch>& touches,
                    const Nodes& shift = {}, NearPoints* known = nullptr);

/// The same against another part of the net's own surface. It may have a rim; what is nearest to a
/// rim from behind counts as inside, so the surface must reach beyond the points. Both sides feel
/// the contact. `facing` (unit, or 0 for none): the surface counts as leaning no farther than 60
/// degrees away from it, so that none that curls up takes for its inside what is beside it.
void touch_surface(const std::vector<NetPoint>& points, const std::vector<double>& allowance,
                   const NetSurface& surface, const Nodes& x, const TouchSettings& settings,
                   std::vector<Touch>& touches,
                   const Eigen::Vector3d& facing = Eigen::Vector3d::Zero());

/// A unit normal, turned toward `front` (unit) until their cosine is at least `least`.
Eigen::Vector3d led(const Eigen::Vector3d& normal, const Eigen::Vector3d& front, double least);

/// Adds each touch's depth to its point's allowance: what overlaps at rest may stay so.
void allow(const std::vector<Touch>& touches, std::vector<double>& allowance);

/// How much the surfaces differ from the planes that stood for them, where anything presses: mm of
/// push. Both are one call's answers for the same points, `used` with planes laid elsewhere, `now`
/// at x. Of several planes of a point the nearest counts.
double plane_error(const std::vector<Touch>& used, const std::vector<Touch>& now, const Nodes& x);

/// `now`, with the forces that `used` presses with at x, and with those planes of it that stood for
/// another face nearby: in a groove a point that saw one side and then the other must obey both, or
/// it goes to and fro for ever. The planes of `now` are turned by `share` (0 to 1) toward those of
/// `used`.
std::vector<Touch> carried_on(const std::vector<Touch>& used, std::vector<Touch> now,
                              const Nodes& x, double share = 0);

/// The touches of an obstacle that has moved on by X.
void move_touches(const Pose& X, std::vector<Touch>& touches);

/// All touches at x: one list for each thing that may be touched.
using Looks = std::vector<std::vector<Touch>>;
void set_contacts(const Looks& looks, NetLoads& loads);

/// A solve in which the planes are laid anew at each answer, until they stand for the surfaces
/// there: then it is a minimum of the energy with the surfaces themselves.
struct TouchingSettings {
  int most_looks = 12;
  double tolerance_mm = 0.03;  // of push, see plane_error
  double gap_mm = 0.03;        // what presses is at most so far from what it presses on
  double rough_mm = 0.1;       // of both, where no more may be spent
};
struct TouchingResult {
  int solves = 0;
  bool settled = false;  // both within the settings
  double error_mm = 0;   // what the planes are still wrong by
  double gap_mm = 0;     // how far what presses is from what it presses on
  Looks looks;           // at the answer; to be carried on to the next solve
};
/// How a call of `solve` ended: at the minimum (or as near as it can come), on the way to it, or
/// where what may be spent is spent: then the answer stands once its touches are within `rough_mm`.
enum class Solved { at_minimum, on_the_way, spent };
/// `solve` moves x downhill under `loads`, whose contacts are set before each call. `before`: the
/// looks of an earlier solve, or nothing.
TouchingResult solve_touching(const std::function<Looks(const Nodes&)>& look,
                              const std::function<Solved()>& solve, NetLoads& loads, Nodes& x,
                              const TouchingSettings& settings = {}, const Looks& before = {});

}  // namespace condyle
