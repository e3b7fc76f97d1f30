#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <array>
#include <fstream>
#include <functional>
#include <numbers>
#include <random>

#include "engine/core/error.h"
#include "sim/motion/recording.h"
#include "tests/support/boxes.h"
#include "tests/support/real_cases.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A jaw that opens, slides and yaws.
Pose jaw_at(double time_s) {
  Pose X;
  X.R = Eigen::AngleAxisd(0.3 * time_s, Vector3d(1, 0.2, -0.1).normalized());
  X.t = Vector3d(2 * time_s, -6 * time_s, -4 * time_s * time_s);
  return X;
}

class RecordingFormats : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() / ("condyle_formats_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  Motion read(const std::string& name, const std::string& content,
              const std::string& sidecar = "") {
    const auto file = folder_ / name;
    std::ofstream(file, std::ios::binary) << content;
    const std::filesystem::path beside = file.string() + ".json";
    std::filesystem::remove(beside);
    if (!sidecar.empty()) std::ofstream(beside, std::ios::binary) << sidecar;
    return read_recording(file);
  }
  void expect_refused(const std::string& name, const std::string& content,
                      const std::string& sidecar, const std::vector<std::string>& words) {
    try {
      read(name, content, sidecar);
      FAIL() << content << sidecar;
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find(name), std::string::npos) << message;
      for (const auto& word : words) EXPECT_NE(message.find(word), std::string::npos) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos);
      EXPECT_LT(message.size(), 600u);
    }
  }

  std::filesystem::path folder_;
};

void expect_jaw(const Motion& motion, double tolerance_mm = 1e-6) {
  ASSERT_NEAR(motion.duration_s, 1, 1e-9);
  for (const double time : {0.0, 0.1, 0.5, 0.7, 1.0})
    for (const Vector3d& p : {Vector3d(0, -80, -40), Vector3d(50, 0, 0), Vector3d(0, 0, 0)})
      EXPECT_LT((motion.target(time) * p - jaw_at(time) * p).norm(), tolerance_mm) << time;
}

/// Eleven rows, each given by `row` for a time.
std::string rows(const std::function<std::string(double)>& row) {
  std::string text;
  for (int k = 0; k <= 10; ++k) text += row(k / 10.0) + "\n";
  return text;
}

std::string matrix(const Pose& X, const char* separator, bool by_columns = false) {
  Eigen::Matrix4d M = Eigen::Matrix4d::Identity();
  M.topLeftCorner<3, 3>() = X.R.toRotationMatrix();
  M.topRightCorner<3, 1>() = X.t;
  std::string text;
  for (int k = 0; k < 16; ++k)
    text += (k ? separator : "") +
            fmt::format("{:.12g}", by_columns ? M(k % 4, k / 4) : M(k / 4, k % 4));
  return text;
}

TEST_F(RecordingFormats, ASidecarNamesColumnsUnitsAxesAndOrigin) {
  // Axes forward, up, right; metres, milliseconds, degrees; about a far origin.
  Matrix3d A;  // file to case
  A << 0, 0, -1, -1, 0, 0, 0, 1, 0;
  const Vector3d origin(10, 300, -200);
  const std::string sidecar =
      R"({"time": "ms", "time_unit": "ms", "length_unit": "m", "angle_unit": "deg", "axes": "ASR",
          "origin_mm": [10, 300, -200],
          "mandible": {"translation": ["x", "y", "z"], "euler": ["a", "b", "c"], "order": "ZYX"}})";
  const auto row = [&](double time) {
    const Pose X = jaw_at(time);
    const Matrix3d R = A.transpose() * X.R.toRotationMatrix() * A;
    const Vector3d t = A.transpose() * (X.t - origin + X.R * origin);
    const Vector3d angles = R.eulerAngles(2, 1, 0) * 180 / std::numbers::pi;
    return fmt::format("{};{:.14g};{:.14g};{:.14g};noise;{:.14g};{:.14g};{:.14g}", 1000 * time,
                       angles[0], angles[1], angles[2], t.x() / 1000, t.y() / 1000, t.z() / 1000);
  };
  expect_jaw(read("jaw.csv", "ms;a;b;c;note;x;y;z\n" + rows(row), sidecar));
}

