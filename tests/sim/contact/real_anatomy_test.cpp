#include <gtest/gtest.h>

#include <chrono>

#include "sim/contact/contact.h"
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
        model.stop_at_contact({}, {Eigen::Quaterniond::Identity(), {0, 0, up}}, nullptr);
    EXPECT_TRUE(stop.stopped);
    EXPECT_GT(stop.contacts.min_clearance_mm(), 0);
    EXPECT_LE(stop.contacts.min_clearance_mm(), 0.05);
    EXPECT_GT(stop.X_CM.t.z(), 3);
    EXPECT_LT(stop.X_CM.t.z(), 5);
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
  // The hinge opening of the first degrees, then back up and beyond.
  const Eigen::Vector3d condyles(0, 31.4501, 79.6370);
  const auto hinge = [&](double radians) {
    const Eigen::Quaterniond R(Eigen::AngleAxisd(radians, Eigen::Vector3d::UnitX()));
    return Pose{R, condyles - R * condyles};
  };
  Pose from;
  ContactSet last = model.at_rest();
  for (const double angle : {0.01, 0.03, 0.06}) {
    const auto stop = model.stop_at_contact(from, hinge(angle), &last);
    EXPECT_FALSE(stop.stopped);
    from = stop.X_CM;
    last = stop.contacts;
  }
  const auto closed = model.stop_at_contact(from, hinge(-0.1), &last);
  EXPECT_TRUE(closed.stopped);
  EXPECT_LE(closed.contacts.max_penetration_mm(), 0.02);
  EXPECT_LT(rotation_angle(closed.X_CM), 0.02);  // about where the bite was
}

}  // namespace
}  // namespace condyle
