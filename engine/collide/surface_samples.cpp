#include "engine/collide/surface_samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/collide/sample_thinning.h"
#include "engine/mesh/topology.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr int samples_a_leaf = 16;  // evaluated by a field in one call
constexpr double hollow_slope =
    0.05;  // tangent of half the angle of an edge that counts as concave

int build_balls(SurfaceSamples& s, std::vector<int>& order, const std::vector<Vector3d>& points,
                int first, int last) {
  Box box;
  for (int i = first; i < last; ++i) box.add(points[order[i]]);
  const int index = static_cast<int>(s.balls.size());
  const Eigen::Vector3f center = box.center().cast<float>();
  double radius2 = 0;
  for (int i = first; i < last; ++i)
    radius2 = std::max(radius2, (points[order[i]] - center.cast<double>()).squaredNorm());
  s.balls.push_back({center, std::nextafter(static_cast<float>(std::sqrt(radius2)), 1e30f), first,
                     last - first, 0});
  if (last - first <= samples_a_leaf) return index;
  Eigen::Index axis = 0;
  box.size().maxCoeff(&axis);
  const int middle = first + (last - first) / 2;
  std::nth_element(order.begin() + first, order.begin() + middle, order.begin() + last,
                   [&](int a, int b) {
                     const double x = points[a][axis], y = points[b][axis];
                     return x < y || (x == y && a < b);
                   });
  build_balls(s, order, points, first, middle);
  s.balls[index].right = build_balls(s, order, points, middle, last);
  return index;
}

void make_blocks(SurfaceSamples& s) {
  for (SurfaceSamples::Ball& ball : s.balls) {
    if (ball.right != 0) continue;
    ball.block = static_cast<int>(s.blocks.size());
    DistanceField::Batch16& block = s.blocks.emplace_back();
    for (int i = 0; i < samples_a_leaf; ++i) {
      const Vector3d& p = s.points[ball.first + std::min(i, ball.count - 1)];
      const Eigen::Vector3f from_center = (p - ball.center.cast<double>()).cast<float>();
      block.x[i] = from_center.x();
      block.y[i] = from_center.y();
      block.z[i] = from_center.z();
    }
  }
}

}  // namespace

SurfaceSamples sample_surface(const TriMesh& mesh, const SampleSettings& settings) {
  SamplePoints places;
  const auto add = [&](const Vector3d& p, const Vector3d& normal, double widest) {
    if (settings.region && !settings.region->contains(p)) return;
    places.points.push_back(p);
    places.normals.push_back(normal);
    places.spread.push_back(static_cast<float>(widest));
  };
  std::vector<Vector3d> face(mesh.triangles.size());
  for (std::size_t i = 0; i < face.size(); ++i) {
    const auto& t = mesh.triangles[i];
    const Vector3d& a = mesh.vertices[t[0]];
    face[i] = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).normalized();
  }

  const std::vector<Vector3d> corner = vertex_normals(mesh);
  std::vector<double> corner_spread(mesh.vertices.size(), 1.0);
  for (std::size_t i = 0; i < face.size(); ++i)
    for (const int v : mesh.triangles[i])
      corner_spread[v] = std::min(corner_spread[v], corner[v].dot(face[i]));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (corner[v] != Vector3d::Zero()) add(mesh.vertices[v], corner[v], corner_spread[v]);

  const EdgeList list = find_edges(mesh);
  for (const Edge& edge : list.edges) {
    const Vector3d &p = mesh.vertices[edge.low], &q = mesh.vertices[edge.high];
    Vector3d sum = Vector3d::Zero();
    for (int i = 0; i < edge.count; ++i) sum += face[list.sides[edge.first + i].triangle];
    double spacing = edge.count == 2 ? settings.spacing_mm : settings.edge_spacing_mm;
    if (edge.count == 2) {
      const Vector3d &m = face[list.sides[edge.first].triangle],
                     &n = face[list.sides[edge.first + 1].triangle];
      const auto& t = mesh.triangles[list.sides[edge.first + 1].triangle];
      int apex = t[0];
      for (int k = 0; k < 3; ++k)
        if (t[k] != edge.low && t[k] != edge.high) apex = t[k];
      const double slope = std::tan(0.5 * std::atan2(m.cross(n).norm(), m.dot(n)));
      if (m.dot(mesh.vertices[apex] - p) >= 0) {
        if (slope > hollow_slope) continue;
      } else if (slope * spacing > 2 * settings.edge_rise_mm) {
        spacing = std::max(2 * settings.edge_rise_mm / slope, settings.edge_spacing_mm);
      }
    }
    const Vector3d normal = sum.normalized();
    double widest = 1;
    for (int i = 0; i < edge.count; ++i)
      widest = std::min(widest, normal.dot(face[list.sides[edge.first + i].triangle]));
    const int pieces = std::max(1, static_cast<int>(std::ceil((q - p).norm() / spacing)));
    for (int i = 1; i < pieces; ++i)
      add(p + (q - p) * (static_cast<double>(i) / pieces), normal, widest);
  }

  for (std::size_t i = 0; i < face.size(); ++i) {
    if (face[i] == Vector3d::Zero()) continue;
    const auto& t = mesh.triangles[i];
    const Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int n = std::max(1, static_cast<int>(std::ceil(longest / settings.spacing_mm)));
    for (int u = 1; u < n; ++u)
      for (int v = 1; u + v < n; ++v)
        add(a + (b - a) * (static_cast<double>(u) / n) + (c - a) * (static_cast<double>(v) / n),
            face[i], 1);
  }

  SurfaceSamples samples;
  if (settings.thin_fraction > 0)
    places = thinned(places, settings.thin_fraction * settings.spacing_mm, settings.edge_rise_mm);
  const auto& [points, normals, spread] = places;
  if (points.empty()) return samples;
  for (const auto& p : points) samples.centroid += p;
  samples.centroid /= static_cast<double>(points.size());
  double square = 0;
  for (const auto& p : points) square += (p - samples.centroid).squaredNorm();
  samples.gyration_mm = std::sqrt(square / static_cast<double>(points.size()));
  std::vector<int> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  build_balls(samples, order, points, 0, static_cast<int>(points.size()));
  for (const int i : order) {
    samples.points.push_back(points[i]);
    samples.normals.push_back(normals[i]);
    samples.spread.push_back(spread[i]);
  }
  make_blocks(samples);
  return samples;
}

}  // namespace condyle
