// What a face does by itself is a function of the time alone, within what people do.
#include "render/life/life_signs.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

namespace condyle {
namespace {

constexpr double rad_per_deg = std::numbers::pi / 180;

struct Blink {
  double from_s, closed_from_s, closed_to_s, to_s;
};

std::vector<Blink> blinks_until(double end_s) {
  constexpr double step_s = 0.001;
  std::vector<Blink> blinks;
  double before = 0;
  for (int i = 0; i * step_s < end_s; ++i) {
    const double t = i * step_s, closure = life_signs(t).lids.left;
    EXPECT_GE(closure, 0);
    EXPECT_LE(closure, 1);
    if (closure > 0 && before == 0) blinks.push_back({t, 0, 0, 0});
    if (closure == 1 && before < 1) blinks.back().closed_from_s = t;
    if (closure < 1 && before == 1) blinks.back().closed_to_s = t;
    if (closure == 0 && before > 0) blinks.back().to_s = t;
    before = closure;
  }
  return blinks;
}

TEST(LifeSigns, LidsCloseWithinTwoSecondsAndThenEveryThreeToFive) {
  const auto blinks = blinks_until(400);
  ASSERT_GT(blinks.size(), 80u);
  EXPECT_LT(blinks.front().to_s, 2.5);
  bool regular = true;
  for (std::size_t i = 1; i + 1 < blinks.size(); ++i) {
    const double interval = blinks[i].from_s - blinks[i - 1].from_s;
    EXPECT_GE(interval, 2.99);
    EXPECT_LE(interval, 5.01);
    regular &= std::abs(interval - 4) < 0.3;
    EXPECT_NEAR(blinks[i].closed_from_s - blinks[i].from_s, 0.1, 0.01);
    EXPECT_NEAR(blinks[i].to_s - blinks[i].closed_to_s, 0.17, 0.01);
    EXPECT_GT(blinks[i].closed_to_s - blinks[i].closed_from_s, 1 / 30.0) << "a film shows it";
  }
  EXPECT_FALSE(regular);
}

TEST(LifeSigns, EyesRestBetweenFastSmallTurns) {
  double still_s = 0, turning_s = 0, widest = 0;
  Eigen::Vector2d before(0, 0);
  for (int i = 0; i < 100000; ++i) {
    const LifeSigns signs = life_signs(0.001 * i);
    const Eigen::Vector2d gaze(signs.gaze_left, signs.gaze_up);
    (gaze == before ? still_s : turning_s) += 0.001;
    widest = std::max(widest, gaze.norm());
    EXPECT_LT((gaze - before).norm() / 0.001, 600 * rad_per_deg) << "per second";
    before = gaze;
  }
  EXPECT_GT(turning_s, 1);
  EXPECT_GT(still_s, 10 * turning_s);
  EXPECT_GT(widest, 5 * rad_per_deg);
  EXPECT_LT(widest, 10 * rad_per_deg);
}

TEST(LifeSigns, StartWithOpenEyesStraightAhead) { EXPECT_EQ(life_signs(0), LifeSigns{}); }

TEST(LifeSigns, BreathsAreTwelveToFifteenAMinute) {
  int breaths = 0;
  double before = 0;
  for (int i = 0; i < 60000; ++i) {
    const double breath = life_signs(0.01 * i).breath;
    EXPECT_LT(std::abs(breath - before), 0.02) << "smooth";
    breaths += breath >= 0.5 && before < 0.5;
    before = breath;
  }
  EXPECT_GE(breaths, 10 * 12);
  EXPECT_LE(breaths, 10 * 15);
}

TEST(LifeSigns, TheHeadExtendsInProportionToTheJawsOpeningAndByNothingElse) {
  const auto turned = [](double deg, const Eigen::Vector3d& axis) {
    return Pose{Eigen::Quaterniond(Eigen::AngleAxisd(deg * rad_per_deg, axis)), {0, 8, -5}};
  };
  const Eigen::Vector3d left = Eigen::Vector3d::UnitX();
  EXPECT_NEAR(life_signs(3, turned(30, left)).extension, 2.1 * rad_per_deg, 1e-12);
  EXPECT_EQ(life_signs(3, turned(-5, left)).extension, 0);
  EXPECT_NEAR(life_signs(3, turned(5, Eigen::Vector3d::UnitZ())).extension, 0, 1e-12);
  // Path of the upper incisors over that of the lower ones, of an adult jaw whose condyles slide.
  const Eigen::Vector3d condyles(0, -13, -7), slid = condyles + Eigen::Vector3d(0, -15, -7);
  const Eigen::Quaterniond turn = turned(35, left).R;
  const Pose opened{turn, slid - turn * condyles};
  const Eigen::Vector3d upper(0, -90, -52), lower(0, -88, -53);
  const Pose still = still_in_cranium(life_about(condyles, {}), life_signs(3, opened).extension);
  const double ratio = (still * upper - upper).norm() / (opened * lower - lower).norm();
  EXPECT_GT(ratio, 0.07);
  EXPECT_LT(ratio, 0.09);
  // An open jaw's chin is lower.
  EXPECT_LT((turned(30, left) * Eigen::Vector3d(0, -80, -40)).z(), -45);
}

TEST(LifeSigns, TheTrunkStaysInThePictureAndTheFaceRises) {
  const Life life = life_about({0, -13, -7});
  const double extension = 3 * rad_per_deg;
  Camera camera;
  camera.direction = Eigen::Vector3d(0.6, -0.8, 0.1).normalized();
  const Eigen::Matrix4f before = view_matrix(camera),
                        after = view_matrix(seeing_extension(camera, life, extension));
  const auto seen = [](const Eigen::Matrix4f& view, const Eigen::Vector3d& p) -> Eigen::Vector3d {
    return (view * p.cast<float>().homogeneous()).head<3>().cast<double>();
  };
  const Eigen::Vector3d sternum(0, -30, -190), nasion(0, -97, 25);
  const Pose still = still_in_cranium(life, extension);
  EXPECT_LT((seen(after, still * sternum) - seen(before, sternum)).norm(), 1e-3);
  EXPECT_LT((seen(after, life.nodding_axis) - seen(before, life.nodding_axis)).norm(), 1e-3);
  EXPECT_GT(seen(after, nasion).y(), seen(before, nasion).y() + 3);
}

}  // namespace
}  // namespace condyle
