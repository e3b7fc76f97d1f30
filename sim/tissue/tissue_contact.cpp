#include "sim/tissue/tissue_contact.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "engine/core/parallel.h"
#include "engine/core/user_cache.h"
#include "engine/mesh/measure.h"
#include "engine/tissue/layered_mesh.h"
#include "engine/tissue/own_stiffness.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Triangle = std::array<int, 3>;

/// Between nodes 5 mm and more apart, bones and teeth would penetrate the flat faces by up to 2 mm:
/// there additional points may touch them, with this spacing, and keep the distance that they have
/// at rest.
constexpr double near_mm = 1.5;  // near the mouth, where teeth have edges
constexpr double far_mm = 2;
constexpr double min_gap_mm = 0.25;
constexpr double slack_mm = 0.1;  // so that little presses at rest when it is perturbed
constexpr double near_mouth_mm = 18;
constexpr double teeth_lip_edge_mm = 7;  // of the points that may touch teeth from the front
constexpr double led_mm = 14;            // of the points that are guided in front of the teeth
constexpr double whole_mm = 7;           // of the lip that the other one can touch
constexpr double corner_mm = 5;          // nearer to a corner both lips merge
constexpr double deepest_lip_mm = 0.4;
constexpr double apart_mm = 0.02;       // between the lips after their nodes have been moved apart
constexpr double lips_stiffness = 0.5;  // N/mm; lips are compliant to each other
constexpr double skin_stiffness = 1;    // N/mm; the value that needs the fewest iterations
/// Contact is at most this many times as stiff as the tissue by itself. Frames of an opening with a
/// smile, 2,140 nodes, take 45 iterations (95th percentile 140); 69 (342) without a limit, 48 (145)
/// with 5, 52 (187) with 8.
constexpr double over_own_stiffness = 6;
constexpr double swept_mm = 10;  // farthest that points move from their rest relative to a bone

/// Columns along one lip's edge, from the right corner to the left, both included.
std::vector<int> lip_edge(const ContactSource& from, int side) {
  std::vector<int> run = side > 0 ? from.skin.mouth.upper : from.skin.mouth.lower;
  run.insert(run.begin(), from.skin.mouth.right_corner);
  run.push_back(from.skin.mouth.left_corner);
  return run;
}

/// The surface of the lip that touches the other lip: from the skin's edge inward.
std::vector<Triangle> edge_faces(const ContactSource& from, int side) {
  std::map<std::pair<int, int>, int> edges;  // directed edges of the skin
  for (const auto& t : from.skin.mesh.triangles)
    for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  std::vector<Triangle> surface;
  const auto node = [&](int column, int sheet) { return node_of(column, sheet, from.sheets); };
  const auto wall = [&](int a, int b) {  // the skin's border runs from a to b
    for (int s = 0; s + 1 < from.sheets; ++s) {
      surface.push_back({node(a, s), node(a, s + 1), node(b, s + 1)});
      surface.push_back({node(a, s), node(b, s + 1), node(b, s)});
    }
  };
  const std::vector<int> run = lip_edge(from, side);
  for (std::size_t i = 0; i + 1 < run.size(); ++i) {
    if (edges.count({run[i], run[i + 1]}) > 0) wall(run[i], run[i + 1]);
    if (edges.count({run[i + 1], run[i]}) > 0) wall(run[i + 1], run[i]);
  }
  return surface;
}

/// The lip's edge with its surroundings: alone it would classify points in front of it as inside.
std::vector<Triangle> whole_lip(const ContactSource& from, int side, std::vector<Triangle> edge) {
  const int inner = from.sheets - 1;
  const auto node = [&](int column, int sheet) { return node_of(column, sheet, from.sheets); };
  for (const auto& t : from.skin.mesh.triangles) {
    if (!std::all_of(t.begin(), t.end(), [&](int c) {
          return from.side[c] * side > 0 && from.columns[c].to_mouth < whole_mm;
        }))
      continue;
    edge.push_back({node(t[0], 0), node(t[1], 0), node(t[2], 0)});
    edge.push_back({node(t[0], inner), node(t[2], inner), node(t[1], inner)});
  }
  return edge;
}

