#include <gtest/gtest.h>

#include <chrono>

#include "sim/contact/contact.h"
#include "tests/support/boxes.h"
#include "tests/support/real_cases.h"

namespace condyle {
namespace {

TEST(RealAnatomy, BadinDrivenUpStopsAtTheSurface) {
  const auto patient = test::case_badin();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  const ContactModel model(*patient);
  EXPECT_NEAR(model.at_rest().min_clearance_mm(), 3.8, 0.1);
  for (const double up : {10.0, 45.0}) {
    const auto stop =
        model.stop_at_contact({}, Pose{Eigen::Quaterniond::Identity(), {0, 0, up}}, nullptr);
    EXPECT_TRUE(stop.stopped);
    EXPECT_GT(stop.contacts.min_clearance_mm(), 0);
    EXPECT_LE(stop.contacts.min_clearance_mm(), 0.05);
    EXPECT_GT(stop.at[mandible_body].t.z(), 3);
    EXPECT_LT(stop.at[mandible_body].t.z(), 5);
    EXPECT_EQ(stop.contacts.max_penetration_mm(), 0);
  }
}

TEST(RealAnatomy, UbcCrownsOverlapAtRestAndMaySlideOutButNoDeeper) {
  const auto patient = test::case_ubc();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  const ContactModel model(*patient);
  ASSERT_EQ(model.at_rest().pairs.size(), 4u);
  EXPECT_EQ(model.notes().size(), 4u);
  double deepest = 0;
  for (const auto& pair : model.at_rest().pairs) deepest = std::max(deepest, pair.depth_mm);
  EXPECT_NEAR(deepest, 1.3, 0.15);
  // The first degrees of an opening, then back up and beyond.
  const Eigen::Vector3d condyles(0, 31.4501, 79.6370);
  const auto turn = [&](double radians, double forward, double drop) {
    const Eigen::Quaterniond R(Eigen::AngleAxisd(radians, Eigen::Vector3d::UnitX()));
    return Pose{R, condyles - R * condyles + Eigen::Vector3d(0, -forward, -drop)};
  };
  Pose from;
  ContactSet last = model.at_rest();
  for (const double angle : {0.01, 0.03, 0.06}) {
    const auto stop = model.stop_at_contact(from, turn(angle, 7 * angle, 3 * angle), &last);
    EXPECT_FALSE(stop.stopped) << angle;
    from = stop.at[mandible_body];
    last = stop.contacts;
  }
  const auto closed = model.stop_at_contact(from, turn(-0.1, 0, 0), &last);
  EXPECT_TRUE(closed.stopped);
  EXPECT_LE(closed.contacts.max_penetration_mm(), 0.02);
  EXPECT_LT(rotation_angle(closed.at[mandible_body]), 0.02);  // about where the bite was
  // The crowns' overlap does not excuse the condyles: a pure hinge soon meets the fossa's rear
  // wall.
  const auto hinge = model.stop_at_contact({}, turn(0.3, 0, 0), &model.at_rest());
  EXPECT_TRUE(hinge.stopped);
  EXPECT_LT(rotation_angle(hinge.at[mandible_body]), 10 * 3.14159 / 180);
  EXPECT_LE(hinge.contacts.max_penetration_mm(), 0.02);
  EXPECT_GT(model.find(turn(0.3, 0, 0), nullptr).max_penetration_mm(), 0.1);
}

/// A scan's skull is open and partly inside out; with another patient's jaw in it, contacts
/// contradict each other. Then there is no exit, but the body must not go deeper either.
TEST(RealAnatomy, JawsOfTwoPatientsDoNotDriftIntoEachOther) {
  const auto data = test::real_data();
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "real anatomy absent";
  ImportRequest request;
  request.files = {{Role::skull, data / "ct-cranium/skull_iso300.ply"},
                   {Role::mandible, data / "case-ubc/mandible_8k.ply"}};
  request.name = "mixed";
  const Case mixed = import_meshes(request);
  const ContactModel model(mixed);
  const Eigen::Vector3d condyles(0, 32.1, 79.2);
  BodyPoses at;
  ContactSet last = model.at_rest();
  const double deep_at_rest = last.pairs.front().depth_mm;
  EXPECT_GT(deep_at_rest, 5);
  for (int i = 1; i <= 6; ++i) {
    const Eigen::Quaterniond R(Eigen::AngleAxisd(0.004 * i, Eigen::Vector3d::UnitX()));
    const Pose target{R, condyles - R * condyles};
    const auto slide = model.slide(at, test::target_poses(target), &last, 2);
    for (const auto& vertex : mixed.parts.back().mesh.vertices)
      ASSERT_LT((slide.at[mandible_body] * vertex - vertex).norm(),
                (target * vertex - vertex).norm() + 0.5);
    at = slide.at;
    last = slide.contacts;
    EXPECT_LT(last.pairs.front().depth_mm, deep_at_rest + 0.5);
  }
}

}  // namespace
}  // namespace condyle