TEST_F(RecordingFormats, AnglesAboutFixedAxesAreTheReverseOrder) {
  const auto order = [&](const char* letters, const std::string& row) {
    return read("jaw.csv", "time_s,tx_mm,ty_mm,tz_mm,a,b,c\n0,0,0,0," + row,
                fmt::format(R"({{"mandible": {{"translation": ["tx_mm", "ty_mm", "tz_mm"],
                              "euler": ["a", "b", "c"], "order": "{}"}}}})",
                            letters))
        .target(0)
        .R;
  };
  EXPECT_LT(order("XYZ", "0.1,0.2,0.3\n").angularDistance(order("zyx", "0.3,0.2,0.1\n")), 1e-12);
  EXPECT_GT(order("XYZ", "0.1,0.2,0.3\n").angularDistance(order("xyz", "0.1,0.2,0.3\n")), 1e-3);
  const Eigen::Quaterniond by_hand = Eigen::AngleAxisd(0.1, Vector3d::UnitX()) *
                                     Eigen::AngleAxisd(0.2, Vector3d::UnitY()) *
                                     Eigen::AngleAxisd(0.3, Vector3d::UnitX());
  EXPECT_LT(order("XYX", "0.1,0.2,0.3\n").angularDistance(by_hand), 1e-12);
}

TEST_F(RecordingFormats, MatricesHaveTimesOrARateByRowsOrByColumns) {
  const auto with_time =
      rows([](double t) { return fmt::format("{} ", t) + matrix(jaw_at(t), " "); });
  expect_jaw(read("jawPose.raw", with_time));
  const auto bare = rows([](double t) { return matrix(jaw_at(t), ","); });
  expect_jaw(read("rows.csv", bare, R"({"rate_hz": 10})"));
  const auto turned = rows([](double t) { return matrix(jaw_at(t), ",", true); });
  expect_jaw(read("rows.csv", turned, R"({"rate_hz": 10})"));
  expect_refused("rows.csv", bare, "", {"rate_hz"});
  // Two bodies in a row: the second is the head that moves too.
  const Pose head{Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Vector3d(1, 2, 3).normalized())),
                  Vector3d(100, 20, 5)};
  std::string columns[2];
  for (int k = 1; k <= 32; ++k)
    columns[k > 16] += fmt::format("{}\"#{}\"", (k - 1) % 16 ? ", " : "", k);
  expect_jaw(read("two.csv", rows([&](double t) {
                    return matrix(head * jaw_at(t), ",") + "," + matrix(head, ",");
                  }),
                  fmt::format(R"({{"rate_hz": 10, "mandible": {{"matrix": [{}]}},
                                "cranium": {{"matrix": [{}]}}}})",
                              columns[0], columns[1])));
}

TEST_F(RecordingFormats, RoundedMatricesBecomeRotationsAndOthersAreRefused) {
  std::string rounded;
  for (int k = 0; k <= 10; ++k) {
    const Matrix3d R = jaw_at(k / 10.0).R.toRotationMatrix();
    const Vector3d t = jaw_at(k / 10.0).t;
    rounded += fmt::format("{:.2f}", k / 10.0);
    for (int i = 0; i < 3; ++i)
      rounded += fmt::format(" {:.2f} {:.2f} {:.2f} {:.2f}", R(i, 0), R(i, 1), R(i, 2), t[i]);
    rounded += " 0.00 0.00 0.00 1.00\n";
  }
  const Motion motion = read("jawPose.raw", rounded);
  EXPECT_NEAR(motion.target(0.6).R.norm(), 1, 1e-12);
  EXPECT_LT(motion.target(0.6).R.angularDistance(jaw_at(0.6).R), 0.01);
  const std::string end = " 0 0 0 1\n";
  expect_refused("a.raw", "0 1 0 0 0 0 1.2 0 0 0 0 1 0" + end, "", {"line 1", "rotation", "0.44"});
  expect_refused("a.raw", "0 1 0 0 0 0 1 0 0 0 0 -1 0" + end, "", {"line 1", "reflection"});
  expect_refused("a.raw", "0 1 0 0 2 0 1 0 0 0 0 1 0 0 0 5 1\n", "",
                 {"line 1", "0 0 0 1", "0 0 5 1"});
  expect_refused("a.raw", "0 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n0 1 0\n", "", {"line 2", "cut off"});
}

