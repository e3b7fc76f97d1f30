// Volumes in NRRD, MetaImage and NIfTI-1 format: values, geometry, and what is refused.
#include "engine/volume/volume_files.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstring>
#include <limits>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "tests/support/places.h"
#include "tests/support/program.h"

namespace condyle {
namespace {

constexpr int wide = 5, high = 4, deep = 3;

/// From -1024 in uneven steps, so that order and sign count.
std::vector<std::int16_t> some_values() {
  std::vector<std::int16_t> values;
  for (int i = 0; i < wide * high * deep; ++i)
    values.push_back(static_cast<std::int16_t>(24 * i + 7 * (i % 3) - 1024));
  return values;
}

template <class Number>
std::string bytes_of_values(bool big_endian = false) {
  std::string bytes;
  for (const std::int16_t value : some_values()) {
    const auto stored = static_cast<Number>(value);
    char one[sizeof(Number)];
    std::memcpy(one, &stored, sizeof one);
    if (big_endian) std::reverse(one, one + sizeof one);
    bytes.append(one, sizeof one);
  }
  return bytes;
}

/// `window`: 31 for gzip, 15 for zlib.
std::string packed(const std::string& bytes, int window) {
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, 6, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(out.size() - stream.avail_out);
  deflateEnd(&stream);
  return out;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

const std::string nrrd_header =
    "NRRD0004\n# a comment\ntype: short\ndimension: 3\nspace: left-posterior-superior\n"
    "sizes: 5 4 3\nspace directions: (0.5,0,0) (0,0,-0.6) (0, 2, 0)\n"
    "kinds: domain domain domain\nendian: little\nencoding: raw\n"
    "space origin: (1,-2,3.5)\nmy key:=my value\n\n";
const std::string meta_header =
    "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
    "CompressedData = False\nTransformMatrix = 1 0 0 0 0 -1 0 1 0\nOffset = 1 -2 3.5\n"
    "CenterOfRotation = 0 0 0\nElementSpacing = 0.5 0.6 2\nDimSize = 5 4 3\n"
    "ElementType = MET_SHORT\nElementDataFile = LOCAL\n";

struct NiftiChoice {
  bool by_rows = true, big_endian = false;
  float slope = 0, intercept = 0;
};
/// The same lattice: RAS has the signs of the first two axes turned.
std::string nifti_header(const NiftiChoice& choice = {}) {
  std::string header(352, '\0');
  const auto put = [&](std::size_t at, auto value) {
    char one[sizeof value];
    std::memcpy(one, &value, sizeof value);
    if (choice.big_endian) std::reverse(one, one + sizeof value);
    std::memcpy(header.data() + at, one, sizeof value);
  };
  put(0, std::int32_t{348});
  for (const auto& [at, n] :
       {std::pair<std::size_t, int>{40, 3}, {42, wide}, {44, high}, {46, deep}})
    put(at, static_cast<std::int16_t>(n));
  put(70, std::int16_t{4});
  put(72, std::int16_t{16});
  put(108, 352.f);
  put(112, choice.slope);
  put(116, choice.intercept);
  header[123] = 2;
  if (choice.by_rows) {
    put(254, std::int16_t{1});
    const float rows[12] = {-0.5f, 0, 0, -1, 0, 0, -2, 2, 0, -0.6f, 0, 3.5f};
    for (std::size_t i = 0; i < 12; ++i) put(280 + 4 * i, rows[i]);
  } else {
    put(252, std::int16_t{1});
    Eigen::Matrix3d R;
    R << -1, 0, 0, 0, 0, -1, 0, -1, 0;
    const double sense = R.determinant();
    R.col(2) *= sense;
    const Eigen::Quaterniond q(R);
    const double sign = q.w() < 0 ? -1 : 1;
    const float values[9] = {static_cast<float>(sign * q.x()),
                             static_cast<float>(sign * q.y()),
                             static_cast<float>(sign * q.z()),
                             -1,
                             2,
                             3.5f,
                             0,
                             0,
                             0};
    for (std::size_t i = 0; i < 6; ++i) put(256 + 4 * i, values[i]);
    const float steps[4] = {static_cast<float>(sense), 0.5f, 0.6f, 2};
    for (std::size_t i = 0; i < 4; ++i) put(76 + 4 * i, steps[i]);
  }
  header.replace(344, 4, std::string("n+1\0", 4));
  return header;
}

class VolumeFiles : public testing::Test {
 protected:
  Volume read(const std::string& name, const std::string& content) {
    write_file(folder_ / name, content);
    return read_volume(folder_ / name);
  }
  /// The message with which it is refused, without the file at its beginning.
  std::string refusal(const std::string& name, const std::string& content) {
    try {
      read(name, content);
    } catch (const InputError& error) {
      const std::string words = error.what(), file = (folder_ / name) + ": ";
      return words.starts_with(file) ? words.substr(file.size()) : words;
    }
    return "read";
  }
  static void expect_the_lattice(const Volume& volume) {
    EXPECT_EQ(volume.size, (std::array<int, 3>{wide, high, deep}));
    EXPECT_LT((volume.spacing_mm - Eigen::Vector3d(0.5, 0.6, 2)).norm(), 1e-6);
    EXPECT_EQ(volume.values, some_values());
    // The second axis points downward, the third backward.
    EXPECT_LT((volume.position(0, 0, 0) - Eigen::Vector3d(1, -2, 3.5)).norm(), 1e-6);
    EXPECT_LT((volume.position(4, 1, 2) - Eigen::Vector3d(3, 2, 2.9)).norm(), 1e-6);
    EXPECT_EQ(volume.at(1, 0, 0), some_values()[1]);
    EXPECT_EQ(volume.at(0, 2, 1), some_values()[2 * wide + wide * high]);
  }

  test::Folder folder_;
};

TEST_F(VolumeFiles, AreReadWithTheirGeometry) {
  const std::string raw = bytes_of_values<std::int16_t>();
  {
    SCOPED_TRACE("NRRD");
    expect_the_lattice(read("a.nrrd", nrrd_header + raw));
    expect_the_lattice(
        read("b.nrrd", replaced(nrrd_header, "encoding: raw", "encoding: gzip") + packed(raw, 31)));
    expect_the_lattice(read("c.nrrd", replaced(nrrd_header, "endian: little", "endian: big") +
                                          bytes_of_values<std::int16_t>(true)));
    std::string ras = replaced(nrrd_header, "left-posterior-superior", "right-anterior-superior");
    ras = replaced(ras, "(0.5,0,0) (0,0,-0.6) (0, 2, 0)", "(-0.5,0,0) (0,0,-0.6) (0,-2,0)");
    expect_the_lattice(read("d.nrrd", replaced(ras, "(1,-2,3.5)", "(-1, 2, 3.5)") + raw));
  }
  {
    SCOPED_TRACE("MetaImage");
    expect_the_lattice(read("a.mha", meta_header + raw));
    expect_the_lattice(read("b.mha", replaced(meta_header, "CompressedData = False",
                                              "CompressedData = True\nCompressedDataSize = 9") +
                                         packed(raw, 15)));
    expect_the_lattice(read("c.MHA", replaced(meta_header, "MSB = False", "MSB = True") +
                                         bytes_of_values<std::int16_t>(true)));
  }
  {
    SCOPED_TRACE("NIfTI");
    expect_the_lattice(read("a.nii", nifti_header() + raw));
    expect_the_lattice(read("b.nii.gz", packed(nifti_header() + raw, 31)));
    expect_the_lattice(
        read("c.nii", nifti_header({.big_endian = true}) + bytes_of_values<std::int16_t>(true)));
    expect_the_lattice(read("d.nii", nifti_header({.by_rows = false}) + raw));
  }
}

TEST_F(VolumeFiles, AQuaternionMayTurnAndMirror) {
  const Eigen::Quaterniond q =
      Eigen::Quaterniond(Eigen::AngleAxisd(0.9, Eigen::Vector3d(1, -2, 0.5).normalized()));
  ASSERT_GT(q.w(), 0);
  const Eigen::Vector3d steps(0.5, 0.6, 2), origin(10, -20, 30);
  for (const double mirror : {1.0, -1.0}) {
    std::string header = nifti_header({.by_rows = false});
    const auto put = [&](std::size_t at, double value) {
      const auto stored = static_cast<float>(value);
      std::memcpy(header.data() + at, &stored, sizeof stored);
    };
    put(76, mirror);
    for (int a = 0; a < 3; ++a) {
      const auto place = 4 * static_cast<std::size_t>(a);
      put(256 + place, q.vec()[a]);
      put(268 + place, origin[a]);
    }
    const Volume volume = read("turned.nii", header + bytes_of_values<std::int16_t>());
    // By the definition: RAS = R (i dx, j dy, qfac k dz) + offset.
    const Eigen::Vector3d ras = q * Eigen::Vector3d(3 * 0.5, 2 * 0.6, mirror * 2) + origin;
    EXPECT_LT((volume.position(3, 2, 1) - Eigen::Vector3d(-ras.x(), -ras.y(), ras.z())).norm(),
              1e-5);
    EXPECT_LT((volume.spacing_mm - steps).norm(), 1e-6);
  }
}

TEST_F(VolumeFiles, DataMayLieBesideItsHeader) {
  write_file(folder_ / "values.raw", bytes_of_values<std::int16_t>());
  expect_the_lattice(read("a.nhdr", replaced(nrrd_header, "\n\n", "\ndata file: values.raw\n")));
  expect_the_lattice(read("a.mhd", replaced(meta_header, "LOCAL", "values.raw")));
  for (const char* elsewhere : {"../values.raw", "/etc/passwd", "sub/values.raw", ".."}) {
    const std::string words = std::string("data file: is \"") + elsewhere +
                              "\"; it must be a file in the folder of the header";
    EXPECT_EQ(refusal("b.nhdr", replaced(nrrd_header, "\n\n",
                                         std::string("\ndata file: ") + elsewhere + "\n")),
              words);
    EXPECT_EQ(refusal("b.mhd", replaced(meta_header, "LOCAL", elsewhere)), words);
  }
}

TEST_F(VolumeFiles, ValuesOfAnyTypeBecomeHounsfieldUnits) {
  const auto as = [&](const char* type) { return replaced(nrrd_header, "short", type); };
  EXPECT_EQ(read("a.nrrd", as("int") + bytes_of_values<std::int32_t>()).values, some_values());
  EXPECT_EQ(read("b.nrrd", as("float") + bytes_of_values<float>()).values, some_values());
  EXPECT_EQ(read("c.nrrd", as("double") + bytes_of_values<double>()).values, some_values());
  // Limited to 16 bits.
  std::string large(wide * high * deep * sizeof(float), '\0');
  const float beyond[3] = {1e9f, -1e9f, std::numeric_limits<float>::quiet_NaN()};
  std::memcpy(large.data(), beyond, sizeof beyond);
  const Volume limited = read("d.nrrd", as("float") + large);
  EXPECT_EQ(limited.values[0], 32767);
  EXPECT_EQ(limited.values[1], -32768);
  EXPECT_EQ(limited.values[2], -32768);
  // Rescaled, and rounded to whole units.
  const Volume scaled = read(
      "e.nii", nifti_header({.slope = 0.5f, .intercept = -3}) + bytes_of_values<std::int16_t>());
  for (std::size_t i = 0; i < scaled.values.size(); ++i)
    EXPECT_NEAR(scaled.values[i], 0.5 * some_values()[i] - 3, 0.51);
}

TEST_F(VolumeFiles, WrittenVolumesAreReadBackBitForBit) {
  Volume written;
  written.size = {wide, high, deep};
  written.values = some_values();
  written.values[3] = -32768;
  written.spacing_mm = {0.1 + 0.2, 1.0 / 3, 1e-3};
  written.axes = Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  written.origin = {-1e-7, 123.456, 1e5 / 7};
  for (const NrrdEncoding encoding : {NrrdEncoding::raw, NrrdEncoding::gzip}) {
    const auto file = folder_ / "written.nrrd";
    write_nrrd(written, file, encoding);
    const Volume back = read_volume(file);
    EXPECT_EQ(back.size, written.size);
    EXPECT_EQ(back.values, written.values);
    EXPECT_EQ(back.origin, written.origin);
    // The file has the product of both.
    EXPECT_LT((back.axes - written.axes).norm(), 1e-15);
    EXPECT_LT((back.spacing_mm - written.spacing_mm).norm(), 1e-15);
  }
}

TEST_F(VolumeFiles, GeometryIsNeverTakenFromADefault) {
  const std::string raw = bytes_of_values<std::int16_t>();
  const auto nrrd_without = [&](const std::string& line) {
    return refusal("a.nrrd", replaced(nrrd_header, line, "") + raw);
  };
  EXPECT_EQ(nrrd_without("space: left-posterior-superior\n"), "space: is missing in the header");
  EXPECT_EQ(nrrd_without("space origin: (1,-2,3.5)\n"), "space origin: is missing in the header");
  EXPECT_EQ(nrrd_without("space directions: (0.5,0,0) (0,0,-0.6) (0, 2, 0)\n"),
            "space directions: is missing in the header");
  EXPECT_EQ(nrrd_without("endian: little\n"), "endian: is missing in the header");
  const auto directions = [&](const std::string& words) {
    return refusal("b.nrrd", replaced(nrrd_header, "(0.5,0,0) (0,0,-0.6) (0, 2, 0)", words) + raw);
  };
  EXPECT_EQ(directions("(0,0,0) (0,0,-0.6) (0,2,0)"), "space directions: a spacing is zero");
  EXPECT_EQ(directions("(0.5,0,0) none (0,2,0)"), "space directions: an axis has none");
  EXPECT_EQ(directions("(0.5,0,0) (0,nan,0) (0,2,0)"), "space directions: \"nan\" is not a number");
  EXPECT_EQ(directions("(0.5,0,0) (0,0.6,0) (0,0.67,2)"),
            "space directions: the axes are sheared by 18.5 degrees, as by a tilted gantry: "
            "resample the scan");
  EXPECT_EQ(refusal("a.mha", replaced(meta_header, "ElementSpacing = 0.5 0.6 2\n", "") + raw),
            "ElementSpacing: is missing in the header");
  EXPECT_EQ(
      refusal("b.mha", replaced(meta_header, "TransformMatrix = 1 0 0 0 0 -1 0 1 0\n", "") + raw),
      "TransformMatrix: is missing in the header");
  for (const char* spacing : {"0.5 0 2", "0.5 -0.6 2"})
    EXPECT_EQ(refusal("c.mha", replaced(meta_header, "0.5 0.6 2", spacing) + raw),
              "ElementSpacing: is not positive along each axis");
  EXPECT_EQ(refusal("d.mha", replaced(meta_header, "1 0 0 0 0 -1", "2 0 0 0 0 -1") + raw),
            "TransformMatrix: a direction does not have length 1");
  EXPECT_EQ(refusal("e.mha", replaced(meta_header, "MSB = False", "MSB = T") + raw),
            "BinaryDataByteOrderMSB: \"T\" is neither True nor False");
  EXPECT_EQ(refusal("f.mha", replaced(meta_header, "BinaryDataByteOrderMSB = False\n", "") + raw),
            "BinaryDataByteOrderMSB: is missing in the header");
  EXPECT_EQ(refusal("c.nrrd", replaced(nrrd_header, "kinds: domain domain domain",
                                       "space units: \"cm\" \"cm\" \"cm\"") +
                                  raw),
            "space units: \"cm\" \"cm\" \"cm\" is not read; it must be \"mm\" \"mm\" \"mm\"");
  EXPECT_EQ(directions("(0.5,0,0) (0,0.6,0) (0,0,2) (1,0,0)"),
            "space directions: has more than 3 vectors");
  EXPECT_EQ(directions("(0.5,0,0) (0,0.6,0) (0,0,1e200)"),
            "space directions: a spacing is not between 0.001 and 100 mm");
  EXPECT_EQ(directions("(0. 5,0,0) (0,0.6,0) (0,0,2)"),
            "space directions: \"0. 5\" is not a number");
  std::string unset = nifti_header() + raw;
  unset[254] = 0;
  EXPECT_EQ(refusal("a.nii", unset),
            "sform_code, qform_code: neither is set, so that the directions of the axes are "
            "unknown");
  unset[254] = 4;
  EXPECT_EQ(refusal("b.nii", unset),
            "sform_code, qform_code: the volume is aligned to a template, not to the patient");
  std::string mirrored = nifti_header({.by_rows = false}) + raw;
  mirrored[83] = static_cast<char>(mirrored[83] | 0x80);  // the sign of the first spacing
  EXPECT_EQ(refusal("c.nii", mirrored), "pixdim: is not positive along each axis");
}

TEST_F(VolumeFiles, PromisesAreComparedWithTheDataBeforeMemoryIsRequested) {
  const std::string raw = bytes_of_values<std::int16_t>();
  const std::string half = raw.substr(0, raw.size() / 2);
  EXPECT_EQ(refusal("a.nrrd", nrrd_header + half),
            "has 60 bytes of data where its header states 120");
  EXPECT_EQ(refusal("b.nrrd", nrrd_header + raw + "x"),
            "has 121 bytes of data where its header states 120");
  EXPECT_EQ(refusal("a.mha", meta_header + half),
            "has 60 bytes of data where its header states 120");
  EXPECT_EQ(refusal("a.nii", nifti_header() + half),
            "has 60 bytes of data where its header states 120");
  const std::string gzip = replaced(nrrd_header, "encoding: raw", "encoding: gzip");
  EXPECT_EQ(refusal("c.nrrd", gzip + packed(half, 31)),
            "its compressed data ends before the 120 bytes that its header states");
  EXPECT_EQ(refusal("d.nrrd", gzip + packed(raw + "x", 31)),
            "its compressed data holds more than the 120 bytes that its header states");
  EXPECT_EQ(refusal("e.nrrd", gzip + packed(raw, 31).substr(0, 40)),
            "its compressed data ends before the 120 bytes that its header states");
  EXPECT_EQ(refusal("f.nrrd", gzip + "no stream"), "its compressed data is damaged");
  const std::string stream = packed(raw, 31);
  const std::string no_end = "its compressed data does not end with its checksum";
  EXPECT_EQ(refusal("j.nrrd", gzip + stream.substr(0, stream.size() - 4)), no_end);
  EXPECT_EQ(refusal("k.nrrd", gzip + stream + "more"), no_end);
  // Members that follow one another are one content.
  expect_the_lattice(read("l.nrrd", gzip + packed(half, 31) + packed(raw.substr(half.size()), 31)));
  // 4 GiB out of a small file.
  const std::string vast = replaced(gzip, "sizes: 5 4 3", "sizes: 2048 1024 1024");
  EXPECT_EQ(refusal("g.nrrd", vast + packed(std::string(1024, 'x'), 31)),
            "its compressed data is too short for the 4294967296 bytes that its header states");
  EXPECT_EQ(refusal("h.nrrd", replaced(gzip, "sizes: 5 4 3", "sizes: 65535 65535 65535") + raw),
            "size: it states more than 2147483648 values");
  EXPECT_EQ(refusal("i.nrrd", replaced(gzip, "sizes: 5 4 3", "sizes: 5 0 3") + raw),
            "size: is 0 along an axis; a volume has at least 2 values along each");
}

TEST_F(VolumeFiles, OtherFormatsAreNamed) {
  const std::string raw = bytes_of_values<std::int16_t>();
  EXPECT_EQ(refusal("a.nrrd", replaced(nrrd_header, "encoding: raw", "encoding: bzip2") + raw),
            "encoding: \"bzip2\" is not read; raw and gzip are");
  EXPECT_EQ(refusal("b.nrrd", replaced(nrrd_header, "dimension: 3", "dimension: 4") + raw),
            "dimension: is 4; a volume has 3");
  EXPECT_EQ(refusal("c.nrrd", replaced(nrrd_header, "type: short", "type: block") + raw),
            "type: \"block\" is not read");
  EXPECT_EQ(
      refusal("a.mha", replaced(meta_header, "BinaryData = True", "BinaryData = False") + raw),
      "BinaryData: must be True: numbers as text are not read");
  EXPECT_EQ(refusal("a.nii", "text"), "has no header of NIfTI-1 with its data in the same file");
  EXPECT_EQ(refusal("empty.nrrd", ""), "its header does not end");
  EXPECT_EQ(refusal("empty.mha", ""), "ElementDataFile: is missing in the header");
  EXPECT_FALSE(is_volume_file("scan.stl"));
  EXPECT_TRUE(is_volume_file("scan.NII.GZ"));
}

/// Any damaged byte gives a volume or a message, never a crash.
TEST_F(VolumeFiles, DamageIsAMessage) {
  const std::string raw = bytes_of_values<std::int16_t>();
  const std::pair<const char*, std::string> whole[] = {
      {"a.nrrd", replaced(nrrd_header, "encoding: raw", "encoding: gzip") + packed(raw, 31)},
      {"a.mha", meta_header + raw},
      {"a.nii", nifti_header() + raw},
      {"a.nii.gz", packed(nifti_header() + raw, 31)}};
  int refused = 0;
  for (const auto& [name, content] : whole)
    for (std::size_t i = 0; i < content.size(); i += 3) {
      for (const char byte : {'\0', '\xff', '9'}) {
        std::string damaged = content;
        damaged[i] = byte;
        refused += refusal(name, damaged) != "read" ? 1 : 0;
      }
      refused += refusal(name, content.substr(0, i)) != "read" ? 1 : 0;
    }
  EXPECT_GT(refused, 500);
}

TEST(RealVolumes, HeadsHaveTheirSizeAndAir) {
  const auto data = test::source_folder() / ".." / "shared" / "data";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << data << " is not there";
  const Volume head = read_volume(data / "ct-head" / "head_ct.nrrd");
  EXPECT_EQ(head.size, (std::array<int, 3>{256, 256, 113}));
  EXPECT_LT((head.position(0, 0, 1) - head.position(0, 0, 0) - Eigen::Vector3d(0, 0, -1.92)).norm(),
            1e-9);
  const Volume cranium = read_volume(data / "ct-cranium" / "cranium_ct.nrrd");
  EXPECT_EQ(cranium.size, (std::array<int, 3>{256, 256, 108}));
  for (const Volume* volume : {&head, &cranium}) {
    const auto [low, high_] = std::minmax_element(volume->values.begin(), volume->values.end());
    EXPECT_LE(*low, -900);
    EXPECT_GE(*high_, 1200);
  }
}

}  // namespace
}  // namespace condyle
