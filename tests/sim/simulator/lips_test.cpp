// Lips slide on teeth and on each other, enter neither with nodes or faces, and return to where
// they rested.
#include "sim/tissue/lips.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "engine/core/units.h"
#include "sim/case/case_io.h"
#include "sim/phantom/phantom.h"
#include "sim/tissue/tissue.h"
#include "tests/support/face_overlap.h"
#include "tests/support/jaw_pose.h"
#include "tests/support/real_cases.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Rotated about the condyles, which translate forward and down; the jaw moves aside.
Pose moved(const Case& patient, double open_deg, double aside_mm) {
  const Vector3d condyles =
      0.5 * (*patient.landmarks.find("left_condyle") + *patient.landmarks.find("right_condyle"));
  const double slide = std::max(0.0, open_deg - 4) * 0.4;
  Pose X_CM;
  X_CM.R = Eigen::Quaterniond(Eigen::AngleAxisd(open_deg * degree, Vector3d::UnitX()));
  X_CM.t =
      condyles - X_CM.R * condyles + Vector3d(aside_mm, -slide, -7.3 * (1 - std::exp(-slide / 6)));
  return X_CM;
}

struct PathResult {
  double penetration_mm = 0, slip_mm = 0, left_behind_mm = 0;
  double faces_in_jaws_mm = 0, lip_in_lip_mm = 0;  // deepest samples of whole faces, beyond rest
  int bad = 0;  // frames that did not converge, or with a prism turned inside out
};

/// There and back.
PathResult travel(const Case& patient, double open_deg, double aside_mm, int frames) {
  constexpr int measured_every = 5;
  const auto model = build_tissue(patient);
  EXPECT_EQ(summary(*model).lip_points_left_out, 0);
  const TissueState rest = rest_tissue(*model);
  const test::FaceOverlap faces(patient, *model);
  EXPECT_GT(faces.samples(), 10000u);
  TissueState state = rest;
  TissueWarmStart warm;
  PathResult result;
  for (int i = 1; i <= frames; ++i) {
    const double part = 0.5 * (1 - std::cos(2 * std::numbers::pi * i / frames));
    const Pose X_CM = moved(patient, part * open_deg, part * aside_mm);
    state = solve_tissue(*model, state, test::jaw_at(X_CM), {}, warm);
    result.penetration_mm = std::max(result.penetration_mm, state.penetration_mm);
    result.slip_mm = std::max(result.slip_mm, state.slip_mm);
    if (i % measured_every == 0) {
      result.faces_in_jaws_mm = std::max(result.faces_in_jaws_mm, faces.in_jaws(X_CM, state.nodes));
      result.lip_in_lip_mm = std::max(result.lip_in_lip_mm, faces.in_other_lip(state.nodes));
    }
    result.bad += !state.converged || state.reused || state.inverted_prisms > 0;
  }
  state = solve_tissue(*model, state, {}, {}, warm);
  for (std::size_t i = 0; i < rest.nodes.size(); ++i)
    result.left_behind_mm =
        std::max(result.left_behind_mm, (state.nodes[i] - rest.nodes[i]).norm());
  return result;
}

void expect_good(const PathResult& result) {
  EXPECT_LT(result.penetration_mm, 0.2);
  EXPECT_LT(result.faces_in_jaws_mm, 0.2);
  EXPECT_LT(result.lip_in_lip_mm, 0.2);
  EXPECT_GT(result.slip_mm, 2);
  EXPECT_LT(result.left_behind_mm, 0.02);
  EXPECT_EQ(result.bad, 0);
}

Case builtin() {
  Case patient = builtin_patient();
  part_lips(patient);
  return patient;
}

TEST(BuiltInLips, OpenCloseAndRestWhereTheyRested) { expect_good(travel(builtin(), 38, 0, 140)); }

TEST(BuiltInLips, GlideAsideOverTeethAndBack) { expect_good(travel(builtin(), 3, 8, 70)); }

class CaseBadinLips : public testing::Test {
 protected:
  void SetUp() override {
    const auto folder = test::real_data() / "case-badin";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "real anatomy absent";
    patient = import_meshes({.files = {{Role::maxilla, folder / "maxilla_capped.ply"},
                                       {Role::mandible, folder / "mandible.ply"},
                                       {Role::face, folder / "face_skin.ply"}},
                             .landmarks = folder / "markers.csv",
                             .name = "badin"});
    part_lips(patient);
  }
  Case patient;
};

TEST_F(CaseBadinLips, OpenCloseAndRestWhereTheyRested) { expect_good(travel(patient, 36, 0, 140)); }

TEST_F(CaseBadinLips, GlideAsideOverTeethAndBack) { expect_good(travel(patient, 3, 8, 70)); }

}  // namespace
}  // namespace condyle
