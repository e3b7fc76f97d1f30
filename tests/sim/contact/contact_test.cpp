#include "sim/contact/contact.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using test::shift;
using test::target_poses;
using test::two_bones;

/// A plate as thin as the walls of real maxillae.
TriMesh thin_plate() { return test::box({-40, -40, 30}, {40, 40, 30.3}); }

void expect_same_bits(const ContactSet& a, const ContactSet& b) {
  ASSERT_EQ(a.pairs.size(), b.pairs.size());
  for (std::size_t i = 0; i < a.pairs.size(); ++i) {
    const PairContact &x = a.pairs[i], &y = b.pairs[i];
    EXPECT_EQ(x.touching, y.touching);
    EXPECT_EQ(x.distance_mm, y.distance_mm);
    EXPECT_EQ(x.depth_mm, y.depth_mm);
    EXPECT_EQ(x.witness_a, y.witness_a);
    EXPECT_EQ(x.witness_b, y.witness_b);
    EXPECT_EQ(x.triangle_a, y.triangle_a);
    ASSERT_EQ(x.contacts.size(), y.contacts.size());
    for (std::size_t k = 0; k < x.contacts.size(); ++k) {
      EXPECT_EQ(x.contacts[k].point, y.contacts[k].point);
      EXPECT_EQ(x.contacts[k].normal, y.contacts[k].normal);
    }
  }
}

TEST(ContactModel, JawsThatOverlapDeeplyAreNamedAsOfTwoPatients) {
  const auto note = [](double deep) {
    const auto notes = ContactModel(two_bones(test::box({0, 0, 0}, {30, 30, 30}),
                                              test::box({0, 0, deep - 30}, {30, 30, deep})))
                           .notes();
    return notes.empty() ? std::string() : notes.front();
  };
  EXPECT_NE(note(6.5).find("overlap by 6.50 mm at rest"), std::string::npos) << note(6.5);
  EXPECT_NE(note(6.5).find("of the same patient"), std::string::npos) << note(6.5);
  EXPECT_NE(note(1).find("overlap by 1.00 mm at rest"), std::string::npos) << note(1);
  EXPECT_EQ(note(1).find("of the same patient"), std::string::npos) << note(1);
}

TEST(ContactModel, MixedUpJawsStopWhereTheyMeetInsteadOfSearching) {
  const ContactModel model(
      two_bones(test::box({0, 0, 0}, {30, 30, 30}), test::box({0, 0, -23.5}, {30, 30, 6.5})));
  const Pose aside = shift(3, 0, 10);
  const auto slide = model.slide({}, target_poses(aside), &model.at_rest());
  const auto stop = model.stop_at_contact({}, aside, &model.at_rest());
  EXPECT_TRUE(slide.stopped);
  EXPECT_EQ(slide.at[mandible_body].t, stop.at[mandible_body].t);
  EXPECT_FALSE(model.slide({}, target_poses(shift(0, 0, -10)), &model.at_rest()).stopped);
}

TEST(ContactModel, TouchingPairsAreFoundWithoutDistancesAsWithThem) {
  // A ball and a box: apart, crossing, and entirely inside, up to 34 mm below the surface.
  const TriMesh room = test::box({-40, -40, 0}, {40, 40, 80});
  const ContactModel model(two_bones(room, test::sphere(4, 6, {0, 0, -12})));
  std::mt19937 random(7);
  std::uniform_real_distribution<double> aside(-55, 55), up(-10, 110);
  int apart = 0, crossing = 0, inside = 0;
  for (int i = 0; i < 200; ++i) {
    const Pose X = shift(aside(random), aside(random), up(random));
    const PairContact known = model.find(X, nullptr).pairs[0];
    const PairContact quick = model.find_touching(X).pairs[0];
    ASSERT_EQ(quick.touching, known.touching) << X.t.transpose();
    EXPECT_EQ(quick.depth_mm, known.depth_mm);
    (!known.touching ? apart : known.depth_mm > 12 ? inside : crossing) += 1;
  }
  EXPECT_GT(apart, 20);
  EXPECT_GT(crossing, 20);
  EXPECT_GT(inside, 10);
}

