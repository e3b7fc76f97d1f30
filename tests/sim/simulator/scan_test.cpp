// A face scan of another person, its lips fused, over the built-in bones: fiction, but the tissue
// must be built on it and move.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/tissue/lips.h"
#include "sim/tissue/tissue.h"
#include "tests/support/jaw_pose.h"
#include "tests/support/scan_case.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Rotated about the condyles, which translate forward and down.
Pose scan_opened(const Case& patient, int degrees) {
  const Vector3d hinge =
      0.5 * (*patient.landmarks.find("left_condyle") + *patient.landmarks.find("right_condyle"));
  Pose X_CM;
  X_CM.R =
      Eigen::Quaterniond(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vector3d::UnitX()));
  X_CM.t = hinge - X_CM.R * hinge + Vector3d(0, -0.4, -0.2) * std::max(0, degrees - 4);
  return X_CM;
}

TEST(FaceScan, OfAnotherPersonOverScaledBonesIsBuiltAndOpens) {
  const auto built = test::scan_over_scaled_bones();
  if (!built) GTEST_SKIP() << "real anatomy absent";
  Case patient = *built;
  const Vector3d tip = test::nose_tip(patient.find(Role::face)->mesh);
  // The lips meet as far below the tip of the nose as in the built-in face, about.
  const Vector3d stomion = *patient.landmarks.find("stomion");
  EXPECT_NEAR(tip.z() - stomion.z(), 33, 4);
  EXPECT_LT(stomion.y(), patient.landmarks.find("upper_incisal_point")->y());
  part_lips(patient);
  // One opening from corner to corner, though a whole mouth lies behind the lips.
  int openings = 0;
  const TriMesh& face_mesh = patient.find(Role::face)->mesh;
  for (const auto& loop : border_loops(face_mesh)) {
    double right = 1e9, left = -1e9;
    for (int v : loop) {
      right = std::min(right, face_mesh.vertices[v].x());
      left = std::max(left, face_mesh.vertices[v].x());
    }
    if ((face_mesh.vertices[loop[0]] - stomion).norm() > 40) continue;
    ++openings;
    EXPECT_NEAR(left - right, 38, 2);  // the skin's corners, 43 apart, stay whole
  }
  EXPECT_EQ(openings, 1);
  for (const auto& t : face_mesh.triangles) {
    const Vector3d p = face_mesh.vertices[t[0]];
    const Vector3d off = p - stomion;
    EXPECT_FALSE(off.y() > 16 && off.y() < 50 && std::hypot(off.x(), off.z()) < 25) << p;
  }
  const auto model = build_tissue(patient, {.surface_nodes = 220});
  const TissueSummary& made = summary(*model);
  EXPECT_TRUE(made.lips_cut);
  EXPECT_GT(made.attached_to_cranium, 10);
  EXPECT_GT(made.attached_to_mandible, 10);
  EXPECT_FALSE(made.notes.empty());  // it reports what it changed in this face
  EXPECT_LT(made.rest_move_mm, 1e-4);

  TissueState state = rest_tissue(*model);
  TissueWarmStart warm;
  for (int degrees = 1; degrees <= 30; ++degrees) {
    state = solve_tissue(*model, state, test::jaw_at(scan_opened(patient, degrees)), {}, warm);
    EXPECT_FALSE(state.reused) << degrees;
    EXPECT_EQ(state.inverted_prisms, 0) << degrees;
  }
  EXPECT_GT(state.slip_mm, 0.2);
  std::vector<Eigen::Vector3f> face;
  deform_face(*model, state, face);
  double most = 0;
  for (std::size_t v = 0; v < face.size(); ++v) {
    ASSERT_TRUE(face[v].allFinite());
    most = std::max(most, (face[v].cast<double>() - face_mesh.vertices[v]).norm());
  }
  EXPECT_GT(most, 25);
  // Both lips move with their own jaw.
  const auto carried = [&](const char* name) {
    return carried_point(*model, state, *patient.landmarks.find(name));
  };
  const auto moved = [&](const char* name) {
    return (carried(name) - *patient.landmarks.find(name)).norm();
  };
  EXPECT_LT(moved("labrale_superius"), 8);
  EXPECT_GT(moved("labrale_inferius"), 18);
  // No skin spans the lips: each moves with its own side; skin that spanned them
  // would be longer by as much as they part.
  double stretched = 0;
  const auto& corners = patient.find(Role::face)->mesh;
  for (const auto& t : corners.triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      if (std::max(corners.vertices[a].y(), corners.vertices[b].y()) > stomion.y() + 15) continue;
      const double before = (corners.vertices[a] - corners.vertices[b]).norm();
      stretched = std::max(stretched, static_cast<double>((face[a] - face[b]).norm()) - before);
    }
  const Vector3d upper = *patient.landmarks.find("labrale_superius"),
                 lower = *patient.landmarks.find("labrale_inferius");
  const double parted =
      (carried("labrale_inferius") - carried("labrale_superius")).norm() - (lower - upper).norm();
  std::printf("an edge of the face is longer by up to %.1f mm, the lips part by %.1f mm\n",
              stretched, parted);
  EXPECT_LT(stretched, parted / 3);
}

// At a corner of the mouth a triangle of this mesh is connected by one edge only and flips over.
TEST(FaceScan, TheDefaultMeshIsBuiltOnItAndSlides) {
  const auto built = test::scan_over_scaled_bones();
  if (!built) GTEST_SKIP() << "real anatomy absent";
  Case patient = *built;
  part_lips(patient);
  const auto model = build_tissue(patient);
  EXPECT_LT(summary(*model).rest_move_mm, 1e-4);
  TissueState state = rest_tissue(*model);
  TissueWarmStart warm;
  for (int degrees = 1; degrees <= 30; ++degrees) {
    state = solve_tissue(*model, state, test::jaw_at(scan_opened(patient, degrees)), {}, warm);
    EXPECT_TRUE(state.converged && !state.reused) << degrees;
    EXPECT_EQ(state.inverted_prisms, 0) << degrees;
    EXPECT_LT(state.penetration_mm, 0.2) << degrees;
  }
}

}  // namespace
}  // namespace condyle
