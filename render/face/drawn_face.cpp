#include "render/face/drawn_face.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "engine/math/smooth_step.h"
#include "render/face/skin_tint.h"
#include "render/shaders/material.h"
#include "sim/frame/face_openings.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int cover_rings = 6;                // from a rim to the centre
constexpr double coarse_mm = 2;               // mean edge length above which a face is subdivided
constexpr std::size_t max_triangles = 30000;  // limit for subdivision

/// The cover of an opening: rings within the rim, and the centre. Rings follow the rim at a limited
/// number of knots.
constexpr int max_knots = 64;

struct Cover {
  std::vector<int> knots;                  // indices in the rim
  std::vector<Eigen::Vector3i> triangles;  // of the rim, then of the interior
  // The interior, ring by ring, with as many vertices as knots in each:
  Eigen::MatrixXd of_knots;      // one row per vertex: weights
  std::vector<Vector3d> offset;  // mm
  std::vector<Vector3f> color;   // relative to the skin's
};

Cover rings_within(int rim) {
  Cover cover;
  const int n = std::min(rim, max_knots), count = (cover_rings - 1) * n + 1;
  for (int i = 0; i < n; ++i)
    cover.knots.push_back(static_cast<int>(static_cast<long long>(i) * rim / n));
  const auto knot = [&](int i) { return i < n ? cover.knots[static_cast<std::size_t>(i)] : rim; };
  const auto at = [&](int ring, int i) {
    if (ring == 0) return knot(i) % rim;
    return rim + (ring - 1) * n + (ring < cover_rings ? i % n : 0);
  };
  for (int i = 0; i < n; ++i)
    for (int ring = 0; ring < cover_rings; ++ring) {
      if (ring == 0) {
        for (int k = knot(i); k < knot(i + 1); ++k)
          cover.triangles.emplace_back(k, (k + 1) % rim, at(1, i));
      } else {
        cover.triangles.emplace_back(at(ring, i), at(ring, i + 1), at(ring + 1, i));
      }
      if (ring + 1 < cover_rings)
        cover.triangles.emplace_back(at(ring, i + 1), at(ring + 1, i + 1), at(ring + 1, i));
    }
  cover.of_knots = Eigen::MatrixXd::Zero(count, n);
  cover.offset.assign(static_cast<std::size_t>(count), Vector3d::Zero());
  cover.color.assign(static_cast<std::size_t>(count), Vector3f::Ones());
  return cover;
}

/// A closed lid: a membrane over the rim, raised as by a ball behind it.
Cover lid(const FaceOpening& opening) {
  constexpr double height_mm = 5.5;
  Cover cover = rings_within(static_cast<int>(opening.rim.size()));
  const int n = static_cast<int>(cover.knots.size());
  const auto inside = cover.of_knots.rows(), count = n + inside;
  // Each vertex is the mean of its neighbours plus a constant pressure.
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(count, count);
  for (const auto& t : rings_within(n).triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      stiffness(a, b) = stiffness(b, a) = -1;
    }
  for (Eigen::Index v = 0; v < count; ++v) stiffness(v, v) = -stiffness.row(v).sum();
  const Eigen::LDLT<Eigen::MatrixXd> solve(stiffness.bottomRightCorner(inside, inside));
  cover.of_knots = solve.solve(-stiffness.bottomLeftCorner(inside, n));
  const Eigen::VectorXd raised = solve.solve(Eigen::VectorXd::Ones(inside));
  for (Eigen::Index v = 0; v < inside; ++v) {
    const double up = raised[v] / raised.maxCoeff();
    cover.offset[static_cast<std::size_t>(v)] = height_mm * up * (2 - up) * opening.outward;
  }
  return cover;
}

/// A nostril leads up and back, regardless of the direction of its rim, and narrows into the dark.
Cover vestibule(const FaceOpening& opening) {
  constexpr double depth_mm = 8, narrowest = 0.55, aside = 0.25;
  const Vector3f dark(.20f, .18f, .17f);
  Vector3d in = -opening.outward;
  in.x() *= aside;
  in.normalize();
  Cover cover = rings_within(static_cast<int>(opening.rim.size()));
  const int n = static_cast<int>(cover.knots.size()), last = (cover_rings - 1) * n;
  for (int v = 0; v <= last; ++v) {
    const double deep = static_cast<double>(1 + v / n) / cover_rings;
    const double width = v == last ? 0 : 1 - deep * (1 - narrowest);
    cover.of_knots.row(v).setConstant((1 - width) / n);
    if (v < last) cover.of_knots(v, v % n) += width;
    cover.offset[static_cast<std::size_t>(v)] = deep * depth_mm * in;
    cover.color[static_cast<std::size_t>(v)] +=
        static_cast<float>(std::min(1.0, 1.5 * deep)) * (dark - Vector3f::Ones());
  }
  return cover;
}

