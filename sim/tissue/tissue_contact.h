#pragma once

#include <memory>
#include <vector>

#include "engine/tissue/net_contact.h"
#include "sim/tissue/columns.h"
#include "sim/tissue/skin_fold.h"

namespace condyle {

struct TissueModel;

/// What the tissue slides on where it is not attached: bone and teeth of both jaws, lip on lip, and
/// the skin below the chin on that of the throat.
struct TissueContact {
  /// Points that must not enter a jaw, and one jaw.
  struct Jaw {
    std::shared_ptr<const NetObstacle> obstacle;  // null when there is no such bone
    Nodes shift;  // one per point, mm: out of the bone, where it overlaps at rest
    /// mm, one per point: overlap at rest that is left so; or less than 0, a distance that is kept.
    std::vector<double> allowance;
    std::vector<char> near_at_rest;  // of each point
    std::vector<char> led;           // of each point: to the front, see below
  };
  std::vector<NetPoint> points;
  Jaw cranium, mandible;
  /// Of each point of the lips, the way out of the mouth at rest (unit); 0 for others. Lips belong
  /// before the teeth: on edges they are led that way, so that none is caught behind, unless it
  /// rests there.
  std::vector<Eigen::Vector3d> front;
  std::vector<char> lower_lip;  // of each point: it turns with the mandible

  /// Its surface: the edge, the skin before and the inner side behind it.
  struct Lip : Flap {
    std::vector<std::array<int, 3>> edge;  // triangles of nodes, from the skin to the inner side
    Eigen::Vector3d facing = Eigen::Vector3d::Zero();  // the edge's mean way at rest; unit
  };
  Lip upper, lower;
  SkinFold fold;
  int lip_points_left_out = 0;  // too deep in the other lip at rest
  double firmness = 1;          // over the usual: of tissue that is firmer than living
};

/// What is known of the sheet when contact is set up.
struct ContactSource {
  const CoarseSkin& skin;
  const std::vector<Column>& columns;
  const std::vector<signed char>& side;  // of each column: +1 above the lip line
  int sheets = 0;
  const Nodes& rest;
  const std::vector<char>& held;     // of each node: anchored firmly
  const std::vector<double>& share;  // of each node, of the mandible's way
  const Pose& wide_open;             // X_CM
};
/// Moves the nodes of closed lips apart where the coarse lips overlap, so that at rest neither is
/// inside the other. Gives the farthest way, mm. `from.held`, `share` and `wide_open` are not used.
double part_closed_lips(const ContactSource& from, Nodes& rest);

/// Cranium and mandible with teeth, merged. Fields are kept in the cache of the user.
TissueContact make_contact(const ContactSource& source, const TriMesh& cranium,
                           const TriMesh& mandible, int threads = 1);

/// Nodes of both lips that lie side by side at rest: see SpringPrismNet::may_touch.
std::vector<std::array<int, 2>> lips_that_may_touch(const TissueContact& contact,
                                                    const Nodes& rest);

/// Order of the lists in what `look_at` returns.
enum ContactList : std::size_t {
  on_cranium,
  on_mandible,
  upper_on_lower,
  lower_on_upper,
  chin_on_throat,
  throat_on_chin,
  contact_lists
};

/// What looks at one pose of the mandible learn for the next ones.
struct NearJaws {
  NearPoints cranium, mandible;
};

/// Everything the tissue touches at x, with the mandible at X_CM. `firmness`: over the usual.
Looks look_at(const TissueContact& contact, const Pose& X_CM, const Nodes& x, int threads = 1,
              NearJaws* known = nullptr, double firmness = 1);

/// How tissue lies on the jaws and on itself.
struct ContactMeasure {
  double penetration_mm = 0;   // deepest point in bone, teeth or skin, beyond rest
  double slip_mm = 0;          // farthest way of a point along the jaw that it lay on at rest
  double rest_overlap_mm = 0;  // deepest that a point was allowed from the start
};
ContactMeasure measure_contact(const TissueContact& contact, const Looks& looks, const Pose& X_CM,
                               const Nodes& rest, const Nodes& x);

}  // namespace condyle
