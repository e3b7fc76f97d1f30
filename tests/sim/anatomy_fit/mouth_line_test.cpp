#include "sim/anatomy_fit/mouth_line.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "sim/phantom/phantom.h"
#include "tools/bench/baseline/head_surfaces.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A head in an arbitrary pose whose carried landmarks of the mouth lie 7 mm too high.
class MouthLine : public testing::Test {
 protected:
  void SetUp() override {
    static const Case model = builtin_patient();
    head_ = scanned_head(model, HeadPopulation::seeded, 3);
    axes_ = head_.X_SH.R.toRotationMatrix();
    for (const char* name : {"stomion", "left_cheilion", "right_cheilion", "labrale_superius",
                             "labrale_inferius", "upper_incisal_point"})
      marks_[name].point = head_.truth.at(name);
  }
  void displace(double up_mm) {
    for (auto& [name, mark] : marks_)
      if (name != "upper_incisal_point") mark.point += axes_ * Vector3d(0, 0, up_mm);
  }
  double error(const char* name) const {
    return (marks_.at(name).point - head_.truth.at(name)).norm();
  }
  void find() { find_mouth_line(marks_, head_.skin, axes_); }

  HeadSurfaces head_;
  Matrix3d axes_;
  std::map<std::string, ProposedLandmark> marks_;
};

TEST_F(MouthLine, IsFoundWhereTheFitHasItElsewhere) {
  for (const double up_mm : {7.0, -7.0}) {
    SetUp();
    displace(up_mm);
    find();
    EXPECT_LT(error("stomion"), 1.5) << up_mm;
    for (const char* name : {"left_cheilion", "right_cheilion"})
      EXPECT_LT(error(name), 3.5) << name;
    for (const char* name : {"labrale_superius", "labrale_inferius"})
      EXPECT_LT(error(name), 3.5) << name;
    EXPECT_GT(marks_.at("stomion").uncertainty_mm, 1);
    EXPECT_FALSE(marks_.at("stomion").doubtful);
  }
}

TEST_F(MouthLine, StaysWhereTheFitHasIt) {
  find();
  EXPECT_EQ(error("stomion"), 0);
  EXPECT_EQ(error("left_cheilion"), 0);
}

TEST_F(MouthLine, IsDoubtfulWhereTheSkinHasNone) {
  displace(12);
  head_.skin = {};
  head_.skin.vertices = {head_.truth.at("stomion"), head_.truth.at("stomion") + Vector3d(9, 0, 0),
                         head_.truth.at("stomion") + Vector3d(0, 0, 9)};
  head_.skin.triangles = {{0, 1, 2}};
  find();
  EXPECT_TRUE(marks_.at("stomion").doubtful);
  EXPECT_FALSE(marks_.at("stomion").reason.empty());
}

}  // namespace
}  // namespace condyle