/// Mean length of the edges, mm.
double mean_edge(const TriMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k)
      sum += (mesh.vertices[static_cast<std::size_t>(t[k])] -
              mesh.vertices[static_cast<std::size_t>(t[(k + 1) % 3])])
                 .norm();
  return mesh.triangles.empty() ? 0 : sum / static_cast<double>(3 * mesh.triangles.size());
}

std::vector<Vector3f> to_float(std::span<const Vector3d> places) {
  std::vector<Vector3f> result;
  result.reserve(places.size());
  for (const auto& p : places) result.push_back(p.cast<float>());
  return result;
}

}  // namespace

DrawnFace::DrawnFace(const TriMesh& face, std::span<const Vector3d> eyes, const Vector3f& color)
    : given_(face.vertices.size()), mesh_(face) {
  close_openings(eyes, color);
  if (changed_) place(face);
  while (smooths(mesh_)) {
    divide();
    place(face);
  }
  draw_lashes();
}

bool DrawnFace::smooths(const TriMesh& face) {
  return face.triangles.size() < max_triangles && mean_edge(face) > coarse_mm;
}

void DrawnFace::close_openings(std::span<const Vector3d> eyes, const Vector3f& color) {
  constexpr double near_mm = 20;
  const auto has_eye = [&](const FaceOpening& opening) {
    return std::any_of(eyes.begin(), eyes.end(),
                       [&](const Vector3d& p) { return (p - opening.middle).norm() < near_mm; });
  };
  for (const auto& opening : find_openings(mesh_)) {
    const bool eye = opening.kind == FaceOpening::Kind::eye;
    if (eye && has_eye(opening)) continue;
    changed_ = true;
    if (mesh_.colors.empty()) mesh_.colors.assign(mesh_.vertices.size(), color);
    const Cover cover = eye ? lid(opening) : vestibule(opening);
    if (eye) {
      constexpr double lower_fraction = 0.5;  // of the height above the rim
      const auto place = [&](int v) -> const Vector3d& {
        return mesh_.vertices[static_cast<std::size_t>(v)];
      };
      const auto [right, left] =
          std::minmax_element(opening.rim.begin(), opening.rim.end(),
                              [&](int a, int b) { return place(a).x() < place(b).x(); });
      double low = place(*right).z();
      for (const int v : opening.rim) low = std::min(low, place(v).z());
      const double line = (place(*right).z() + place(*left).z()) / 2;
      closed_eyes_.push_back({place(*right), place(*left), lower_fraction * (line - low)});
    }
    const int n = static_cast<int>(opening.rim.size());
    const int own = static_cast<int>(mesh_.vertices.size()) - n;
    std::vector<VertexSums::Term> sum;
    for (Eigen::Index v = 0; v < cover.of_knots.rows(); ++v) {
      sum.clear();
      Vector3f skin = Vector3f::Zero();
      for (std::size_t i = 0; i < cover.knots.size(); ++i) {
        const float fraction = static_cast<float>(cover.of_knots(v, static_cast<Eigen::Index>(i)));
        if (fraction == 0) continue;
        const int of = opening.rim[static_cast<std::size_t>(cover.knots[i])];
        sum.push_back({of, fraction});
        skin += fraction * mesh_.colors[static_cast<std::size_t>(of)];
      }
      covers_.add(sum);
      offsets_.push_back(cover.offset[static_cast<std::size_t>(v)].cast<float>());
      mesh_.vertices.emplace_back(Vector3d::Zero());
      mesh_.colors.push_back(skin.cwiseProduct(cover.color[static_cast<std::size_t>(v)]));
    }
    for (Eigen::Vector3i t : cover.triangles) {
      for (int& v : t) v = v < n ? opening.rim[static_cast<std::size_t>(v)] : own + v;
      mesh_.triangles.push_back(t);
    }
  }
}

/// The line where the lids meet is dark, with lashes.
void DrawnFace::draw_lashes() {
  constexpr double half_mm = 0.8, deep_mm = 15;
  const Vector3f dark(.42f, .33f, .31f);
  for (const auto& eye : closed_eyes_) {
    const Vector3d along = eye.left - eye.right;
    for (std::size_t v = 0; v < mesh_.vertices.size(); ++v) {
      const Vector3d p = mesh_.vertices[v] - eye.right;
      const double u = p.x() / along.x();
      if (u < 0 || u > 1 || p.y() > u * along.y() + deep_mm) continue;
      const double off = p.z() - u * along.z() + 4 * u * (1 - u) * eye.below_mm;
      const double fraction =
          std::exp(-std::pow(off / half_mm, 2)) * std::min(1.0, 8 * u * (1 - u));
      mesh_.colors[v] = mesh_.colors[v].cwiseProduct(
          Vector3f::Ones() + static_cast<float>(fraction) * (dark - Vector3f::Ones()));
    }
  }
}

