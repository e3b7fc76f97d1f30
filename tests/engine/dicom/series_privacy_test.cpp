// A series whose every text is a marker word: nothing that is reported has it.
#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/dicom/ct_volume.h"
#include "engine/volume/volume_files.h"
#include "tests/engine/dicom/series_files.h"

namespace condyle {
namespace {

using test::SeriesFiles;
using test::set_element;

const std::string marker = "Zyxwvut";

struct TextField {
  std::uint32_t tag;
  const char* type;
};

/// Every text that a CT image may have at its top level, and a private one.
constexpr TextField text_fields[] = {
    {dicom_tag(0x0008, 0x0005), "CS"}, {dicom_tag(0x0008, 0x0008), "CS"},
    {dicom_tag(0x0008, 0x0016), "UI"}, {dicom_tag(0x0008, 0x0018), "UI"},
    {dicom_tag(0x0008, 0x0020), "DA"}, {dicom_tag(0x0008, 0x0021), "DA"},
    {dicom_tag(0x0008, 0x0030), "TM"}, {dicom_tag(0x0008, 0x0050), "SH"},
    {dicom_tag(0x0008, 0x0070), "LO"}, {dicom_tag(0x0008, 0x0080), "LO"},
    {dicom_tag(0x0008, 0x0081), "ST"}, {dicom_tag(0x0008, 0x0090), "PN"},
    {dicom_tag(0x0008, 0x1010), "SH"}, {dicom_tag(0x0008, 0x1030), "LO"},
    {dicom_tag(0x0008, 0x103e), "LO"}, {dicom_tag(0x0008, 0x1050), "PN"},
    {dicom_tag(0x0008, 0x1070), "PN"}, {dicom_tag(0x0008, 0x1090), "LO"},
    {dicom_tag(0x0009, 0x0010), "LO"}, {dicom_tag(0x0010, 0x0010), "PN"},
    {dicom_tag(0x0010, 0x0020), "LO"}, {dicom_tag(0x0010, 0x0030), "DA"},
    {dicom_tag(0x0010, 0x0040), "CS"}, {dicom_tag(0x0010, 0x1000), "LO"},
    {dicom_tag(0x0010, 0x1010), "AS"}, {dicom_tag(0x0010, 0x4000), "LT"},
    {dicom_tag(0x0018, 0x1030), "LO"}, {dicom_tag(0x0018, 0x1210), "SH"},
    {dicom_tag(0x0018, 0x5100), "CS"}, {dicom_tag(0x0020, 0x000d), "UI"},
    {dicom_tag(0x0020, 0x000e), "UI"}, {dicom_tag(0x0020, 0x0010), "SH"},
    {dicom_tag(0x0020, 0x0012), "IS"}, {dicom_tag(0x0020, 0x0052), "UI"},
    {dicom_tag(0x0020, 0x4000), "LT"}, {dicom_tag(0x0028, 0x0004), "CS"},
    {dicom_tag(0x0028, 0x1054), "LO"}, {dicom_tag(0x0028, 0x1055), "LO"},
    {dicom_tag(0x0040, 0x0254), "LO"}, {dicom_tag(0x0040, 0x0275), "LO"}};
/// Texts without which the series is refused.
constexpr TextField needed_fields[] = {
    {dicom_tag(0x0002, 0x0010), "UI"}, {dicom_tag(0x0008, 0x0060), "CS"},
    {dicom_tag(0x0020, 0x0032), "DS"}, {dicom_tag(0x0020, 0x0037), "DS"},
    {dicom_tag(0x0028, 0x0030), "DS"}, {dicom_tag(0x0028, 0x1053), "DS"},
    {dicom_tag(0x0028, 0x0008), "IS"}, {dicom_tag(0x0018, 0x0060), "DS"}};

void mark(std::string& file) {
  for (const TextField& field : text_fields) set_element(file, field.tag, marker, field.type);
}

/// All that is said of a folder and its series, whether they are read or refused.
std::string everything_reported(const CtFolder& folder) {
  std::string text;
  const auto add = [&](const std::vector<std::string>& lines) {
    for (const std::string& line : lines) text += line + "\n";
  };
  add(folder.notes());
  for (const CtSeries& one : folder.series()) {
    add({one.modality, one.kernel, one.manufacturer, one.coding, one.uneven});
    add(one.notes);
    add(one.problems);
  }
  for (int series = 0; series <= static_cast<int>(folder.series().size()); ++series)
    for (const bool resample : {false, true}) try {
        const CtVolume read = folder.read({.series = series, .resample = resample});
        add(read.notes);
        text.append(reinterpret_cast<const char*>(read.volume.values.data()),
                    2 * read.volume.values.size());
      } catch (const InputError& error) {
        add({error.what()});
      }
  return text;
}

void expect_private(const CtFolder& folder, const std::string& what) {
  const std::string text = everything_reported(folder);
  EXPECT_GT(text.size(), 20u) << what;
  EXPECT_EQ(text.find(marker.substr(1)), std::string::npos) << what << "\n" << text.substr(0, 2000);
}

TEST(SeriesPrivacy, FactsAndVolumeHaveNoTextOfTheHeader) {
  SeriesFiles series;
  series.each(mark);
  series.save(marker + "-");
  std::filesystem::create_directory(series.path() / marker);
  series.add(marker + "/" + marker, series[1]);  // doubled
  series.add(marker + ".txt", marker);
  const CtFolder folder(series.path());
  ASSERT_EQ(folder.series().size(), 1u);
  EXPECT_TRUE(folder.series()[0].readable(false));
  EXPECT_EQ(folder.series()[0].kernel, "other");
  expect_private(folder, "marked");
  const CtVolume read = folder.read({});
  const auto file = series.path().parent_path() / "volume.nrrd";
  write_nrrd(read.volume, file, NrrdEncoding::raw);
  EXPECT_EQ(read_file(file).find(marker), std::string::npos);
}

TEST(SeriesPrivacy, ErrorsHaveNoTextOfTheHeader) {
  for (const TextField& field : needed_fields) {
    SeriesFiles series;
    series.each(mark);
    set_element(series[4], field.tag, marker, field.type);
    series.save(marker + "-");
    expect_private(CtFolder(series.path()), std::to_string(field.tag));
  }
  const std::function<void(SeriesFiles&)> breaks[] = {
      [](SeriesFiles& series) { series[3].resize(series[3].size() - 100); },
      [](SeriesFiles& series) { series[3].resize(400); },
      [](SeriesFiles& series) { series.files().erase(series.files().begin() + 3); },
      [](SeriesFiles& series) {
        series.add("0-" + marker, series[5]);
        series[5].back() = '?';
      },
      [](SeriesFiles& series) { set_element(series[3], dicom_tag(0x0010, 0x0020), "B", "LO"); }};
  for (const auto& change : breaks) {
    SeriesFiles series;
    series.each(mark);
    change(series);
    series.save(marker + "-");
    expect_private(CtFolder(series.path()), "broken");
  }
}

TEST(SeriesPrivacy, WrittenSeriesHaveNoNamesAndNoDates) {
  SeriesFiles series;
  for (const TextField& field : text_fields) {
    const std::string type = field.type;
    if (type == "PN" || type == "DA" || type == "TM") {
      EXPECT_EQ(test::element(series[0], field.tag), "");
    }
  }
  SeriesFiles again;
  EXPECT_EQ(series.files(), again.files());
}

}  // namespace
}  // namespace condyle
