#include "sim/occlusion/elastic_layer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/parallel.h"
#include "engine/mesh/topology.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double tangent_fraction = 0.05;  // of the thickness, below which the law is linear
constexpr double bent_mm = 0.05;           // error bound of interpolated distances
// Where two edges cross, no centre of a piece may be near: sharp convex edges get narrow pieces of
// their own.
constexpr double sharp_cos = 0.94;  // 20 degrees between the faces' normals
constexpr double edge_spacing_mm = 0.1, edge_width_mm = 0.02;
constexpr int leaf_pieces = 24;
constexpr std::size_t runs = 16;  // parts of each surface, summed in a fixed order

int build_balls(LayerSurface& surface, int first, int last) {
  auto& pieces = surface.pieces;
  Box box;
  for (int i = first; i < last; ++i) box.add(pieces[i].point);
  LayerSurface::Ball ball{box.center(), 0, first, last - first, 0};
  for (int i = first; i < last; ++i)
    ball.radius = std::max(ball.radius, (pieces[i].point - ball.center).norm());
  const int index = static_cast<int>(surface.balls.size());
  surface.balls.push_back(ball);
  if (last - first <= leaf_pieces) return index;
  Eigen::Index axis = 0;
  box.size().maxCoeff(&axis);
  const int middle = first + (last - first) / 2;
  std::nth_element(pieces.begin() + first, pieces.begin() + middle, pieces.begin() + last,
                   [axis](const auto& a, const auto& b) {
                     return a.point[axis] != b.point[axis] ? a.point[axis] < b.point[axis]
                                                           : a.triangle < b.triangle;
                   });
  build_balls(surface, first, middle);
  const int right = build_balls(surface, middle, last);
  surface.balls[index].right = right;
  return index;
}

/// Calls visit(piece, point, sample) for the pieces of one surface that are within `reach_mm` of
/// the other, or inside it; X maps the surface into the frame of the field.
template <class Visit>
void visit_near(const LayerSurface& surface, const DistanceField& field, const Pose& X,
                double reach_mm, int root, const Visit& visit) {
  const Eigen::Matrix3d R = X.R.toRotationMatrix();
  std::array<int, 64> stack;
  int depth = 0;
  stack[depth++] = root;
  while (depth > 0) {
    const int index = stack[--depth];
    const auto& ball = surface.balls[index];
    const Vector3d center = R * ball.center + X.t;
    if (field.lower_bound(center) > ball.radius + reach_mm) continue;
    if (const auto here = field.at(center);
        here.known && here.distance_mm - bent_mm > ball.radius + reach_mm)
      continue;
    if (ball.right != 0) {
      stack[depth++] = ball.right;
      stack[depth++] = index + 1;
      continue;
    }
    for (int i = ball.first; i < ball.first + ball.count; ++i) {
      const Vector3d p = R * surface.pieces[i].point + X.t;
      const FieldSample sample = field.at(p);
      if (sample.distance_mm < reach_mm) visit(i, p, sample);
    }
  }
}

/// Balls that divide a surface into about the given number of runs.
std::vector<int> roots(const LayerSurface& surface) {
  std::vector<int> level;
  if (!surface.balls.empty()) level.push_back(0);
  while (!level.empty() && level.size() < runs) {
    std::vector<int> next;
    for (const int index : level) {
      next.push_back(surface.balls[index].right ? index + 1 : index);
      if (surface.balls[index].right) next.push_back(surface.balls[index].right);
    }
    if (next.size() == level.size()) break;
    level = std::move(next);
  }
  return level;
}

void add_sharp_edges(const TriMesh& mesh, const Box& region, LayerSurface& surface) {
  const auto edges = find_edges(mesh);
  const auto corner = [&](int triangle, int k) -> const Vector3d& {
    return mesh.vertices[mesh.triangles[triangle][k]];
  };
  const auto normal = [&](int t) {
    return Vector3d((corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).normalized());
  };
  for (const auto& edge : edges.edges) {
    const Vector3d &a = mesh.vertices[edge.low], &b = mesh.vertices[edge.high];
    if (edge.count != 2 || !region.contains((a + b) / 2)) continue;
    const int s = edges.sides[edge.first].triangle, t = edges.sides[edge.first + 1].triangle;
    const Vector3d n = normal(s);
    const Vector3d middle = (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3;
    if (n.dot(normal(t)) > sharp_cos || n.dot(middle - a) > 0) continue;
    const double length = (b - a).norm();
    const int count = std::max(1, static_cast<int>(std::ceil(length / edge_spacing_mm)));
    for (int i = 0; i <= count; ++i)
      surface.pieces.push_back(
          {a + (b - a) * (static_cast<double>(i) / count), length / count * edge_width_mm, s});
  }
}

}  // namespace

