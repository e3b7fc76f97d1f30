#include "engine/collide/solid.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/collide/shells.h"
#include "engine/core/infinity.h"
#include "engine/mesh/topology.h"

namespace condyle {
namespace {

constexpr int faces_a_leaf = 4;

double distance_to(const Box& box, const Eigen::Vector3d& p) {
  return (p - p.cwiseMax(box.low).cwiseMin(box.high)).norm();
}

std::vector<int> in_order(const TriMesh& mesh) {
  std::vector<int> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  return order;
}

}  // namespace

Solid::Solid(const TriMesh& mesh) : faces_({mesh.vertices, mesh.triangles, {}}) {
  require_sound(mesh);
  std::vector<Shell> shells = solid_shells(mesh);
  shell_count_ = static_cast<int>(shells.size());
  for (Shell& shell : shells) {
    samples_.push_back(shell.mesh.vertices.front());
    if (shell.closed) {
      const Box box = bounding_box(shell.mesh);
      shells_.push_back({MadeOnce<TriangleTree, TriMesh>(std::move(shell.mesh)), box});
    } else {
      ++open_shell_count_;
    }
  }
  face_count_ = mesh.triangles.size();
  ball_ = ball_around(mesh, in_order(mesh), 0, static_cast<int>(face_count_)).first;
}

Solid::Faces::Faces(const TriMesh& mesh) {
  std::vector<int> order = in_order(mesh);
  balls.reserve(order.size());
  build_balls(mesh, order, 0, static_cast<int>(order.size()));
  find_connected(mesh, order);
  faces.reserve(order.size());
  slot.resize(order.size());
  for (const int i : order) {
    const auto& t = mesh.triangles[i];
    slot[i] = static_cast<int>(faces.size());
    faces.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
  }
  find_neighbours(mesh);
}

void Solid::Faces::find_neighbours(const TriMesh& mesh) {
  corners.resize(faces.size());
  first_at.assign(mesh.vertices.size() + 1, 0);
  for (std::size_t i = 0; i < slot.size(); ++i) {
    corners[slot[i]] = mesh.triangles[i];
    for (const int v : mesh.triangles[i]) ++first_at[v + 1];
  }
  std::partial_sum(first_at.begin(), first_at.end(), first_at.begin());
  at_corner.resize(3 * faces.size());
  std::vector<int> next = first_at;
  for (std::size_t face = 0; face < corners.size(); ++face)
    for (const int v : corners[face]) at_corner[next[v]++] = static_cast<int>(face);

  const Components components = find_components(mesh);
  piece.resize(faces.size());
  piece_face.assign(static_cast<std::size_t>(components.count), -1);
  for (std::size_t i = 0; i < slot.size(); ++i) {
    piece[slot[i]] = components.of_triangle[i];
    piece_face[components.of_triangle[i]] = slot[i];
  }
}

std::pair<Solid::Ball, Box> Solid::ball_around(const TriMesh& mesh, const std::vector<int>& order,
                                               int first, int last) {
  Box box;
  for (int i = first; i < last; ++i)
    for (const int v : mesh.triangles[order[i]]) box.add(mesh.vertices[v]);
  const Eigen::Vector3d center = box.center();
  double radius2 = 0;
  for (int i = first; i < last; ++i)
    for (const int v : mesh.triangles[order[i]])
      radius2 = std::max(radius2, (mesh.vertices[v] - center).squaredNorm());
  return {{center, std::sqrt(radius2), first, last - first, 0, false}, box};
}

int Solid::Faces::build_balls(const TriMesh& mesh, std::vector<int>& order, int first, int last) {
  const auto middle_of = [&](int i) -> Eigen::Vector3d {
    const auto& t = mesh.triangles[i];
    return mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]];
  };
  const auto [ball, box] = ball_around(mesh, order, first, last);
  const int index = static_cast<int>(balls.size());
  balls.push_back(ball);
  if (last - first <= faces_a_leaf) return index;
  Eigen::Index axis = 0;
  box.size().maxCoeff(&axis);
  const int middle = first + (last - first) / 2;
  const auto before = [&](int i, int j) {  // a total order gives the same tree on any machine
    const double x = middle_of(i)[axis], y = middle_of(j)[axis];
    return x != y ? x < y : i < j;
  };
  std::nth_element(order.begin() + first, order.begin() + middle, order.begin() + last, before);
  build_balls(mesh, order, first, middle);
  const int right = build_balls(mesh, order, middle, last);
  balls[index].right = right;
  return index;
}

