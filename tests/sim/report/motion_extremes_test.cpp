#include "sim/report/motion_extremes.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "sim/motion/measure_pose.h"
#include "sim/report/bite_position.h"
#include "sim/report/report.h"
#include "tests/support/boxes.h"

namespace condyle::test {
namespace {

/// Down by 30 mm in a second, aside by 3 mm to the right in the middle, and back in half a second.
Motion down_and_back() {
  return {"prescribed",
          1.5,
          false,
          [](double t) {
            const double fraction = t < 1 ? t : 1 - 2 * (t - 1);
            const double aside = t > 0.4 && t < 0.6 ? -3 : 0;
            return Pose{Eigen::Quaterniond::Identity(), {aside, 0, -30 * fraction}};
          },
          {}};
}

}  // namespace

TEST(Extremes, AreTheLargestOfEachMeasureAndWhen) {
  const Scene scene = make_scene(box_patient());
  const Motion motion = down_and_back();
  MotionSeries series(scene, motion);
  EXPECT_TRUE(extremes(series).empty());
  MotionReport report(scene, motion, {});
  for (int i = 0; i <= 150; ++i) {
    FrameState frame = rest_frame(scene);
    frame.time_s = 0.01 * i;
    frame.poses = motion.target(frame.time_s);
    frame.X_PB_target = frame.poses.X_CB;
    if (i == 100) {
      frame.stopped = true;
      frame.X_PB_target[1].t.z() -= 2;
    }
    frame.measures = measure(scene.patient, frame.poses);
    series.add(frame);
    report.add(frame);
  }
  const auto all = extremes(series);
  EXPECT_NEAR(extreme(all, "opening").value, 30, 1e-9);
  EXPECT_NEAR(extreme(all, "opening").time_s, 1, 1e-9);
  EXPECT_NEAR(extreme(all, "laterotrusion_right").value, 3, 1e-9);
  EXPECT_NEAR(extreme(all, "midline_deviation").value, 3, 1e-9);
  EXPECT_NEAR(extreme(all, "laterotrusion_left").value, 0, 1e-9);
  EXPECT_NEAR(extreme(all, "left_condyle_travel").value, 30, 1e-9);
  EXPECT_NEAR(extreme(all, "condyle_asymmetry").value, 0, 1e-9);
  EXPECT_NEAR(extreme(all, "opening_speed").value, 30, 1e-6);
  EXPECT_NEAR(extreme(all, "closing_speed").value, 60, 1e-6);
  EXPECT_GT(extreme(all, "closing_speed").time_s, 1);
  EXPECT_THROW(extreme(all, "yawning"), std::out_of_range);

  const auto json = nlohmann::json::parse(report.json());
  EXPECT_NEAR(json["measures"]["opening"]["value"], 30, 1e-9);
  EXPECT_EQ(json["measures"]["opening"]["unit"], "mm");
  EXPECT_NEAR(json["contact"]["contact_deviation_mm"], 2, 1e-9);
  EXPECT_NE(report.text().find("by up to 2.00 mm at the incisors"), std::string::npos);
}

TEST(BiteFrame, IsWhereBordersBeginOrAGlideCloses) {
  const Scene scene = make_scene(box_patient());
  Motion motion = down_and_back();
  const auto bite = [&] {
    MotionSeries series(scene, motion);
    for (int i = 0; i <= 150; ++i) {
      FrameState frame = rest_frame(scene);
      frame.time_s = 0.01 * i;
      frame.measures = measure(scene.patient, motion.target(frame.time_s));
      series.add(frame);
    }
    return Eigen::Vector3d(bite_position(series) - series.rest.incisor);
  };
  EXPECT_LT(bite().norm(), 1e-12);
  motion.phases = {{"protrusion", 0, 0.2}, {"closing", 0.2, 0.3}, {"back to the start", 0.3, 1.5}};
  EXPECT_NEAR(bite().z(), -9, 1e-9);
  motion.borders.sagittal = {scene.patient.landmarks.points.at("lower_incisal_point")};
  EXPECT_LT(bite().norm(), 1e-12);
}

}  // namespace condyle::test