ElasticLayer::Response ElasticLayer::at(double gap_mm) const {
  const double h = thickness_mm, S = stiffness_MPa;
  if (gap_mm >= h) return {};
  const double straight = tangent_fraction * h, g = std::max(gap_mm, straight);
  Response answer{S * (h * std::log(h / g) - (h - g)), S * (h / g - 1), S * h / (g * g)};
  const double deeper = g - gap_mm;
  answer.energy += deeper * (answer.pressure + 0.5 * deeper * answer.stiffness);
  answer.pressure += deeper * answer.stiffness;
  return answer;
}

LayerSurface make_layer_surface(const TriMesh& mesh, const Box& region, double spacing_mm) {
  LayerSurface surface;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& triangle = mesh.triangles[t];
    const Vector3d &a = mesh.vertices[triangle[0]], &b = mesh.vertices[triangle[1]],
                   &c = mesh.vertices[triangle[2]];
    if (!region.contains((a + b + c) / 3)) continue;
    const double area = 0.5 * (b - a).cross(c - a).norm();
    const double edge = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int n = std::max(1, static_cast<int>(std::ceil(edge / spacing_mm)));
    const auto add = [&](double u, double v) {
      surface.pieces.push_back(
          {a + (b - a) * (u / n) + (c - a) * (v / n), area / (n * n), static_cast<int>(t)});
    };
    // Centroids of n * n equal triangles, both orientations.
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n - i; ++j) {
        add(i + 1.0 / 3, j + 1.0 / 3);
        if (i + j < n - 1) add(i + 2.0 / 3, j + 2.0 / 3);
      }
  }
  add_sharp_edges(mesh, region, surface);
  if (!surface.pieces.empty()) build_balls(surface, 0, static_cast<int>(surface.pieces.size()));
  return surface;
}

LayerForce LayerContact::evaluate(const Pose& X_FM, const Vector3d& pivot,
                                  double rotation_length_mm, int threads) const {
  const Vector3d center = X_FM * pivot;
  const Pose X_MF = X_FM.inverse();
  const Eigen::Matrix3d R = X_FM.R.toRotationMatrix();
  const auto moving_roots = roots(*moving_.surface), fixed_roots = roots(*fixed_.surface);
  std::vector<LayerForce> parts(moving_roots.size() + fixed_roots.size());
  parallel_for(parts.size(), threads, [&](std::size_t k) {
    LayerForce& part = parts[k];
    part.min_gap_mm = fixed_.field->settings().band_mm;
    const bool moving = k < moving_roots.size();
    const LayerSurface& surface = moving ? *moving_.surface : *fixed_.surface;
    visit_near(surface, moving ? *fixed_.field : *moving_.field, moving ? X_FM : X_MF,
               layer_.thickness_mm, moving ? moving_roots[k] : fixed_roots[k - moving_roots.size()],
               [&](int i, const Vector3d& p, const FieldSample& sample) {
                 part.min_gap_mm = std::min(part.min_gap_mm, sample.distance_mm);
                 if (!sample.known) return;
                 const auto& piece = surface.pieces[i];
                 const double area = 0.5 * piece.area_mm2;
                 const auto answer = layer_.at(sample.distance_mm);
                 const Vector3d along = moving ? sample.gradient : Vector3d(-(R * sample.gradient));
                 const Twist row = contact_row((moving ? p : piece.point) - center, along,
                                               sample.distance_mm, rotation_length_mm)
                                       .along;
                 part.energy += area * answer.energy;
                 part.gradient -= area * answer.pressure * row;
                 part.hessian += area * answer.stiffness * row * row.transpose();
                 part.area_mm2 += area;
               });
  });
  LayerForce force;
  force.min_gap_mm = fixed_.field->settings().band_mm;
  for (const auto& part : parts) {
    force.energy += part.energy;
    force.gradient += part.gradient;
    force.hessian += part.hessian;
    force.area_mm2 += part.area_mm2;
    force.min_gap_mm = std::min(force.min_gap_mm, part.min_gap_mm);
  }
  return force;
}

bool LayerContact::free(const Pose& X_FM) const {
  bool found = false;
  const auto any = [&](int, const Vector3d&, const FieldSample&) { found = true; };
  if (!moving_.surface->balls.empty())
    visit_near(*moving_.surface, *fixed_.field, X_FM, layer_.thickness_mm, 0, any);
  if (!found && !fixed_.surface->balls.empty())
    visit_near(*fixed_.surface, *moving_.field, X_FM.inverse(), layer_.thickness_mm, 0, any);
  return !found;
}

std::vector<LayerContact::LoadedPiece> LayerContact::loaded_pieces(const Pose& X_FM) const {
  std::vector<LoadedPiece> all;
  if (moving_.surface->balls.empty()) return all;
  visit_near(*moving_.surface, *fixed_.field, X_FM, layer_.thickness_mm, 0,
             [&](int i, const Vector3d& p, const FieldSample& sample) {
               if (!sample.known) return;
               all.push_back(
                   {i, p, sample.gradient, sample.distance_mm,
                    moving_.surface->pieces[i].area_mm2 * layer_.at(sample.distance_mm).pressure});
             });
  return all;
}

}  // namespace condyle
