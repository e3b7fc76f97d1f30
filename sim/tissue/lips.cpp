#include "sim/tissue/lips.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "engine/mesh/repair.h"
#include "engine/mesh/topology.h"
#include "sim/tissue/anatomy.h"
#include "sim/tissue/lip_pocket.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

Vector3d expected_mouth(const Landmarks& landmarks, const Vector3d& incisors) {
  if (const auto stomion = landmarks.find("stomion")) return *stomion;
  return incisors + Vector3d(0, -8, 0);  // lips lie about 8 mm in front of the incisal edges
}

int nearest_of(const std::vector<int>& loop, const TriMesh& mesh, const Vector3d& p) {
  int best = 0;
  for (std::size_t i = 1; i < loop.size(); ++i)
    if ((mesh.vertices[loop[i]] - p).squaredNorm() < (mesh.vertices[loop[best]] - p).squaredNorm())
      best = static_cast<int>(i);
  return best;
}

MouthOutline outline_of(const std::vector<int>& loop, const TriMesh& face,
                        const Landmarks& landmarks) {
  int right = 0, left = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const double x = face.vertices[loop[i]].x();
    if (x < face.vertices[loop[right]].x()) right = static_cast<int>(i);
    if (x > face.vertices[loop[left]].x()) left = static_cast<int>(i);
  }
  // A landmark near the loop locates the corner better than the widest point.
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
  const bool forward_is_upper = faces_outward(face);
  mouth.upper = forward_is_upper ? forward : backward;
  mouth.lower = forward_is_upper ? backward : forward;
  return mouth;
}

}  // namespace

bool faces_outward(const TriMesh& mesh) {
  Vector3d middle = Vector3d::Zero();
  for (const auto& p : mesh.vertices) middle += p / static_cast<double>(mesh.vertices.size());
  double outward = 0;
  for (const auto& t : mesh.triangles) {
    const Vector3d a = mesh.vertices[t[0]] - middle, b = mesh.vertices[t[1]] - middle,
                   c = mesh.vertices[t[2]] - middle;
    outward += a.dot(b.cross(c));
  }
  return outward > 0;
}

