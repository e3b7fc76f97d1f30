#include "sim/motion/condylar_path_table.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/sim/motion/jaws.h"
#include "tests/support/program.h"

namespace condyle {
namespace {

/// The user's cache in another folder, as long as this lives.
class OwnCache {
 public:
  OwnCache() {
    if (const char* before = std::getenv("XDG_CACHE_HOME")) before_ = before;
    ::setenv("XDG_CACHE_HOME", folder_.path().c_str(), 1);
  }
  ~OwnCache() {
    if (before_.empty())
      ::unsetenv("XDG_CACHE_HOME");
    else
      ::setenv("XDG_CACHE_HOME", before_.c_str(), 1);
  }
  int tables() const {
    int count = 0;
    for (const auto& file : std::filesystem::recursive_directory_iterator(folder_.path()))
      count += file.path().filename().string().starts_with("condylar-path");
    return count;
  }

 private:
  test::Folder folder_;
  std::string before_;
};

std::vector<double> values(const CondylarPathTable& table) {
  std::vector<double> all;
  for (double forward = 0.5; forward < 18; forward += 1.7)
    for (const double theta : {0.0, 0.3, 0.7})
      for (const double shift : {-0.8, 0.0, 1.1})
        all.push_back(table.inferior_translation_mm(forward, theta, shift));
  return all;
}

TEST(CondylarPathTable, ReadFromTheCacheIsTheSameToTheBit) {
  const Case patient = test::jaw_in_fossae();
  const auto joint = JointSurfaces::find(patient);
  ASSERT_TRUE(joint);
  const Eigen::Vector3d right = *patient.landmarks.find("right_condyle"),
                        left = *patient.landmarks.find("left_condyle");
  CondylarPathTable::Settings settings{
      .center = left, .axis = (left - right).normalized(), .gap = {}, .widest_shift_mm = 1.5};
  const OwnCache cache;
  const auto table = [&](JawSide side) {
    return values(CondylarPathTable(*joint, side, settings, 2));
  };
  const std::vector<double> made = table(JawSide::left);
  EXPECT_EQ(cache.tables(), 1);
  EXPECT_GT(made.back(), 0.5);
  EXPECT_EQ(table(JawSide::left), made);
  EXPECT_EQ(cache.tables(), 1);
  // Another disc and another joint have tables of their own.
  settings.gap.seated_mm += 0.5;
  EXPECT_NE(table(JawSide::left), made);
  EXPECT_EQ(cache.tables(), 2);
  settings.gap.seated_mm -= 0.5;
  settings.center = right;
  table(JawSide::right);
  EXPECT_EQ(cache.tables(), 3);
}

}  // namespace
}  // namespace condyle
