#include "sim/dynamics/muscle_jaw.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/support/builtin.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using test::builtin;

std::vector<double> excite(const std::vector<Muscle>& muscles,
                           const std::map<std::string, double>& groups) {
  std::vector<double> out;
  for (const Muscle& muscle : muscles) {
    const auto found = groups.find(muscle.group);
    out.push_back(found == groups.end() ? 0.0 : found->second);
  }
  return out;
}

TEST(MuscleJaw, BitesHarderTheMoreItsClosersAreExcitedAndStaysStill) {
  double before = 0;
  for (const double excitation : {0.05, 0.2}) {
    MuscleJaw jaw(builtin(), {});
    const auto closing = excite(jaw.muscles(), {{"closer", excitation}});
    for (int k = 0; k < 500; ++k) ASSERT_TRUE(jaw.step(closing));
    const Pose rest = jaw.pose();
    double push = 0, drift = 0;
    for (int k = 0; k < 200; ++k) {
      ASSERT_TRUE(jaw.step(closing));
      drift = std::max(drift,
                       (jaw.pose() * Vector3d(0, -92, -51) - rest * Vector3d(0, -92, -51)).norm());
    }
    for (const auto& contact : jaw.world().contacts()) push += contact.push_N;
    EXPECT_GT(push, 1.5 * before);
    EXPECT_LT(drift, 0.02) << excitation;
    // Isometric, near the optimal length: as strong as the muscles are.
    double pull = 0, most = 0;
    for (std::size_t m = 0; m < closing.size(); ++m) {
      if (jaw.muscles()[m].group != "closer") continue;
      pull += jaw.states()[m].force_N;
      most += jaw.muscles()[m].max_force_N * excitation;
    }
    EXPECT_NEAR(pull, most, 0.05 * most);
    before = push;
  }
  EXPECT_GT(before, 60);  // N
}

void chews_for_a_minute(MuscleJawSettings::HyoidMode hyoid, bool crowns) {
  MuscleJaw jaw(builtin(),
                {.bolus = {.side = BolusSettings::Side::left}, .hyoid = hyoid, .teeth = crowns});
  const Vector3d incisor = *builtin().landmarks.find("lower_incisal_point");
  std::vector<double> drops;  // of each cycle
  for (int k = 0; k < 60000; ++k) {
    const double phase = std::fmod(k / 700.0, 1.0);
    const auto now = excite(jaw.muscles(), {{"opener", phase < 0.4 ? 0.1 : 0.0},
                                            {"protruder_opener", phase < 0.4 ? 0.1 : 0.0},
                                            {"hyoid", phase < 0.4 ? 0.15 : 0.05},
                                            {"closer", phase > 0.45 && phase < 0.9 ? 0.1 : 0.01}});
    ASSERT_TRUE(jaw.step(now)) << k;
    if (k % 700 == 0) drops.push_back(0);
    drops.back() = std::max(drops.back(), incisor.z() - (jaw.pose() * incisor).z());
  }
  drops.pop_back();
  ASSERT_GT(drops.size(), 80u);
  for (std::size_t c = 5; c < drops.size(); ++c) EXPECT_NEAR(drops[c], drops[5], 0.1) << c;
  EXPECT_GT(drops[5], 1);
  EXPECT_LT(drops[5], 60);
  EXPECT_LT(jaw.hyoid_pose().t.norm(), 60);
}

TEST(MuscleJaw, AMinuteOfChewingNeitherDriftsNorFliesOff) {
  using Mode = MuscleJawSettings::HyoidMode;
  {
    SCOPED_TRACE("hyoid fixed, on crowns");
    chews_for_a_minute(Mode::fixed, true);
  }
  SCOPED_TRACE("hyoid free, on a flat bite");
  chews_for_a_minute(Mode::free, false);
}

TEST(MuscleJaw, AnySuddenExcitationStaysInBounds) {
  using Mode = MuscleJawSettings::HyoidMode;
  for (const Mode hyoid : {Mode::free, Mode::fixed})
    for (const MuscleLaw law : {MuscleLaw::peck, MuscleLaw::hill}) {
      MuscleJaw jaw(builtin(), {.law = {.law = law}, .hyoid = hyoid, .teeth = false});
      for (int k = 0; k < 1500; ++k) {
        std::vector<double> wild;
        for (std::size_t m = 0; m < jaw.muscles().size(); ++m)
          wild.push_back((k / 100 + m * 7) % 3 == 0 ? 1.0 : 0.0);
        ASSERT_TRUE(jaw.step(wild));
        ASSERT_LT((jaw.pose() * Vector3d(0, -92, -51) - Vector3d(0, -92, -51)).norm(), 150);
        ASSERT_LT(jaw.hyoid_pose().t.norm(), 150);
      }
    }
}

TEST(MuscleJaw, IsBitIdenticalOnTwoThreads) {
  MuscleJaw one(builtin(), {}, 1), two(builtin(), {}, 2);
  const auto open = excite(one.muscles(), {{"opener", 0.2}, {"protruder_opener", 0.1}});
  const auto close = excite(one.muscles(), {{"closer", 0.1}});
  for (int k = 0; k < 400; ++k) {
    ASSERT_TRUE(one.step(k < 200 ? open : close, 1));
    ASSERT_TRUE(two.step(k < 200 ? open : close, 2));
    ASSERT_EQ(one.pose().t, two.pose().t);
    ASSERT_EQ(one.pose().R.coeffs(), two.pose().R.coeffs());
  }
}

TEST(Bolus, ResistsUntilItIsBittenThroughAndIsThereAgainAfterAWideOpening) {
  Bolus bolus({.side = BolusSettings::Side::left, .size_mm = 10, .resistance_N = 35}, {0, 0, 0},
              {0, 0, -1});
  const auto push = [&](double gap, double closing = 0) {
    return bolus.push_N({0, 0, -gap}, {0, 0, closing});
  };
  EXPECT_EQ(push(5), 0);  // nothing is eaten yet
  EXPECT_EQ(push(11), 0);
  EXPECT_NEAR(push(8), 7, 1e-9);
  EXPECT_NEAR(push(8, 100), 8, 1e-9);
  EXPECT_NEAR(push(8, -100), 7, 1e-9);
  EXPECT_NEAR(push(1), 31.5, 1e-9);
  EXPECT_EQ(push(0.2), 0);
  EXPECT_EQ(push(8), 0);  // crushed
  EXPECT_EQ(push(10.5), 0);
  EXPECT_NEAR(push(9), 3.5, 1e-9);
}

}  // namespace
}  // namespace condyle