TEST(ContactModel, WitnessesOfTouchingSurfacesAreTheDeepestPoint) {
  // A ball that sinks 2 mm into the flat lower side of a box: the rim is 6.6 mm from its top.
  const ContactModel model(
      two_bones(test::box({-30, -30, 0}, {30, 30, 30}), test::sphere(5, 12, {3, -4, -13})));
  const PairContact apart = model.at_rest().pairs[0];
  EXPECT_NEAR((apart.witness_a - Eigen::Vector3d(3, -4, 0)).norm(), 0, 0.1);
  EXPECT_NEAR((apart.witness_b - Eigen::Vector3d(3, -4, -1)).norm(), 0, 0.1);
  const PairContact touching = model.find(shift(0, 0, 3), nullptr).pairs[0];
  EXPECT_NEAR(touching.depth_mm, 2, 0.01);
  // The ball's top is as deep in the box as the face below it is in the ball.
  EXPECT_LT((touching.witness_a - Eigen::Vector3d(3, -4, 0)).head<2>().norm(), 0.3);
  EXPECT_GE(touching.witness_a.z(), -1e-6);
  EXPECT_LE(touching.witness_a.z(), 2 + 1e-6);
  EXPECT_EQ(touching.witness_a, touching.witness_b);
}

TEST(ContactModel, PairsEveryCraniumPartWithEveryMandiblePart) {
  Case patient = two_bones(test::box({-5, -5, 10}, {5, 5, 20}), test::box({-5, -5, 0}, {5, 5, 5}));
  patient.parts.push_back({"skull", Role::skull, test::box({-5, -5, 30}, {5, 5, 40}), {}});
  patient.parts.push_back({"lower", Role::lower_teeth, test::box({-1, -1, 5}, {1, 1, 6}), {}});
  patient.parts.push_back({"face", Role::face, test::box({-50, -50, -50}, {50, 50, 50}), {}});
  patient.parts.push_back({"tongue", Role::tongue, test::box({-1, -1, 4}, {1, 1, 16}), {}});
  const ContactModel model(patient);
  const ContactSet& rest = model.at_rest();
  ASSERT_EQ(rest.pairs.size(), 4u);  // face and tongue take no part
  EXPECT_NEAR(rest.min_clearance_mm(), 4, 1e-12);
  EXPECT_NEAR(model.find(shift(0, 0, 3), &rest).min_clearance_mm(), 1, 1e-12);
  EXPECT_TRUE(model.notes().empty());
}

TEST(ContactModel, WithoutPairsNothingStops) {
  Case patient = two_bones(test::box({0, 0, 0}, {1, 1, 1}), test::box({0, 0, 0}, {1, 1, 1}));
  patient.parts.pop_back();
  const ContactModel model(patient);
  EXPECT_EQ(model.at_rest().min_clearance_mm(), std::numeric_limits<double>::infinity());
  EXPECT_FALSE(model.stop_at_contact({}, shift(0, 0, 9), nullptr).stopped);
}

TEST(ContactModel, SpheresReportTheirAnalyticGapAndDepth) {
  const ContactModel model(two_bones(test::sphere(4, 20), test::sphere(4, 10, {0, 0, -40})));
  EXPECT_NEAR(model.at_rest().pairs[0].distance_mm, 10, 0.12);  // facets lie up to 0.06 mm inside
  const PairContact deep = model.find(shift(0, 0, 12), nullptr).pairs[0];
  EXPECT_TRUE(deep.touching);
  EXPECT_EQ(deep.distance_mm, 0);
  EXPECT_NEAR(deep.depth_mm, 2, 0.12);
  EXPECT_EQ(deep.rest_depth_mm, 0);
  EXPECT_FALSE(deep.contacts.empty());
  EXPECT_LE(deep.contacts.size(), 64u);
  for (const auto& contact : deep.contacts)
    EXPECT_LT(contact.normal.z(), -0.5);  // from A down to B
}

TEST(ContactModel, ABoneWhollyInsideAnotherTouchesIt) {
  const ContactModel model(two_bones(test::sphere(3, 20), test::sphere(2, 3, {0, 0, -40})));
  const PairContact pair = model.find(shift(0, 0, 35), nullptr).pairs[0];
  EXPECT_TRUE(pair.touching);
  EXPECT_EQ(pair.distance_mm, 0);
  EXPECT_GT(pair.depth_mm, 15);
  EXPECT_EQ(pair.contacts.size(), 1u);
}

TEST(ContactModel, AFreePathIsCompleted) {
  const ContactModel model(two_bones(test::sphere(3, 20), test::sphere(3, 10, {0, 0, -40})));
  std::mt19937_64 random(1);
  int taken = 0;
  Pose from;
  ContactSet last = model.at_rest();
  for (int k = 0; k < 30; ++k) {
    Pose target = test::any_pose(random, 3);
    target.R = Eigen::Quaterniond::Identity().slerp(0.05, target.R);
    const auto stop = model.stop_at_contact(from, target, &last);
    EXPECT_FALSE(stop.stopped);
    EXPECT_EQ(stop.at[mandible_body].t, target.t);
    EXPECT_EQ(stop.at[mandible_body].R.coeffs(), target.R.coeffs());
    from = stop.at[mandible_body];
    last = stop.contacts;
    ++taken;
  }
  EXPECT_EQ(taken, 30);
}