TEST_F(RecordingFormats, OpenSimStorageIsInItsAxesAndUnits) {
  Matrix3d A;
  A << 0, 0, -1, -1, 0, 0, 0, 1, 0;
  const auto content = [&](const char* degrees, double unit) {
    return fmt::format(
               "jaw motion\nversion=1\nnRows=11\nnColumns=8\ninDegrees={}\nendheader\ntime\tother\t"
               "jaw_rx\tjaw_ry\tjaw_rz\tjaw_tx\tjaw_ty\tjaw_tz\n",
               degrees) +
           rows([&](double time) {
             const Pose X = jaw_at(time);
             const Vector3d t = A.transpose() * X.t / 1000;
             const Vector3d angles =
                 (A.transpose() * X.R.toRotationMatrix() * A).eulerAngles(0, 1, 2);
             // The other solution of the same rotation where Eigen chooses it.
             return fmt::format("{}\t7\t{:.14g}\t{:.14g}\t{:.14g}\t{:.14g}\t{:.14g}\t{:.14g}", time,
                                angles[0] * unit, angles[1] * unit, angles[2] * unit, t.x(), t.y(),
                                t.z());
           });
  };
  expect_jaw(read("jaw.mot", content("yes", 180 / std::numbers::pi)));
  expect_jaw(read("jaw.sto", content("no", 1)));
  std::string old = content("no", 1);
  old.replace(0, old.find("endheader"), "name x\ndatacolumns 8\ndatarows 11\n");
  expect_jaw(read("old.mot", old));
  expect_refused("jaw.sto", "x\nendheader\ntime\ta\n0\t1\n", "", {"line 3", "_tx", "jaw.sto.json"});
}

TEST_F(RecordingFormats, ProbesHaveAHeaderOfTwoLines) {
  const auto fixed =
      "0 1 1\nlinear 16 0.1\n" + rows([](double t) { return matrix(jaw_at(t), " "); });
  expect_jaw(read("probe.txt", fixed));
  const auto times = "0 1 1\nCubic 16 explicit\n" +
                     rows([](double t) { return fmt::format("{} ", t) + matrix(jaw_at(t), " "); });
  expect_jaw(read("probe.txt", times));
  const auto twelve = "0 1 0.5\nstep 12 0.2\n" + rows([](double t) {
                        const std::string all = matrix(jaw_at(t), " ");
                        return all.substr(0, all.size() - 8);
                      });
  expect_jaw(read("probe.txt", twelve));
  expect_refused("probe.txt", "0 1 1\nlinear 3 0.1\n1 2 3\n", "", {"line 2", "3 columns"});
  expect_refused("probe.txt", "0 1 1\nlinear 16 0\n1 2 3\n", "", {"line 2", "time step"});
}

std::string trc(const std::vector<Vector3d>& markers, const std::vector<Vector3d>& head,
                double noise, int hide_from = 99, int hide_to = 99) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;  // of unit variance: there may be no noise
  const Pose lab{Eigen::Quaterniond(Eigen::AngleAxisd(0.2, Vector3d(0, 1, 1).normalized())),
                 Vector3d(300, 100, -50)};
  std::string text = "PathFileType\t4\t(X/Y/Z)\tjaw.trc\nDataRate\tNumFrames\tUnits\n10\t11\tmm\n";
  text += "Frame#\tTime";
  const auto count = markers.size() + head.size();
  for (std::size_t m = 0; m < count; ++m) text += fmt::format("\tm{}\t\t", m);
  text += "\n\t\tX1\tY1\tZ1\n";
  for (int k = 0; k <= 10; ++k) {
    text += fmt::format("{}\t{}", k + 1, k / 10.0);
    // Nods, and the jaw with it.
    const Pose nod{Eigen::Quaterniond(Eigen::AngleAxisd(0.03 * k, Vector3d::UnitY())),
                   Vector3d(0, 0.5 * k, 0)};
    for (std::size_t m = 0; m < count; ++m) {
      const bool of_head = m >= markers.size();
      const Vector3d p = lab * (head.empty() ? Pose{} : nod) *
                         (of_head ? head[m - markers.size()] : jaw_at(k / 10.0) * markers[m]);
      if (m == 0 && k >= hide_from && k <= hide_to)
        text += "\t\t\t";
      else
        text += fmt::format("\t{:.12g}\t{:.12g}\t{:.12g}", p.x() + noise * normal(random),
                            p.y() + noise * normal(random), p.z() + noise * normal(random));
    }
    text += "\n";
  }
  return text;
}

