#include "sim/face_scan/fuse_face.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/core/parallel.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/refine.h"
#include "engine/mesh/repair.h"
#include "engine/registration/surface_pairs.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double partner_mm = 3;     // farther partners are of another place
constexpr double open_mouth_mm = 2;  // more: the lower face is left alone
constexpr int fade_rings = 8;        // of vertices, from where the scan ends

/// Vertices that share an edge, in one array.
class VertexRings {
 public:
  explicit VertexRings(const TriMesh& mesh) : first_(mesh.vertices.size() + 1, 0) {
    for (const auto& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) first_[static_cast<std::size_t>(t[k]) + 1] += 2;
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    other_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (const auto& t : mesh.triangles)
      for (int k = 0; k < 3; ++k)
        for (const int by : {1, 2})
          other_[next[static_cast<std::size_t>(t[k])]++] = t[(k + by) % 3];
  }
  template <class Visit>
  void around(std::size_t vertex, const Visit& visit) const {
    for (std::size_t i = first_[vertex]; i < first_[vertex + 1]; ++i)
      visit(static_cast<std::size_t>(other_[i]));
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<int> other_;
};

/// Place and colour of the scan at a vertex of the skin.
struct Partner {
  bool found = false;
  Vector3d by = Vector3d::Zero();  // from the vertex to the scan
  Vector3f colour = Vector3f::Zero();
};

std::vector<Partner> partners_of(const TriMesh& skin, const TriMesh& scan, int threads) {
  const SurfacePairs surface(scan);
  const std::vector<Vector3d> normals = vertex_normals(skin);
  std::vector<Partner> partners(skin.vertices.size());
  parallel_for(partners.size(), threads, [&](std::size_t i) {
    const Vector3d& p = skin.vertices[i];
    const auto pair = surface.find(p, normals[i]);
    if (!pair || (pair->point - p).norm() > partner_mm) return;
    Partner& partner = partners[i];
    partner.found = true;
    partner.by = pair->point - p;
    if (scan.colors.empty()) return;
    const SurfacePoint at = surface.tree().nearest(pair->point);
    for (int k = 0; k < 3; ++k)
      partner.colour += static_cast<float>(at.barycentric[k]) *
                        scan.colors[static_cast<std::size_t>(
                            scan.triangles[static_cast<std::size_t>(at.triangle)][k])];
  });
  return partners;
}

/// Number of edges from a vertex to the nearest one without a partner, at most `fade_rings`.
std::vector<int> rings_inside(const std::vector<Partner>& partners, const VertexRings& rings) {
  std::vector<int> depth(partners.size());
  for (std::size_t i = 0; i < depth.size(); ++i) depth[i] = partners[i].found ? fade_rings : 0;
  for (int ring = 1; ring < fade_rings; ++ring)
    for (std::size_t i = 0; i < depth.size(); ++i) {
      if (depth[i] < ring) continue;
      bool beside = false;
      rings.around(i, [&](std::size_t n) { beside = beside || depth[n] == ring - 1; });
      if (beside && depth[i] > ring) depth[i] = ring;
    }
  return depth;
}

/// Noise of scan and skin does not become a rough surface.
void smooth(std::vector<Vector3d>& moves, const VertexRings& rings) {
  constexpr int rounds = 2;
  for (int round = 0; round < rounds; ++round) {
    const std::vector<Vector3d> before = moves;
    for (std::size_t i = 0; i < moves.size(); ++i) {
      Vector3d sum = before[i];
      double count = 1;
      rings.around(i, [&](std::size_t n) {
        sum += before[n];
        ++count;
      });
      moves[i] = sum / count;
    }
  }
}

Vector3f median_colour(const std::vector<Partner>& partners) {
  Vector3f median = Vector3f::Zero();
  for (int k = 0; k < 3; ++k) {
    std::vector<float> values;
    for (const Partner& partner : partners)
      if (partner.found) values.push_back(partner.colour[k]);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    median[k] = *middle;
  }
  return median;
}

/// Colours of the scan; beyond it the means of the neighbours, ring by ring, which tend to the
/// median colour.
std::vector<Vector3f> colours_of(const std::vector<Partner>& partners, const VertexRings& rings) {
  constexpr float kept = 0.93f;  // of the neighbours' colour from ring to ring
  const Vector3f median = median_colour(partners);
  std::vector<Vector3f> colours(partners.size(), median);
  std::vector<char> known(partners.size(), 0);
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < partners.size(); ++i)
    if (partners[i].found) {
      known[i] = 1;
      colours[i] = partners[i].colour;
      front.push_back(i);
    }
  while (!front.empty()) {
    std::vector<std::size_t> next;
    for (const std::size_t i : front)
      rings.around(i, [&](std::size_t n) {
        if (!known[n]) next.push_back(n);
      });
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
    for (const std::size_t n : next) {
      Vector3f sum = Vector3f::Zero();
      float count = 0;
      rings.around(n, [&](std::size_t m) {
        if (!known[m]) return;
        sum += colours[m];
        ++count;
      });
      colours[n] = median + kept * (sum / count - median);
    }
    for (const std::size_t n : next) known[n] = 1;
    front = std::move(next);
  }
  return colours;
}

