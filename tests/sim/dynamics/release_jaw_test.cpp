// A released jaw hangs in its joints and muscles, or lies on its teeth.
#include "sim/dynamics/release_jaw.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "engine/core/error.h"
#include "sim/motion/measure_pose.h"
#include "tests/support/boxes.h"
#include "tests/support/builtin.h"
#include "tests/support/program.h"
#include "tests/support/real_cases.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using test::builtin;

/// Opened about the condyles and to the side, then displaced as by a hand.
Pose in_hand(const Case& of, double open_deg, double aside_deg, const Vector3d& shift) {
  const Vector3d hinge =
      0.5 * (*of.landmarks.find("left_condyle") + *of.landmarks.find("right_condyle"));
  Pose X;
  X.R = Eigen::AngleAxisd(aside_deg * std::numbers::pi / 180, Vector3d::UnitZ()) *
        Eigen::AngleAxisd(open_deg * std::numbers::pi / 180, Vector3d::UnitX());
  X.t = hinge - X.R * hinge + shift;
  return X;
}

const ContactModel& bones() {
  static const ContactModel contacts(builtin(), {});
  return contacts;
}

Pose rest_position(const Case& of) {
  const Motion rest = make_motion("rest", of, bones());
  return rest.target(rest.duration_s);
}

TEST(JawRelease, FallsBackToItsRestPositionFromWhereverAHandHadIt) {
  const Pose X_rest = rest_position(builtin());
  const double freeway_mm = measure(builtin(), X_rest).opening_mm;
  ASSERT_GT(freeway_mm, 1);
  for (const Pose& from :
       {Pose{}, in_hand(builtin(), 30, 0, {0, 0, 0}), in_hand(builtin(), 20, 0, {0, -10, -5}),
        in_hand(builtin(), 0, 0, {0, 0, -20}), in_hand(builtin(), 10, 8, {8, 0, -5})}) {
    const JawRelease course = release_jaw(builtin(), bones(), from, {.X_CM_rest = X_rest}, 2);
    ASSERT_TRUE(course.rest.reached);
    EXPECT_EQ(course.X_CM.front().t, from.t);
    EXPECT_GT(
        (course.X_CM.front() * Vector3d(0, -90, -50) - course.X_CM.back() * Vector3d(0, -90, -50))
            .norm(),
        2);
    const Measures there = measure(builtin(), course.X_CM.back());
    EXPECT_NEAR(there.opening_mm, freeway_mm, 0.3);
    EXPECT_NEAR(there.incisor.x(), 0, 0.3);
    EXPECT_EQ(course.bite_N, 0) << "teeth are apart at rest";
    EXPECT_EQ(course.lies_on, JawRelease::On::nothing);
    for (const double seated : {there.left_condyle.x() + there.right_condyle.x(),
                                there.left_condyle.z() - there.right_condyle.z()})
      EXPECT_NEAR(seated, 0, 0.1);
  }
}

TEST(JawRelease, ExcitedClosersSeatItOnItsTeethAndRelaxedOnesLetItHang) {
  const Pose from = in_hand(builtin(), 15, 0, {0, 0, 0});
  const auto with = [&](double excitation, bool teeth = true) {
    std::map<std::string, double> excitations;
    for (const char* name : {"lat", "rat", "lsm", "rsm", "ldm", "rdm", "lmp", "rmp"})
      excitations[name] = excitation;
    return release_jaw(builtin(), bones(), from,
                       {.muscles = {.teeth = teeth}, .excitations = excitations}, 2);
  };
  const JawRelease bites = with(0.05), hangs = with(0);
  ASSERT_TRUE(bites.rest.reached && hangs.rest.reached);
  EXPECT_GT(bites.bite_N, 10);
  EXPECT_EQ(bites.lies_on, JawRelease::On::teeth);
  EXPECT_LT(bites.rest.depth_mm, 0.1);
  EXPECT_NEAR(measure(builtin(), bites.X_CM.back()).opening_mm, 0, 0.5);
  EXPECT_EQ(hangs.bite_N, 0);
  EXPECT_EQ(hangs.lies_on, JawRelease::On::nothing);
  EXPECT_EQ(with(0.05, false).lies_on, JawRelease::On::flat_bite);
  EXPECT_GT(measure(builtin(), hangs.X_CM.back()).opening_mm, 3);
}

TEST(JawRelease, IsBitIdenticalForAnyThreadCount) {
  const Pose from = in_hand(builtin(), 12, 5, {3, 0, -4});
  const JawRelease one = release_jaw(builtin(), bones(), from, {}, 1),
                   two = release_jaw(builtin(), bones(), from, {}, 2);
  ASSERT_EQ(one.X_CM.size(), two.X_CM.size());
  ASSERT_GT(one.X_CM.size(), 100u);
  for (std::size_t k = 0; k < one.X_CM.size(); ++k) {
    ASSERT_EQ(one.X_CM[k].t, two.X_CM[k].t) << k;
    ASSERT_EQ(one.X_CM[k].R.coeffs(), two.X_CM[k].R.coeffs()) << k;
  }
}

TEST(JawRelease, CanBeCancelledWhileItsBonesAreMeasured) {
  struct GivenUp {};
  const test::Folder cache;  // empty: every field is built
  const char* before = std::getenv("XDG_CACHE_HOME");
  const std::string kept = before ? before : "";
  ::setenv("XDG_CACHE_HOME", cache.path().c_str(), 1);
  int calls = 0;
  double fraction = 1;
  const auto give_up = [&](std::string_view, double at) {
    fraction = at;
    if (++calls == 40) throw GivenUp{};
  };
  EXPECT_THROW(release_jaw(builtin(), bones(), Pose{}, {}, 2, give_up), GivenUp);
  EXPECT_EQ(fraction, 0) << "its first jaw is not even made";
  if (before)
    ::setenv("XDG_CACHE_HOME", kept.c_str(), 1);
  else
    ::unsetenv("XDG_CACHE_HOME");
}