TEST_F(RecordingFormats, MarkersAreFittedAndTheirResidualIsReported) {
  const std::vector<Vector3d> jaw = {{0, -90, -50}, {30, -60, -60}, {-30, -60, -60}, {0, -80, -70}};
  const std::vector<Vector3d> head = {{0, -80, 60}, {40, -60, 80}, {-40, -60, 80}};
  // As the lab has it the jaw turns about other axes; with the lab's axes given, it is the jaw.
  const Motion alone = read("jaw.trc", trc(jaw, {}, 0), R"({"axes": "LPS"})");
  EXPECT_LT(alone.recording->residual_max_mm, 1e-9);
  EXPECT_NEAR(rotation_angle(alone.target(1)), rotation_angle(jaw_at(1)), 1e-9);
  const std::string both = R"({"axes": "LPS",
    "mandible": {"markers": ["m0", "m1", "m2", "m3"]}, "cranium": {"markers": ["m4", "m5", "m6"]}})";
  const Motion against = read("jaw.trc", trc(jaw, head, 0), both);
  EXPECT_NEAR(rotation_angle(against.target(0.7)), rotation_angle(jaw_at(0.7)), 1e-9);
  const Motion noisy = read("jaw.trc", trc(jaw, head, 0.2), both);
  EXPECT_GT(noisy.recording->residual_rms_mm, 0.1);
  EXPECT_LT(noisy.recording->residual_rms_mm, 0.6);
  // A hidden marker leaves three; two hidden rows of a body of three are a gap.
  EXPECT_EQ(read("jaw.trc", trc(jaw, head, 0, 4, 6), both).recording->rows, 11);
  const std::string three = R"({"axes": "LPS", "mandible": {"markers": ["m0", "m1", "m2"]}})";
  const Motion gap = read("jaw.trc", trc(jaw, {}, 0, 4, 6), three);
  EXPECT_EQ(gap.recording->rows_without_pose, 3);
  ASSERT_EQ(gap.recording->gaps.size(), 1u);
  EXPECT_NEAR(gap.recording->gaps[0].after_s, 0.3, 1e-9);
  EXPECT_NEAR(gap.recording->gaps[0].length_s, 0.4, 1e-9);
  expect_refused("jaw.trc", trc(jaw, {}, 0), R"({"mandible": {"markers": ["m0", "m1", "m9"]}})",
                 {"m9", "m0"});
  expect_refused("jaw.trc", trc({{0, 0, 0}, {10, 0, 0}, {20, 0, 0}}, {}, 0), "", {"line"});
}

TEST_F(RecordingFormats, JitterIsRemovedOnlyOnRequest) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 0.1);
  std::string text = "time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz\n";
  const auto truth = [](double t) {
    return Vector3d(0, -5 * std::sin(3 * t), -8 * std::sin(3 * t));
  };
  for (int k = 0; k <= 400; ++k) {
    const Vector3d t = truth(k / 200.0);
    text += fmt::format("{},{},{},{},1,0,0,0\n", k / 200.0, t.x() + normal(random),
                        t.y() + normal(random), t.z() + normal(random));
  }
  const auto rms = [&](const Motion& motion) {
    double sum = 0;
    for (const double t : motion.sample_times) sum += (motion.target(t).t - truth(t)).squaredNorm();
    return std::sqrt(sum / static_cast<double>(motion.sample_times.size()));
  };
  const double raw = rms(read("a.csv", text)),
               smooth = rms(read("a.csv", text, R"({"smooth_hz": 6})"));
  EXPECT_NEAR(raw, 0.1 * std::sqrt(3), 0.02);
  EXPECT_LT(smooth, 0.35 * raw);
}

TEST_F(RecordingFormats, MistakenUnitsAndAxesAreReported) {
  const Case patient = test::box_patient();
  const auto notes = [&](const std::string& name, const std::string& rows,
                         const std::string& sidecar = "") {
    Motion motion =
        read(name, "time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n" + rows, sidecar);
    note_implausible_values(patient, motion);
    std::string all;
    for (const auto& note : motion.notes) all += note + "\n";
    return all;
  };
  const auto expect_in = [](const std::string& text, std::initializer_list<const char*> words) {
    for (const char* word : words) EXPECT_NE(text.find(word), std::string::npos) << text;
  };
  EXPECT_EQ(notes("good.csv", "1,0,-3,-30,1,0,0,0\n"), "");
  // Metres read as millimetres, without and with a rotation, and with the unit declared.
  expect_in(notes("m.csv", "1,0,0,-0.04,1,0,0,0\n"),
            {"m.csv", "motion is tiny, 0.04 mm", "{\"length_unit\": \"m\"}", "m.csv.json"});
  const std::string turn = "0.98480775,0.17364818,0,0\n";  // 20 degrees
  expect_in(notes("turned.csv", "1,0,-0.008,-0.005," + turn),
            {"turned.csv", "turns by 20 degrees", "tiny", "{\"length_unit\": \"m\"}"});
  EXPECT_EQ(notes("told.csv", "1,0,0,-0.04,1,0,0,0\n", R"({"length_unit": "m"})"), "");
  EXPECT_EQ(notes("hinge.csv", "1,0,0,0," + turn).find("tiny"), std::string::npos);
  // Millimetres read as metres.
  expect_refused("mm.csv",
                 "time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1,0,0,-40,1,0,0,0\n",
                 R"({"length_unit": "m"})",
                 {"mm.csv", "line 3", "tz_mm", "-40000 mm", "in metres", "length_unit"});
  expect_in(notes("far.csv", "1,0,0,-0.8,1,0,0,0\n", R"({"length_unit": "m"})"),
            {"far.csv", "is 800 mm from rest at 1.00 s", "length_unit"});
  expect_in(notes("up.csv", "1,0,0,30,1,0,0,0\n"), {"up.csv", "rises 30.0 mm", "\"axes\""});
}