std::vector<std::vector<int>> border_loops(const TriMesh& mesh) {
  std::map<int, int> next;  // a border vertex of a manifold surface has one successor
  const EdgeList list = find_edges(mesh);
  for (const auto& edge : list.edges) {
    if (edge.count != 1) continue;
    if (list.sides[edge.first].forward)
      next[edge.low] = edge.high;
    else
      next[edge.high] = edge.low;
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

namespace {

std::optional<LipLine> find_lip_line(const Landmarks& landmarks, const Vector3d& incisors,
                                     std::vector<std::string>& notes) {
  LipLine line;
  line.middle = expected_mouth(landmarks, incisors);
  const auto right = landmarks.find("right_cheilion"), left = landmarks.find("left_cheilion");
  constexpr double half_width = 24.5;
  line.right = right ? *right : Vector3d(line.middle + Vector3d(-half_width, 8, 0));
  line.left = left ? *left : Vector3d(line.middle + Vector3d(half_width, 8, 0));
  if (!right || !left)
    notes.push_back("mouth corners are not marked: taken 24.5 mm to the sides of the lips' middle");
  if (!landmarks.find("stomion"))
    notes.push_back("stomion is not marked: taken at the height of the incisal edges");
  if (line.right.x() > line.middle.x() - 8 || line.left.x() < line.middle.x() + 8)
    return std::nullopt;
  return line;
}

/// Opens the pocket between the lips, if there is one; empty, with the face unchanged, otherwise.
MouthOutline open_pocket(TriMesh& face, const LipLine& line, const Landmarks& landmarks,
                         const Vector3d& incisors, std::vector<std::string>& notes) {
  auto bottom = pocket_bottom(face, line);
  if (bottom.empty()) return {};
  TriMesh parted = face;
  if (open_pouch(parted, line, bottom)) {
    if (MouthOutline mouth = find_mouth(parted, landmarks, incisors); mouth.found()) {
      face = std::move(parted);
      notes.push_back(
          "the face has a mouth behind its lips: it was opened, and removed except for a seam");
      return mouth;
    }
    parted = face;
  }
  if (!faces_outward(face)) std::reverse(bottom.begin(), bottom.end());
  cut_along(bottom, parted);
  MouthOutline mouth = find_mouth(parted, landmarks, incisors);
  if (!mouth.found()) return {};
  face = std::move(parted);
  notes.push_back(
      "the lips were one surface: separated along the bottom of the pocket between them");
  return mouth;
}

/// The triangle cut along its edges: `outline` has its corners and the new vertices between them,
/// one or two.
std::vector<Eigen::Vector3i> pieces_of(const Eigen::Vector3i& triangle,
                                       const std::vector<int>& outline) {
  const int n = static_cast<int>(outline.size());
  const auto at = [&](int i) { return outline[(i + n) % n]; };
  const auto is_new = [&](int k) {
    return at(k) != triangle[0] && at(k) != triangle[1] && at(k) != triangle[2];
  };
  int i = 0;
  if (n == 4) {  // one edge crossed: from the new vertex to the corner across
    while (!is_new(i)) ++i;
    return {{at(i), at(i + 1), at(i + 2)}, {at(i), at(i + 2), at(i + 3)}};
  }
  // Two edges crossed: the lone corner, between both new vertices, and a quad.
  while (!(is_new(i - 1) && is_new(i + 1))) ++i;
  return {{at(i - 1), at(i), at(i + 1)},
          {at(i + 1), at(i + 2), at(i + 3)},
          {at(i + 1), at(i + 3), at(i + 4)}};
}

/// Cuts the front of a face along the lip line.
class LipLineCut {
 public:
  LipLineCut(TriMesh& face, const LipLine& line)
      : face_(face), line_(line), in_zone_(face.triangles.size()) {
    height_.assign(face.vertices.size(), 1e9);
  }

  /// Returns false where too few vertices lie on the line.
  bool cut() {
    measure_heights();
    snap_to_line();
    split_triangles();
    return part_line();
  }

 private:
  /// Not the nape behind the line.
  bool is_near(const Eigen::Vector3i& t) const {
    for (int k = 0; k < 3; ++k) {
      const Vector3d& p = face_.vertices[t[k]];
      if (p.x() < line_.right.x() - 8 || p.x() > line_.left.x() + 8 ||
          std::abs(line_.height(p)) > 15 || p.y() > line_.middle.y() + 40)
        return false;
    }
    return true;
  }

  std::array<int, 3> corners(int t) const {
    const Eigen::Vector3i& triangle = face_.triangles[t];
    return {triangle[0], triangle[1], triangle[2]};
  }

  bool faces_front(const Eigen::Vector3i& t) const {
    const Vector3d &a = face_.vertices[t[0]], &b = face_.vertices[t[1]], &c = face_.vertices[t[2]];
    return (b - a).cross(c - a).y() < 0;
  }

  void measure_heights() {
    std::vector<int> near, front;
    for (std::size_t t = 0; t < face_.triangles.size(); ++t) {
      if (!is_near(face_.triangles[t])) continue;
      near.push_back(static_cast<int>(t));
      for (const int v : face_.triangles[t]) height_[v] = line_.height(face_.vertices[v]);
      if (faces_front(face_.triangles[t])) front.push_back(static_cast<int>(t));
    }
    follow_line(near, std::move(front));
  }

  /// The zone: the front of the face, and where the line goes on from there into folds.
  void follow_line(const std::vector<int>& near, std::vector<int> waiting) {
    std::map<std::pair<int, int>, std::vector<int>> beside;
    for (const int t : near)
      for (int k = 0; k < 3; ++k)
        beside[std::minmax(face_.triangles[t][k], face_.triangles[t][(k + 1) % 3])].push_back(t);
    for (const int t : waiting) in_zone_[t] = 1;
    while (!waiting.empty()) {
      const Eigen::Vector3i triangle = face_.triangles[waiting.back()];
      waiting.pop_back();
      for (int k = 0; k < 3; ++k) {
        const int a = triangle[k], b = triangle[(k + 1) % 3];
        if (height_[a] * height_[b] >= 0) continue;
        for (const int t : beside[std::minmax(a, b)])
          if (!in_zone_[t]) {
            in_zone_[t] = 1;
            waiting.push_back(t);
          }
      }
    }
    take_around_line(near);
  }

  /// All triangles around the vertices beside the line: one left out would join the lips.
  void take_around_line(const std::vector<int>& near) {
    std::vector<char> beside(face_.vertices.size(), 0);
    for (const int t : near) {
      const auto [a, b, c] = corners(t);
      const bool above = height_[a] > 0;
      if (!in_zone_[t] || ((height_[b] > 0) == above && (height_[c] > 0) == above)) continue;
      beside[a] = beside[b] = beside[c] = 1;
    }
    std::vector<double> in_zone(height_.size(), 1e9);
    for (const int t : near) {
      const auto [a, b, c] = corners(t);
      in_zone_[t] |= beside[a] | beside[b] | beside[c];
      if (in_zone_[t])
        for (const int v : {a, b, c}) in_zone[v] = height_[v];
    }
    height_ = std::move(in_zone);
  }

  /// Fraction of an edge where the line crosses it.
  double crossing(int a, int b) const { return height_[a] / (height_[a] - height_[b]); }

  /// A vertex close to where the line crosses one of its edges counts as lying on it: the first of
  /// each edge, then, after all of those, the second.
  void snap_to_line() {
    for (std::size_t t = 0; t < face_.triangles.size(); ++t)
      for (int k = 0; in_zone_[t] && k < 3; ++k) {
        const int a = face_.triangles[t][k], b = face_.triangles[t][(k + 1) % 3];
        if (height_[a] * height_[b] < 0 && crossing(a, b) < 0.15) height_[a] = 0;
      }
    for (std::size_t t = 0; t < face_.triangles.size(); ++t)
      for (int k = 0; in_zone_[t] && k < 3; ++k) {
        const int a = face_.triangles[t][k], b = face_.triangles[t][(k + 1) % 3];
        if (height_[a] * height_[b] < 0 && crossing(a, b) > 0.85) height_[b] = 0;
      }
  }

  /// The vertex where the line crosses an edge, inserted if it is new; -1 if it does not cross.
  int cut_vertex(int a, int b) {
    if (height_[a] * height_[b] >= 0) return -1;
    const auto key = std::minmax(a, b);
    const double s = crossing(key.first, key.second);
    const Vector3d p =
        face_.vertices[key.first] + s * (face_.vertices[key.second] - face_.vertices[key.first]);
    if (!line_.spans(p.x())) return -1;
    const auto [it, fresh] =
        on_edge_.try_emplace({key.first, key.second}, static_cast<int>(face_.vertices.size()));
    if (fresh) {
      face_.vertices.push_back(p);
      height_.push_back(0);
      if (colored_)
        face_.colors.push_back(face_.colors[key.first] +
                               static_cast<float>(s) *
                                   (face_.colors[key.second] - face_.colors[key.first]));
    }
    return it->second;
  }

  /// Inserts a vertex on every edge that the line crosses and splits the triangles there.
  void split_triangles() {
    const std::size_t before = face_.triangles.size();
    for (std::size_t t = 0; t < before; ++t) {
      if (!in_zone_[t]) continue;
      std::vector<int> outline;
      const Eigen::Vector3i tri = face_.triangles[t];
      for (int k = 0; k < 3; ++k) {
        outline.push_back(tri[k]);
        const int cut = cut_vertex(tri[k], tri[(k + 1) % 3]);
        if (cut >= 0) outline.push_back(cut);
      }
      if (outline.size() == 3) continue;
      const auto pieces = pieces_of(tri, outline);
      face_.triangles[t] = pieces[0];
      for (std::size_t k = 1; k < pieces.size(); ++k) {
        face_.triangles.push_back(pieces[k]);
        in_zone_.push_back(1);
      }
    }
  }

  /// Duplicates every vertex on the line except the two ends; the triangles below use the
  /// duplicates.
  bool part_line() {
    std::vector<int> on_line;
    for (std::size_t v = 0; v < height_.size(); ++v)
      if (height_[v] == 0 && line_.spans(face_.vertices[v].x()))
        on_line.push_back(static_cast<int>(v));
    if (on_line.size() < 5) return false;
    const auto by_x = [&](int a, int b) { return face_.vertices[a].x() < face_.vertices[b].x(); };
    const int right_end = *std::min_element(on_line.begin(), on_line.end(), by_x);
    const int left_end = *std::max_element(on_line.begin(), on_line.end(), by_x);
    std::map<int, int> twin;
    for (int v : on_line) {
      if (v == right_end || v == left_end) continue;
      twin[v] = static_cast<int>(face_.vertices.size());
      const Vector3d p = face_.vertices[v];
      face_.vertices.push_back(p);
      if (colored_) {
        const Eigen::Vector3f c = face_.colors[v];
        face_.colors.push_back(c);
      }
    }
    for (std::size_t t = 0; t < face_.triangles.size(); ++t) {
      auto& tri = face_.triangles[t];
      if (!in_zone_[t]) continue;
      double sum = 0;
      for (int k = 0; k < 3; ++k)
        if (tri[k] < static_cast<int>(height_.size())) sum += height_[tri[k]];
      if (sum >= 0) continue;
      for (int k = 0; k < 3; ++k)
        if (const auto it = twin.find(tri[k]); it != twin.end()) tri[k] = it->second;
    }
    return true;
  }

  TriMesh& face_;
  const LipLine& line_;
  const bool colored_ = !face_.colors.empty();
  std::vector<char> in_zone_;   // per triangle: near the line
  std::vector<double> height_;  // per vertex: above the line, in the zone
  std::map<std::pair<int, int>, int> on_edge_;
};

}  // namespace

MouthOutline cut_lip_line(TriMesh& face, const Landmarks& landmarks, const Vector3d& incisors,
                          std::vector<std::string>& notes) {
  const auto line = find_lip_line(landmarks, incisors, notes);
  if (!line) return {};
  if (MouthOutline mouth = open_pocket(face, *line, landmarks, incisors, notes); mouth.found())
    return mouth;
  if (!LipLineCut(face, *line).cut()) return {};
  notes.push_back("the lips were one surface: separated along the lip line");
  return find_mouth(face, landmarks, incisors);
}

void part_lips(Case& patient) {
  for (auto& part : patient.parts) {
    if (part.role != Role::face || part.mesh.empty()) continue;
    const Vector3d incisors = read_anatomy(patient, patient.notes).incisors;
    if (find_mouth(part.mesh, patient.landmarks, incisors).found()) continue;
    cut_lip_line(part.mesh, patient.landmarks, incisors, patient.notes);
    drop_unreferenced(part.mesh);
  }
}

}  // namespace condyle
