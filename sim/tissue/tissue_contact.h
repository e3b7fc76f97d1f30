#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/tissue/mesh_contact.h"
#include "sim/tissue/body_weights.h"
#include "sim/tissue/columns.h"
#include "sim/tissue/skin_fold.h"

namespace condyle {

/// Bone and teeth of a body that the tissue slides on, with the limits of each contact point
/// against it.
struct Obstacle {
  BodyId body;
  std::shared_ptr<const ContactObstacle> surface;
  Box extent;   // of the bone at rest
  Nodes shift;  // one per point, mm: the shortest exit from the bone, where it overlaps at rest
  /// mm, one per point: overlap at rest that is allowed; if negative, a distance that is kept.
  std::vector<double> allowance;
  std::vector<char> near_at_rest;  // of each point
  std::vector<char> front_guided;  // of each point: its normal is limited to the front, see below
};

/// Contact of tissue that is not attached: with bones and teeth, lip on lip, and the skin below the
/// chin on that of the throat.
struct TissueContact {
  std::vector<MeshPoint> points;
  std::vector<Obstacle> obstacles;  // one for each body with bone
  /// For each point of the lips, the direction out of the mouth at rest (unit); 0 for others. Lips
  /// lie in front of the teeth: at edges their normals are limited to this direction, so that no
  /// point is caught behind a tooth, unless it rests there.
  std::vector<Eigen::Vector3d> front;
  std::vector<char> lower_lip;  // of each point: it rotates with the lower lip's body

  /// Its surface: the edge, the skin in front and the inner side behind it.
  struct Lip : Flap {
    BodyId body;                           // the arch that it rotates with
    std::vector<std::array<int, 3>> edge;  // triangles of nodes, from the skin to the inner side
    Eigen::Vector3d facing = Eigen::Vector3d::Zero();  // mean normal of the edge at rest; unit
  };
  Lip upper, lower;
  SkinFold fold;
  int lip_points_left_out = 0;  // too deep in the other lip at rest
  double firmness = 1;  // of contact, over the default: for tissue stiffer than living tissue
};

/// State of the sheet when contact is set up.
struct ContactSource {
  const CoarseSkin& skin;
  const std::vector<Column>& columns;
  const std::vector<signed char>& side;  // of each column: +1 above the lip line
  int sheets = 0;
  const Nodes& rest;
  const std::vector<char>& attached;  // of each node: firmly anchored
  const BodyWeights& weights;         // of each node
  const Pose& wide_open;              // of the lower arch, X_CM
  JawBodies jaw = {};
};
/// Separates the nodes of closed lips where the coarse lips overlap, so that at rest neither is
/// inside the other. Returns the largest displacement, mm. `from.attached`, `weights` and
/// `wide_open` are not used.
double part_closed_lips(const ContactSource& from, Nodes& rest);

/// A body's bone with its teeth.
struct BodySurface {
  BodyId body;
  TriMesh mesh;  // mm, at rest in the cranium's frame; welded
};
/// Distance fields of the surfaces are cached in the user's cache folder.
TissueContact make_contact(const ContactSource& source, std::span<const BodySurface> bones,
                           int threads = 1);

/// A body's surface where the points of the contact may come.
std::shared_ptr<const ContactObstacle> surface_near(const TissueContact& contact, const Nodes& rest,
                                                    const BodySurface& bone, int threads = 1);

/// A body's surface, with the overlap of the points at rest. `shift` of each point: its
/// displacement out of this surface, or none for the shortest. Only `points` and `front` of the
/// contact are used.
Obstacle make_obstacle(const TissueContact& contact, const Nodes& rest, const BodySurface& bone,
                       int threads = 1,
                       const std::vector<std::optional<Eigen::Vector3d>>& shift = {});

/// The same of a piece of a surface that was cut. `of_uncut`: the obstacle of the whole surface.
Obstacle make_piece_obstacle(const TissueContact& contact, const Nodes& rest,
                             const BodySurface& piece, const TriMesh& uncut,
                             const Obstacle& of_uncut, int threads,
                             const std::vector<std::optional<Eigen::Vector3d>>& shift);

/// A surface that is not there at rest: no overlap with it is allowed.
Obstacle make_new_obstacle(const TissueContact& contact, const Nodes& rest, const BodySurface& bone,
                           int threads = 1);

/// Fills the obstacle's values of each point from its surface and the overlap at rest; the rest as
/// in make_obstacle().
void fit_to_rest(const TissueContact& contact, const Nodes& rest,
                 const std::vector<std::optional<Eigen::Vector3d>>& shift, Obstacle& obstacle);

/// Pairs of nodes of both lips that are side by side at rest: see SpringPrismMesh::may_touch.
std::vector<std::array<int, 2>> lip_contact_pairs(const TissueContact& contact, const Nodes& rest);

/// Contacts of the tissue with itself. `find_tissue_contacts` returns the lists of the obstacles
/// first, in their order, then these.
enum SelfContact : std::size_t {
  upper_on_lower,
  lower_on_upper,
  chin_on_throat,
  throat_on_chin,
  self_contacts
};
inline std::size_t contact_lists(const TissueContact& contact) {
  return contact.obstacles.size() + self_contacts;
}

/// Bounds that a search passes on to the next, of each obstacle.
using NearObstacles = std::vector<NearPoints>;

/// All contacts of the tissue at x, with the bodies at X_CB. `firmness`: contact stiffness over the
/// default. Up to 1, contact of soft tissue is softer, by `own_stiffness` of each node (see
/// TissueMesh): frames need fewer iterations. Predictions from rest converge where it is firm.
ContactLists find_tissue_contacts(const TissueContact& contact,
                                  std::span<const double> own_stiffness, std::span<const Pose> X_CB,
                                  const Nodes& x, int threads = 1, NearObstacles* known = nullptr,
                                  double firmness = 1);

/// Overlap and slip of tissue on bones and on itself.
struct ContactMeasure {
  double penetration_mm = 0;  // deepest point in bone, teeth or skin, beyond rest
  double slip_mm = 0;  // largest displacement of a point along the bone that it touched at rest
};
ContactMeasure measure_contact(const TissueContact& contact, const ContactLists& lists,
                               std::span<const Pose> X_CB, const Nodes& rest, const Nodes& x);

/// Deepest overlap that is allowed because it exists at rest, mm.
double overlap_at_rest(const TissueContact& contact);

}  // namespace condyle
