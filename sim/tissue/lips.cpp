#include "sim/tissue/lips.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "engine/mesh/topology.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

Vector3d expected_mouth(const Landmarks& landmarks, const Vector3d& incisors) {
  if (const auto stomion = landmarks.find("stomion")) return *stomion;
  return incisors + Vector3d(0, -8, 0);  // lips stand about 8 mm before the incisal edges
}

int nearest_of(const std::vector<int>& loop, const TriMesh& mesh, const Vector3d& p) {
  int best = 0;
  for (std::size_t i = 1; i < loop.size(); ++i)
    if ((mesh.vertices[loop[i]] - p).squaredNorm() < (mesh.vertices[loop[best]] - p).squaredNorm())
      best = static_cast<int>(i);
  return best;
}

double mean_height(const std::vector<int>& run, const TriMesh& mesh) {
  double sum = 0;
  for (int v : run) sum += mesh.vertices[v].z();
  return run.empty() ? 0 : sum / static_cast<double>(run.size());
}

MouthOutline outline_of(const std::vector<int>& loop, const TriMesh& face,
                        const Landmarks& landmarks) {
  int right = 0, left = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const double x = face.vertices[loop[i]].x();
    if (x < face.vertices[loop[right]].x()) right = static_cast<int>(i);
    if (x > face.vertices[loop[left]].x()) left = static_cast<int>(i);
  }
  // A landmark near the loop knows better where the corner is than the widest point.
  const auto refine = [&](const char* name, int& corner) {
    const auto mark = landmarks.find(name);
    if (!mark) return;
    const int near = nearest_of(loop, face, *mark);
    if ((face.vertices[loop[near]] - *mark).norm() < 6) corner = near;
  };
  refine("right_cheilion", right);
  refine("left_cheilion", left);

  MouthOutline mouth;
  if (right == left) return mouth;
  mouth.right_corner = loop[right];
  mouth.left_corner = loop[left];
  const int n = static_cast<int>(loop.size());
  std::vector<int> forward, backward;
  for (int i = (right + 1) % n; i != left; i = (i + 1) % n) forward.push_back(loop[i]);
  for (int i = (right + n - 1) % n; i != left; i = (i + n - 1) % n) backward.push_back(loop[i]);
  if (forward.empty() || backward.empty()) return {};
  const bool forward_is_upper = mean_height(forward, face) > mean_height(backward, face);
  mouth.upper = forward_is_upper ? forward : backward;
  mouth.lower = forward_is_upper ? backward : forward;
  return mouth;
}

}  // namespace

std::vector<std::vector<int>> border_loops(const TriMesh& mesh) {
  std::map<int, int> next;  // a border vertex of a manifold surface has one way on
  const EdgeList list = find_edges(mesh);
  for (const auto& edge : list.edges) {
    if (edge.count != 1) continue;
    if (list.sides[edge.first].forward) next[edge.low] = edge.high;
    else next[edge.high] = edge.low;
  }
  std::vector<std::vector<int>> loops;
  while (!next.empty()) {
    std::vector<int> loop;
    int v = next.begin()->first;
    for (auto it = next.find(v); it != next.end(); it = next.find(v)) {
      loop.push_back(v);
      v = it->second;
      next.erase(it);
    }
    if (loop.size() >= 3) loops.push_back(std::move(loop));
  }
  return loops;
}

MouthOutline find_mouth(const TriMesh& face, const Landmarks& landmarks, const Vector3d& incisors) {
  const Vector3d expected = expected_mouth(landmarks, incisors);
  const std::vector<int>* best = nullptr;
  double best_distance = 18;  // the nostrils are 25 mm away
  const auto loops = border_loops(face);
  for (const auto& loop : loops) {
    Vector3d low = face.vertices[loop[0]], high = low;
    for (int v : loop) {
      low = low.cwiseMin(face.vertices[v]);
      high = high.cwiseMax(face.vertices[v]);
    }
    const double width = high.x() - low.x();
    if (width < 20 || width > 110) continue;
    const Vector3d middle = 0.5 * (low + high);
    const double distance = std::hypot(middle.x() - expected.x(), middle.z() - expected.z());
    if (distance < best_distance) {
      best_distance = distance;
      best = &loop;
    }
  }
  return best ? outline_of(*best, face, landmarks) : MouthOutline{};
}

MouthOutline cut_lip_line(TriMesh&, const Landmarks&, const Vector3d&, std::vector<std::string>&) {
  return {};
}

void part_lips(Case&) {}

}  // namespace condyle