void Solid::Faces::find_connected(const TriMesh& mesh, const std::vector<int>& order) {
  std::vector<int> last_run(mesh.vertices.size(), -1);
  // Children come after their parents.
  for (int index = static_cast<int>(balls.size()) - 1; index >= 0; --index) {
    Ball& ball = balls[index];
    const auto mark = [&](int i) {
      for (const int v : mesh.triangles[order[i]]) last_run[v] = index;
    };
    const auto meets = [&](int i) {
      const auto& t = mesh.triangles[order[i]];
      return last_run[t[0]] == index || last_run[t[1]] == index || last_run[t[2]] == index;
    };
    const int end = ball.first + ball.count;
    if (ball.right == 0) {
      mark(ball.first);
      int joined = 1;
      for (bool grows = true; grows;) {
        const int before = joined;
        joined = 1;
        for (int i = ball.first + 1; i < end; ++i)
          if (meets(i)) {
            mark(i);
            ++joined;
          }
        grows = joined > before;
      }
      ball.connected = joined == ball.count;
      continue;
    }
    const Ball &left = balls[index + 1], &right = balls[ball.right];
    if (!left.connected || !right.connected) continue;
    for (int i = left.first; i < left.first + left.count; ++i) mark(i);
    for (int i = right.first; i < end && !ball.connected; ++i) ball.connected = meets(i);
  }
}

double Solid::ClosedShell::depth(const Eigen::Vector3d& p, double ball_radius, double reach) const {
  if (distance_to(box, p) > ball_radius) return -infinity;
  return -tree().signed_nearest(p, reach).distance;
}

double Solid::extent(const Eigen::Vector3d& direction) const {
  double most = -infinity;
  for (const Triangle& face : faces().faces)
    for (const auto& corner : face) most = std::max(most, direction.dot(corner));
  return most;
}

double Solid::signed_distance(const Eigen::Vector3d& p) const {
  // The shell whose box is nearest is queried first; its answer makes most other queries
  // unnecessary.
  std::size_t first = 0;
  double nearest_box = infinity;
  for (std::size_t i = 0; i < shells_.size(); ++i)
    if (const double d = distance_to(shells_[i].box, p); d < nearest_box) {
      nearest_box = d;
      first = i;
    }
  double least = infinity;
  for (std::size_t k = 0; k < shells_.size(); ++k) {
    const ClosedShell& shell = shells_[k == 0 ? first : k <= first ? k - 1 : k];
    const double to_box = distance_to(shell.box, p);
    if (to_box > 0 && to_box >= least) continue;
    // Within its box the point may be deep inside, regardless of the distance to the others.
    least = std::min(least, shell.tree().signed_nearest(p, to_box > 0 ? least : infinity).distance);
  }
  return least;
}

bool Solid::has_shell_inside(const Solid& other, const Pose& X_OS) const {
  for (const auto& sample : samples_)
    for (const auto& shell : other.shells_)
      if (shell.depth(X_OS * sample, 0, infinity) > 0) return true;
  return false;
}

bool one_encloses_other(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB) {
  const Pose X_AB = X_WA.inverse() * X_WB;
  return b.has_shell_inside(a, X_AB) || a.has_shell_inside(b, X_AB.inverse());
}

}  // namespace condyle
