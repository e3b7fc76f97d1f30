// Series that are wrong, as scanners, archives and people make them: what is reported of each.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/core/error.h"
#include "engine/dicom/ct_volume.h"
#include "tests/engine/dicom/series_files.h"

namespace condyle {
namespace {

using test::element;
using test::refusal;
using test::remove_element;
using test::SeriesFiles;
using test::set_element;
using test::small_volume;
using test::small_volume_hu;

constexpr std::uint32_t patient_tag = dicom_tag(0x0010, 0x0020),
                        kernel_tag = dicom_tag(0x0018, 0x1210),
                        series_tag = dicom_tag(0x0020, 0x000e),
                        instance_tag = dicom_tag(0x0008, 0x0018),
                        acquisition_tag = dicom_tag(0x0020, 0x0012),
                        position_tag = dicom_tag(0x0020, 0x0032),
                        orientation_tag = dicom_tag(0x0020, 0x0037),
                        spacing_tag = dicom_tag(0x0028, 0x0030),
                        modality_tag = dicom_tag(0x0008, 0x0060),
                        image_type_tag = dicom_tag(0x0008, 0x0008),
                        rows_tag = dicom_tag(0x0028, 0x0010),
                        columns_tag = dicom_tag(0x0028, 0x0011),
                        intercept_tag = dicom_tag(0x0028, 0x1052),
                        slope_tag = dicom_tag(0x0028, 0x1053),
                        syntax_tag = dicom_tag(0x0002, 0x0010);

#define EXPECT_NAMES(message, words) \
  EXPECT_NE((message).find(words), std::string::npos) << (message)

std::string us(int number) { return {static_cast<char>(number), static_cast<char>(number >> 8)}; }

std::string decimals(const Eigen::Vector3d& v) {
  char text[80];
  std::snprintf(text, sizeof text, "%.9g\\%.9g\\%.9g", v.x(), v.y(), v.z());
  return text;
}

void expect_equal(const Volume& read, const Volume& expected) {
  EXPECT_EQ(read.size, expected.size);
  EXPECT_LT((read.spacing_mm - expected.spacing_mm).norm(), 1e-9);
  EXPECT_LT((read.axes - expected.axes).norm(), 1e-9);
  EXPECT_LT((read.origin - expected.origin).norm(), 1e-9);
  EXPECT_EQ(read.values, expected.values);
}

TEST(BrokenSeries, ItIsReadBeforeItIsBroken) {
  SeriesFiles series;
  series.save();
  const CtFolder folder(series.path());
  ASSERT_EQ(folder.series().size(), 1u);
  const CtSeries& facts = folder.series()[0];
  EXPECT_EQ(facts.kind, SeriesKind::volume);
  EXPECT_TRUE(facts.readable(false));
  EXPECT_TRUE(facts.notes.empty());
  EXPECT_EQ(facts.slices, 9);
  EXPECT_EQ(facts.kernel, "STANDARD");
  EXPECT_EQ(facts.kvp, 120);
  EXPECT_EQ(folder.counts().files, 9);
  EXPECT_TRUE(folder.notes().empty());
  expect_equal(folder.read({}).volume, small_volume());
}

TEST(BrokenSeries, MissingSlicesAreRefusedWithTheirPlace) {
  SeriesFiles series;
  series.files().erase(series.files().begin() + 4, series.files().begin() + 6);
  series.save();
  const CtFolder folder(series.path());
  const std::string message = refusal(folder, {.series = 1});
  EXPECT_NAMES(message, "2 slices are missing between slices 4 and 5, at 4.5 and 9 mm");
  EXPECT_NAMES(refusal(folder), "2 slices are missing between slices 4 and 5");

  const CtVolume read = folder.read({.series = 1, .resample = true});
  EXPECT_EQ(read.volume.size[2], 9);
  // The values are linear in the position, so that interpolation restores them; each is rounded.
  const Volume whole = small_volume();
  for (std::size_t i = 0; i < whole.values.size(); ++i)
    ASSERT_NEAR(read.volume.values[i], whole.values[i], 1.01);
}

TEST(BrokenSeries, UnevenStepsAreRefusedAboveOnePercent) {
  const auto moved = [](double mm) {
    SeriesFiles series;
    const Volume volume = small_volume();
    for (std::size_t k = 5; k < 9; ++k)
      set_element(
          series[k], position_tag,
          decimals(volume.position(0, 0, static_cast<double>(k)) + Eigen::Vector3d(0, 0, mm)),
          "DS");
    series.save();
    return CtFolder(series.path()).series()[0].uneven;
  };
  EXPECT_EQ(moved(0.0149), "");
  EXPECT_NAMES(moved(0.02), "between slices 5 and 6");
  EXPECT_NAMES(moved(0.7), "the step is 2.2 mm between slices 5 and 6");
}

TEST(BrokenSeries, TiltOfTheGantryIsShearedBack) {
  const double tilt = 18.5;
  const Volume upright = small_volume();
  const double shift = upright.spacing_mm.z() * std::tan(tilt * std::numbers::pi / 180);
  Volume tilted = upright;
  for (int k = 0; k < 9; ++k)
    for (int j = 0; j < 20; ++j)
      for (int i = 0; i < 24; ++i)
        tilted.values[tilted.index(i, j, k)] = static_cast<std::int16_t>(std::round(
            small_volume_hu(upright.position(i, j, k) - Eigen::Vector3d(0, k * shift, 0))));
  SeriesFiles series(tilted);
  for (std::size_t k = 0; k < 9; ++k) {
    const double at = static_cast<double>(k);
    set_element(series[k], position_tag,
                decimals(upright.position(0, 0, at) - Eigen::Vector3d(0, at * shift, 0)), "DS");
  }
  series.save();
  const CtFolder folder(series.path());
  EXPECT_NEAR(folder.series()[0].tilt_degrees, tilt, 1e-3);
  const CtVolume read = folder.read({});
  ASSERT_FALSE(read.notes.empty());
  EXPECT_NAMES(read.notes[0], "tilted by 18.5 degrees");
  // Eight steps of 0.5019 mm in rows of 0.6 mm.
  EXPECT_EQ(read.volume.size, (std::array{24, 20 + 7, 9}));
  EXPECT_NEAR(read.volume.spacing_mm.z(), 1.5, 1e-9);
  EXPECT_LT((read.volume.axes - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  int compared = 0;
  for (int k = 0; k < 9; ++k)
    for (int j = 0; j < read.volume.size[1]; ++j)
      for (int i = 0; i < 24; ++i) {
        const Eigen::Vector3d p = read.volume.position(i, j, k);
        // Inside the slice, with a neighbour on both sides.
        const double row = (p.y() - upright.origin.y() + k * shift) / 0.6;
        if (row < -1 || row > 20) {
          EXPECT_EQ(read.volume.at(i, j, k), -1024);
        }
        if (row < 0 || row > 19) continue;
        ++compared;
        ASSERT_NEAR(read.volume.at(i, j, k), small_volume_hu(p), 1.01) << i << " " << j << " " << k;
      }
  EXPECT_GT(compared, 24 * 19 * 9 - 1);
}

TEST(BrokenSeries, ASmallTiltIsIgnoredBelowHalfADegree) {
  for (const double degrees : {0.3, 0.8}) {
    SeriesFiles series;
    const double shift = 1.5 * std::tan(degrees * std::numbers::pi / 180);
    for (std::size_t k = 0; k < 9; ++k)
      set_element(series[k], position_tag,
                  decimals(small_volume().position(0, 0, static_cast<double>(k)) +
                           Eigen::Vector3d(static_cast<double>(k) * shift, 0, 0)),
                  "DS");
    series.save();
    EXPECT_EQ(CtFolder(series.path()).read({}).volume.size[0], degrees < 0.5 ? 24 : 25);
  }
}

TEST(BrokenSeries, TwoPatientsUnderOneIdentifierAreTwoSeries) {
  SeriesFiles series;
  for (std::size_t k = 0; k < 9; ++k) set_element(series[k], patient_tag, k < 5 ? "A" : "B", "LO");
  series.save();
  const CtFolder folder(series.path());
  ASSERT_EQ(folder.series().size(), 2u);
  EXPECT_EQ(folder.series()[0].slices, 5);
  EXPECT_EQ(folder.series()[1].slices, 4);
  EXPECT_NAMES(folder.series()[0].notes.at(0), "identifier of series 2");
  EXPECT_NAMES(folder.series()[0].notes.at(0), "patient");
  EXPECT_NAMES(refusal(folder), "2 patients");
  EXPECT_EQ(folder.read({.series = 2}).volume.size[2], 4);
}

TEST(BrokenSeries, TwoStudiesOrFramesOfReferenceAreTwoSeries) {
  for (const std::uint32_t tag : {dicom_tag(0x0020, 0x000d), dicom_tag(0x0020, 0x0052)}) {
    SeriesFiles series;
    for (std::size_t k = 0; k < 4; ++k) set_element(series[k], tag, "1.2.3", "UI");
    series.save();
    const CtFolder folder(series.path());
    ASSERT_EQ(folder.series().size(), 2u);
    EXPECT_EQ(folder.series()[0].notes.size(), 1u);
    EXPECT_EQ(folder.default_series(false), 2);
  }
}

TEST(BrokenSeries, TwoKernelsUnderOneIdentifierAreTwoSeries) {
  SeriesFiles series, sharp(small_volume(), {.kernel = "BONE"});
  for (std::size_t k = 0; k < 9; ++k) {
    set_element(sharp[k], series_tag, element(series[k], series_tag), "UI");
    series.add("t" + std::to_string(k), sharp[k]);
  }
  series.save();
  const CtFolder folder(series.path());
  ASSERT_EQ(folder.series().size(), 2u);
  EXPECT_EQ(folder.series()[0].kernel + folder.series()[1].kernel, "STANDARDBONE");
  EXPECT_NAMES(folder.series()[1].notes.at(0), "kernel");
  expect_equal(folder.read({.series = 2}).volume, small_volume());
  EXPECT_EQ(folder.default_series(false), 1);
}

TEST(BrokenSeries, ADoubledFileIsDropped) {
  SeriesFiles series;
  series.add("a-copy", series[3]);
  std::filesystem::create_directory(series.path() / "copies");
  series.add("copies/another", series[7]);
  series.save();
  const CtVolume read = CtFolder(series.path()).read({});
  expect_equal(read.volume, small_volume());
  EXPECT_NAMES(read.notes.at(0), "2 doubled files were left out");
}

TEST(BrokenSeries, DifferentSlicesAtOnePositionAreSeparatedOrRefused) {
  const auto with_other = [](bool marked) {
    SeriesFiles series;
    for (std::size_t k = 0; k < 9; ++k) {
      std::string other = series[k];
      other.back() = static_cast<char>(other.back() ^ 1);
      set_element(other, instance_tag, "1.2." + std::to_string(k), "UI");
      if (marked) set_element(other, acquisition_tag, "2", "IS");
      series.add("t" + std::to_string(k), other);
    }
    series.save();
    return CtFolder(series.path()).series();
  };
  const auto apart = with_other(true), mixed = with_other(false);
  ASSERT_EQ(apart.size(), 2u);
  EXPECT_TRUE(apart[0].readable(false));
  EXPECT_NAMES(apart[0].notes.at(0), "image type or acquisition");
  ASSERT_EQ(mixed.size(), 1u);
  EXPECT_FALSE(mixed[0].readable(true));
  EXPECT_NAMES(mixed[0].problems.at(0), "files 1 and 10 are different slices at one position");
}

/// Changes one slice or all and expects the series to be refused with these words.
void expect_refused(const std::function<void(std::string&)>& change, const std::string& words) {
  for (const bool all : {false, true}) {
    SeriesFiles series;
    if (all)
      series.each(change);
    else
      change(series[3]);
    series.save();
    const CtFolder folder(series.path());
    ASSERT_EQ(folder.series().size(), 1u) << words;
    const std::string message = refusal(folder, {.series = 1, .resample = true});
    EXPECT_NAMES(message, words);
    EXPECT_NAMES(message, all ? "file 1 of 9" : "file 4 of 9");
    EXPECT_EQ(message.find("s10"), std::string::npos) << message;
  }
}

TEST(BrokenSeries, NoGeometryIsTakenFromADefault) {
  expect_refused([](std::string& file) { remove_element(file, position_tag); },
                 "states no position");
  expect_refused([](std::string& file) { set_element(file, position_tag, "1\\nan\\3", "DS"); },
                 "states no position");
  expect_refused([](std::string& file) { remove_element(file, orientation_tag); },
                 "states no orientation");
  expect_refused([](std::string& file) { remove_element(file, spacing_tag); },
                 "states no pixel spacing");
  expect_refused([](std::string& file) { set_element(file, spacing_tag, "0\\0", "DS"); },
                 "states the pixel spacing 0 x 0 mm");
  expect_refused(
      [](std::string& file) { set_element(file, orientation_tag, "1\\0\\0\\1\\0\\0", "DS"); },
      "not perpendicular");
  expect_refused(
      [](std::string& file) { set_element(file, orientation_tag, "0\\0\\0\\0\\0\\0", "DS"); },
      "not unit vectors");
  expect_refused([](std::string& file) { remove_element(file, slope_tag); }, "no rescale slope");
  expect_refused([](std::string& file) { set_element(file, slope_tag, "0", "DS"); },
                 "rescale slope 0");
}

TEST(BrokenSeries, CutPixelsAreRefused) {
  expect_refused([](std::string& file) { file.resize(file.size() - 480); },
                 "states 24 x 20 pixels, 960 bytes, and holds 480");
  expect_refused([](std::string& file) { file.resize(file.size() - 970); }, "ends early");
}

TEST(BrokenSeries, AHeaderThatStatesMoreThanTheFileHoldsIsRefused) {
  expect_refused(
      [](std::string& file) {
        set_element(file, rows_tag, us(65535), "US");
        set_element(file, columns_tag, us(65535), "US");
      },
      "states 65535 x 65535 pixels, 8589672450 bytes, and holds 960");
  // A length that no file can have.
  expect_refused([](std::string& file) { file.replace(file.size() - 964, 4, "\xf0\xff\xff\xff"); },
                 "960 bytes, and that it holds 4294967280");
}

TEST(BrokenSeries, OtherEncodingsAreNamed) {
  expect_refused(
      [](std::string& file) { set_element(file, syntax_tag, "1.2.840.10008.1.2.4.201", "UI"); },
      "is compressed as HTJ2K, which is not supported");
  expect_refused([](std::string& file) { set_element(file, syntax_tag, "1.2.3", "UI"); },
                 "unknown transfer syntax");
  expect_refused(
      [](std::string& file) { set_element(file, syntax_tag, "1.2.840.10008.1.2.4.70", "UI"); },
      "another form than it states");
}

TEST(BrokenSeries, MagneticResonanceIsRefused) {
  SeriesFiles series;
  series.each([](std::string& file) { set_element(file, modality_tag, "MR", "CS"); });
  series.save();
  const CtFolder folder(series.path());
  EXPECT_EQ(folder.series()[0].kind, SeriesKind::not_ct);
  EXPECT_NAMES(refusal(folder), "is MR, not CT");
}

TEST(BrokenSeries, ASliceOfAnotherSizeIsNamed) {
  Volume narrow = small_volume();
  narrow.size = {24, 10, 18};  // the same values in other slices
  SeriesFiles series, other(narrow);
  for (const std::size_t k : {std::size_t{0}, std::size_t{5}, std::size_t{8}}) {
    SeriesFiles mixed;
    std::string odd = other[0];
    for (const std::uint32_t tag :
         {series_tag, dicom_tag(0x0020, 0x000d), dicom_tag(0x0020, 0x0052)})
      set_element(odd, tag, element(mixed[k], tag), "UI");
    set_element(odd, position_tag, element(mixed[k], position_tag), "DS");
    mixed[k] = odd;
    mixed.save();
    const CtFolder folder(mixed.path());
    ASSERT_EQ(folder.series().size(), 1u);
    const std::string message = refusal(folder, {.series = 1, .resample = true});
    EXPECT_NAMES(message, "file " + std::to_string(k + 1) + " of 9 has 24 x 10 pixels");
    EXPECT_NAMES(message, "the others 24 x 20");
  }
}

TEST(BrokenSeries, EmptyFilesAndJunkAreCounted) {
  SeriesFiles series;
  series.add("a", "");
  series.add("b.txt", "The slices of the patient.\n");
  series.add("c", std::string(2000, '\0'));
  series.add("d", series[2].substr(0, 200));
  std::string report = series[0];
  for (const std::uint32_t tag : {rows_tag, columns_tag}) remove_element(report, tag);
  report.resize(report.size() - 972);  // the element of the pixels
  series.add("e", report);
  series.save();
  const CtFolder folder(series.path());
  EXPECT_EQ(folder.counts().files, 14);
  EXPECT_EQ(folder.counts().slices, 9);
  EXPECT_EQ(folder.counts().empty, 1);
  EXPECT_EQ(folder.counts().not_dicom, 2);
  EXPECT_EQ(folder.counts().damaged, 1);
  EXPECT_EQ(folder.counts().without_image, 1);
  EXPECT_EQ(folder.notes().size(), 4u);
  expect_equal(folder.read({}).volume, small_volume());
}

TEST(BrokenSeries, EachSliceHasItsOwnRescale) {
  SeriesFiles series;
  // Stored values are HU + 1024 by the writer.
  set_element(series[2], slope_tag, "2", "DS");
  set_element(series[5], intercept_tag, "-1000", "DS");
  set_element(series[7], slope_tag, "0.5", "DS");
  series.save();
  const Volume whole = small_volume(), read = CtFolder(series.path()).read({}).volume;
  for (int j = 0; j < 20; ++j)
    for (int i = 0; i < 24; ++i) {
      EXPECT_EQ(read.at(i, j, 1), whole.at(i, j, 1));
      EXPECT_EQ(read.at(i, j, 2), 2 * (whole.at(i, j, 2) + 1024) - 1024);
      EXPECT_EQ(read.at(i, j, 5), whole.at(i, j, 5) + 24);
      EXPECT_EQ(read.at(i, j, 7), std::round(0.5 * (whole.at(i, j, 7) + 1024) - 1024));
    }
}

TEST(BrokenSeries, ReversedRowsAndColumnsKeepTheirPlaces) {
  Volume turned = small_volume();
  turned.axes.col(0) *= -1;
  turned.axes.col(1) *= -1;
  SeriesFiles series(turned);
  EXPECT_EQ(element(series[0], orientation_tag), "-1\\0\\0\\0\\-1\\0");
  series.save();
  expect_equal(CtFolder(series.path()).read({}).volume, turned);
}

TEST(BrokenSeries, SlicesFromFeetToHeadAndBackAreTheSame) {
  Volume turned = small_volume();  // the slices descend; the lattice that is read ascends
  turned.axes.col(2) *= -1;
  SeriesFiles series(turned);
  series.save();
  const Volume read = CtFolder(series.path()).read({}).volume;
  EXPECT_LT((read.axes - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  for (int k = 0; k < 9; ++k) {
    EXPECT_LT((read.position(3, 4, k) - turned.position(3, 4, 8 - k)).norm(), 1e-9);
    EXPECT_EQ(read.at(3, 4, k), turned.at(3, 4, 8 - k));
  }
}

TEST(BrokenSeries, ScoutsAndPagesAreListedAndNeverTaken) {
  SeriesFiles series, scout(small_volume(), {.series_number = 2}),
      pages(small_volume(), {.series_number = 3});
  set_element(scout[0], image_type_tag, "ORIGINAL\\PRIMARY\\LOCALIZER", "CS");
  series.add("scout", scout[0]);
  for (std::size_t k = 0; k < 9; ++k) {
    set_element(pages[k], position_tag, "0\\0\\0", "DS");
    series.add("page" + std::to_string(k), pages[k]);
  }
  series.save();
  const CtFolder folder(series.path());
  ASSERT_EQ(folder.series().size(), 3u);
  EXPECT_EQ(folder.default_series(false), 1);
  EXPECT_EQ(folder.series()[1].kind, SeriesKind::scout);
  EXPECT_EQ(folder.series()[2].kind, SeriesKind::one_position);
  EXPECT_NAMES(refusal(folder, {.series = 2}), "scout");
  EXPECT_NAMES(refusal(folder, {.series = 3}), "one position");
  EXPECT_NAMES(refusal(folder, {.series = 4}), "does not exist; there are 3");
}

TEST(BrokenSeries, ThickSlicesAreReadOnlyWhenChosen) {
  Volume thick = small_volume();
  thick.spacing_mm.z() = 3.01;
  SeriesFiles series(thick);
  series.save();
  const CtFolder folder(series.path());
  EXPECT_NAMES(refusal(folder), "has a step of 3.01 mm");
  expect_equal(folder.read({.series = 1}).volume, thick);
}

TEST(BrokenSeries, PaddingBecomesAir) {
  Volume padded = small_volume();
  SeriesFiles series(padded);
  for (std::size_t k = 0; k < 9; ++k) {
    set_element(series[k], intercept_tag, "-2000", "DS");
    set_element(series[k], dicom_tag(0x0028, 0x0120), us(65535), "US");
    series[k].replace(series[k].size() - 2, 2, "\xff\xff");
  }
  series.save();
  const Volume read = CtFolder(series.path()).read({}).volume;
  for (int k = 0; k < 9; ++k) EXPECT_EQ(read.at(23, 19, k), -1024);
  EXPECT_EQ(read.at(3, 0, 4), std::max(padded.at(3, 0, 4) - 976, -1024));
  EXPECT_EQ(read.at(23, 0, 8), std::max(padded.at(23, 0, 8) - 976, -1024));
}

TEST(BrokenSeries, AFolderOrFileThatIsNoScanIsRefused) {
  SeriesFiles series;
  EXPECT_NAMES(refusal(CtFolder(series.path())), "holds no DICOM image among 0 files");
  EXPECT_THROW(CtFolder(series.path() / "absent"), InputError);
  series.save();
  try {
    ct_volume(series.path() / "s103");
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NAMES(std::string(error.what()), "is one file of a DICOM series: name its folder");
  }
}

}  // namespace
}  // namespace condyle
