#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <vector>

#include "engine/collide/distance_field.h"
#include "engine/core/made_once.h"
#include "engine/math/pose.h"
#include "engine/mesh/triangle_tree.h"
#include "engine/tissue/mesh_point.h"
#include "engine/tissue/mesh_surface.h"
#include "engine/tissue/near_points.h"
#include "engine/tissue/spring_prism.h"

namespace condyle {

/// A body that the mesh slides on and must not penetrate, in its own coordinates: a distance field
/// near its surface within a region, exact triangle queries where the field is unknown. Queries are
/// thread-safe; the tree for the exact ones is made for the first of them.
class ContactObstacle {
 public:
  /// The mesh must be welded, with valid indices. The field is cached in the folder `cache`, where
  /// given.
  ContactObstacle(const TriMesh& mesh, const Box& region, const std::filesystem::path& cache,
                  int threads = 1);

  /// The same of a piece of the mesh of another obstacle that was cut, computed faster.
  ContactObstacle(const TriMesh& piece, const TriMesh& uncut, const ContactObstacle& of_uncut,
                  const std::filesystem::path& cache, int threads = 1);

  struct Near {
    double distance = 0;     // mm, negative inside
    Eigen::Vector3d normal;  // unit, out of the body; near its surface averaged over a patch
  };
  /// Whether p is nearer than `reach` (mm, below 2), with distance and normal. Always false beyond
  /// the region. Where false, `near.distance` is a lower bound of the distance.
  bool near(const Eigen::Vector3d& p, double reach, Near& near) const;
  /// The shortest displacement out of the body for a point inside, mm; zero outside.
  Eigen::Vector3d exit_displacement(const Eigen::Vector3d& p) const;
  /// Memory that it holds with the tree, which is made where it is missing.
  std::size_t bytes() const { return field_.memory_bytes() + surface_.get().bytes(); }

 private:
  /// Length of the field's gradient about p, by central differences: 1 before a smooth surface,
  /// less between two. Continuous where the field is known around p, else 0.
  double gradient_length(const Eigen::Vector3d& p) const;
  /// Replaces the normal at p by the patch average where contact forces can occur.
  void apply_patch_normal(const Eigen::Vector3d& p, Near& near) const;
  /// The mean direction around p, a continuous function of p; `own` where it is undefined.
  Eigen::Vector3d patch_normal(const Eigen::Vector3d& p, const Eigen::Vector3d& own) const;

  DistanceField field_;
  MadeOnce<TriangleTree, TriMesh> surface_;  // few points need it, and some paths none
};

/// A point of the mesh near a surface that it must not penetrate.
struct PointContact {
  int point = 0;  // index in the list of points
  /// Distance (mm, negative inside) plus the allowance of the point: the gap of `spring` at the
  /// present nodes. For other nodes the tangent plane at the nearest surface point approximates the
  /// surface.
  double gap = 0;
  ContactSpring spring;
  Eigen::Vector3d at =
      Eigen::Vector3d::Zero();  // position of the point when the plane was computed
  /// Multiplier of the augmented Lagrangian method, as mm of the spring: the force at zero gap.
  /// With it a compliant spring enforces the contact as a stiff one would.
  double push = 0;
  /// Rate of the gap over that of the plane: at a sharp edge the distance changes faster than along
  /// the averaged normal. `spring` then has the gap divided by it.
  double steepness = 1;

