#include "sim/muscles/excitations.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <fstream>

#include "engine/core/error.h"
#include "sim/muscles/default_muscles.h"
#include "sim/phantom/phantom.h"

namespace condyle {
namespace {

class ExcitationFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("condyle_excitations_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    for (const char* name : {"lat", "rat", "lmt", "rmt", "lam", "ram", "lpm", "rpm"}) {
      Muscle m;
      m.name = name;
      m.kind = m.name.substr(1);
      muscles_.push_back(m);
    }
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  Excitations read(const std::string& content, const std::string& sidecar = "") {
    const auto beside = folder_ / "excite.csv.json";
    if (sidecar.empty())
      std::filesystem::remove(beside);
    else
      std::ofstream(beside, std::ios::binary) << sidecar;
    const auto file = folder_ / "excite.csv";
    std::ofstream(file, std::ios::binary) << content;
    return read_excitations(file, muscles_);
  }
  void expect_refused(const std::string& content, const std::vector<std::string>& words,
                      const std::string& sidecar = "") {
    try {
      read(content, sidecar);
      FAIL() << content;
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find("excite.csv"), std::string::npos) << message;
      for (const auto& word : words) EXPECT_NE(message.find(word), std::string::npos) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos);
    }
  }

  std::filesystem::path folder_;
  std::vector<Muscle> muscles_;
};

TEST_F(ExcitationFile, ColumnsNameMusclesKindsAndGroupsAndAddUp) {
  const auto at = read("# who pulls\ntime_s,lat,bi_mt,rmy,t\n0,0.1,0.2,0.3,0.05\n").at(7);
  const std::vector<double> expected = {0.15, 0.05, 0.25, 0.25, 0, 0.3, 0, 0.3};
  for (std::size_t m = 0; m < expected.size(); ++m) EXPECT_NEAR(at[m], expected[m], 1e-12) << m;
  EXPECT_EQ(read("LAT,TIME_S,t\r\n0.7,0,0.6\r\n").at(0)[0], 1);  // never above 1
}

TEST_F(ExcitationFile, IsExactAtItsRowsAndNeverBeyondThem) {
  const Excitations e = read("time_s,lat\n2,0\n2.1,0.8\n2.3,0.8\n2.4,0\n");
  EXPECT_NEAR(e.duration_s, 0.4, 1e-12);
  EXPECT_NEAR(e.at(0.1)[0], 0.8, 1e-9);
  for (double t = -1; t < 1; t += 0.003) {
    EXPECT_GE(e.at(t)[0], 0);
    EXPECT_LE(e.at(t)[0], 0.8 + 1e-12);  // rounding
  }
  EXPECT_EQ(e.at(9)[0], 0);
}

TEST_F(ExcitationFile, RefusesErrorsWithTheirLocation) {
  expect_refused("", {"empty"});
  expect_refused("# only words\n", {"empty"});
  expect_refused("time_s,lat\n", {"no excitation"});
  expect_refused("time_s\n0\n", {"line 1", "names a muscle"});
  expect_refused("lat\n0\n", {"line 1", "time_s"});
  expect_refused("time_s,biceps\n0,0\n", {"line 1", "biceps", "lat", "stiffenjaw"});
  expect_refused("time_s,xclose\n0,0\n", {"line 1", "xclose"});
  expect_refused("time_s,lat,lat\n0,0,0\n", {"line 1", "lat", "twice"});
  expect_refused("time_s,lat\n0,0\n1\n", {"line 3", "cut off"});
  expect_refused("time_s,lat\n0,0\n1,1.2\n", {"line 3", "lat", "1.2", "0 to 1"});
  expect_refused("time_s,lat\n0,0\n1,-0.2\n", {"line 3", "lat", "-0.2"});
  expect_refused("time_s,lat\n0,0\n1,nan\n", {"line 3", "lat", "nan"});
  expect_refused("time_s,lat\n0,0\n1,much\n", {"line 3", "lat", "much"});
  expect_refused("time_s,lat\n1,0\n1,0\n", {"line 3", "time_s", "after 1"});
  expect_refused("time_s,lat\n1,0\n0.5,0\n", {"line 3", "time_s", "0.5"});
}

TEST_F(ExcitationFile, KnotsOfEachMuscleHaveTimesOfTheirOwn) {
  const std::string header = "muscle,time_s,excitation,interpolation,probe\n";
  const Excitations e = read(header +
                             "lat,0.1,0.2,Cubic,7\nlat,0.2,0.6,Cubic,7\nlat,0.4,0.4,Cubic,7\n"
                             "rmy,0,0.3,linear,7\nrmy,0.5,0.1,linear,7\nt,0.2,0.1,step,7\n");
  EXPECT_NEAR(e.duration_s, 0.5, 1e-12);
  EXPECT_NEAR(e.at(0)[0], 0.2 + 0.1, 1e-12);  // of its own, and of the temporalis
  EXPECT_NEAR(e.at(0.2)[0], 0.7, 1e-12);
  // Hermite with a slope of (0.4 - 0.2) / 0.3 at the middle knot and none at the ends.
  EXPECT_NEAR(e.at(0.15)[0], 0.1 + 0.4 - 0.1 * (0.2 / 0.3) / 8, 1e-12);
  EXPECT_NEAR(e.at(0.25)[5], 0.2, 1e-12);
  EXPECT_NEAR(e.at(0.25)[7], 0.2, 1e-12);
  EXPECT_EQ(read("muscle,time_s,excitation,active_in_file\nlat,0,0.1,1\nrat,0,0.1,0\n").at(0)[1],
            0);
  expect_refused("muscle,time_s\nlat,0\n", {"line 1", "excitation", "missing"});
  expect_refused(header, {"no excitation"});
  expect_refused(header + "lat,0,0.2,Cubic\n", {"line 2", "4 columns", "5"});
  expect_refused(header + "biceps,0,0.2,Cubic,1\n", {"line 2", "muscle", "biceps", "lat"});
  expect_refused(header + "lat,0,2,Cubic,1\n", {"line 2", "excitation", "2", "0 to 1"});
  expect_refused(header + "lat,x,0,Cubic,1\n", {"line 2", "time_s", "x"});
  expect_refused(header + "lat,0,0,Cubist,1\n", {"line 2", "interpolation", "Cubist", "linear"});
  expect_refused(header + "lat,-1,0,step,1\n", {"line 2", "time_s", "-1"});
  expect_refused(header + "lat,1,0,step,1\nrat,0,0,step,1\nlat,1,0,step,1\n",
                 {"line 4", "time_s", "later than 1"});
  expect_refused(header + "lat,0,0,step,1\nlat,1,0,linear,1\n", {"line 3", "lat"});
}

