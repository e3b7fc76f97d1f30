#include "tests/support/picture.h"

#include <png.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "tests/support/places.h"

namespace condyle::test {
namespace {

/// Both pictures as files called by the test and a number.
testing::AssertionResult failed(const Picture& a, const Picture& b, const char* b_is,
                                const std::string& words) {
  static int number = 0;
  const auto* info = testing::UnitTest::GetInstance()->current_test_info();
  std::string name = info ? std::string(info->test_suite_name()) + "." + info->name() : "picture";
  std::replace(name.begin(), name.end(), '/', '-');
  const auto folder = kept_pictures() / "failed";
  std::filesystem::create_directories(folder);
  const auto keep = [&](const Picture& picture, const std::string& is) {
    const auto file = folder / (name + "-" + std::to_string(number) + "-" + is + ".png");
    if (!picture.empty()) picture.save(file);
    return picture.empty() ? "(no picture)" : file.string();
  };
  ++number;
  const std::string seen = keep(a, "seen");
  return testing::AssertionFailure() << words << ": " << seen << ", " << keep(b, b_is);
}

constexpr int max_alike = 12;  // levels of a channel

/// Fraction of the pixels of a region, given by the index of their first channel.
template <class Is>
double fraction(const Picture& picture, const Region& region, const Is& is) {
  const int left = std::max(0, static_cast<int>(region.x)),
            top = std::max(0, static_cast<int>(region.y)),
            right = static_cast<int>(std::min<double>(picture.width, region.x + region.width)),
            bottom = static_cast<int>(std::min<double>(picture.height, region.y + region.height));
  long counted = 0, all = 0;
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x, ++all)
      counted += is(4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                         static_cast<std::size_t>(x)));
  return all ? static_cast<double>(counted) / static_cast<double>(all) : 0;
}

std::string percent(double fraction) { return std::to_string(100 * fraction) + " %"; }

}  // namespace

Picture::Picture(const std::string& file) {
  png_image head{};
  head.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&head, file.c_str())) return;
  head.format = PNG_FORMAT_RGBA;
  rgba.resize(PNG_IMAGE_SIZE(head));
  png_image_finish_read(&head, nullptr, rgba.data(), 0, nullptr);
  width = static_cast<int>(head.width);
  height = static_cast<int>(head.height);
}

void Picture::save(const std::filesystem::path& file) const {
  png_image head{};
  head.version = PNG_IMAGE_VERSION;
  head.width = static_cast<png_uint_32>(width);
  head.height = static_cast<png_uint_32>(height);
  head.format = PNG_FORMAT_RGBA;
  head.flags = PNG_IMAGE_FLAG_FAST;
  png_image_write_to_file(&head, file.c_str(), 0, rgba.data(), 0, nullptr);
}

double difference(const Picture& a, const Picture& b, const Region& region) {
  if (a.empty() || a.width != b.width || a.height != b.height) return 1;
  return fraction(a, region, [&](std::size_t pixel) {
    for (std::size_t k = pixel; k < pixel + 4; ++k)
      if (std::abs(a.rgba[k] - b.rgba[k]) > max_alike) return true;
    return false;
  });
}

double colour_fraction(const Picture& picture, unsigned rgb, const Region& region) {
  return fraction(picture, region, [&](std::size_t pixel) {
    for (std::size_t k = 0; k < 3; ++k)
      if (std::abs(picture.rgba[pixel + k] - int(rgb >> (16 - 8 * k) & 0xff)) > max_alike)
        return false;
    return true;
  });
}

testing::AssertionResult alike(const Picture& seen, const Picture& expected, double most,
                               const Region& region) {
  const double fraction = difference(seen, expected, region);
  if (fraction <= most) return testing::AssertionSuccess();
  return failed(seen, expected, "expected",
                percent(fraction) + " of the pixels differ, of " + percent(most) + " allowed");
}

testing::AssertionResult unlike(const Picture& seen, const Picture& before, double least,
                                const Region& region) {
  const double fraction = difference(seen, before, region);
  if (fraction > least) return testing::AssertionSuccess();
  return failed(seen, before, "before",
                percent(fraction) + " of the pixels differ, not more than " + percent(least));
}

testing::AssertionResult same_bytes(const Picture& seen, const Picture& expected) {
  if (seen.width == expected.width && seen.rgba == expected.rgba)
    return testing::AssertionSuccess();
  return failed(seen, expected, "expected", "the pictures are not the same to the byte");
}

std::filesystem::path kept_pictures() {
  const auto folder = program_file().parent_path() / "test-results" / "pictures";
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace condyle::test
