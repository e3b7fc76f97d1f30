// The virtual CT scanner: values, truth, disturbances, other heads.
#include "sim/scanner/ct_scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/phantom/phantom.h"
#include "sim/scanner/scan_accuracy.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// The front of both jaws and the lips.
CtSettings small_settings() {
  CtSettings settings;
  settings.spacing_mm = {1.2, 1.2, 1.2};
  settings.field_of_view = {{-36, -118, -80}, {36, -44, -28}};
  settings.noise_hu = 0;
  settings.threads = 2;
  return settings;
}

/// Mean value of the voxels of a tissue, and their number.
std::pair<double, int> mean_of(const CtScan& scan, ScanTissue tissue) {
  double sum = 0;
  int count = 0;
  for (std::size_t q = 0; q < scan.truth.size(); ++q)
    if (scan.truth[q] == tissue) sum += scan.volume.values[q], ++count;
  return {count ? sum / count : 0, count};
}

const CtScan& plain_scan() {
  static const CtScan scan = scan_ct(ScannedHead(), small_settings());
  return scan;
}

TEST(CtScan, ValuesFollowTheTissues) {
  const CtScan& scan = plain_scan();
  EXPECT_EQ(scan.volume.values.size(), scan.truth.size());
  const auto expect = [&](ScanTissue tissue, double low, double high) {
    const auto [mean, count] = mean_of(scan, tissue);
    EXPECT_GT(count, 200) << static_cast<int>(tissue);
    EXPECT_GT(mean, low) << static_cast<int>(tissue);
    EXPECT_LT(mean, high) << static_cast<int>(tissue);
  };
  expect(ScanTissue::outside, -1001, -950);
  expect(ScanTissue::soft, -100, 200);
  expect(ScanTissue::skull, 500, 1300);
  expect(ScanTissue::mandible, 500, 1300);
  expect(ScanTissue::upper_teeth, 1300, 2200);
  expect(ScanTissue::lower_teeth, 1300, 2200);
  // A voxel belongs to the solid that its centre lies in.
  const ScannedHead head;
  for (int k = 0; k < scan.volume.size[2]; k += 7)
    for (int j = 0; j < scan.volume.size[1]; j += 5)
      for (int i = 0; i < scan.volume.size[0]; i += 5) {
        const Vector3d p = scan.volume.position(i, j, k);
        const ScanTissue tissue = scan.truth[scan.volume.index(i, j, k)];
        if (std::abs(head.skin(p)) > 0.1) {
          EXPECT_EQ(head.skin(p) > 0, tissue == ScanTissue::outside) << p.transpose();
        }
        if (std::abs(head.lower_bone(p)) > 0.1 && head.upper_bone(p) > 0.1) {
          EXPECT_EQ(head.lower_bone(p) < 0,
                    tissue == ScanTissue::mandible || tissue == ScanTissue::lower_teeth)
              << p.transpose();
        }
      }
}

TEST(CtScan, SameBitsForAnyNumberOfThreads) {
  CtSettings settings = small_settings();
  settings.field_of_view.low.z() = -64;
  settings.field_of_view.high.z() = -44;
  settings.noise_hu = 40;
  settings.fillings = settings.table = true;
  settings.threads = 1;
  const CtScan one = scan_ct(ScannedHead(), settings);
  settings.threads = 3;
  const CtScan three = scan_ct(ScannedHead(), settings);
  EXPECT_EQ(one.volume.values, three.volume.values);
  EXPECT_EQ(one.truth, three.truth);
  settings.seed = 2;
  EXPECT_NE(scan_ct(ScannedHead(), settings).volume.values, three.volume.values);
}

TEST(CtScan, NoiseHasItsStandardDeviation) {
  Volume noisy = plain_scan().volume;
  for (auto& value : noisy.values) value = std::max<std::int16_t>(value, -500);  // no clipping
  const auto before = noisy.values;
  add_noise(40, 7, 2, noisy);
  double sum = 0, squares = 0, product = 0;
  for (std::size_t q = 0; q + 1 < before.size(); ++q) {
    const double a = noisy.values[q] - before[q], b = noisy.values[q + 1] - before[q + 1];
    sum += a, squares += a * a, product += a * b;
  }
  const auto n = static_cast<double>(before.size());
  EXPECT_NEAR(sum / n, 0, 0.5);
  EXPECT_NEAR(std::sqrt(squares / n), 40, 0.5);
  EXPECT_NEAR(product / squares, 0, 0.02);  // white
}

TEST(CtScan, DisturbancesAreThere) {
  const CtScan& plain = plain_scan();
  const auto brightest = [](const CtScan& scan) {
    return *std::max_element(scan.volume.values.begin(), scan.volume.values.end());
  };
  CtSettings settings = small_settings();
  settings.fillings = true;
  const CtScan filled = scan_ct(ScannedHead(), settings);
  EXPECT_LT(brightest(plain), 2500);
  EXPECT_GT(brightest(filled), 2900);
  int streaks = 0;  // bright as bone, in soft tissue
  for (std::size_t q = 0; q < filled.truth.size(); ++q)
    streaks += filled.truth[q] == ScanTissue::soft &&
               filled.volume.values[q] > plain.volume.values[q] + 250;
  EXPECT_GT(streaks, 50);

  settings = small_settings();
  settings.dark_marrow = true;
  const CtScan dark = scan_ct(ScannedHead(), settings);
  EXPECT_LT(mean_of(dark, ScanTissue::mandible).first,
            mean_of(plain, ScanTissue::mandible).first - 50);

  const ScannedHead grown({}, 0.1);
  const CtScan touching = scan_ct(grown, small_settings());
  EXPECT_GT(mean_of(touching, ScanTissue::upper_teeth).second,
            mean_of(plain, ScanTissue::upper_teeth).second);
}

TEST(CtScan, AnotherHeadIsThatOfItsCase) {
  HeadChoice choice;
  choice.seed = 5;
  choice.variant = HeadChoice::Variant::class_iii;
  const ScannedHead head(choice);
  const Case patient = builtin_patient(choice);
  const auto median_error = [&](Role role, const auto& distance) {
    std::vector<double> errors;
    for (const Part& part : patient.parts)
      if (part.role == role)
        for (std::size_t v = 0; v < part.mesh.vertices.size(); v += 97)
          errors.push_back(std::abs(distance(part.mesh.vertices[v])));
    EXPECT_GT(errors.size(), 20u);
    std::sort(errors.begin(), errors.end());
    return errors[errors.size() / 2];
  };
  EXPECT_LT(median_error(Role::mandible, [&](const auto& p) { return head.lower_bone(p); }), 0.1);
  EXPECT_LT(median_error(Role::skull, [&](const auto& p) { return head.upper_bone(p); }), 0.1);
  EXPECT_LT(median_error(Role::lower_teeth, [&](const auto& p) { return head.lower_bone(p); }),
            0.1);
  const Vector3d p(20, -90, -70);
  EXPECT_LT((head.place(HeadMap::mandible, head.standard_place(HeadMap::mandible, p)) - p).norm(),
            1e-3);
}

}  // namespace
}  // namespace condyle