/// Smaller triangles where the scan has colours.
void refine_under(const TriMesh& scan, int threads, TriMesh& skin) {
  constexpr double edge_mm = 0.9;
  constexpr int most_triangles = 300000;
  const auto partners = partners_of(skin, scan, threads);
  std::vector<double> edges(skin.vertices.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < edges.size(); ++i)
    if (partners[i].found) edges[i] = edge_mm;
  skin = refine(std::move(skin), edges, most_triangles);
}

}  // namespace

FaceFusion fuse_face(const FaceScan& scan, const FaceRegistration& registration, int threads,
                     Case& patient) {
  const auto part = std::find_if(patient.parts.begin(), patient.parts.end(),
                                 [](const Part& p) { return p.role == Role::face; });
  FaceFusion fusion;
  if (part == patient.parts.end()) return fusion;
  TriMesh placed = scan.mesh;
  for (auto& v : placed.vertices) v = registration.X_CS * v;
  weld(placed);
  TriMesh& skin = part->mesh;
  if (!placed.colors.empty()) {
    skin.colors.assign(skin.vertices.size(), Vector3f::Zero());
    refine_under(placed, threads, skin);
  }
  std::vector<Partner> partners = partners_of(skin, placed, threads);
  const VertexRings rings(skin);
  const std::vector<int> depth = rings_inside(partners, rings);
  const auto stomion = patient.landmarks.find("stomion");
  const bool other_mouth = stomion && registration.mouth_opening_mm &&
                           std::abs(*registration.mouth_opening_mm) > open_mouth_mm;
  std::vector<Vector3d> moves(partners.size(), Vector3d::Zero());
  std::vector<double> moved;
  for (std::size_t i = 0; i < partners.size(); ++i) {
    if (!partners[i].found) continue;
    moved.push_back(partners[i].by.norm());
    if (other_mouth && skin.vertices[i].z() < stomion->z() + 6) continue;
    moves[i] = partners[i].by * (static_cast<double>(depth[i]) / fade_rings);
  }
  if (moved.empty()) return fusion;
  smooth(moves, rings);
  if (!placed.colors.empty()) skin.colors = colours_of(partners, rings);
  double area = 0, covered = 0;
  for (const auto& t : skin.triangles) {
    const auto at = [&](int k) { return skin.vertices[static_cast<std::size_t>(t[k])]; };
    const double size = 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
    area += size;
    for (int k = 0; k < 3; ++k)
      if (partners[static_cast<std::size_t>(t[k])].found) covered += size / 3;
  }
  for (std::size_t i = 0; i < moves.size(); ++i) skin.vertices[i] += moves[i];
  std::nth_element(moved.begin(), moved.begin() + static_cast<std::ptrdiff_t>(moved.size() / 2),
                   moved.end());
  fusion.moved_mm = moved[moved.size() / 2];
  fusion.covered = covered / area;
  return fusion;
}

}  // namespace condyle
