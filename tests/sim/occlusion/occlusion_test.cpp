#include "sim/occlusion/occlusion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "sim/occlusion/arches.h"
#include "sim/phantom/phantom.h"
#include "tests/support/boxes.h"
#include "tests/support/overlap_oracle.h"
#include "tests/support/program.h"
#include "tests/support/real_cases.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

const Case& builtin() {
  static const Case patient = builtin_patient();
  return patient;
}

OcclusionSettings kept() {
  static const Folder folder;  // fields are built once
  OcclusionSettings settings;
  settings.cache = folder.path();
  return settings;
}

const BiteFinder& finder() {
  static const BiteFinder made(builtin(), kept());
  return made;
}

Bite settled(const Case& patient, const Pose& start, const OcclusionSettings& settings = {}) {
  return BiteFinder(patient, settings).find(start);
}

double farthest(const TriMesh& mesh, const Pose& a, const Pose& b) {
  double largest = 0;
  for (const auto& p : mesh.vertices) largest = std::max(largest, (a * p - b * p).norm());
  return largest;
}

/// Deepest overlap of both arches by an independent exact measure.
double exact_overlap(const Case& patient, const Bite& bite, const Pose& X_CM) {
  const auto mesh_of = [&](const std::string& name) -> const TriMesh& {
    return std::find_if(patient.parts.begin(), patient.parts.end(),
                        [&](const Part& part) { return part.name == name; })
        ->mesh;
  };
  return deepest(OverlapOracle(mesh_of(bite.upper)), OverlapOracle(mesh_of(bite.lower)), X_CM);
}

