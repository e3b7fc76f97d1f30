#include "sim/motion/recording.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "tests/support/real_cases.h"

namespace condyle {
namespace {

/// A temporary file.
class Recording : public testing::Test {
 protected:
  Recording()
      : folder_(std::filesystem::temp_directory_path() /
                ("condyle_recording_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~Recording() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path file(const std::string& content) {
    const auto path = folder_ / "poses.csv";
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }
  Motion read(const std::string& content) { return read_recording(file(content)); }

  /// The message names the file and each of the words.
  void expect_refused(const std::string& content, const std::vector<std::string>& words) {
    try {
      read(content);
      ADD_FAILURE() << "accepted:\n" << content;
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find("poses.csv"), std::string::npos) << message;
      for (const auto& word : words) EXPECT_NE(message.find(word), std::string::npos) << message;
      EXPECT_LT(message.size(), 400u);
      EXPECT_EQ(message.find('\n'), std::string::npos);
    }
  }

  std::filesystem::path folder_;
};

const std::string header = "time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz\n";

TEST_F(Recording, IsExactAtItsSamplesAndStraightBetween) {
  const Motion motion = read(header +
                             "2.0,0,0,0,1,0,0,0\n"
                             "2.5,1,2,3,0.6,0.8,0,0\n"
                             "4.0,5,2,3,0,1,0,0\n");
  EXPECT_TRUE(motion.recorded);
  EXPECT_EQ(motion.name, "poses");
  EXPECT_DOUBLE_EQ(motion.duration_s, 2.0);
  EXPECT_EQ(motion.target(0).t, Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(motion.target(0.5).t, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(motion.target(0.5).R.x(), 0.8, 1e-15);
  EXPECT_EQ(motion.target(2.0).t, Eigen::Vector3d(5, 2, 3));
  EXPECT_LT((motion.target(0.25).t - Eigen::Vector3d(0.5, 1, 1.5)).norm(), 1e-15);
  // Halfway in angle: slerp.
  const double whole = rotation_angle(motion.target(0.5));
  EXPECT_NEAR(rotation_angle(motion.target(0.25)), whole / 2, 1e-12);
  // Clamped beyond both ends.
  EXPECT_EQ(motion.target(-1).t, motion.target(0).t);
  EXPECT_EQ(motion.target(99).t, motion.target(2.0).t);
}

TEST_F(Recording, TakesColumnsInAnyOrderWithOthersBetweenAndWindowsLineEnds) {
  const Motion plain = read(header + "0,1,2,3,0.6,0,0.8,0\n1,4,5,6,0.6,0,0,0.8\n");
  const Motion odd = read(
      "\xEF\xBB\xBFqz, qy ,QX,qw,note,tz_mm,ty_mm,tx_mm,Time_s\r\n"
      "0,0.8,0,0.6,hello,3,2,1,0\r\n\r\n0.8,0,0,0.6,,6,5,4,+1\r\n");
  for (const double time : {0.0, 0.3, 1.0}) {
    EXPECT_EQ(plain.target(time).t, odd.target(time).t);
    EXPECT_EQ(plain.target(time).R.coeffs(), odd.target(time).R.coeffs());
  }
  // A last line without an end is whole.
  EXPECT_EQ(read(header + "0,0,0,0,1,0,0,0\n1,7,0,0,1,0,0,0").target(1).t.x(), 7);
}

TEST_F(Recording, QuaternionsMayBeRoundedAndChangeSign) {
  const Motion motion = read(header + "0,0,0,0,0.9995,0,0,0\n1,0,0,0,-0.9998,-0.02,0,0\n");
  EXPECT_NEAR(motion.target(0).R.norm(), 1, 1e-15);
  EXPECT_NEAR(motion.target(0.5).R.norm(), 1, 1e-15);
  EXPECT_LT(rotation_angle(motion.target(0.5)), 0.021);  // not the long arc
  EXPECT_NEAR(rotation_angle(motion.target(1)), 0.04, 1e-4);
}

TEST_F(Recording, OneRowIsAStillPose) {
  const Motion motion = read(header + "5,1,2,3,1,0,0,0\n");
  EXPECT_EQ(motion.duration_s, 0);
  EXPECT_EQ(motion.target(0.7).t, Eigen::Vector3d(1, 2, 3));
}

TEST_F(Recording, RefusesErrorsWithTheirLocation) {
  const std::string good = "0,0,0,0,1,0,0,0\n";
  expect_refused("", {"empty"});
  expect_refused("\r\n \n", {"empty"});
  expect_refused(header, {"no pose"});
  expect_refused("time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy\n" + good, {"line 1", "qz", "missing"});
  expect_refused("time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz,qz\n" + good, {"line 1", "qz", "twice"});
  expect_refused("0,0,0,0,1,0,0,0\n" + good, {"line 1", "time_s"});
  expect_refused(header + good + "1,0,0\n", {"line 3", "3 values", "cut off"});
  expect_refused(header + good + "1,0,0,0,1,0,0\n", {"line 3", "7 values"});
  expect_refused(header + good + "1,0,0,zero,1,0,0,0\n", {"line 3", "tz_mm", "zero"});
  expect_refused(header + good + "1,0,0,1.5x,1,0,0,0\n", {"line 3", "tz_mm", "1.5x"});
  expect_refused(header + good + "1,0,,0,1,0,0,0\n", {"line 3", "ty_mm"});
  expect_refused(header + good + "1,0,nan,0,1,0,0,0\n", {"line 3", "ty_mm", "nan"});
  expect_refused(header + good + "1,0,0,0,1,inf,0,0\n", {"line 3", "qx", "inf"});
  expect_refused(header + good + "1,0,0,0,1,0,0,1e999\n", {"line 3", "qz", "1e999"});
  expect_refused(header + good + "1,0,0,0,0,0,0,0\n", {"line 3", "length 0"});
  expect_refused(header + good + "1,0,0,0,1,0.1,0,0\n", {"line 3", "length 1.00499"});
  expect_refused(header + "1,0,0,0,1,0,0,0\n" + good, {"line 3", "time_s", "0", "after 1"});
  expect_refused(header + good + good, {"line 3", "time_s", "after 0"});
  expect_refused(header + good + "1,0,-4000,0,1,0,0,0\n",
                 {"line 3", "ty_mm", "-4000", "millimetres"});
  expect_refused(header + good + "1e9,0,0,0,1,0,0,0\n", {"line 3", "time_s", "seconds"});
  expect_refused(std::string(100000, 'x') + "\n" + good, {"line 1", "time_s"});
  EXPECT_THROW(read_recording(folder_ / "absent.csv"), InputError);
  EXPECT_THROW(read_recording(folder_), InputError);
}

TEST_F(Recording, AJsonFileIsNoMotion) {
  const auto file = folder_ / "foo.json";
  std::ofstream(file) << "{\"a\": 1}";
  try {
    read_recording(file);
    FAIL();
  } catch (const InputError& error) {
    const std::string words = error.what();
    EXPECT_NE(words.find("foo.json: is not a motion"), std::string::npos) << words;
    EXPECT_EQ(words.find("json.json"), std::string::npos) << words;
  }
}

TEST(RealRecording, RightChewPlaysBackAsWritten) {
  const auto path = test::real_data() / "case-ubc" / "trajectories" / "rightchew_jaw_pose.csv";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "real anatomy absent";
  const Motion motion = read_recording(path);
  EXPECT_NEAR(motion.duration_s, 1.002, 1e-9);
  const Eigen::Vector3d incisor(0, -46.9584, 41.7642);
  // The file read again by the simplest method: pose times marker.
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  int rows = 0;
  double max_drop = 0;
  while (std::getline(in, line)) {
    double time, x, y, z, w, a, b, c;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", &time, &x, &y, &z, &w,
                          &a, &b, &c),
              8);
    const Eigen::Vector3d expected =
        Eigen::Quaterniond(w, a, b, c).normalized() * incisor + Eigen::Vector3d(x, y, z);
    ASSERT_LT((motion.target(time) * incisor - expected).norm(), 1e-9) << time;
    max_drop = std::max(max_drop, incisor.z() - expected.z());
    ++rows;
  }
  EXPECT_EQ(rows, 1003);
  EXPECT_NEAR(max_drop, 20.09, 0.02);
}

}  // namespace
}  // namespace condyle