TEST_F(ExcitationFile, HoldsOrInterpolatesItsRowsAsItsHeaderOrSidecarSays) {
  const std::string rows = "time_s,lat\n0,0\n0.3,0.6\n0.6,0.2\n";
  const Excitations held = read("# interpolation: step\n" + rows);
  EXPECT_EQ(held.at(0.299)[0], 0);
  EXPECT_EQ(held.at(3 * 0.1)[0], 0.6);  // a time that rounding puts off by a little
  EXPECT_EQ(held.at(0.59)[0], 0.6);
  EXPECT_NEAR(read(rows, R"({"interpolation": "linear"})").at(0.15)[0], 0.3, 1e-12);
  EXPECT_NEAR(read(rows, R"({"interpolation": "cubic"})").at(0.15)[0], 0.3 - 0.3 * (0.2 / 0.6) / 8,
              1e-12);
  expect_refused("# interpolation: wild\n" + rows, {"line 1", "wild", "smooth"});
  expect_refused(rows, {"excite.csv.json", "interpolation", "wild"},
                 R"({"interpolation": "wild"})");
}

TEST_F(ExcitationFile, ASidecarSetsToneAndRemovesMuscles) {
  const std::string rows = "time_s,lat,rmy,lpm\n0,0.1,0.3,0.4\n";
  const Excitations e =
      read(rows, R"({"tone": {"t": 0.01, "lat": 0.02}, "without": ["pm"], "until_s": 0.4})");
  EXPECT_EQ(e.duration_s, 0.4);
  EXPECT_EQ(e.without, (std::vector<std::string>{"lpm", "rpm"}));
  const std::vector<double> expected = {0.13, 0.01, 0.01, 0.01, 0, 0.3};  // lat rat lmt rmt lam ram
  const auto at = e.at(0);
  ASSERT_EQ(at.size(), expected.size());
  for (std::size_t m = 0; m < expected.size(); ++m) EXPECT_NEAR(at[m], expected[m], 1e-12) << m;
  expect_refused(rows, {"excite.csv.json", "without", "biceps"}, R"({"without": ["biceps"]})");
  expect_refused(rows, {"excite.csv.json", "without", "no muscle"},
                 R"({"without": ["at", "mt", "my"]})");
  expect_refused(rows, {"excite.csv.json", "tone.t", "2"}, R"({"tone": {"t": 2}})");
  expect_refused(rows, {"excite.csv.json", "tones", "without"}, R"({"tones": {}})");
  expect_refused(rows, {"excite.csv.json", "line 1"}, "{");
}

TEST(DefaultMuscles, AreMirroredAndPullWhereTheirGroupSays) {
  const Case patient = builtin_patient();
  const auto muscles = default_muscles(patient);
  ASSERT_EQ(muscles.size(), 34u);
  const Eigen::Vector3d condyle = *patient.landmarks.find("left_condyle");
  double closers_N = 0;
  for (std::size_t i = 0; i < muscles.size(); i += 2) {
    const Muscle &left = muscles[i], &right = muscles[i + 1];
    EXPECT_EQ(left.name, "l" + left.kind);
    EXPECT_EQ(right.name, "r" + left.kind);
    EXPECT_LT((Eigen::Vector3d(-right.origin.x(), right.origin.y(), right.origin.z()) - left.origin)
                  .norm(),
              1e-9);
    EXPECT_NEAR((left.origin - left.insertion).norm(), left.optimal_length_mm, 1e-9);
    if (!left.moves(MuscleBody::mandible)) continue;
    const bool by_origin = left.origin_body == MuscleBody::mandible;
    const Eigen::Vector3d at = by_origin ? left.origin : left.insertion,
                          pull = (by_origin ? -1 : 1) * (left.origin - left.insertion);
    // Torque about the axis through the condyles, which points to the left: closing lifts the
    // front.
    const double closing = -(at - condyle).cross(pull.normalized()).x();
    if (left.group == "closer") {
      EXPECT_GT(closing, 10) << left.name;
      closers_N += 2 * left.max_force_N;
    } else if (left.group == "opener") {
      EXPECT_LT(closing, -10) << left.name;
    } else {
      EXPECT_LT(pull.y(), 0) << left.name;  // forward
    }
  }
  EXPECT_NEAR(closers_N, 2 * (158 + 95.6 + 75.6 + 190.4 + 81.6 + 174.8), 1e-9);
}

}  // namespace
}  // namespace condyle
