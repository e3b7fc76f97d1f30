// The face of a plan is the model of the uncut patient at other poses of the pieces.
#include "sim/tissue/pieces.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "engine/mesh/topology.h"
#include "sim/tissue/anatomy.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/model.h"
#include "tests/support/builtin.h"
#include "tests/support/jaw_pose.h"
#include "tests/support/plane_cut.h"
#include "tests/support/scan_case.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

constexpr BodyId mandible = JawBodies{}.lower_arch, chin{2};

/// The chin below a plane that enters this far above pogonion and exits through the lower border.
CutBone cut_chin(const Case& patient, double above_mm) {
  constexpr double slope = 0.45;
  CutBone cut;
  cut.whole = mandible;
  cut.surface = jaw_mesh(patient, patient.jaw.lower_arch);
  const Vector3d pogonion = *patient.landmarks.find("pogonion");
  const PlaneCut parts = cut_by_plane(cut.surface, pogonion + Vector3d(0, 0, above_mm),
                                      Vector3d(0, slope, 1).normalized());
  for (char below : parts.is_below) cut.owner.push_back(below ? chin : mandible);
  cut.pieces = {{mandible, parts.above}, {chin, parts.below}};
  const double whole = inspect(cut.surface).volume_mm3;
  const Topology of_chin = inspect(parts.below), of_rest = inspect(parts.above);
  EXPECT_TRUE(of_chin.closed());
  EXPECT_TRUE(of_rest.closed());
  EXPECT_GT(of_chin.volume_mm3, 1000);
  EXPECT_NEAR(of_chin.volume_mm3 + of_rest.volume_mm3, whole, 1e-6 * whole);
  return cut;
}

/// Poses of all bodies with the chin displaced relative to the mandible.
std::array<Pose, 3> poses(const Pose& X_CM, const Vector3d& chin_mm) {
  Pose X_MS;
  X_MS.t = chin_mm;
  return {Pose{}, X_CM, X_CM * X_MS};
}

/// Angle of the plain opening at which the lower incisal point has descended by `descent_mm`.
double angle_of(const Case& patient, const OpeningPath& path, double descent_mm) {
  const Vector3d incisal = *patient.landmarks.find("lower_incisal_point");
  double low = 0, high = 0.75;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (incisal.z() - (path.pose(middle) * incisal).z() < descent_mm ? low : high) = middle;
  }
  return high;
}

/// A face that is solved pose by pose; no solve may fail or invert a prism.
class Face {
 public:
  explicit Face(const TissueModel& model) : model_(model), state_(rest_tissue(model)) {}

  void move(std::span<const Pose> X_CB) {
    state_ = solve_tissue(model_, state_, X_CB, {}, warm_);
    EXPECT_FALSE(state_.reused);
    EXPECT_EQ(state_.inverted_prisms, 0);
    penetration_mm_ = std::max(penetration_mm_, state_.penetration_mm);
    unconverged_ += !state_.converged;
  }
  /// Opens the mouth with the chin at a constant pose relative to the mandible.
  void open(double angle_rad, const Vector3d& chin_mm) {
    constexpr int steps = 14;
    for (int i = 1; i <= steps; ++i)
      move(poses(model_.opening.path->pose(angle_rad * i / steps), chin_mm));
  }
  const TissueState& state() const { return state_; }
  /// A point of the face in the mandible's frame.
  Vector3d on_mandible(const Vector3d& rest) const {
    return pose_in(state_.X_CB, mandible).inverse() * carried_point(model_, state_, rest);
  }
  int unconverged() const { return unconverged_; }
  double penetration_mm() const { return penetration_mm_; }

 private:
  const TissueModel& model_;
  TissueState state_;
  TissueWarmStart warm_;
  int unconverged_ = 0;
  double penetration_mm_ = 0;
};

void expect_the_chin_takes_the_skin_along(Case patient, double above_mm) {
  constexpr double open_mm = 40, forward_mm = 8, min_mm = 6;
  part_lips(patient);
  const auto uncut = build_tissue(patient);
  const std::array cuts{cut_chin(patient, above_mm)};
  const auto cut = carry_to_pieces(*uncut, cuts);
  EXPECT_EQ(cut->mesh, uncut->mesh);
  EXPECT_EQ(cut->display, uncut->display);
  EXPECT_EQ(cut->contact->obstacles.size(), uncut->contact->obstacles.size() + 1);
  const Vector3d soft_pogonion = *patient.landmarks.find("soft_pogonion");
  const double angle = angle_of(patient, *uncut->opening.path, open_mm);
  const Vector3d stays = Vector3d::Zero(), forward(0, -forward_mm, 0);

  // Nothing is lost by the saw and nothing has moved.
  Face whole(*uncut), parted(*cut), moved(*cut);
  whole.move({});
  parted.move(poses({}, stays));
  EXPECT_LT(largest_displacement(whole.state().nodes, parted.state().nodes), 1e-3);
  moved.move(poses({}, forward));
  const double at_rest_mm =
      parted.on_mandible(soft_pogonion).y() - moved.on_mandible(soft_pogonion).y();
  EXPECT_GT(at_rest_mm, min_mm);
  Face back = moved;
  back.move(poses({}, stays));
  const double left_mm = largest_displacement(back.state().nodes, whole.state().nodes);
  EXPECT_LT(left_mm, 0.3);

  parted.open(angle, stays);
  moved.open(angle, forward);
  whole.open(angle, stays);
  const double open_forward_mm =
      parted.on_mandible(soft_pogonion).y() - moved.on_mandible(soft_pogonion).y();
  EXPECT_GT(open_forward_mm, min_mm);
  const double difference_mm = largest_displacement(whole.state().nodes, parted.state().nodes);
  EXPECT_LT(difference_mm, 1);
  std::printf(
      "soft pogonion moves %.2f mm forward at rest, %.2f mm at %.0f mm of opening; deepest %.2f "
      "mm; "
      "%d solves unfinished; put back %.3f mm remain; the cut alone changes the open face by %.3f "
      "mm\n",
      at_rest_mm, open_forward_mm, open_mm, moved.penetration_mm(), moved.unconverged(), left_mm,
      difference_mm);
  EXPECT_LT(moved.penetration_mm(), 0.5);
}

TEST(Pieces, TheChinCarriesTheSkinInTheBuiltInPatient) {
  expect_the_chin_takes_the_skin_along(builtin(), 8);
}

TEST(Pieces, TheChinCarriesTheSkinInARealPatient) {
  const auto patient = case_badin_with_face();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  expect_the_chin_takes_the_skin_along(*patient, 11);
}

}  // namespace
}  // namespace condyle::test