TEST(ContactModel, BodiesMovedTogetherStopAtTheSurface) {
  const ContactModel model(
      two_bones(test::sphere(4, 20, {0, 0, 0}, 0.02), test::sphere(4, 10, {0, 0, -40}, 0.02)));
  std::mt19937_64 random(2);
  int stopped = 0;
  for (int k = 0; k < 12; ++k) {
    Pose target = test::any_pose(random, 8);
    target.R = Eigen::Quaterniond::Identity().slerp(0.2, target.R);
    target.t.z() += 22;
    const auto stop = model.stop_at_contact({}, target, nullptr);
    if (!stop.stopped) continue;
    ++stopped;
    EXPECT_FALSE(stop.contacts.pairs[0].touching);
    EXPECT_GT(stop.contacts.min_clearance_mm(), 0);
    EXPECT_LE(stop.contacts.min_clearance_mm(), 0.01);
    // The pose lies on the path, and slightly farther the bones touch: it is the first contact.
    EXPECT_LT(rotation_angle(stop.at[mandible_body]), rotation_angle(target));
    EXPECT_EQ(model.find(stop.at[mandible_body], nullptr).pairs[0].distance_mm,
              stop.contacts.pairs[0].distance_mm);
  }
  EXPECT_GT(stopped, 6);
}

/// Contacts between two bodies that move as one lie where the bodies are, not where they were.
TEST(ContactModel, ContactsBetweenBodiesMovedAsOneMoveAlong) {
  Case patient = two_bones(test::box({-40, -40, 30}, {40, 40, 40}), test::sphere(3, 10));
  const BodyId piece = patient.bodies.add({.name = "piece", .parent = mandible_body});
  patient.parts.push_back(
      {"piece", Role::segment, test::sphere(3, 10, {0, -19, 0}, 0.05), {}, piece});
  const ContactModel model(patient);
  const Pose turned{Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 2) / 3)),
                    {3, 5, -20}};
  for (const Pose& X_piece : {Pose{}, shift(0.2, 0, 0)}) {
    const auto slide = model.slide({}, target_poses(turned, {X_piece}), &model.at_rest());
    const auto further =
        model.slide(slide.at, target_poses(shift(0, 0, -8) * turned, {X_piece}), &slide.contacts);
    const auto stop = model.stop_at_contact(slide.at, shift(0, 0, -8) * turned, &slide.contacts);
    for (const auto* moved : {&slide, &further, &stop}) {
      const ContactSet exact = model.find(moved->at, nullptr);
      ASSERT_EQ(moved->contacts.pairs.size(), exact.pairs.size());
      for (std::size_t i = 0; i < exact.pairs.size(); ++i) {
        const PairContact &x = moved->contacts.pairs[i], &y = exact.pairs[i];
        EXPECT_EQ(x.touching, y.touching);
        EXPECT_LT((x.witness_a - y.witness_a).norm(), 1e-9);
        ASSERT_EQ(x.contacts.size(), y.contacts.size());
        for (std::size_t k = 0; k < x.contacts.size(); ++k)
          EXPECT_LT((x.contacts[k].point - y.contacts[k].point).norm(), 1e-9);
      }
    }
  }
}

TEST(ContactModel, AJumpDoesNotPassThroughAThinWall) {
  const ContactModel model(two_bones(thin_plate(), test::sphere(3, 10)));
  for (const double jump : {22.0, 45.0, 300.0}) {
    const auto stop = model.stop_at_contact({}, shift(0, 0, jump), nullptr);
    EXPECT_TRUE(stop.stopped);
    EXPECT_NEAR(stop.at[mandible_body].t.z(), 20,
                0.02);  // the ball's top is a vertex or within 0.01 of one
    EXPECT_GT(stop.contacts.min_clearance_mm(), 0);
    EXPECT_LE(stop.contacts.min_clearance_mm(), 0.01);
  }
}

