#include "render/drawn_face.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "render/face_openings.h"
#include "render/material.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int rings = 6;                       // from a rim to the middle
constexpr double coarse_mm = 2;                // of a mean edge that is still divided
constexpr std::size_t most_triangles = 30000;  // that are

/// What closes an opening: rings of as many vertices as the rim has, which is the first, and the
/// middle. The rim's own are numbered first.
struct Cover {
  std::vector<Eigen::Vector3i> triangles;
  Eigen::MatrixXd of_rim;        // a row a vertex: shares of the rim's
  std::vector<Vector3d> offset;  // mm
  std::vector<Vector3f> color;   // as a share of the skin's
};

Cover rings_within(int n) {
  Cover cover;
  const auto at = [&](int ring, int i) { return ring * n + (ring < rings ? i % n : 0); };
  for (int i = 0; i < n; ++i)
    for (int ring = 0; ring < rings; ++ring) {
      cover.triangles.emplace_back(at(ring, i), at(ring, i + 1), at(ring + 1, i));
      if (ring + 1 < rings)
        cover.triangles.emplace_back(at(ring, i + 1), at(ring + 1, i + 1), at(ring + 1, i));
    }
  const int count = rings * n + 1;
  cover.of_rim = Eigen::MatrixXd::Zero(count, n);
  cover.of_rim.topRows(n).setIdentity();
  cover.offset.assign(static_cast<std::size_t>(count), Vector3d::Zero());
  cover.color.assign(static_cast<std::size_t>(count), Vector3f::Ones());
  return cover;
}

/// A closed lid: stretched over the rim, and raised as by a ball behind it.
Cover lid(const FaceOpening& opening) {
  constexpr double height_mm = 5.5;
  const int n = static_cast<int>(opening.rim.size());
  Cover cover = rings_within(n);
  const auto count = cover.of_rim.rows(), inside = count - n;
  // Each vertex is the mean of its neighbours; under even pressure it stands off that.
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(count, count);
  for (const auto& t : cover.triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      stiffness(a, b) = stiffness(b, a) = -1;
    }
  for (Eigen::Index v = 0; v < count; ++v) stiffness(v, v) = -stiffness.row(v).sum();
  const Eigen::LDLT<Eigen::MatrixXd> solve(stiffness.bottomRightCorner(inside, inside));
  cover.of_rim.bottomRows(inside) = solve.solve(-stiffness.bottomLeftCorner(inside, n));
  const Eigen::VectorXd raised = solve.solve(Eigen::VectorXd::Ones(inside));
  for (Eigen::Index v = 0; v < inside; ++v) {
    const double up = raised[v] / raised.maxCoeff();
    cover.offset[static_cast<std::size_t>(n + v)] = height_mm * up * (2 - up) * opening.outward;
  }
  return cover;
}

/// A nostril leads up and back, whichever way its rim looks, and narrows into the dark.
Cover vestibule(const FaceOpening& opening) {
  constexpr double depth_mm = 8, narrowest = 0.55, aside = 0.25;
  const Vector3f dark(.20f, .18f, .17f);
  Vector3d in = -opening.outward;
  in.x() *= aside;
  in.normalize();
  const int n = static_cast<int>(opening.rim.size());
  Cover cover = rings_within(n);
  for (int v = n; v <= rings * n; ++v) {
    const double deep = static_cast<double>(v / n) / rings;
    const double width = v == rings * n ? 0 : 1 - deep * (1 - narrowest);
    cover.of_rim.row(v).setConstant((1 - width) / n);
    if (v < rings * n) cover.of_rim(v, v % n) += width;
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

DrawnFace::DrawnFace(const TriMesh& face, EyesBehind behind, const Vector3f& color)
    : given_(face.vertices.size()), mesh_(face) {
  for (int v = 0; v < static_cast<int>(face.vertices.size()); ++v)
    closed_.add(std::vector<VertexSums::Share>{{v, 1.f}});
  offsets_.assign(face.vertices.size(), Vector3f::Zero());
  close_openings(face, behind, color);
  if (changed_) place(face);
  while (mean_edge(mesh_) > coarse_mm && mesh_.triangles.size() < most_triangles) {
    divide();
    place(face);
  }
}

void DrawnFace::close_openings(const TriMesh& face, EyesBehind behind, const Vector3f& color) {
  for (const auto& opening : find_openings(face)) {
    if (opening.kind == FaceOpening::Kind::eye && behind == EyesBehind::eyes) continue;
    changed_ = true;
    if (mesh_.colors.empty()) mesh_.colors.assign(mesh_.vertices.size(), color);
    const Cover cover = opening.kind == FaceOpening::Kind::eye ? lid(opening) : vestibule(opening);
    const int n = static_cast<int>(opening.rim.size());
    const int own = static_cast<int>(mesh_.vertices.size()) - n;
    std::vector<VertexSums::Share> sum;
    for (Eigen::Index v = n; v < cover.of_rim.rows(); ++v) {
      sum.clear();
      Vector3f skin = Vector3f::Zero();
      for (int i = 0; i < n; ++i) {
        const float share = static_cast<float>(cover.of_rim(v, i));
        if (share == 0) continue;
        const int of = opening.rim[static_cast<std::size_t>(i)];
        sum.push_back({of, share});
        skin += share * mesh_.colors[static_cast<std::size_t>(of)];
      }
      closed_.add(sum);
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

void DrawnFace::divide() {
  auto finer = subdivide(static_cast<int>(mesh_.vertices.size()), mesh_.triangles);
  mesh_.triangles = std::move(finer.triangles);
  if (!mesh_.colors.empty()) mesh_.colors = finer.vertices.of<Vector3f>(mesh_.colors);
  smooth_ = divided_ ? composed(finer.vertices, smooth_) : std::move(finer.vertices);
  divided_ = changed_ = true;
}

void DrawnFace::place(const TriMesh& face) {
  mesh_.vertices.clear();
  for (const auto& p : places(to_float(face.vertices))) mesh_.vertices.push_back(p.cast<double>());
}

std::vector<Vector3f> DrawnFace::places(std::span<const Vector3f> face) const {
  auto closed = closed_.of(face);
  for (std::size_t v = 0; v < closed.size(); ++v) closed[v] += offsets_[v];
  return divided_ ? smooth_.of<Vector3f>(closed) : closed;
}

std::vector<float> DrawnFace::values(std::span<const float> face) const {
  const auto closed = closed_.of(face);
  return divided_ ? smooth_.of<float>(closed) : closed;
}

DrawnParts::DrawnParts(std::span<const Part> patient) : shown_(patient) {
  const auto face = std::find_if(patient.begin(), patient.end(),
                                 [](const Part& part) { return part.role == Role::face; });
  if (face == patient.end()) return;
  const bool eyes = std::any_of(patient.begin(), patient.end(),
                                [](const Part& part) { return part.role == Role::eyes; });
  DrawnFace drawn(face->mesh, eyes ? EyesBehind::eyes : EyesBehind::none,
                  material_of(Role::face).color);
  if (!drawn.changed()) return;
  own_.assign(patient.begin(), patient.end());
  own_[static_cast<std::size_t>(face - patient.begin())].mesh = drawn.mesh();
  shown_ = own_;
  face_ = std::move(drawn);
}

}  // namespace condyle
