// Scans of dental arches whose truth is known, made from the crowns of a case.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <random>

#include "engine/field/isosurface.h"
#include "engine/math/pose.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/topology.h"
#include "sim/case/case.h"

namespace condyle::test {

inline const Part& crowns(const Case& patient, bool upper) {
  return *patient.find(upper ? Role::upper_teeth : Role::lower_teeth);
}

inline TriMesh carried(TriMesh mesh, const Pose& X) {
  for (auto& v : mesh.vertices) v = X * v;
  return mesh;
}

/// Cut at the gum: the occlusal 7 mm of each tooth.
inline TriMesh cut_at_gum(const TriMesh& mesh, bool upper, double height_mm = 7) {
  const Components teeth = find_components(mesh);
  std::vector<double> top(static_cast<std::size_t>(teeth.count), -1e9), values;
  std::vector<int> tooth_of(mesh.vertices.size());
  const auto height = [&](int v) { return (upper ? -1 : 1) * mesh.vertices[v].z(); };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const int v : mesh.triangles[t]) {
      tooth_of[v] = teeth.of_triangle[t];
      top[tooth_of[v]] = std::max(top[tooth_of[v]], height(v));
    }
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v)
    values.push_back(top[tooth_of[v]] - height(v) - height_mm);
  return clipped(mesh, values);
}

inline void add_noise(TriMesh& mesh, double sigma_mm, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, sigma_mm);
  for (auto& v : mesh.vertices)
    v += Eigen::Vector3d(normal(random), normal(random), normal(random));
}

inline void punch_hole(TriMesh& mesh, const Eigen::Vector3d& at, double radius_mm) {
  std::erase_if(mesh.triangles, [&](const Eigen::Vector3i& t) {
    return (mesh.vertices[t[0]] - at).norm() < radius_mm;
  });
  drop_unreferenced(mesh);
}

/// Anywhere, turned in any direction.
inline Pose random_pose(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Pose pose;
  pose.R = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random));
  pose.R.normalize();
  pose.t = 80 * Eigen::Vector3d(normal(random), normal(random), normal(random));
  return pose;
}

/// As a scanner gives it: cut at the gum, with noise of 0.02 mm.
inline TriMesh made_scan(const Part& teeth, const Pose& X_SC, unsigned seed = 1) {
  TriMesh mesh = cut_at_gum(teeth.mesh, teeth.role == Role::upper_teeth);
  add_noise(mesh, 0.02, seed);
  return carried(std::move(mesh), X_SC);
}

/// Crowns as a CT shows them: noise of 0.15 mm, 0.10 mm too large, a fifth of the area off by up to
/// 3 mm along its normal in patches.
inline void make_ct_like(Part& teeth, unsigned seed) {
  constexpr double noise_mm = 0.15, outward_mm = 0.10, off_mm = 3, patch_mm = 4, fraction = 0.2;
  TriMesh& mesh = teeth.mesh;
  const auto normals = vertex_normals(mesh);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-off_mm, off_mm);
  std::vector<double> off(mesh.vertices.size(), 0);
  std::size_t moved = 0;
  while (static_cast<double>(moved) < fraction * static_cast<double>(off.size())) {
    const Eigen::Vector3d center = mesh.vertices[random() % mesh.vertices.size()];
    const double shift = uniform(random);
    for (std::size_t i = 0; i < off.size(); ++i)
      if (off[i] == 0 && (mesh.vertices[i] - center).norm() < patch_mm) off[i] = shift, ++moved;
  }
  for (std::size_t i = 0; i < off.size(); ++i)
    mesh.vertices[i] += (outward_mm + off[i]) * normals[i] +
                        noise_mm * Eigen::Vector3d(normal(random), normal(random), normal(random));
}

/// Mean and greatest distance of the crowns' vertices between two poses of the scan.
struct PoseError {
  double mean_mm = 0, largest_mm = 0;
};
inline PoseError pose_error(const TriMesh& scan, const Pose& X, const Pose& truth) {
  PoseError error;
  for (const auto& v : scan.vertices) {
    const double mm = (X * v - truth * v).norm();
    error.mean_mm += mm / static_cast<double>(scan.vertices.size());
    error.largest_mm = std::max(error.largest_mm, mm);
  }
  return error;
}

}  // namespace condyle::test