TEST(ContactModel, AnArmDoesNotSwingThroughAThinWall) {
  // Half a turn about the far end, from one side of the plate to the other: both ends are free.
  const ContactModel model(
      two_bones(test::box({20, -40, -5}, {60, 40, -4.7}), test::box({-50, -2, -30}, {50, 2, -26})));
  const Eigen::Vector3d hinge(-50, 0, -28);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(-0.9, Eigen::Vector3d::UnitY()));
  const Pose target{turn, hinge - turn * hinge};
  ASSERT_FALSE(model.find(target, nullptr).pairs[0].touching);
  const auto stop = model.stop_at_contact({}, target, nullptr);
  EXPECT_TRUE(stop.stopped);
  EXPECT_GT(stop.contacts.min_clearance_mm(), 0);
  EXPECT_LE(stop.contacts.min_clearance_mm(), 0.01);
}

TEST(ContactModel, AStoppedJawMayLeaveAndSlideAlong) {
  const ContactModel model(
      two_bones(test::box({-30, -30, 30}, {30, 30, 40}), test::box({-5, -5, 0}, {5, 5, 10})));
  const auto at_wall = model.stop_at_contact({}, shift(0, 0, 25), nullptr);
  ASSERT_TRUE(at_wall.stopped);
  Pose along = at_wall.at[mandible_body], away = at_wall.at[mandible_body];
  along.t.x() += 3;
  away.t.z() -= 5;
  EXPECT_FALSE(model.stop_at_contact(at_wall.at[mandible_body], along, &at_wall.contacts).stopped);
  EXPECT_FALSE(model.stop_at_contact(at_wall.at[mandible_body], away, &at_wall.contacts).stopped);
  Pose into = at_wall.at[mandible_body];
  into.t.z() += 1;
  const auto again = model.stop_at_contact(at_wall.at[mandible_body], into, &at_wall.contacts);
  EXPECT_TRUE(again.stopped);
  EXPECT_LE((again.at[mandible_body].t - at_wall.at[mandible_body].t).norm(), 0.01);
}

TEST(ContactModel, OverlapAtRestIsTheBaseline) {
  // The ball sits 1.2 mm deep in the block.
  const ContactModel model(
      two_bones(test::box({-30, -30, 10}, {30, 30, 40}), test::sphere(4, 10, {0, 0, 1.2})));
  const double rest = model.at_rest().pairs[0].depth_mm;
  EXPECT_NEAR(rest, 1.2, 0.05);
  EXPECT_EQ(model.at_rest().max_penetration_mm(), 0);
  ASSERT_EQ(model.notes().size(), 1u);
  EXPECT_NE(model.notes()[0].find("overlap by 1.2"), std::string::npos);
  // Out and along it moves freely.
  EXPECT_FALSE(model.stop_at_contact({}, shift(0, 0, -20), &model.at_rest()).stopped);
  EXPECT_FALSE(model.stop_at_contact({}, shift(4, 0, -0.5), &model.at_rest()).stopped);
  // Deeper it does not, from rest or from elsewhere, slowly or in a jump.
  for (const double up : {0.1, 3.0, 45.0}) {
    const auto stop = model.stop_at_contact({}, shift(0, 0, up), &model.at_rest());
    EXPECT_TRUE(stop.stopped);
    EXPECT_LE(stop.contacts.max_penetration_mm(), 0.02);
    const auto back = model.stop_at_contact(shift(5, 0, -20), shift(5, 0, up), nullptr);
    EXPECT_TRUE(back.stopped);
    EXPECT_LE(back.contacts.max_penetration_mm(), 0.02);
    EXPECT_GT(back.contacts.max_penetration_mm(), 0.0);
  }
}

TEST(ContactModel, OverlapInOnePlaceDoesNotExcuseContactInAnother) {
  // One ball sits 2 mm deep in the block; the other, 40 mm away, half a millimetre under it.
  const ContactModel model(two_bones(
      test::box({-60, -30, 10}, {60, 30, 40}),
      test::joined(test::sphere(4, 10, {-20, 0, 2}), test::sphere(4, 10, {20, 0, -0.5}))));
  ASSERT_NEAR(model.at_rest().pairs[0].depth_mm, 2, 0.06);
  // Turning about the first ball leaves its depth as it is and drives the other up.
  const Eigen::Vector3d center(-20, 0, 2);
  const Eigen::Quaterniond R(Eigen::AngleAxisd(-0.04, Eigen::Vector3d::UnitY()));
  const Pose target{R, center - R * center};
  EXPECT_NEAR(model.find(target, nullptr).max_penetration_mm(), 1.1, 0.3);
  const auto stop = model.stop_at_contact({}, target, &model.at_rest());
  EXPECT_TRUE(stop.stopped);
  EXPECT_NEAR(rotation_angle(stop.at[mandible_body]), 0.5 / 40, 0.002);
  EXPECT_LE(stop.contacts.max_penetration_mm(), 0.02);
}

