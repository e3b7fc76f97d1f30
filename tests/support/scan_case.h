#pragma once

#include <cmath>
#include <optional>

#include "engine/mesh_io/mesh_files.h"
#include "sim/case/soft_landmarks.h"
#include "sim/phantom/phantom.h"
#include "tests/support/real_cases.h"

namespace condyle::test {

/// A real subject with bones and face; lips, nostrils and eyes are open.
inline std::optional<Case> case_badin_with_face() {
  const auto folder = real_data() / "case-badin";
  if (!std::filesystem::exists(folder)) return std::nullopt;
  ImportRequest request;
  request.files = {{Role::maxilla, folder / "maxilla_capped.ply"},
                   {Role::mandible, folder / "mandible.ply"},
                   {Role::face, folder / "face_skin.ply"}};
  request.landmarks = folder / "markers.csv";
  request.name = "case-badin";
  return import_meshes(request);
}

/// The foremost point near the middle: the tip of the nose.
inline Eigen::Vector3d nose_tip(const TriMesh& face) {
  Eigen::Vector3d tip(0, 1e9, 0);
  for (const auto& p : face.vertices)
    if (std::abs(p.x()) < 15 && p.y() < tip.y()) tip = p;
  return tip;
}

/// A face scan of another person, its lips fused, over the built-in bones scaled to fit under it.
inline std::optional<Case> scan_over_scaled_bones() {
  using Eigen::Vector3d;
  const auto file = real_data() / "scan-leeperrysmith" / "head_lps_mm.ply";
  if (!std::filesystem::exists(file)) return std::nullopt;
  constexpr double scale = 0.93;
  Case patient = builtin_patient();
  const Vector3d tip = nose_tip(patient.find(Role::face)->mesh);
  const auto scaled = [&](const Vector3d& p) { return Vector3d(tip + scale * (p - tip)); };
  TriMesh scan = read_mesh(file);
  const Vector3d shift = tip - nose_tip(scan) + Vector3d(0, -4, 0);
  for (auto& p : scan.vertices) p += shift;
  for (auto& part : patient.parts)
    if (part.role == Role::face)
      part.mesh = scan;
    else
      for (auto& p : part.mesh.vertices) p = scaled(p);
  // Soft landmarks belong to the removed face.
  for (auto it = patient.landmarks.points.begin(); it != patient.landmarks.points.end();) {
    const bool bony = it->first == "left_condyle" || it->first == "right_condyle" ||
                      it->first == "upper_incisal_point" || it->first == "lower_incisal_point";
    if (bony) it->second = scaled(it->second);
    it = bony ? std::next(it) : patient.landmarks.points.erase(it);
  }
  estimate_profile_landmarks(patient);
  return patient;
}

}  // namespace condyle::test