std::string complaint(const Case& patient, const Pose& start = {}) {
  try {
    settled(patient, start);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

bool mentions(const std::string& text, const std::string& word) {
  return text.find(word) != std::string::npos;
}

}  // namespace

TEST(CloseBite, BuiltBiteIsFoundFromTwentyStartsUpToThreeMillimetresAndDegreesAway) {
  constexpr std::size_t seeds = 20;
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> fraction(0, 1);
  const auto direction = [&] {
    return Vector3d(normal(random), normal(random), normal(random)).normalized();
  };
  std::vector<Pose> starts;
  for (std::size_t i = 0; i < seeds; ++i) {
    // Half of them at the limit.
    const double mm = i % 2 ? 3 : 3 * fraction(random), deg = i % 2 ? 3 : 3 * fraction(random);
    const Vector3d shift = direction(), axis = direction();
    starts.push_back(displaced_from_rest(builtin(), mm * shift, deg * axis));
  }
  std::vector<Bite> bites(seeds);
  parallel_for(seeds, 2, [&](std::size_t i) { bites[i] = finder().find(starts[i]); });
  const TriMesh& lower = builtin().find(Role::lower_teeth)->mesh;
  int far = 0;
  double worst = 0;
  for (std::size_t i = 0; i < seeds; ++i) {
    const auto& bite = bites[i];
    far += farthest(lower, starts[i], {}) > 2;
    worst = std::max(worst, farthest(lower, bite.rest.X_CM, {}));
    EXPECT_LT(farthest(lower, bite.rest.X_CM, {}), 0.1) << i;
    EXPECT_TRUE(bite.stable) << bite.unstable_because;
    EXPECT_EQ(bite.overlap_mm, 0);
    EXPECT_NEAR(bite.moved_from_start_mm, farthest(lower, starts[i], bite.rest.X_CM), 3);
  }
  RecordProperty("worst_um", static_cast<int>(1000 * worst));
  EXPECT_GE(far, 10);
}

TEST(CloseBite, AGridOfStartsFindsTheBiteFromAnArchInNoRelation) {
  const Pose away = displaced_from_rest(builtin(), {1.5, 2, -4}, {1, 0, 2});
  const auto bites = finder().find_from_grid(away);
  ASSERT_FALSE(bites.empty());
  EXPECT_LE(bites.size(), 3u);
  const TriMesh& lower = builtin().find(Role::lower_teeth)->mesh;
  EXPECT_LT(farthest(lower, bites.front().rest.X_CM, {}), 0.1);
  EXPECT_TRUE(bites.front().stable) << bites.front().unstable_because;
  EXPECT_EQ(bites.front().starts, 27);
  for (std::size_t i = 1; i < bites.size(); ++i)
    EXPECT_GT(farthest(lower, bites[i].rest.X_CM, bites.front().rest.X_CM), 0.1);
  // With normal incisors the arch lies near its bite.
  EXPECT_LT(farthest(lower, normal_relation(find_arches(builtin())), {}), 3);
}

TEST(Arches, OfASplitJawAreThoseOfTheBodiesThatCarryThem) {
  const Arches native = find_arches(builtin());
  Case split = builtin();
  const BodyId tooth_segment = split.bodies.add(
      {.name = "tooth segment", .parent = mandible_body, .driver = BodyDriver::hand});
  split.jaw.lower_arch = tooth_segment;
  for (Part& part : split.parts)
    if (part.role == Role::lower_teeth) part.body = tooth_segment;
  // Teeth that stay on the ramus are none of the arch, whatever their place in the list.
  Part wisdom = *builtin().find(Role::lower_teeth);
  wisdom.name = "wisdom teeth";
  for (auto& p : wisdom.mesh.vertices) p.y() += 30;
  split.parts.insert(split.parts.begin(), wisdom);
  const Arches arches = find_arches(split);
  EXPECT_EQ(arches.lower.part, split.teeth_of(tooth_segment));
  EXPECT_EQ(arches.lower.part->name, native.lower.part->name);
  EXPECT_EQ(arches.lower.edge, native.lower.edge);
  EXPECT_EQ(arches.lower.molars, native.lower.molars);
  EXPECT_EQ(arches.upper.edge, native.upper.edge);

  EXPECT_TRUE(split.has_both_arches());
  split.jaw.lower_arch = split.jaw.left_condyle;
  split.parts.erase(split.parts.begin());
  EXPECT_FALSE(split.has_both_arches());
}

TEST(CloseBite, BuiltBiteHasManyBalancedContacts) {
  const Bite bite = finder().find({});
  ASSERT_TRUE(bite.stable) << bite.unstable_because;
  EXPECT_LE(exact_overlap(builtin(), bite, bite.rest.X_CM), 0.05);
  EXPECT_GE(bite.contacts.size(), 12u);
  EXPECT_NEAR(bite.left_fraction, 0.5, 0.03);
  double all = 0;
  for (const auto& contact : bite.contacts) {
    all += contact.load_fraction;
    // The opponents of the built-in patient are as in a textbook: same side, neighbours.
    EXPECT_EQ(contact.left, contact.lower_fdi / 10 == 3);
    EXPECT_EQ(contact.upper_fdi / 10, contact.left ? 2 : 1);
    EXPECT_LE(std::abs(contact.upper_fdi % 10 - contact.lower_fdi % 10), 1);
    EXPECT_GT(contact.gap_mm, 0);
    EXPECT_LT(contact.gap_mm, 0.1);
    EXPECT_LT(contact.normal.z(), 0);  // upper teeth press down
  }
  EXPECT_NEAR(all, 1, 1e-9);
  double upper = 0, lower = 0;
  for (const auto& tooth : bite.teeth) (tooth.fdi < 30 ? upper : lower) += tooth.load_fraction;
  EXPECT_EQ(bite.teeth.size(), 28u);
  EXPECT_NEAR(upper, 1, 1e-9);
  EXPECT_NEAR(lower, 1, 1e-9);
  EXPECT_NEAR(bite.after.overjet_mm, 2.7, 0.3);
  EXPECT_NEAR(bite.after.overbite_mm, 2.3, 0.3);
  ASSERT_TRUE(bite.condyle_moved);
  EXPECT_LT((*bite.condyle_moved)[0].norm(), 0.1);
}

TEST(CloseBite, StartInDeepOverlapIsOpenedFirst) {
  const Pose deep = displaced_from_rest(builtin(), {0, 0, 3}, {0, 0, 0});
  const Bite bite = finder().find(deep);
  ASSERT_GT(exact_overlap(builtin(), bite, deep), 1);
  EXPECT_TRUE(bite.stable);
  EXPECT_LT(farthest(builtin().find(Role::lower_teeth)->mesh, bite.rest.X_CM, {}), 0.1);
}

TEST(CloseBite, IsBitIdenticalForOneAndTwoThreads) {
  auto settings = kept();
  const Pose start = displaced_from_rest(builtin(), {1, -2, 0.5}, {1, 1, -2});
  const Bite one = finder().find(start);
  settings.threads = 2;
  const Bite two = settled(builtin(), start, settings);
  EXPECT_EQ(one.rest.X_CM.t, two.rest.X_CM.t);
  EXPECT_EQ(one.rest.X_CM.R.coeffs(), two.rest.X_CM.R.coeffs());
  EXPECT_EQ(one.rest.work, two.rest.work);
  EXPECT_EQ(one.left_fraction, two.left_fraction);
  EXPECT_EQ(one.load_center, two.load_center);
}

TEST(CloseBite, FlatArchesCompressTheFilmByForceOverArea) {
  const Case patient = box_patient();
  OcclusionSettings settings;
  settings.joint_N_per_mm = 1;
  settings.layer_stiffness_MPa = 0.5;
  const Bite bite = settled(patient, {}, settings);
  EXPECT_TRUE(bite.stable) << bite.unstable_because;
  // Under the load, half of the force on each side.
  double area = 0;
  for (const auto& contact : bite.contacts) area += contact.area_mm2;
  ASSERT_GT(area, 2000);
  EXPECT_NEAR(
      bite.gap_mm,
      settings.film_mm / (1 + settings.closing_force_N / (area * settings.layer_stiffness_MPa)),
      0.01);
  EXPECT_NEAR(bite.left_fraction, 0.5, 1e-3);
  EXPECT_NEAR(bite.load_center.x(), 0, 0.05);
  const double molar_y = -92 + 28;
  EXPECT_NEAR(bite.load_center.y(), molar_y, 2.5);
  EXPECT_NEAR(bite.before.overjet_mm, -2, 1e-6);
  EXPECT_NEAR(bite.before.overbite_mm, -1, 1e-6);
}

TEST(CloseBite, TeethOfOneSideAloneAreNoStableBite) {
  Case patient = box_patient();
  patient.parts[0].mesh = box({2, -90, -40}, {30, -40, 0});
  patient.landmarks.points["upper_incisal_point"] = {2, -90, -40};
  const Bite bite = settled(patient, {});
  EXPECT_FALSE(bite.stable);
  EXPECT_TRUE(mentions(bite.unstable_because, "left") || mentions(bite.unstable_because, "joints"))
      << bite.unstable_because;
}

TEST(CloseBite, MissingArchesAndImpossibleStartsAreRefused) {
  Case patient = box_patient();
  patient.landmarks.points.erase("lower_incisal_point");
  EXPECT_TRUE(mentions(complaint(patient), "no lower teeth")) << complaint(patient);
  patient = box_patient();
  patient.parts.erase(patient.parts.begin());
  EXPECT_TRUE(mentions(complaint(patient), "no upper teeth")) << complaint(patient);
  patient = box_patient();
  Pose start;
  start.t.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(mentions(complaint(patient, start), "finite"));
  start.t = {0, 0, -60};
  EXPECT_TRUE(mentions(complaint(patient, start), "at most 25 mm")) << complaint(patient, start);
  start.R = Eigen::AngleAxisd(0.6, Vector3d::UnitY());
  const Vector3d middle(0, -65, -40);  // of the teeth
  start.t = middle - start.R * middle;
  EXPECT_TRUE(mentions(complaint(patient, start), "at most 30 degrees"))
      << complaint(patient, start);
  start.R.setIdentity();
  start.t = {1e300, 0, 0};
  EXPECT_TRUE(mentions(complaint(patient, start), "at most 25 mm"));
}

TEST(CloseBite, RealCrownsThatOverlapEndInABiteWithoutOverlap) {
  const auto patient = case_ubc();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  const BiteFinder ubc(*patient, kept());
  const Bite bite = ubc.find({});
  EXPECT_TRUE(bite.stable) << bite.unstable_because;
  EXPECT_GT(exact_overlap(*patient, bite, {}), 1);
  EXPECT_LE(exact_overlap(*patient, bite, bite.rest.X_CM), 0.05);
  EXPECT_LE(bite.overlap_mm, 0.05);
  EXPECT_GE(bite.contacts.size(), 4u);
  EXPECT_NEAR(bite.left_fraction, 0.5, 0.1);
  EXPECT_LT(bite.moved_from_rest_mm, 3);
  const Bite again = ubc.find(displaced_from_rest(*patient, {1, 2, 1}, {-1, 2, 1}));
  EXPECT_LT(farthest(patient->find(Role::lower_teeth)->mesh, bite.rest.X_CM, again.rest.X_CM), 0.1);
}

TEST(CloseBite, RealBonesWithCrownsThatDoNotTouchAreClosed) {
  const auto patient = case_badin();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  const Bite bite = settled(*patient, {}, kept());
  EXPECT_TRUE(bite.stable) << bite.unstable_because;
  EXPECT_LE(exact_overlap(*patient, bite, bite.rest.X_CM), 0.05);
  EXPECT_GE(bite.contacts.size(), 3u);
  EXPECT_GT(bite.moved_from_rest_mm, 3.5);
  EXPECT_FALSE(bite.notes.empty());  // notes state that the bones replace the arches
}

}  // namespace condyle::test
