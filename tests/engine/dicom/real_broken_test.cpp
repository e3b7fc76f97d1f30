// Broken copies of a real series of ../shared/data: what is reported of each.
#include <gdcmAttribute.h>
#include <gdcmReader.h>
#include <gdcmWriter.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <numbers>
#include <sstream>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/dicom/ct_folder.h"
#include "tests/engine/dicom/series_files.h"
#include "tests/support/places.h"

namespace condyle {
namespace {

using Change = std::function<void(gdcm::DataSet&)>;

/// Eight neighbouring slices of 512 x 512 at 5 mm.
class RealBroken : public testing::Test {
 protected:
  void SetUp() override {
    const auto path = test::source_folder() / "../shared/data/ct-series/philips-5mm";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
    for (int i = 10; i < 18; ++i)
      files_.push_back(read_file(path / ("I" + std::to_string(10 * i))));
  }

  static void edit(std::string& file, const Change& change) {
    std::istringstream in(file);
    gdcm::Reader reader;
    reader.SetStream(in);
    ASSERT_TRUE(reader.Read());
    change(reader.GetFile().GetDataSet());
    gdcm::Writer writer;
    writer.SetFile(reader.GetFile());
    writer.CheckFileMetaInformationOff();
    std::ostringstream out;
    writer.SetStream(out);
    ASSERT_TRUE(writer.Write());
    file = out.str();
  }
  static void set_text(gdcm::DataSet& data, std::uint16_t group, std::uint16_t element,
                       std::string text) {
    const gdcm::Tag tag(group, element);
    if (text.size() % 2 != 0) text += ' ';
    gdcm::DataElement changed(tag);
    if (data.FindDataElement(tag)) changed.SetVR(data.GetDataElement(tag).GetVR());
    changed.SetByteValue(text.data(), static_cast<std::uint32_t>(text.size()));
    data.Replace(changed);
  }
  static Change text(std::uint16_t group, std::uint16_t element, const std::string& value) {
    return [=](gdcm::DataSet& data) { set_text(data, group, element, value); };
  }
  static Change without(std::uint16_t group, std::uint16_t element) {
    return [=](gdcm::DataSet& data) { data.Remove(gdcm::Tag(group, element)); };
  }
  static Change size(std::uint16_t rows, std::uint16_t columns) {
    return [=](gdcm::DataSet& data) {
      gdcm::Attribute<0x0028, 0x0010> high;
      gdcm::Attribute<0x0028, 0x0011> wide;
      high.SetValue(rows);
      wide.SetValue(columns);
      data.Replace(high.GetAsDataElement());
      data.Replace(wide.GetAsDataElement());
    };
  }

  CtFolder saved() {
    const auto to = folder_.path() / std::to_string(++saved_);
    std::filesystem::create_directory(to);
    for (std::size_t i = 0; i < files_.size(); ++i)
      write_file(to / ("f" + std::to_string(100 + i)), files_[i]);
    return CtFolder(to);
  }
  void expect_refused(const std::string& words) {
    const std::string message = test::refusal(saved(), {.series = 1});
    EXPECT_NE(message.find(words), std::string::npos) << message;
  }
  void expect_refused(const Change& change, const std::string& words) {
    const std::string whole = files_[3];
    edit(files_[3], change);
    expect_refused("file 4 of 8 " + words);
    files_[3] = whole;
  }

