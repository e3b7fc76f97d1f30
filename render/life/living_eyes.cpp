#include "render/life/living_eyes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "render/face/lashes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr float smallest_mm = 9, largest_mm = 15;  // radius of an eyeball
constexpr float uneven_mm = 1.5f;                  // of its surface: the cornea bulges
constexpr float iris_mm = 5.5f;                    // radius
constexpr float dark = 0.12f;                      // of a pupil, largest of the channels
constexpr double seen_mm = 700;                    // distance of the point that is looked at
// Roots of lashes: within this many radii of an eyeball's centre, and this near to the skin.
constexpr float beside_eye = 1.5f, off_skin_mm = 3;
constexpr float visible_mm = 0.02f;
const Vector3f ahead(0, -1, 0);

/// Vertices of the triangles by the component they are in.
std::vector<std::vector<int>> pieces_of(const TriMesh& mesh,
                                        const std::vector<Eigen::Vector3i>& triangles) {
  const TriMesh own{mesh.vertices, triangles, {}};
  const Components components = find_components(own);
  std::vector<std::set<int>> pieces(static_cast<std::size_t>(components.count));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    pieces[static_cast<std::size_t>(components.of_triangle[t])].insert(triangles[t].begin(),
                                                                       triangles[t].end());
  std::vector<std::vector<int>> lists;
  for (const auto& piece : pieces) lists.emplace_back(piece.begin(), piece.end());
  return lists;
}

/// Distance from the axis of the gaze at rest.
float off_axis(const Vector3f& v) { return std::hypot(v.x(), v.z()); }

/// Measures how far its surface is from the centre.
void measure(Eyeball& eyeball, const TriMesh& mesh, std::span<const int> vertices) {
  eyeball.profile.assign(static_cast<std::size_t>(3.2f / Eyeball::step_rad) + 1, eyeball.radius);
  for (const int v : vertices) {
    const Vector3f from = mesh.vertices[static_cast<std::size_t>(v)].cast<float>() - eyeball.centre;
    const float at = std::acos(std::clamp(-from.y() / from.norm(), -1.f, 1.f)) / Eyeball::step_rad;
    float& most = eyeball.profile[static_cast<std::size_t>(at)];
    most = std::max(most, from.norm());
  }
}

/// Radius of the pupil, mm: up to the first vertex from the middle that is not dark; 0: none.
float pupil_of(const Eyeball& eyeball, const TriMesh& mesh, std::span<const int> vertices) {
  if (mesh.colors.size() != mesh.vertices.size()) return 0;
  float innermost = std::numeric_limits<float>::infinity(), black = 0;
  const auto from = [&](int v) -> Vector3f {
    return mesh.vertices[static_cast<std::size_t>(v)].cast<float>() - eyeball.centre;
  };
  const auto is_dark = [&](int v) {
    return mesh.colors[static_cast<std::size_t>(v)].maxCoeff() < dark;
  };
  for (const int v : vertices)
    if (from(v).y() < 0 && !is_dark(v)) innermost = std::min(innermost, off_axis(from(v)));
  for (const int v : vertices)
    if (from(v).y() < 0 && is_dark(v) && off_axis(from(v)) < innermost)
      black = std::max(black, off_axis(from(v)));
  return black < 0.8f * iris_mm ? black : 0;
}

}  // namespace

LivingEyes::LivingEyes(const TriMesh& mesh) {
  const EyePieces parted = part_lashes(mesh);
  const auto place = [&](int v) -> Vector3f {
    return mesh.vertices[static_cast<std::size_t>(v)].cast<float>();
  };
  std::vector<std::vector<int>> others;
  for (auto& piece : pieces_of(mesh, parted.eyes)) {
    Eigen::AlignedBox3f box;
    for (const int v : piece) box.extend(place(v));
    // The back is round whatever the cornea does.
    Eyeball ball;
    ball.radius = (box.sizes().x() + box.sizes().z()) / 4;
    ball.centre = box.center();
    ball.centre.y() = box.max().y() - ball.radius;
    const bool round = std::all_of(piece.begin(), piece.end(), [&](int v) {
      return std::abs((place(v) - ball.centre).norm() - ball.radius) < uneven_mm;
    });
    if (!round || ball.radius < smallest_mm || ball.radius > largest_mm) {
      others.push_back(std::move(piece));
      continue;
    }
    measure(ball, mesh, piece);
    pupils_.push_back(pupil_of(ball, mesh, piece));
    eyeballs_.push_back(std::move(ball));
    on_.push_back(std::move(piece));
  }
  const auto nearest = [&](const Vector3f& p) {
    std::size_t best = 0;
    for (std::size_t e = 1; e < eyeballs_.size(); ++e)
      if ((p - eyeballs_[e].centre).norm() < (p - eyeballs_[best].centre).norm()) best = e;
    return best;
  };
  if (eyeballs_.empty()) return;
  for (const auto& piece : others) {
    const std::size_t e = nearest(place(piece.front()));
    if ((place(piece.front()) - eyeballs_[e].centre).norm() < eyeballs_[e].radius + uneven_mm)
      on_[e].insert(on_[e].end(), piece.begin(), piece.end());
  }
  for (auto& piece : pieces_of(mesh, parted.lashes)) {
    const Eyeball& ball = eyeballs_[nearest(place(piece.front()))];
    const int root = *std::min_element(piece.begin(), piece.end(), [&](int a, int b) {
      return (place(a) - ball.centre).norm() < (place(b) - ball.centre).norm();
    });
    lashes_.push_back({std::move(piece), place(root)});
  }
}

