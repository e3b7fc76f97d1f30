// The lining behind the lips, which has no nodes of its own, in the built-in patient.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "sim/phantom/phantom.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/tissue.h"
#include "tests/support/jaw_pose.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

TEST(LipLining, BehindTheUpperLipStaysWhenTheJawOpens) {
  Case patient = builtin_patient();
  part_lips(patient);
  const auto model = build_tissue(patient);
  const Vector3d condyles =
      0.5 * (*patient.landmarks.find("left_condyle") + *patient.landmarks.find("right_condyle"));
  TissueState state = rest_tissue(*model);
  TissueWarmStart warm;
  for (int degrees = 2; degrees <= 16; degrees += 2) {
    Pose X_CM;
    X_CM.R =
        Eigen::Quaterniond(Eigen::AngleAxisd(degrees * std::acos(-1) / 180, Vector3d::UnitX()));
    X_CM.t = condyles - X_CM.R * condyles;
    state = solve_tissue(*model, state, jaw_at(X_CM), {}, warm);
  }
  ASSERT_TRUE(state.converged);
  std::vector<Eigen::Vector3f> face;
  deform_face(*model, state, face);

  // From 4 mm behind the vermilion of the upper lip back, above the lip line.
  const Vector3d lip = *patient.landmarks.find("labrale_superius"),
                 stomion = *patient.landmarks.find("stomion");
  const auto& rest = patient.find(Role::face)->mesh.vertices;
  int lining = 0;
  double most = 0;
  for (std::size_t v = 0; v < rest.size(); ++v) {
    const Vector3d& p = rest[v];
    const double above = p.z() - stomion.z();
    if (std::abs(p.x()) > 18 || above < 3 || above > 8) continue;
    const double arch = 0.02 * p.x() * p.x();  // the lips curve back towards the corners
    if (p.y() < lip.y() + arch + 4 || p.y() > lip.y() + arch + 14) continue;
    ++lining;
    most = std::max(most, (face[v].cast<double>() - p).norm());
  }
  std::printf("%d vertices of the lining move by up to %.1f mm\n", lining, most);
  EXPECT_GT(lining, 50);
  EXPECT_LT(most, 8);
  const Vector3d lower = *patient.landmarks.find("labrale_inferius");
  EXPECT_GT((carried_point(*model, state, lower) - lower).norm(), 20);
}

}  // namespace
}  // namespace condyle::test