  test::Folder folder_;
  std::vector<std::string> files_;
  int saved_ = 0;
};

TEST_F(RealBroken, HeadersThatAreWrongAreRefused) {
  expect_refused(without(0x0020, 0x0032), "states no position");
  expect_refused(without(0x0020, 0x0037), "states no orientation");
  expect_refused(text(0x0020, 0x0037, "1\\0\\0\\1\\0\\0"), "states directions");
  expect_refused(without(0x0028, 0x0030), "states no pixel spacing");
  expect_refused(text(0x0028, 0x0030, "0\\0"), "states the pixel spacing 0 x 0 mm");
  expect_refused(without(0x0028, 0x1053), "states no rescale");
  expect_refused(size(65535, 65535), "states 65535 x 65535 pixels, 8589672450 bytes, and holds");
  expect_refused(size(256, 512), "states 512 x 256 pixels, 262144 bytes, and that it holds 524288");
  const auto smaller = [](gdcm::DataSet& data) {
    size(256, 512)(data);
    const gdcm::Tag pixels(0x7fe0, 0x0010);
    gdcm::DataElement element = data.GetDataElement(pixels);
    const std::string half(element.GetByteValue()->GetPointer(), 262144);
    element.SetByteValue(half.data(), 262144);
    data.Replace(element);
  };
  expect_refused(smaller, "has 512 x 256 pixels");
}

TEST_F(RealBroken, SlicesThatAreWrongAreRefused) {
  const std::vector<std::string> whole = files_;
  files_.erase(files_.begin() + 3);
  expect_refused("a slice is missing between slices 3 and 4");
  files_ = whole;
  files_[3].resize(files_[3].size() - 262144);
  expect_refused("file 4 of 8 states 512 x 512 pixels, 524288 bytes, and holds");
  files_ = whole;
  for (std::string& file : files_) edit(file, text(0x0008, 0x0060, "MR"));
  expect_refused("is MR, not CT");
}

TEST_F(RealBroken, MixedSeriesAreSeparated) {
  const std::vector<std::string> whole = files_;
  for (std::size_t i = 4; i < 8; ++i) edit(files_[i], text(0x0010, 0x0020, "ANOTHER"));
  EXPECT_EQ(saved().series().size(), 2u);
  files_ = whole;
  for (std::string file : whole) {
    edit(file, text(0x0018, 0x1210, "BONE"));
    files_.push_back(file);
  }
  const CtFolder kernels = saved();
  ASSERT_EQ(kernels.series().size(), 2u);
  EXPECT_EQ(kernels.series()[1].kernel, "BONE");
  files_ = whole;
  files_.push_back(whole[5]);
  files_.emplace_back();
  files_.emplace_back("junk");
  const CtFolder doubled = saved();
  const CtVolume read = doubled.read({.series = 1});
  EXPECT_EQ(read.volume.size[2], 8);
  EXPECT_EQ(read.notes.at(0), "1 doubled file was left out");
  EXPECT_EQ(doubled.counts().empty, 1);
  EXPECT_EQ(doubled.counts().not_dicom, 1);
}

TEST_F(RealBroken, GeometryOfAnyKindIsFollowed) {
  const Volume straight = saved().read({.series = 1}).volume;
  const std::vector<std::string> whole = files_;
  edit(files_[2], text(0x0028, 0x1053, "2"));
  const Volume scaled = saved().read({.series = 1}).volume;
  for (int i = 200; i < 300; ++i) {
    EXPECT_EQ(scaled.at(i, 256, 1), straight.at(i, 256, 1));
    EXPECT_NEAR(scaled.at(i, 256, 2), 2 * straight.at(i, 256, 2) + 1024, 2);
  }
  files_ = whole;
  for (std::string& file : files_) edit(file, text(0x0020, 0x0037, "-1\\0\\0\\0\\-1\\0"));
  const Volume turned = saved().read({.series = 1}).volume;
  EXPECT_LT((turned.axes.col(0) + Eigen::Vector3d::UnitX()).norm(), 1e-9);
  EXPECT_EQ(turned.values, straight.values);
  // Each slice 0.6 mm in front of the next.
  files_ = whole;
  for (std::size_t k = 0; k < 8; ++k) {
    const Eigen::Vector3d at = straight.position(
        0, -static_cast<double>(k) * 0.6 / straight.spacing_mm.y(), static_cast<double>(k));
    edit(files_[k], text(0x0020, 0x0032,
                         std::to_string(at.x()) + "\\" + std::to_string(at.y()) + "\\" +
                             std::to_string(at.z())));
  }
  const CtFolder tilted = saved();
  EXPECT_NEAR(tilted.series()[0].tilt_degrees, std::atan2(0.6, 5) * 180 / std::numbers::pi, 1e-3);
  EXPECT_EQ(tilted.read({.series = 1}).volume.size[1], 512 + 10);
}

}  // namespace
}  // namespace condyle