TEST(ContactModel, AStartThatIsTooDeepMayLeaveButNotDeepen) {
  const ContactModel model(two_bones(test::box({-30, -30, 30}, {30, 30, 60}), test::sphere(3, 10)));
  const Pose inside = shift(0, 0, 25);  // 5 mm deep
  const auto out = model.stop_at_contact(inside, shift(0, 0, 10), nullptr);
  EXPECT_FALSE(out.stopped);
  const auto deeper = model.stop_at_contact(inside, shift(0, 0, 35), nullptr);
  EXPECT_TRUE(deeper.stopped);
  EXPECT_NEAR(deeper.at[mandible_body].t.z(), 25, 0.01);
}

TEST(ContactModel, OpenShellsAreMeasuredByTheirTrianglesAndReported) {
  TriMesh sheet;  // one layer, no inside
  sheet.vertices = {{-30, -30, 30}, {30, -30, 30}, {30, 30, 30}, {-30, 30, 30}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  const ContactModel model(two_bones(sheet, test::sphere(3, 10)));
  ASSERT_EQ(model.notes().size(), 1u);
  EXPECT_NE(model.notes()[0].find("maxilla: 1 of 1"), std::string::npos);
  EXPECT_GT(model.find(shift(0, 0, 21), nullptr).pairs[0].depth_mm, 0);
  const auto stop = model.stop_at_contact({}, shift(0, 0, 45), nullptr);
  EXPECT_TRUE(stop.stopped);
  EXPECT_NEAR(stop.at[mandible_body].t.z(), 20, 0.02);
}

TEST(ContactModel, ATurnedSceneGivesTheTurnedAnswer) {
  std::mt19937_64 random(5);
  const TriMesh upper = test::sphere(3, 20, {0, 0, 0}, 0.05),
                lower = test::sphere(3, 10, {0, 0, -40}, 0.05);
  const ContactModel here(two_bones(upper, lower));
  for (int k = 0; k < 4; ++k) {
    const Pose turn = test::any_pose(random, 30);
    const ContactModel there(two_bones(test::moved(upper, turn), test::moved(lower, turn)));
    const Pose target = shift(1, -2, 25);
    const auto a = here.stop_at_contact({}, target, nullptr);
    const auto b = there.stop_at_contact({}, turn * target * turn.inverse(), nullptr);
    EXPECT_TRUE(a.stopped);
    EXPECT_TRUE(b.stopped);
    // The path turns with the scene, its halvings may round differently: equal within the stop's
    // gap.
    const Pose a_turned = turn * a.at[mandible_body] * turn.inverse();
    EXPECT_LT((a_turned.t - b.at[mandible_body].t).norm(), 0.01);
    EXPECT_NEAR(there.find(turn * target * turn.inverse(), nullptr).pairs[0].depth_mm,
                here.find(target, nullptr).pairs[0].depth_mm, 1e-9);
  }
}

TEST(ContactModel, OneAndTwoThreadsAreBitIdentical) {
  Case patient =
      two_bones(test::sphere(4, 20, {0, 0, 0}, 0.05), test::sphere(4, 10, {0, 0, -29}, 0.05));
  patient.parts.push_back({"upper", Role::upper_teeth, test::sphere(3, 5, {8, 0, -21}), {}});
  patient.parts.push_back({"lower", Role::lower_teeth, test::sphere(3, 5, {8, 0, -29}), {}});
  const ContactModel model(patient);
  std::mt19937_64 random(6);
  Pose from;
  ContactSet last = model.at_rest();
  int stopped = 0;
  for (int k = 0; k < 20; ++k) {
    Pose target = test::any_pose(random, 4);
    target.R = Eigen::Quaterniond::Identity().slerp(0.05, target.R);
    expect_same_bits(model.find(target, &last, 1), model.find(target, &last, 2));
    const auto one = model.stop_at_contact(from, target, &last, 1);
    const auto two = model.stop_at_contact(from, target, &last, 2);
    EXPECT_EQ(one.stopped, two.stopped);
    EXPECT_EQ(one.at[mandible_body].t, two.at[mandible_body].t);
    EXPECT_EQ(one.at[mandible_body].R.coeffs(), two.at[mandible_body].R.coeffs());
    expect_same_bits(one.contacts, two.contacts);
    stopped += one.stopped;
    from = one.at[mandible_body];
    last = one.contacts;
  }
  EXPECT_GT(stopped, 0);
}

}  // namespace
}  // namespace condyle