/// Brows over two closed eyes, in fractions of an eye's width: rising to near the outer corner,
/// then slightly falling. The width follows from the distance of the eyes, since the openings are
/// wider.
void DrawnFace::draw_brows() {
  constexpr double width_fraction = 0.43, deep_mm = 20;
  const Vector3f dark(.42f, .36f, .34f);
  if (closed_eyes_.size() != 2) return;
  const auto middle = [&](std::size_t e) -> Vector3d {
    return (closed_eyes_[e].right + closed_eyes_[e].left) / 2;
  };
  const Vector3d between = (middle(0) + middle(1)) / 2;
  const double width = width_fraction * (middle(1) - middle(0)).norm();
  for (std::size_t e = 0; e < 2; ++e) {
    const double outward = middle(e).x() > between.x() ? 1 : -1;
    for (std::size_t v = 0; v < mesh_.vertices.size(); ++v) {
      const Vector3d p = mesh_.vertices[v] - middle(e);
      const double u = outward * p.x() / width;
      if (std::abs(u) > 1 || p.y() > deep_mm) continue;
      const double height = 0.60 + 0.14 * smooth_step((u + 0.7) / 0.9) -
                            0.20 * std::pow(std::max(0.0, (u - 0.1) / 0.7), 2);
      const double half = 0.12 - 0.07 * smooth_step((u + 0.1) / 0.8);
      const double off = (p.z() / width - height) / half;
      const double ends = smooth_step((u + 0.75) / 0.2) * smooth_step((0.85 - u) / 0.4);
      const double fraction = 0.8 * ends * std::exp(-std::pow(std::abs(off), 2.6));
      mesh_.colors[v] = mesh_.colors[v].cwiseProduct(
          Vector3f::Ones() + static_cast<float>(fraction) * (dark - Vector3f::Ones()));
    }
  }
}

void DrawnFace::divide() {
  auto finer = subdivide(static_cast<int>(mesh_.vertices.size()), mesh_.triangles);
  mesh_.triangles = std::move(finer.triangles);
  if (!mesh_.colors.empty()) mesh_.colors = finer.vertices.of<Vector3f>(mesh_.colors);
  smooth_ = divided_ ? composed(finer.vertices, smooth_) : std::move(finer.vertices);
  divided_ = changed_ = true;
}

void DrawnFace::tint(std::span<const int> rim, const Vector3f& skin) {
  if (mesh_.colors.empty()) mesh_.colors.assign(mesh_.vertices.size(), skin);
  tint_skin(mesh_, rim, mesh_.colors);
  changed_ = true;
}

void DrawnFace::place(const TriMesh& face) {
  mesh_.vertices.clear();
  for (const auto& p : places(to_float(face.vertices))) mesh_.vertices.push_back(p.cast<double>());
}

std::vector<Vector3f> DrawnFace::closed(std::span<const Vector3f> face) const {
  std::vector<Vector3f> all(face.begin(), face.end());
  const auto covers = covers_.of(face);
  for (std::size_t v = 0; v < covers.size(); ++v) all.push_back(covers[v] + offsets_[v]);
  return all;
}

std::vector<Vector3f> DrawnFace::places(std::span<const Vector3f> face) const {
  auto all = closed(face);
  return divided_ ? smooth_.of<Vector3f>(all) : all;
}

std::vector<Vector3f> DrawnFace::places_of_given(std::span<const Vector3f> face) const {
  return divided_ ? smooth_.of<Vector3f>(closed(face), given_)
                  : std::vector<Vector3f>(face.begin(), face.end());
}

std::vector<float> DrawnFace::values(std::span<const float> face) const {
  std::vector<float> closed(face.begin(), face.end());
  const auto covers = covers_.of(face);
  closed.insert(closed.end(), covers.begin(), covers.end());
  return divided_ ? smooth_.of<float>(closed) : closed;
}

PreparedParts::PreparedParts(std::span<const Part> patient) : patient_(patient) {
  const auto face = std::find_if(patient.begin(), patient.end(),
                                 [](const Part& part) { return part.role == Role::face; });
  if (face == patient.end()) return;
  std::vector<Vector3d> eyes;
  for (const auto& part : patient)
    if (part.role == Role::eyes)
      eyes.insert(eyes.end(), part.mesh.vertices.begin(), part.mesh.vertices.end());
  const Vector3f skin = material_of(Role::face).color;
  DrawnFace drawn(face->mesh, eyes, skin);
  lining_ = line_mouth(patient, &drawn.mesh());
  // Where the lips have an inner side, they do not end at the rim.
  if (face->mesh.colors.empty()) drawn.draw_brows();
  if (face->mesh.colors.empty() && lining_ && !lining_->cut) drawn.tint(lining_->rim, skin);
  if (!drawn.changed()) return;
  replaced_ = &*face;
  own_ = {face->name, face->role, drawn.mesh(), {}, face->body};
  face_ = std::move(drawn);
}

}  // namespace condyle