TissueContact::Lip make_lip(const ContactSource& from, int side) {
  TissueContact::Lip lip;
  lip.body = side > 0 ? from.jaw.upper_arch : from.jaw.lower_arch;
  if (!from.skin.mouth.found()) return lip;
  lip.edge = edge_faces(from, side);
  for (const auto& [a, b, c] : lip.edge)
    lip.facing += (from.rest[b] - from.rest[a]).cross(from.rest[c] - from.rest[a]);
  lip.facing.normalize();
  lip.surface = MeshSurface(whole_lip(from, side, lip.edge), from.rest);
  const auto& vertices = from.skin.mesh.vertices;
  for (int c : lip_edge(from, side)) {
    const auto to = [&](int corner) { return (vertices[c] - vertices[corner]).norm(); };
    if (std::min(to(from.skin.mouth.right_corner), to(from.skin.mouth.left_corner)) < corner_mm)
      continue;
    for (int s = 0; s < from.sheets; ++s)
      lip.points.push_back(MeshPoint::of_node(node_of(c, s, from.sheets)));
  }
  lip.allowance.assign(lip.points.size(), 0.0);
  return lip;
}

/// Removes points so deep in the other lip at rest that no exit direction is defined. Returns how
/// many.
int leave_out_deep(const std::vector<PointContact>& touches, TissueContact::Lip& lip) {
  std::vector<char> deep(lip.points.size(), 0);
  for (const auto& touch : touches) deep[touch.point] = touch.gap < -deepest_lip_mm;
  std::vector<MeshPoint> kept;
  for (std::size_t i = 0; i < lip.points.size(); ++i)
    if (!deep[i]) kept.push_back(lip.points[i]);
  const int gone = static_cast<int>(lip.points.size() - kept.size());
  lip.points = std::move(kept);
  lip.allowance.assign(lip.points.size(), 0.0);
  return gone;
}

/// Displacements of the two ends of each column, outer and inner; it remains straight between them.
struct ColumnShifts {
  Nodes sum;
  std::vector<double> weight;
  explicit ColumnShifts(std::size_t columns)
      : sum(2 * columns, Vector3d::Zero()), weight(2 * columns, 0.0) {}

  void add(std::size_t column, double fraction, const Vector3d& shift) {
    sum[2 * column] += (1 - fraction) * shift;
    weight[2 * column] += 1 - fraction;
    sum[2 * column + 1] += fraction * shift;
    weight[2 * column + 1] += fraction;
  }
  Vector3d shift(std::size_t column, double fraction) const {
    const auto end = [&](std::size_t i) {
      return weight[i] > 0 ? Vector3d(sum[i] / weight[i]) : Vector3d(Vector3d::Zero());
    };
    return (1 - fraction) * end(2 * column) + fraction * end(2 * column + 1);
  }
  void stop(std::size_t column) { weight[2 * column] = weight[2 * column + 1] = 0; }
};

/// Cosine between the contact normal of a guided point and its front direction.
constexpr double min_front_cos = 0.5;

/// Where the edges of the teeth would push a lip's point in either direction, its normal is limited
/// to the front.
void guide_lips(const TissueContact& contact, const Obstacle& obstacle, std::span<const Pose> X_CB,
                const Nodes& x, std::vector<PointContact>& touches) {
  const Pose X_CU = pose_in(X_CB, contact.upper.body), X_CL = pose_in(X_CB, contact.lower.body);
  for (auto& touch : touches) {
    if (!obstacle.front_guided[touch.point]) continue;
    const Vector3d front =
        (contact.lower_lip[touch.point] ? X_CL : X_CU).R * contact.front[touch.point];
    if (touch.spring.normal.dot(front) >= min_front_cos) continue;
    touch.spring.normal = limit_angle(touch.spring.normal, front, min_front_cos);
    touch.spring.offset = touch.spring.along(x) - touch.gap;
  }
}

/// A body's surface near the points, without their values.
Obstacle obstacle_of(const TissueContact& contact, const Nodes& rest, const BodySurface& bone,
                     int threads) {
  Obstacle made;
  made.body = bone.body;
  made.extent = bounding_box(bone.mesh);
  made.surface = surface_near(contact, rest, bone, threads);
  return made;
}

}  // namespace

std::shared_ptr<const ContactObstacle> surface_near(const TissueContact& contact, const Nodes& rest,
                                                    const BodySurface& bone, int threads) {
  Box region;
  for (const auto& point : contact.points) region.add(point.at(rest));
  region.low.array() -= swept_mm;
  region.high.array() += swept_mm;
  return std::make_shared<const ContactObstacle>(bone.mesh, region, user_cache_folder(), threads);
}