TEST_F(RecordingFormats, LengthsInCentimetresAreRecognizedByTheCondyles) {
  Case patient = test::box_patient();
  for (auto& [name, point] : patient.landmarks.points) point += Vector3d(0, 65, 112);
  const auto notes = [&](double unit_mm, const std::string& sidecar = "") {
    const Vector3d hinge(0, 60, 100);
    std::string rows = "time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz\n";
    for (int k = 0; k <= 10; ++k) {
      const Eigen::Quaterniond R(Eigen::AngleAxisd(0.021 * k, Vector3d::UnitX()));  // to 12 degrees
      const Vector3d t = (hinge - R * hinge) / unit_mm;
      rows += fmt::format("{},{},{},{},{},{},{},{}\n", 0.1 * k, t.x(), t.y(), t.z(), R.w(), R.x(),
                          R.y(), R.z());
    }
    Motion motion = read("turn.csv", rows, sidecar);
    note_implausible_values(patient, motion);
    std::string all;
    for (const auto& note : motion.notes) all += note + "\n";
    return all;
  };
  EXPECT_EQ(notes(1), "");
  const std::string in_cm = notes(10);
  for (const char* words : {"turn.csv", "condyles leave their joints", "turns by 12 degrees",
                            "turn.csv.json", "{\"length_unit\": \"cm\"}"})
    EXPECT_NE(in_cm.find(words), std::string::npos) << in_cm;
  EXPECT_EQ(notes(10, R"({"length_unit": "cm"})"), "");
}

TEST_F(RecordingFormats, PositionsAloneAreRefusedWithTheColumnsThatAreNeeded) {
  for (const std::string text : {"x,y,z\n0,0,0\n0,-1,-2\n", "time_s,x,y,z\n0,0,0,0\n1,0,-1,-2\n",
                                 "0 0 0\n0 -1 -2\n", "0,0,0,0\n1,0,-1,-2\n"})
    expect_refused("path.csv", text, "",
                   {"line 1", "rotation of the jaw", "tx_mm,ty_mm,tz_mm,qw,qx,qy,qz", ".trc",
                    "path.csv.json"});
}

TEST_F(RecordingFormats, SidecarsAreReadStrictly) {
  const std::string csv = "time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n";
  expect_refused("a.csv", csv, "{", {"a.csv.json"});
  expect_refused("a.csv", csv, R"({"colour": 1})", {"colour", "valid keys"});
  expect_refused("a.csv", csv, R"({"axes": "XYZ"})", {"axes", "XYZ"});
  expect_refused("a.csv", csv, R"({"length_unit": "furlong"})", {"length_unit", "furlong", "mm"});
  expect_refused("a.csv", csv, R"({"mandible": {"translation": ["a", "b"]}})",
                 {"translation", "3"});
  expect_refused("a.csv", csv, R"({"mandible": {"translation": ["a", "b", "c"]}})", {"rotation"});
  expect_refused("a.csv", csv,
                 R"({"mandible": {"translation": ["tx_mm", "ty_mm", "tz_mm"],
                     "euler": ["qx", "qy", "qz"], "order": "XXY"}})",
                 {"order", "XXY"});
  expect_refused("a.csv", csv, R"({"mandible": {"translation": ["tx_mm", "ty_mm", "tz_mm"],
                                   "quaternion": ["q0", "qx", "qy", "qz"]}})",
                 {"line 1", "q0", "qw"});
  expect_refused("a.csv", csv, R"({"smooth_hz": -1})", {"smooth_hz", "-1"});
}

TEST(RealFormats, TheRoundedMatricesOfACasePlayLikeItsPoses) {
  const auto folder = test::real_data() / "case-ubc" / "trajectories";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "real anatomy absent";
  const Motion exact = read_recording(folder / "rightchew_jaw_pose.csv"),
               rounded = read_recording(folder / "rightchew_jaw_pose_raw2dp.csv");
  for (double t = 0; t < 0.8; t += 0.05)
    EXPECT_LT((exact.target(t + 0.001).t - rounded.target(t).t).norm(), 0.05);
  EXPECT_TRUE(exact.recording->gaps.empty());
}

}  // namespace
}  // namespace condyle
