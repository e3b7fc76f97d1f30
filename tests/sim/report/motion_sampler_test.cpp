// What happens between two frames is found, too.
#include "sim/report/motion_sampler.h"

#include <gtest/gtest.h>

#include <random>

#include "sim/report/clearance.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle::test {
namespace {

/// From one pose to another in a second, straight.
Motion jump(const Pose& from, const Pose& to) {
  return {"jump", 1, true, [from, to](double t) { return interpolate(from, to, t); }, {}, {0, 1}};
}

Pose shifted(const Eigen::Vector3d& by) { return {Eigen::Quaterniond::Identity(), by}; }

/// A plate of bone and a ball of 4 mm, 20 mm below its centre.
Case plate_patient(double thick_mm) {
  Case patient = box_patient();
  patient.parts[0].mesh = box({-30, -90, 0}, {30, -40, thick_mm});
  patient.parts[1].mesh = sphere(4, 2, {0, -65, -22});
  return patient;
}

ClearanceCheck checked(const Scene& scene, const Motion& motion, double margin_mm, int frames = 2,
                       int threads = 2) {
  SimulatorSettings settings;
  settings.threads = threads;
  return check_clearance(scene, motion, {.margin_mm = margin_mm, .sampling = {.frames = frames}},
                         settings);
}

TEST(MotionSampler, AJumpThroughAThinWallIsSeen) {
  const Scene scene = make_scene(plate_patient(0.3));
  const auto check = checked(scene, jump({}, shifted({0, 0, 45})), 0);
  ASSERT_EQ(check.frames(), 2);
  const auto& pair = check.pairs.at(0);
  EXPECT_TRUE(pair.collides);
  ASSERT_TRUE(pair.first_touch);
  EXPECT_NEAR(pair.first_touch->time_s * 45, 20, 0.021);
  EXPECT_TRUE(pair.first_touch->between);
  EXPECT_EQ(pair.first_touch->frame, 1);
  EXPECT_EQ(pair.touches, 1);
  EXPECT_EQ(pair.touching_frames, 0);
  EXPECT_TRUE(pair.worst.when.between);
  EXPECT_GT(pair.worst.measure.area_mm2, 1);
  EXPECT_LT(check.samples_between, 400);
}

TEST(MotionSampler, AJumpThroughASheetWithoutThicknessIsSeen) {
  Case patient = plate_patient(1);
  patient.parts[0].mesh.triangles.resize(2);  // the lower face alone
  const Scene scene = make_scene(std::move(patient));
  const auto pair = checked(scene, jump({}, shifted({0, 0, 45})), 0).pairs.at(0);
  EXPECT_TRUE(pair.collides);
  ASSERT_TRUE(pair.first_touch);
  EXPECT_NEAR(pair.first_touch->time_s * 45, 20, 0.021);
}

TEST(MotionSampler, PassingNearerThanTheMarginBetweenFramesIsDetectedAndFartherNeedsNoSample) {
  const Scene scene = make_scene(plate_patient(1));
  // Past the plate's edge at x = 30, the ball's side 0.5 mm from it.
  const auto past = jump(shifted({32.5, 0, 0}), shifted({32.5, 0, 45}));
  const auto near = checked(scene, past, 1).pairs.at(0);
  EXPECT_TRUE(near.too_close);
  EXPECT_FALSE(near.collides);
  EXPECT_NEAR(near.min_distance_mm, 0.5, 0.11);
  EXPECT_FALSE(checked(scene, past, 0.3).violated());
  EXPECT_EQ(checked(scene, jump({}, shifted({0, 0, -20})), 1).samples_between, 0);
}

TEST(MotionSampler, AnExcursionBetweenTwoFramesIsFound) {
  const Scene scene = make_scene(plate_patient(4));
  Motion motion = jump({}, {});
  motion.target = [](double t) { return shifted({0, 0, 80 * t * (1 - t)}); };
  motion.sample_times.clear();
  EXPECT_NEAR(checked(scene, motion, 0).pairs.at(0).min_distance_mm, 0.02, 0.1);
  motion.target = [](double t) { return shifted({0, 0, 84 * t * (1 - t)}); };  // up by 21 mm
  const auto pair = checked(scene, motion, 0).pairs.at(0);
  EXPECT_TRUE(pair.collides);
  EXPECT_NEAR(pair.beyond_rest_mm, 1, 0.15);
}

TEST(MotionSampler, TheLeastDistanceDependsOnNeitherMarginNorFrames) {
  const Scene scene = make_scene(plate_patient(4));
  Motion motion = jump({}, {});
  // Two approaches: to 0.9 mm at 0.3 s and to 0.85 mm at 0.737 s.
  motion.target = [](double t) {
    const double x = t < 0.5 ? (t - 0.3) / 0.3 : (t - 0.737) / 0.3;
    return shifted({0, 0, (t < 0.5 ? 19.1 : 19.15) - 12 * x * x});
  };
  motion.sample_times.clear();
  const double facet_mm = 0.02;  // the ball's lowest vertices are on its sphere, its faces inside
  for (const int frames : {11, 24, 60, 100})
    for (const double margin : {0.0, 0.5, 1.0, 2.0}) {
      const auto pair = checked(scene, motion, margin, frames).pairs.at(0);
      EXPECT_NEAR(pair.min_distance_mm, 0.85, facet_mm) << frames << " " << margin;
      EXPECT_NEAR(pair.min_distance_at.time_s, 0.737, 0.02) << frames << " " << margin;
    }
}

TEST(MotionSampler, FewFramesFindWhatManyFind) {
  // Any paths of a bumpy ball past another: the deepest, or nearest, of 800 poses is found from two
  // frames to a tenth of a millimetre, and the first touch as well.
  std::mt19937_64 random(3);
  int touched = 0;
  for (int i = 0; i < 6; ++i) {
    Case patient = box_patient();
    patient.parts[0].mesh = sphere(3, 10, {0, -65, 0}, 0.08);
    patient.parts[1].mesh = sphere(3, 8, {0, -65, -30}, 0.08);
    const Scene scene = make_scene(std::move(patient));
    Pose from = any_pose(random, 6), to = any_pose(random, 6);
    const Eigen::Vector3d ball(0, -65, -30);
    from.t += Eigen::Vector3d(0, -65, -22) - from.R * ball;
    to.t += Eigen::Vector3d(12, -65, 18) - to.R * ball;
    const Motion motion = jump(from, to);
    double worst = 1e300, first = -1;
    ContactSet set = scene.contacts.at_rest();
    for (int k = 0; k <= 800; ++k) {
      set = scene.contacts.find(motion.target(k / 800.0), &set);
      worst = std::min(worst, set.pairs.at(0).signed_distance_mm());
      if (first < 0 && set.pairs[0].touching) first = k / 800.0;
    }
    const auto pair = checked(scene, motion, 100).pairs.at(0);
    EXPECT_NEAR(pair.beyond_rest_mm > 0 ? -pair.beyond_rest_mm : pair.min_distance_mm, worst, 0.11);
    ASSERT_EQ(pair.first_touch.has_value(), first >= 0);
    if (first < 0) continue;
    ++touched;
    EXPECT_NEAR(pair.first_touch->time_s, first, 2.0 / 800);
  }
  EXPECT_GT(touched, 0);
}

TEST(MotionSampler, IsBitIdenticalForOneAndTwoThreads) {
  const Scene scene = make_scene(plate_patient(1));
  const Motion motion = jump({}, shifted({3, 0, 45}));
  const auto one = checked(scene, motion, 1, 40, 1), two = checked(scene, motion, 1, 40, 2);
  EXPECT_EQ(one.pairs_csv, two.pairs_csv);
  EXPECT_EQ(one.json(scene, motion), two.json(scene, motion));
  EXPECT_GT(one.samples_between, 0);
}

TEST(FrameTimes, FromTheFirstToTheLastMoment) {
  Motion motion = jump({}, {});
  EXPECT_EQ(frame_times(motion, {}).size(), 31u);
  EXPECT_EQ(frame_times(motion, {}).back(), 1);
  EXPECT_EQ(frame_times(motion, {.frames = 5}), (std::vector<double>{0, 0.25, 0.5, 0.75, 1}));
  motion.duration_s = 0.004;
  EXPECT_EQ(frame_times(motion, {}), (std::vector<double>{0, 0.004}));
  motion.duration_s = 0;
  EXPECT_EQ(frame_times(motion, {}).size(), 1u);
  motion.duration_s = 1e6;
  EXPECT_EQ(frame_times(motion, {}).size(), 3000u);
}

}  // namespace
}  // namespace condyle::test