void fit_to_rest(const TissueContact& contact, const Nodes& rest,
                 const std::vector<std::optional<Vector3d>>& shift, Obstacle& obstacle) {
  const std::size_t count = contact.points.size();
  obstacle.allowance.assign(count, 0.0);
  obstacle.near_at_rest.assign(count, 0);
  std::vector<PointContact> touches;
  find_obstacle_contacts(contact.points, obstacle.allowance, *obstacle.surface, Pose{}, rest, {},
                         touches);
  obstacle.shift.assign(count, Vector3d::Zero());
  obstacle.front_guided.resize(count);
  for (std::size_t i = 0; i < count; ++i) obstacle.front_guided[i] = !contact.front[i].isZero();
  for (const auto& touch : touches) {
    const auto i = static_cast<std::size_t>(touch.point);
    // A point that rests under a tooth's edge would not return there.
    if (touch.spring.normal.dot(contact.front[i]) < min_front_cos) obstacle.front_guided[i] = 0;
    obstacle.near_at_rest[i] = 1;
    if (touch.gap < 0)
      obstacle.shift[i] =
          !shift.empty() && shift[i] ? *shift[i] : obstacle.surface->exit_displacement(touch.at);
  }
  touches.clear();
  find_obstacle_contacts(contact.points, obstacle.allowance, *obstacle.surface, Pose{}, rest, {},
                         touches, obstacle.shift);
  allow_depths(touches, obstacle.allowance);
  std::vector<double> min_gap(count, min_gap_mm);
  for (const auto& touch : touches)
    min_gap[touch.point] = std::clamp(touch.gap - slack_mm, 0.0, min_gap_mm);
  for (std::size_t i = 0; i < count; ++i)
    if (contact.points[i].count > 1) obstacle.allowance[i] -= min_gap[i];
}

Obstacle make_obstacle(const TissueContact& contact, const Nodes& rest, const BodySurface& bone,
                       int threads, const std::vector<std::optional<Vector3d>>& shift) {
  Obstacle made = obstacle_of(contact, rest, bone, threads);
  fit_to_rest(contact, rest, shift, made);
  return made;
}

Obstacle make_piece_obstacle(const TissueContact& contact, const Nodes& rest,
                             const BodySurface& piece, const TriMesh& uncut,
                             const Obstacle& of_uncut, int threads,
                             const std::vector<std::optional<Vector3d>>& shift) {
  Obstacle made;
  made.body = piece.body;
  made.extent = bounding_box(piece.mesh);
  made.surface = std::make_shared<ContactObstacle>(piece.mesh, uncut, *of_uncut.surface,
                                                   user_cache_folder(), threads);
  fit_to_rest(contact, rest, shift, made);
  return made;
}

Obstacle make_new_obstacle(const TissueContact& contact, const Nodes& rest, const BodySurface& bone,
                           int threads) {
  Obstacle made = obstacle_of(contact, rest, bone, threads);
  const std::size_t count = contact.points.size();
  made.shift.assign(count, Vector3d::Zero());
  made.allowance.assign(count, 0.0);
  made.near_at_rest.assign(count, 0);
  made.front_guided.assign(count, 0);
  for (std::size_t i = 0; i < count; ++i)
    if (contact.points[i].count > 1) made.allowance[i] = -min_gap_mm;
  return made;
}

