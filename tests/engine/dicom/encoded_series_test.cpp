// Encodings of pixels and headers: each gives the values of the uncompressed series.
#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmImageReader.h>
#include <gdcmImageWriter.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <Eigen/Geometry>
#include <random>
#include <sstream>

#include "engine/core/error.h"
#include "engine/dicom/ct_volume.h"
#include "tests/engine/dicom/series_files.h"

namespace condyle {
namespace {

using test::SeriesFiles;
using test::set_element;
using test::small_volume;

std::string encoded(const std::string& file, gdcm::TransferSyntax::TSType syntax) {
  std::istringstream in(file);
  gdcm::ImageReader reader;
  reader.SetStream(in);
  EXPECT_TRUE(reader.Read());
  gdcm::ImageChangeTransferSyntax change;
  change.SetTransferSyntax(syntax);
  change.SetInput(reader.GetImage());
  EXPECT_TRUE(change.Change()) << syntax;
  gdcm::ImageWriter writer;
  writer.SetFile(reader.GetFile());
  writer.SetImage(change.GetOutput());
  std::ostringstream out;
  writer.SetStream(out);
  EXPECT_TRUE(writer.Write()) << syntax;
  return out.str();
}

/// The file with its data set deflated.
std::string deflated(std::string file) {
  const std::uint32_t syntax = dicom_tag(0x0002, 0x0010);
  set_element(file, syntax, "1.2.840.10008.1.2.1.99", "UI");
  const std::size_t begin =
      file.find(std::string("\x08\x00\x08\x00"
                            "CS",
                            6));
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, 6, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string out(file.size() + 100, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(file.data() + begin);
  stream.avail_in = static_cast<uInt>(file.size() - begin);
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(out.size() - stream.avail_out);
  deflateEnd(&stream);
  return file.substr(0, begin) + out;
}

Volume read_back(SeriesFiles& series) {
  series.save();
  const CtFolder folder(series.path());
  return folder.read({.series = 1}).volume;
}

class Encoding : public testing::TestWithParam<gdcm::TransferSyntax::TSType> {};

TEST_P(Encoding, GivesTheValuesOfTheSeries) {
  SeriesFiles series;
  for (std::string& file : series.files()) file = encoded(file, GetParam());
  const Volume read = read_back(series);
  EXPECT_EQ(read.values, small_volume().values);
  EXPECT_LT((read.origin - small_volume().origin).norm(), 1e-9);
}

/// CT has 12 bits, signed or not; 16 are allocated.
TEST_P(Encoding, GivesTheValuesOfTwelveBits) {
  for (const bool is_signed : {false, true}) {
    SeriesFiles series;
    for (std::string& file : series.files()) {
      for (const auto& [tag, value] : {std::pair{dicom_tag(0x0028, 0x0101), 12},
                                       {dicom_tag(0x0028, 0x0102), 11},
                                       {dicom_tag(0x0028, 0x0103), int{is_signed}}})
        set_element(file, tag, std::string{static_cast<char>(value), '\0'}, "US");
      set_element(file, dicom_tag(0x0028, 0x1052), is_signed ? "0" : "-1024", "DS");
      if (is_signed)  // stored values are Hounsfield units
        for (std::size_t at = file.size() - 960; at < file.size(); at += 2)
          file[at + 1] = static_cast<char>(file[at + 1] - 4);
      file = encoded(file, GetParam());
    }
    EXPECT_EQ(read_back(series).values, small_volume().values) << is_signed;
  }
}

TEST_P(Encoding, DamagedDataIsRefusedOrReadWithoutACrash) {
  SeriesFiles series;
  series.files().resize(3);
  for (std::string& file : series.files()) file = encoded(file, GetParam());
  series.save();
  const std::string whole = series[1];
  const bool big_endian = GetParam() == gdcm::TransferSyntax::ExplicitVRBigEndian;
  const std::size_t pixels = whole.find(big_endian ? std::string("\x7f\xe0\x00\x10", 4)
                                                   : std::string("\xe0\x7f\x10\x00", 4));
  ASSERT_NE(pixels, std::string::npos);
  std::mt19937 random(7);
  const auto place = [&] { return pixels + 8 + random() % (whole.size() - pixels - 8); };
  int refused = 0;
  for (int i = 0; i < 30; ++i) {
    std::string file = whole;
    if (i % 3 == 0)
      file.resize(place());
    else
      for (int n = 0; n < 4; ++n) file[place()] = static_cast<char>(random());
    series.add("s101", file);
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    try {
      CtFolder(series.path()).read({.series = 1});
    } catch (const InputError&) {
      ++refused;
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  }
  EXPECT_GE(refused, 10);  // all that are cut
}

INSTANTIATE_TEST_SUITE_P(
    , Encoding,
    testing::Values(gdcm::TransferSyntax::ImplicitVRLittleEndian,
                    gdcm::TransferSyntax::ExplicitVRBigEndian, gdcm::TransferSyntax::RLELossless,
                    gdcm::TransferSyntax::JPEGLosslessProcess14_1,
                    gdcm::TransferSyntax::JPEGLSLossless, gdcm::TransferSyntax::JPEG2000Lossless),
    [](const auto& one) { return "Syntax" + std::to_string(static_cast<int>(one.param)); });

TEST(EncodedSeries, DeflatedFilesAreRead) {
  SeriesFiles series;
  for (std::string& file : series.files()) file = deflated(file);
  EXPECT_EQ(read_back(series).values, small_volume().values);
}

TEST(EncodedSeries, AWrongLittleEndianSyntaxIsRecognized) {
  SeriesFiles series;
  for (std::string& file : series.files())
    set_element(file, dicom_tag(0x0002, 0x0010), "1.2.840.10008.1.2", "UI");
  EXPECT_EQ(read_back(series).values, small_volume().values);
}

TEST(EncodedSeries, FilesWithoutPreambleAreRead) {
  SeriesFiles series;
  for (std::string& file : series.files())
    file =
        file.substr(file.find(std::string("\x08\x00\x08\x00"
                                          "CS",
                                          6)));
  EXPECT_EQ(read_back(series).values, small_volume().values);
}

TEST(EncodedSeries, ObliqueAxesAreWrittenAndRead) {
  Volume oblique = small_volume();
  oblique.axes =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
  SeriesFiles series(oblique);
  const Volume read = read_back(series);
  // Numbers of a header have 16 characters: 13 digits of a direction.
  EXPECT_LT((read.axes - oblique.axes).norm(), 1e-11);
  EXPECT_LT((read.origin - oblique.origin).norm(), 1e-9);
  EXPECT_EQ(read.values, oblique.values);
}

TEST(EncodedSeries, AnyNumberOfThreadsGivesTheSameBits) {
  Volume volume = small_volume();
  SeriesFiles series(volume);
  for (std::size_t k = 0; k < 9; ++k) {
    const Eigen::Vector3d at =
        volume.position(0, 0.37 * static_cast<double>(k), static_cast<double>(k));
    set_element(
        series[k], dicom_tag(0x0020, 0x0032),
        std::to_string(at.x()) + "\\" + std::to_string(at.y()) + "\\" + std::to_string(at.z()),
        "DS");
  }
  series.save();
  const CtVolume one = CtFolder(series.path(), 1).read({.threads = 1}),
                 more = CtFolder(series.path(), 5).read({.threads = 5});
  EXPECT_GT(one.volume.size[1], 20);
  EXPECT_EQ(one.volume.values, more.volume.values);
}

/// No byte of a header that is changed or missing ends the program or takes memory.
TEST(EncodedSeries, DamagedHeadersAreReportedOrRead) {
  SeriesFiles series;
  series.save();
  std::mt19937 random(11);
  int refused = 0;
  for (int i = 0; i < 300; ++i) {
    std::string file = series[4];
    if (i % 2 == 0)
      file.resize(random() % (file.size() - 962));
    else
      file[128 + random() % (file.size() - 1088)] = static_cast<char>(random());
    series.add("s104", file);
    try {
      const CtFolder folder(series.path());
      folder.read({.series = 1});
    } catch (const InputError& error) {
      ++refused;
      EXPECT_EQ(std::string(error.what()).find("s104"), std::string::npos);
    }
  }
  EXPECT_GE(refused, 150);
}

}  // namespace
}  // namespace condyle
