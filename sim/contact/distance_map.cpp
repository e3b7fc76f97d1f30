#include "sim/contact/distance_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "engine/collide/quick_distance.h"
#include "engine/collide/shells.h"
#include "engine/core/infinity.h"
#include "engine/core/parallel.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/refine.h"
#include "sim/case/pair_rules.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double rounding_mm = 1e-3;  // of single precision, with a margin
constexpr int leaf_vertices = 12;
constexpr int task_vertices = 600;  // processed as one task by a thread
constexpr double meeting_mm = 12;   // bones this near at rest may touch in motion
constexpr double coarsest_mm = 8;   // of edges, so that the vertices register approaching surfaces

/// A rigid motion, quick to apply to many points.
struct Place {
  Eigen::Matrix3d R;
  Vector3d t;

  explicit Place(const Pose& pose) : R(pose.R.toRotationMatrix()), t(pose.t) {}
  Vector3d operator*(const Vector3d& p) const { return R * p + t; }
};

/// One connected piece of a target surface.
struct Target {
  QuickDistance surface;
  Box box;
  bool closed;

  /// Lower bound of the distance of p.
  double to_box(const Vector3d& p) const {
    return (box.low - p).cwiseMax(p - box.high).cwiseMax(0.0).norm();
  }
  /// mm, negative inside; infinite beyond the limit.
  double distance(const Vector3d& p, double limit, QuickDistance::Start& start) const {
    const float found = surface.signed_distance(p, static_cast<float>(limit), start);
    return closed ? found : std::abs(found);
  }
};

std::vector<Target> targets_of(const TriMesh& mesh) {
  std::vector<Target> targets;
  for (const Shell& shell : solid_shells(mesh))
    targets.push_back({QuickDistance(shell.mesh), bounding_box(shell.mesh), shell.closed});
  return targets;
}

struct Ball {  // around a range of vertices
  Vector3d center;
  double radius = 0;
  int first = 0, count = 0;
  int right = 0;  // second child (the first is next); 0 for a leaf
};

/// The vertices of a surface in a hierarchy of balls.
class VertexBalls {
 public:
  explicit VertexBalls(const std::vector<Vector3d>& vertices) : points_(vertices) {
    for (std::size_t i = 0; i < vertices.size(); ++i) vertex_.push_back(static_cast<int>(i));
    build(0, static_cast<int>(vertices.size()));
    for (std::size_t i = 0; i < vertices.size(); ++i) points_[i] = vertices[vertex_[i]];
  }

  const Ball& ball(int i) const { return balls_[static_cast<std::size_t>(i)]; }
  const Vector3d& point(int i) const { return points_[static_cast<std::size_t>(i)]; }
  int vertex(int i) const { return vertex_[static_cast<std::size_t>(i)]; }

  /// Balls that contain every vertex once, none with more than `most`.
  std::vector<int> cut(int most) const {
    std::vector<int> found, open = {0};
    while (!open.empty()) {
      const int i = open.back();
      open.pop_back();
      if (ball(i).count <= most || ball(i).right == 0) {
        found.push_back(i);
      } else {
        open.push_back(i + 1);
        open.push_back(ball(i).right);
      }
    }
    return found;
  }

 private:
  int build(int first, int last) {
    Box box;
    for (int i = first; i < last; ++i) box.add(points_[vertex_[i]]);
    const int index = static_cast<int>(balls_.size());
    balls_.push_back({box.center(), 0, first, last - first, 0});
    double radius2 = 0;
    for (int i = first; i < last; ++i)
      radius2 = std::max(radius2, (points_[vertex_[i]] - box.center()).squaredNorm());
    balls_[index].radius = std::sqrt(radius2);
    if (last - first <= leaf_vertices) return index;
    Eigen::Index axis = 0;
    box.size().maxCoeff(&axis);
    const int middle = first + (last - first) / 2;
    std::nth_element(vertex_.begin() + first, vertex_.begin() + middle, vertex_.begin() + last,
                     [&](int a, int b) {
                       const double x = points_[a][axis], y = points_[b][axis];
                       return x < y || (x == y && a < b);
                     });
    build(first, middle);
    const int right = build(middle, last);
    balls_[index].right = right;
    return index;
  }

  std::vector<Vector3d> points_;  // in the order of the balls
  std::vector<int> vertex_;       // of the mesh
  std::vector<Ball> balls_;       // depth first
};

/// Computes the distances of a range of vertices to one target, lowering `values` where it is
/// nearer. A distance changes by at most the displacement from a point where it is known: this
/// bounds each query without affecting its result.
class Search {
 public:
  Search(const VertexBalls& balls, const Target& target, const Place& X_TV, double reach_mm,
         std::vector<float>& values)
      : balls_(balls), target_(target), X_TV_(X_TV), reach_mm_(reach_mm), values_(values) {}