double part_closed_lips(const ContactSource& from, Nodes& rest) {
  constexpr int max_rounds = 60;
  constexpr double min_fraction = 0.4;  // of a prism's volume that must remain
  const TissueContact::Lip upper = make_lip(from, +1), lower = make_lip(from, -1);
  const MeshSurface upper_edge(upper.edge, rest), lower_edge(lower.edge, rest);
  const Nodes before = rest;
  const auto fraction = [&](int node) {
    const int outer = node - node % from.sheets, inner = outer + from.sheets - 1;
    return (before[node] - before[outer]).norm() / (before[inner] - before[outer]).norm();
  };
  const auto sound = [&](const Eigen::Vector3i& t) {
    for (int s = 0; s + 1 < from.sheets; ++s) {
      std::array<int, 6> prism;
      for (int k = 0; k < 3; ++k) {
        prism[k] = node_of(t[k], s, from.sheets);
        prism[k + 3] = node_of(t[k], s + 1, from.sheets);
      }
      if (prism_volume(rest, prism) < min_fraction * prism_volume(before, prism)) return false;
    }
    return true;
  };
  for (int round = 0; round < max_rounds; ++round) {
    std::vector<PointContact> touches;
    find_surface_contacts(upper.points, upper.allowance, lower_edge, rest, {}, touches);
    find_surface_contacts(lower.points, lower.allowance, upper_edge, rest, {}, touches);
    ColumnShifts shifts(from.columns.size());
    bool any = false;
    for (const auto& touch : touches) {
      if (touch.gap >= 0) continue;
      any = true;
      const ContactSpring& row = touch.spring;
      double square = 0;
      for (int k = 0; k < row.count; ++k) square += row.weight[k] * row.weight[k];
      for (int k = 0; k < row.count; ++k)
        shifts.add(row.node[k] / from.sheets, fraction(row.node[k]),
                   (apart_mm - touch.gap) * row.weight[k] / square * row.normal);
    }
    if (!any) break;
    const Nodes last = rest;
    const auto move = [&](int column) {
      for (int s = 0; s < from.sheets; ++s) {
        const int node = node_of(column, s, from.sheets);
        rest[node] = last[node] + shifts.shift(column, fraction(node));
      }
    };
    for (std::size_t c = 0; c < from.columns.size(); ++c) move(static_cast<int>(c));
    for (const auto& t : from.skin.mesh.triangles)
      if (!sound(t))
        for (int column : t) {
          shifts.stop(column);
          move(column);
        }
  }
  double farthest = 0;
  for (std::size_t n = 0; n < rest.size(); ++n)
    farthest = std::max(farthest, (rest[n] - before[n]).norm());
  return farthest;
}

