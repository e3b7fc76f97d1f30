// The measure with which tests compare pictures, and the files of a failed comparison.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/picture.h"

namespace condyle::test {
namespace {

namespace fs = std::filesystem;

Picture grey(int width, int height) {
  Picture picture;
  picture.width = width;
  picture.height = height;
  picture.rgba.assign(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 100);
  return picture;
}

TEST(PictureComparison, CountsPixelsOfWhichAChannelDiffersByMoreThanTwelve) {
  const Picture a = grey(4, 2);
  Picture b = a;
  b.rgba[4 * 5 + 1] += 12;
  EXPECT_EQ(difference(a, b), 0);
  b.rgba[4 * 5 + 1] += 1;
  EXPECT_EQ(difference(a, b), 1 / 8.0);
  EXPECT_EQ(difference(a, b, {0, 1, 2, 1}), 1 / 2.0);
  EXPECT_EQ(difference(a, b, {2, 0, 2, 2}), 0);
  EXPECT_EQ(difference(a, grey(2, 4)), 1);
  EXPECT_EQ(difference({}, {}), 1);
  EXPECT_EQ(colour_fraction(b, 0x646a64), 1);
  EXPECT_EQ(colour_fraction(b, 0x647264), 1 / 8.0);
}

TEST(PictureComparison, OneThatFailsKeepsBothPicturesAndNamesThem) {
  const Picture a = grey(4, 2);
  Picture b = a;
  b.rgba[0] = 0;
  EXPECT_TRUE(alike(b, a, 1 / 8.0));
  EXPECT_TRUE(unlike(b, a, 0.1));
  EXPECT_TRUE(same_bytes(a, a));
  const auto expect_kept = [&](const testing::AssertionResult& result, const char* other) {
    EXPECT_FALSE(result);
    const std::string words = result.message();
    for (const std::string& is : {std::string("-seen.png"), std::string(other)}) {
      const auto end = words.find(is);
      ASSERT_NE(end, std::string::npos) << words;
      const auto start = words.rfind(' ', end) + 1;
      const fs::path file = words.substr(start, end + is.size() - start);
      EXPECT_EQ(Picture(file.string()).rgba, is == "-seen.png" ? b.rgba : a.rgba) << file;
      fs::remove(file);
    }
  };
  expect_kept(alike(b, a, 0.1), "-expected.png");
  expect_kept(unlike(b, a, 1 / 8.0), "-before.png");
  expect_kept(same_bytes(b, a), "-expected.png");
}

}  // namespace
}  // namespace condyle::test