  /// Contact force at x, mm of its spring.
  double pressed(const Nodes& x) const { return std::max(0.0, push - spring.gap(x)); }
};

struct PointContactSettings {
  double reach_mm = 1.5;   // points farther away have no contact; below 2
  double stiffness = 3.0;  // N/mm: ten times the tissue's own stiffness; contact forces reach 4 N
};

/// Appends the contacts of points near the obstacle at pose X_WO. `allowance` (mm, one per point):
/// allowed depth, from overlap at rest; negative where a distance is kept. `shift` (mm, obstacle
/// coordinates; one per point, or none): offset from a point to the location at which it is tested.
/// A point deep inside at rest is tested at the surface instead, because from deep inside an edge
/// the exit direction is ambiguous. `known`: bounds kept by the caller between searches with the
/// same points, obstacle and shifts; or none.
void find_obstacle_contacts(const std::vector<MeshPoint>& points,
                            const std::vector<double>& allowance, const ContactObstacle& obstacle,
                            const Pose& X_WO, const Nodes& x, const PointContactSettings& settings,
                            std::vector<PointContact>& contacts, const Nodes& shift = {},
                            NearPoints* known = nullptr);

/// The same for contact with another part of the mesh's own surface. The surface may have a rim;
/// points behind a rim count as inside, so the surface must extend beyond the points. The contact
/// acts on both sides. `facing` (unit, or 0 for none): normals are limited to 60 degrees from it,
/// so that a surface that curls up does not treat points beside it as inside.
void find_surface_contacts(const std::vector<MeshPoint>& points,
                           const std::vector<double>& allowance, const MeshSurface& surface,
                           const Nodes& x, const PointContactSettings& settings,
                           std::vector<PointContact>& contacts,
                           const Eigen::Vector3d& facing = Eigen::Vector3d::Zero());

/// A unit normal, rotated towards `front` (unit) until the cosine between them is at least `least`.
Eigen::Vector3d limit_angle(const Eigen::Vector3d& normal, const Eigen::Vector3d& front,
                            double least);

/// Adds the depth of each contact to the allowance of its point: overlap at rest is allowed.
void allow_depths(const std::vector<PointContact>& contacts, std::vector<double>& allowance);

/// Error of the tangent planes where contact forces act, as mm of spring force. `used`: contacts
/// with planes computed at an earlier state; `now`: contacts of the same points at x. Of several
/// planes of a point the nearest counts.
double plane_error(const std::vector<PointContact>& used, const std::vector<PointContact>& now,
                   const Nodes& x);

/// `now` with the contact forces of `used` at x as multipliers, and with those planes of `used`
/// that represent another face nearby: in a groove a point must satisfy the planes of both sides,
/// or it would oscillate. The planes of `now` are rotated by `fraction` (0 to 1) towards those of
/// `used`. `relaxed`: contacts at edges converge where they would oscillate: planes that differ by
/// up to 45 degrees count as one curved face, and rotated planes get their steepness. `steepened`:
/// only those whose gap changes sign between searches get it, and keep it.
std::vector<PointContact> with_history(const std::vector<PointContact>& used,
                                       std::vector<PointContact> now, const Nodes& x,
                                       double fraction = 0, bool relaxed = false,
                                       bool steepened = false);

/// Moves contacts with their obstacle by X.
void move_contacts(const Pose& X, std::vector<PointContact>& contacts);

/// All contacts at x: one list per obstacle or surface.
using ContactLists = std::vector<std::vector<PointContact>>;
void set_contacts(const ContactLists& lists, MeshLoads& loads);

/// Repeated solution with tangent planes updated at each result, until the planes agree with the
/// surfaces there: the result is then a minimum of the energy with the surfaces themselves.
struct ContactSolveSettings {
  int max_contact_searches = 12;
  double tolerance_mm = 0.03;  // of spring force, see plane_error
  double gap_mm = 0.03;        // largest distance between a pressed point and its surface
  double rough_mm = 0.1;       // both tolerances once the budget is spent
  bool relaxed = false;        // see with_history()
  bool damped = false;         // planes are rotated towards earlier ones from the first search on
};
struct ContactSolveResult {
  int solves = 0;
  bool settled = false;   // both errors are within the settings
  double error_mm = 0;    // remaining error of the planes
  double gap_mm = 0;      // remaining distance of pressed points from their surfaces
  ContactLists contacts;  // at the result; initial values of the next solve
};
/// Result of a call of `solve`: at the minimum (or as near as possible), in progress, or with the
/// budget spent; the result is then accepted once its contacts are within `rough_mm`.
enum class Solved { at_minimum, in_progress, budget_spent };
/// `solve` moves x downhill under `loads`, whose contacts are set before each call; its argument is
/// true where the last search left contacts within their tolerances. `before`: the contacts of an
/// earlier solve, or empty.
ContactSolveResult solve_contact(const std::function<ContactLists(const Nodes&)>& query,
                                 const std::function<Solved(bool contacts_settled)>& solve,
                                 MeshLoads& loads, Nodes& x,
                                 const ContactSolveSettings& settings = {},
                                 const ContactLists& before = {});

}  // namespace condyle