std::vector<std::array<int, 2>> lip_contact_pairs(const TissueContact& contact, const Nodes& rest) {
  constexpr double beside_mm = 6;
  std::vector<std::array<int, 2>> pairs;
  const auto add = [&](const TissueContact::Lip& lip, const TissueContact::Lip& other) {
    for (const auto& point : lip.points)
      for (const auto& triangle : other.edge)
        for (int node : triangle)
          if ((rest[point.node[0]] - rest[node]).norm() < beside_mm)
            pairs.push_back({point.node[0], node});
  };
  add(contact.upper, contact.lower);
  add(contact.lower, contact.upper);
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

TissueContact make_contact(const ContactSource& from, std::span<const BodySurface> bones,
                           int threads) {
  TissueContact contact;
  const int last = from.sheets - 1;
  const auto free = [&](int node) { return !from.attached[node]; };
  for (std::size_t c = 0; c < from.columns.size(); ++c) {
    const bool lip = from.columns[c].to_mouth < teeth_lip_edge_mm;
    for (int s = lip ? 0 : last; s <= last; ++s)
      if (const int node = node_of(static_cast<int>(c), s, from.sheets); free(node))
        contact.points.push_back(MeshPoint::of_node(node));
  }
  std::vector<Eigen::Vector3i> before_teeth, sliding;
  for (const auto& t : from.skin.mesh.triangles) {
    const Eigen::Vector3i inner = t.unaryExpr([&](int c) { return node_of(c, last, from.sheets); });
    if (!free(inner[0]) || !free(inner[1]) || !free(inner[2])) continue;
    double to_mouth = 0;
    for (int c : t) to_mouth = std::max(to_mouth, from.columns[c].to_mouth);
    (to_mouth < near_mouth_mm ? before_teeth : sliding).push_back(inner);
  }
  contact.upper = make_lip(from, 1);
  contact.lower = make_lip(from, -1);
  for (const auto* lip : {&contact.upper, &contact.lower})
    for (const auto& [a, b, c] : lip->edge) before_teeth.emplace_back(a, b, c);
  spread(before_teeth, from.rest, near_mm, contact.points);
  spread(sliding, from.rest, far_mm, contact.points);
  for (const auto& point : contact.points) {
    Vector3d front = Vector3d::Zero();
    bool lip = true;
    for (int k = 0; k < point.count; ++k) {
      const int column = point.node[k] / from.sheets;
      lip = lip && from.columns[column].to_mouth < led_mm;
      front -= from.columns[column].inward;
    }
    contact.front.push_back(lip ? Vector3d(front.normalized()) : Vector3d::Zero());
    contact.lower_lip.push_back(from.side[point.node[0] / from.sheets] < 0);
  }
  if (!contact.points.empty())
    for (const auto& bone : bones)
      if (!bone.mesh.empty())
        contact.obstacles.push_back(make_obstacle(contact, from.rest, bone, threads));

  for (const auto& [lip, other] :
       {std::pair{&contact.upper, &contact.lower}, std::pair{&contact.lower, &contact.upper}}) {
    std::vector<PointContact> touches;
    find_surface_contacts(lip->points, lip->allowance, other->surface, from.rest, {}, touches,
                          other->facing);
    contact.lip_points_left_out += leave_out_deep(touches, *lip);
    touches.clear();
    find_surface_contacts(lip->points, lip->allowance, other->surface, from.rest, {}, touches,
                          other->facing);
    allow_depths(touches, lip->allowance);
  }
  contact.fold = find_fold(from);
  return contact;
}

ContactLists find_tissue_contacts(const TissueContact& contact,
                                  std::span<const double> own_stiffness, std::span<const Pose> X_CB,
                                  const Nodes& x, int threads, NearObstacles* known,
                                  double firmness) {
  const bool firm = firmness > 1;
  firmness *= contact.firmness;
  const std::size_t obstacles = contact.obstacles.size();
  if (known) known->resize(obstacles);
  ContactLists lists(contact_lists(contact));
  const auto on_obstacle = [&](std::size_t i) {
    const Obstacle& obstacle = contact.obstacles[i];
    const PointContactSettings settings{.stiffness = firmness * PointContactSettings{}.stiffness};
    find_obstacle_contacts(contact.points, obstacle.allowance, *obstacle.surface,
                           pose_in(X_CB, obstacle.body), x, settings, lists[i], obstacle.shift,
                           known ? &(*known)[i] : nullptr);
    guide_lips(contact, obstacle, X_CB, x, lists[i]);
  };
  const auto on_self = [&](SelfContact which) {
    const auto flap = [&](const Flap& of, const Flap& on, double stiffness,
                          const Vector3d& facing = Vector3d::Zero()) {
      find_surface_contacts(of.points, of.allowance, on.surface, x,
                            {.stiffness = firmness * stiffness}, lists[obstacles + which], facing);
    };
    const auto facing = [&](const TissueContact::Lip& lip) {
      return Vector3d(pose_in(X_CB, lip.body).R * lip.facing);
    };
    const auto& [upper, lower] = std::tie(contact.upper, contact.lower);
    const auto& [chin, throat] = contact.fold;
    switch (which) {
      case upper_on_lower:
        return flap(upper, lower, lips_stiffness, facing(lower));
      case lower_on_upper:
        return flap(lower, upper, lips_stiffness, facing(upper));
      case chin_on_throat:
        return flap(chin, throat, skin_stiffness);
      default:
        return flap(throat, chin, skin_stiffness);
    }
  };
  parallel_for(lists.size(), threads, [&](std::size_t i) {
    if (i < obstacles)
      on_obstacle(i);
    else
      on_self(static_cast<SelfContact>(i - obstacles));
    if (!firm) limit_stiffness(own_stiffness, over_own_stiffness, lists[i]);
  });
  return lists;
}

double overlap_at_rest(const TissueContact& contact) {
  double deepest = 0;
  for (const auto& obstacle : contact.obstacles)
    for (std::size_t i = 0; i < obstacle.shift.size(); ++i)
      deepest = std::max(deepest, obstacle.shift[i].norm() + obstacle.allowance[i]);
  for (const auto* lip : {&contact.upper, &contact.lower})
    for (double depth : lip->allowance) deepest = std::max(deepest, depth);
  return deepest;
}

ContactMeasure measure_contact(const TissueContact& contact, const ContactLists& lists,
                               std::span<const Pose> X_CB, const Nodes& rest, const Nodes& x) {
  ContactMeasure measure;
  for (const auto& touches : lists)
    for (const auto& touch : touches)
      measure.penetration_mm = std::max(measure.penetration_mm, -touch.gap);
  for (std::size_t o = 0; o < contact.obstacles.size(); ++o) {
    const Obstacle& obstacle = contact.obstacles[o];
    const Pose X_CO = pose_in(X_CB, obstacle.body);
    for (const auto& touch : lists[o]) {
      if (!obstacle.near_at_rest[touch.point]) continue;
      const MeshPoint& point = contact.points[touch.point];
      const Vector3d moved = point.at(x) - X_CO * point.at(rest);
      const Vector3d along = moved - moved.dot(touch.spring.normal) * touch.spring.normal;
      measure.slip_mm = std::max(measure.slip_mm, along.norm());
    }
  }
  return measure;
}

}  // namespace condyle
