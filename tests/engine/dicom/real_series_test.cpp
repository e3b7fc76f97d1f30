// Real series of ../shared/data, each read or refused for the right reason.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/core/error.h"
#include "engine/dicom/ct_volume.h"
#include "tests/engine/dicom/series_files.h"
#include "tests/support/places.h"

namespace condyle {
namespace {

std::filesystem::path real(const std::string& name) {
  return test::source_folder() / "../shared/data/ct-series" / name;
}

#define NEED(folder) \
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << (folder)

TEST(RealSeries, TiltedAndUnevenIsRefusedWithItsPlaceOrResampled) {
  const auto path = real("ge-tilt-uneven");
  NEED(path);
  const CtFolder folder(path);
  ASSERT_EQ(folder.series().size(), 1u);
  const CtSeries& facts = folder.series()[0];
  EXPECT_EQ(facts.slices, 28);
  EXPECT_EQ(facts.manufacturer, "GE");
  EXPECT_NEAR(facts.tilt_degrees, 18.5, 0.1);
  EXPECT_NE(test::refusal(folder, {.series = 1}).find("between slices"), std::string::npos);

  const CtVolume read = folder.read({.series = 1, .resample = true});
  EXPECT_GT(read.volume.size[1], 512);
  EXPECT_EQ(*std::min_element(read.volume.values.begin(), read.volume.values.end()), -1024);
  EXPECT_GT(*std::max_element(read.volume.values.begin(), read.volume.values.end()), 1000);
}

TEST(RealSeries, ThickSlicesAreReadWhenChosen) {
  const auto path = real("philips-5mm");
  NEED(path);
  const CtFolder folder(path);
  EXPECT_NE(test::refusal(folder).find("step of 5 mm"), std::string::npos);
  const int number = folder.series()[0].number;
  const CtVolume read = folder.read({.series = number});
  EXPECT_EQ(read.volume.size, (std::array{512, 512, 28}));
  EXPECT_NEAR(read.volume.spacing_mm.x(), 0.451, 1e-3);
  EXPECT_NEAR(read.volume.spacing_mm.z(), 5, 1e-3);
}

TEST(RealSeries, AScoutIsRefused) {
  const auto path = real("philips-scout");
  NEED(path);
  const CtFolder folder(path);
  EXPECT_NE(test::refusal(folder).find("scout"), std::string::npos);
}

}  // namespace
}  // namespace condyle