  void run(int ball) { run(ball, {}); }

 private:
  /// A point to continue from, coordinates of the target.
  struct Known {
    Vector3d point = Vector3d::Zero();
    double distance_mm = 0;
    QuickDistance::Start start = {};
    bool any = false;
  };

  void run(int index, Known known) {
    const Ball& ball = balls_.ball(index);
    const Vector3d c = X_TV_ * ball.center;
    const double search_mm = farthest(ball);
    if (target_.to_box(c) > search_mm + ball.radius) return;
    if (!ask(c, search_mm + ball.radius, known)) return;
    if (std::abs(known.distance_mm) > search_mm + ball.radius) {
      // The surface is outside the ball: all of the ball lies on one side of it.
      if (known.distance_mm > 0) return;
      for (int i = ball.first; i < ball.first + ball.count; ++i)
        lower(i, -std::numeric_limits<float>::infinity());
    } else if (ball.right != 0) {
      run(index + 1, known);
      run(ball.right, known);
    } else {
      for (int i = ball.first; i < ball.first + ball.count; ++i) vertex(i, known);
    }
  }

  void vertex(int i, Known& known) {
    const Vector3d p = X_TV_ * balls_.point(i);
    const double search_mm = std::clamp(static_cast<double>(value(i)), 0.0, reach_mm_);
    if (target_.to_box(p) > search_mm || !ask(p, search_mm, known)) return;
    if (std::abs(known.distance_mm) <= reach_mm_)
      lower(i, static_cast<float>(known.distance_mm));
    else if (known.distance_mm < 0)
      lower(i, -std::numeric_limits<float>::infinity());
  }

  /// Computes the distance of p, from that of a nearby point, into `known`. False, without change
  /// of `known`, when p is outside and farther than `search_mm`.
  bool ask(const Vector3d& p, double search_mm, Known& known) const {
    double limit = infinity;
    if (known.any) {
      const double step = (p - known.point).norm() + rounding_mm;
      limit = std::abs(known.distance_mm) + step;
      if (known.distance_mm > step) {  // p is outside as well
        if (known.distance_mm - step > search_mm) return false;
        limit = std::min(limit, search_mm + rounding_mm);
      }
    }
    const double distance = target_.distance(p, limit, known.start);
    if (!std::isfinite(distance)) return false;
    known.point = p;
    known.distance_mm = distance;
    known.any = true;
    return true;
  }

  /// A target farther away is irrelevant to all vertices of the ball.
  double farthest(const Ball& ball) const {
    float most = -std::numeric_limits<float>::infinity();
    if (ball.count > 4 * leaf_vertices) return reach_mm_;
    for (int i = ball.first; i < ball.first + ball.count; ++i) most = std::max(most, value(i));
    return std::clamp(static_cast<double>(most), 0.0, reach_mm_);
  }

  float& value(int i) const { return values_[static_cast<std::size_t>(balls_.vertex(i))]; }
  void lower(int i, float to) { value(i) = std::min(value(i), to); }

  const VertexBalls& balls_;
  const Target& target_;
  const Place& X_TV_;  // vertices to the target
  double reach_mm_;
  std::vector<float>& values_;
};

/// Whether the distance of two parts matters: both collide, and belong to different bodies.
bool may_meet(const Case& patient, std::span<const PairRule> more, const Part& a, const Part& b) {
  if (&a == &b || !collides(a.role) || !collides(b.role) || a.mesh.empty() || b.mesh.empty())
    return false;
  if (a.body == b.body) return false;
  return rule_for(patient, more, a, b).policy != PairPolicy::cut_face;
}

/// The part's surface without very large triangles; its normals are processed as colours, so that
/// new vertices are interpolated.
TriMesh with_normals(const TriMesh& part, int max_triangles) {
  TriMesh mesh{part.vertices, part.triangles, {}};
  for (const auto& n : vertex_normals(mesh)) mesh.colors.push_back(n.cast<float>());
  const std::vector<double> edge_mm(mesh.vertices.size(), coarsest_mm);
  return refine(std::move(mesh), edge_mm, max_triangles);
}

/// Smaller triangles where parts may touch.
void divide(DistanceMap::Surface& surface, Role role, const std::vector<float>& rest_mm,
            const DistanceMapSettings& settings) {
  TriMesh& mesh = surface.mesh;
  std::vector<double> edge_mm(mesh.vertices.size(), infinity);
  for (std::size_t v = 0; v < edge_mm.size(); ++v)
    if (std::isfinite(rest_mm[v]) || rest_mm[v] < 0)
      edge_mm[v] = is_teeth(role) ? settings.teeth_edge_mm : settings.bone_edge_mm;
  mesh = refine(std::move(mesh), std::move(edge_mm), settings.max_triangles);
  surface.normals = std::move(mesh.colors);
  mesh.colors.clear();
  for (auto& n : surface.normals) {
    const float length = n.norm();
    n = length > 0 ? Eigen::Vector3f(n / length) : Eigen::Vector3f::UnitZ();
  }
}

}  // namespace