void LivingEyes::root_lashes(std::span<const UpperLid> lids, std::span<const Vector3f> rest,
                             std::span<const Eigen::Vector3i> triangles) {
  std::vector<Eigen::Vector3i> near;
  const auto beside = [&](const Vector3f& p, std::size_t lid) {
    return (p - lids[lid].eyeball().centre).norm() < beside_eye * lids[lid].eyeball().radius;
  };
  TriMesh skin;
  for (const auto& t : triangles)
    for (std::size_t lid = 0; lid < lids.size(); ++lid)
      if (beside(rest[static_cast<std::size_t>(t[0])], lid)) {
        near.push_back(t);
        for (const int v : t)
          skin.vertices.push_back(rest[static_cast<std::size_t>(v)].cast<double>());
        const int last = static_cast<int>(skin.vertices.size());
        skin.triangles.emplace_back(last - 3, last - 2, last - 1);
        break;
      }
  if (near.empty()) return;
  const TriangleTree tree(skin);
  for (Lash& lash : lashes_)
    for (std::size_t lid = 0; lid < lids.size() && !lash.lid; ++lid) {
      if (!beside(lash.root, lid)) continue;
      const SurfacePoint root = tree.nearest(lash.root.cast<double>(), off_skin_mm);
      if (root.triangle < 0) continue;
      lash.lid = lid;
      const auto& t = near[static_cast<std::size_t>(root.triangle)];
      for (int k = 0; k < 3; ++k) {
        lash.skin[static_cast<std::size_t>(k)] = t[k];
        lash.skin_rest[static_cast<std::size_t>(k)] = rest[static_cast<std::size_t>(t[k])];
        lash.weight[k] = static_cast<float>(root.barycentric[k]);
      }
    }
}

std::vector<Vector3f> LivingEyes::root_shifts(std::span<const Vector3f> face) const {
  std::vector<Vector3f> shifts;
  float farthest = 0;
  for (const Lash& lash : lashes_) {
    Vector3f shift = Vector3f::Zero();
    for (std::size_t k = 0; lash.lid && k < 3; ++k)
      shift += lash.weight[static_cast<int>(k)] *
               (face[static_cast<std::size_t>(lash.skin[k])] - lash.skin_rest[k]);
    farthest = std::max(farthest, shift.norm());
    shifts.push_back(shift);
  }
  if (farthest < visible_mm) shifts.clear();
  return shifts;
}

Vector3f LivingEyes::gaze_of(std::size_t eyeball, const LifeSigns& signs) const {
  if (!signs.alive) return ahead;
  Vector3d middle = Vector3d::Zero();
  for (const Eyeball& each : eyeballs_)
    middle += each.centre.cast<double>() / static_cast<double>(eyeballs_.size());
  const Vector3d to(std::sin(signs.gaze_left), -std::cos(signs.gaze_left) * std::cos(signs.gaze_up),
                    std::sin(signs.gaze_up));
  return (middle + seen_mm * to - eyeballs_[eyeball].centre.cast<double>())
      .normalized()
      .cast<float>();
}

void LivingEyes::move(const LifeSigns& signs, std::span<Vector3f> places,
                      std::span<Vector3f> normals) const {
  for (std::size_t e = 0; signs.alive && e < eyeballs_.size(); ++e) {
    const Eyeball& ball = eyeballs_[e];
    const Eigen::Matrix3f R =
        Eigen::Quaternionf::FromTwoVectors(ahead, gaze_of(e, signs)).toRotationMatrix();
    const float pupil = pupils_[e], wider = pupil * static_cast<float>(signs.pupil - 1);
    for (const int v : on_[e]) {
      Vector3f& p = places[static_cast<std::size_t>(v)];
      Vector3f from = p - ball.centre;
      const float off = off_axis(from);
      if (pupil > 0 && off > 0 && off < iris_mm && from.y() < 0) {
        const float now =
            off + wider * (off < pupil ? off / pupil : (iris_mm - off) / (iris_mm - pupil));
        const float far = from.norm();
        from.x() *= now / off;
        from.z() *= now / off;
        from.y() = -std::sqrt(std::max(0.f, far * far - now * now));
      }
      p = ball.centre + R * from;
      normals[static_cast<std::size_t>(v)] = R * normals[static_cast<std::size_t>(v)];
    }
  }
}

void LivingEyes::move_lashes(std::span<const Vector3f> shifts, std::span<const UpperLid> lids,
                             std::span<Vector3f> places, std::span<Vector3f> normals) const {
  for (std::size_t i = 0; i < shifts.size(); ++i) {
    const Lash& lash = lashes_[i];
    if (!lash.lid) continue;
    const UpperLid& lid = lids[*lash.lid];
    const auto up = [&](const Vector3f& p) { return lid.place_of(p.cast<double>()).up; };
    const Vector3f to = lash.root + shifts[i];
    const Eigen::Matrix3f R = lid.turned(up(to) - up(lash.root));
    for (const int v : lash.vertices) {
      Vector3f& p = places[static_cast<std::size_t>(v)];
      p = to + R * (p - lash.root);
      normals[static_cast<std::size_t>(v)] = R * normals[static_cast<std::size_t>(v)];
    }
  }
}

}  // namespace condyle