TEST(JawRelease, RefusesACondyleThatNoLigamentWouldHold) {
  for (const Pose& from :
       {in_hand(builtin(), 10, 0, {60, -80, -40}), in_hand(builtin(), 10, 120, {0, 0, 0})})
    try {
      release_jaw(builtin(), bones(), from, {}, 2);
      ADD_FAILURE() << "it flew";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("out of its joint"), std::string::npos);
    }
}

/// Its deepest penetration on the path, and where it ends.
struct Depths {
  double path_mm = 0, end_mm = 0;
};
Depths depths_of(const JawRelease& course, const ContactModel& contacts) {
  Depths depths;
  for (std::size_t k = 0; k < course.X_CM.size(); k += 10)
    depths.path_mm =
        std::max(depths.path_mm, contacts.find(course.X_CM[k], nullptr, 2).max_penetration_mm());
  depths.end_mm = contacts.find(course.X_CM.back(), nullptr, 2).max_penetration_mm();
  return depths;
}

TEST(JawRelease, IsStoppedByTheRestOfTheSkull) {
  // Far aside, where a hand got it to beside the skull: the joints would draw it through bone.
  const Pose aside = in_hand(builtin(), 10, 8, {12, 0, -5});
  const Pose from = bones().slide({}, test::target_poses(aside), nullptr, 2).at[mandible_body];
  ASSERT_LT(bones().find(from, nullptr, 2).max_penetration_mm(), 0.03);
  const JawRelease course = release_jaw(builtin(), bones(), from, {.X_CM_rest = Pose{}}, 2);
  const Depths depths = depths_of(course, bones());
  EXPECT_LT(depths.path_mm, 0.2);
  EXPECT_LT(depths.end_mm, jaw_rest_depth_mm);
  EXPECT_TRUE(course.rest.reached);
}

TEST(JawRelease, LiesOnBoneThatIsBelowItsChin) {
  Case patient = builtin();
  const auto& jaw = patient.find(Role::mandible)->mesh.vertices;
  const Vector3d chin = *std::min_element(
      jaw.begin(), jaw.end(),
      [](const Vector3d& a, const Vector3d& b) { return a.y() + a.z() < b.y() + b.z(); });
  double lowest = chin.z();
  for (const Vector3d& v : jaw)
    if (std::abs(v.x()) < 12 && v.y() < chin.y() + 25) lowest = std::min(lowest, v.z());
  const TriMesh below =
      test::box({-10, chin.y() - 5, lowest - 12}, {10, chin.y() + 20, lowest - 2});
  patient.add_piece({"graft", Role::transplant, below, {}}, cranium_body);
  const ContactModel contacts(patient, {});
  const JawRelease course =
      release_jaw(patient, contacts, Pose{}, {.excitations = {{"lat", 0.0}}}, 2);
  EXPECT_EQ(course.lies_on, JawRelease::On::bone);
  EXPECT_EQ(course.bite_N, 0);
  EXPECT_LT(course.rest.depth_mm, jaw_rest_depth_mm);
  EXPECT_LT(measure(patient, course.X_CM.back()).opening_mm, 3);
}

TEST(JawRelease, AMeasuredJawThatBitesEndsInNoBone) {
  const auto ubc = test::case_ubc(test::Driven::by_muscles);
  if (!ubc) GTEST_SKIP() << "no real anatomy here";
  const ContactModel contacts(*ubc, {});
  std::map<std::string, double> closers;
  for (const char* name : {"lat", "rat", "lsm", "rsm", "ldm", "rdm", "lmp", "rmp"})
    closers[name] = 0.05;
  for (const Vector3d& shift : {Vector3d(0, 0, -20), Vector3d(-6, 0, -6)}) {
    const Pose from = contacts.slide({}, test::target_poses(in_hand(*ubc, 0, 0, shift)), nullptr, 2)
                          .at[mandible_body];
    const JawRelease course = release_jaw(*ubc, contacts, from, {.excitations = closers}, 2);
    EXPECT_TRUE(course.rest.reached);
    EXPECT_GT(course.bite_N, 10);
    EXPECT_LT(depths_of(course, contacts).end_mm, jaw_rest_depth_mm);
  }
}

TEST(JawRelease, MeasuredPatientsHangToo) {
  const auto ubc = test::case_ubc(test::Driven::by_muscles), badin = test::case_badin();
  if (!ubc || !badin) GTEST_SKIP() << "no real anatomy here";
  for (const Case* of : {&*ubc, &*badin}) {
    SCOPED_TRACE(of->name);
    const JawRelease course =
        release_jaw(*of, ContactModel(*of, {}), in_hand(*of, 15, 4, {2, -3, -3}),
                    {.X_CM_rest = in_hand(*of, 1.5, 0, {0, 0, 0})}, 2);
    EXPECT_TRUE(course.rest.reached);
    EXPECT_LT(course.rest.depth_mm, 0.1);
    const Measures there = measure(*of, course.X_CM.back());
    EXPECT_GT(there.opening_mm, -0.5);
    EXPECT_LT(there.opening_mm, 8);
    EXPECT_NEAR(there.incisor.x(), of->landmarks.find("lower_incisal_point")->x(), 2);
  }
}

}  // namespace
}  // namespace condyle