struct DistanceMap::State {
  BodyTree bodies;
  std::vector<BodyId> body;                  // of each part
  std::vector<std::vector<Target>> targets;  // of each part; empty where none can touch it
  std::vector<Surface> surfaces;
  std::vector<VertexBalls> balls;         // of each surface
  std::vector<std::vector<int>> meets;    // of each surface: parts
  std::vector<std::pair<int, int>> runs;  // surface and ball: the tasks of the threads
  double reach_mm = 0;

  void lay_out() {
    balls.clear();
    runs.clear();
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
      balls.emplace_back(surfaces[s].mesh.vertices);
      for (const int ball : balls.back().cut(task_vertices))
        runs.emplace_back(static_cast<int>(s), ball);
    }
  }

  Values at(const BodyPoses& given, double reach, int threads) const {
    const BodyPoses poses = completed(bodies, given);
    std::vector<Pose> X_WP;
    for (const BodyId b : body) X_WP.push_back(poses[b]);
    std::vector<std::vector<Place>> X_TV(surfaces.size());
    Values values;
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
      for (const int other : meets[s])
        X_TV[s].emplace_back(X_WP[static_cast<std::size_t>(other)].inverse() *
                             X_WP[static_cast<std::size_t>(surfaces[s].part)]);
      values.emplace_back(surfaces[s].mesh.vertices.size(), std::numeric_limits<float>::infinity());
    }
    // Every task has its own vertices: no two threads write to the same value.
    parallel_for(runs.size(), threads, [&](std::size_t r) {
      const auto [surface, ball] = runs[r];
      const auto s = static_cast<std::size_t>(surface);
      for (std::size_t m = 0; m < meets[s].size(); ++m)
        for (const Target& target : targets[static_cast<std::size_t>(meets[s][m])])
          Search(balls[s], target, X_TV[s][m], reach, values[s]).run(ball);
    });
    return values;
  }
};

DistanceMap::DistanceMap(const Case& patient, const DistanceMapSettings& settings, int threads)
    : state_(std::make_unique<State>()) {
  State& state = *state_;
  state.reach_mm = settings.reach_mm;
  state.bodies = patient.bodies;
  const auto& parts = patient.parts;
  state.targets.resize(parts.size());
  std::vector<std::size_t> met;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Part& part = parts[i];
    state.body.push_back(part.body);
    std::vector<int> meets;
    for (std::size_t k = 0; k < parts.size(); ++k)
      if (may_meet(patient, settings.pair_rules, part, parts[k]))
        meets.push_back(static_cast<int>(k));
    if (meets.empty()) continue;
    met.push_back(i);
    state.meets.push_back(std::move(meets));
    state.surfaces.push_back(
        {static_cast<int>(i), with_normals(part.mesh, settings.max_triangles), {}, false});
  }
  parallel_for(met.size(), threads,
               [&](std::size_t i) { state.targets[met[i]] = targets_of(parts[met[i]].mesh); });
  state.lay_out();
  const Values rest = state.at({}, meeting_mm, threads);
  parallel_for(state.surfaces.size(), threads, [&](std::size_t s) {
    Surface& surface = state.surfaces[s];
    divide(surface, parts[met[s]].role, rest[s], settings);
    for (const int other : state.meets[s])
      for (const Target& target : state.targets[static_cast<std::size_t>(other)])
        surface.unsigned_near_open |= !target.closed;
  });
  state.lay_out();
}

bool has_open_surfaces(const Case& patient) {
  return std::any_of(patient.parts.begin(), patient.parts.end(), [](const Part& part) {
    if (!collides(part.role)) return false;
    const auto shells = solid_shells(part.mesh);
    return std::any_of(shells.begin(), shells.end(), [](const Shell& s) { return !s.closed; });
  });
}

DistanceMap::~DistanceMap() = default;
DistanceMap::DistanceMap(DistanceMap&&) noexcept = default;
DistanceMap& DistanceMap::operator=(DistanceMap&&) noexcept = default;

const std::vector<DistanceMap::Surface>& DistanceMap::surfaces() const { return state_->surfaces; }

DistanceMap::Values DistanceMap::at(const BodyPoses& poses, int threads) const {
  return state_->at(poses, state_->reach_mm, threads);
}

double DistanceMap::reach_mm() const { return state_->reach_mm; }

}  // namespace condyle
