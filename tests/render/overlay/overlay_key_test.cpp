// The key to the overlays.
#include "render/overlay/overlay_key.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "render/overlay/annotations.h"
#include "render/overlay/legend.h"
#include "tests/render/scene_parts.h"
#include "tests/support/picture.h"

namespace condyle {
namespace {

using Mark = KeyEntry::Mark;

std::vector<KeyEntry> key_of(int count) {
  std::vector<KeyEntry> key;
  for (int i = 0; i < count; ++i)
    key.push_back(
        {"What a colour means, " + std::to_string(i),
         {{0.9f, 0.2f, 0.1f}, {0.1f, 0.2f, 0.9f}},
         std::array{Mark::line, Mark::path, Mark::arrow, Mark::sheet, Mark::scale}[i % 5]});
  return key;
}

Image grey(int width, int height) {
  return {width, height,
          std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height * 4, 128)};
}

struct Size {
  int width, height;
};
class KeyOn : public testing::TestWithParam<Size> {
 protected:
  const int width_ = GetParam().width, height_ = GetParam().height;
  Glyphs words_;
};

TEST_P(KeyOn, IsClearOfLegendScaleBarAndLetters) {
  ASSERT_TRUE(words_.has_font()) << "install fonts-dejavu-core";
  const Image bare = grey(width_, height_);
  Image key = bare, legend = bare, signs = bare;
  const PixelBox pane = add_key(key, words_, key_of(20));
  EXPECT_GT(pane.x1 - pane.x0, width_ / 8);
  EXPECT_LT(pane.x1, width_ / 2);
  EXPECT_LT(pane.y1, height_ / 2);
  Annotations notes{.scale_bar = true, .letters = true};
  const PixelBox low =
      add_legend(legend, words_, distance_colours(),
                 {"to parts it may touch", "open surfaces have no inside:", "no sign near them"});
  keep_clear_of(notes, low, legend);
  annotate(signs, words_, Camera{}, notes);
  int in_key = 0, in_legend = 0, in_signs = 0, shared = 0;
  for (std::size_t i = 0; i < bare.rgba.size(); i += 4) {
    const auto differs = [&](const Image& image) {
      return image.rgba[i] != 128 || image.rgba[i + 1] != 128 || image.rgba[i + 2] != 128;
    };
    const bool k = differs(key), l = differs(legend), s = differs(signs);
    in_key += k;
    in_legend += l;
    in_signs += s;
    shared += k + l + s > 1;
  }
  EXPECT_GT(in_key, 1000);
  EXPECT_GT(in_legend, 1000);
  EXPECT_GT(in_signs, 100);
  EXPECT_EQ(shared, 0);
}

TEST_P(KeyOn, ShowsEachColourBesideItsWords) {
  Image image = grey(width_, height_);
  const auto key = key_of(5);
  const PixelBox pane = add_key(image, words_, key);
  ASSERT_GT(pane.x1, pane.x0);
  const double row = (pane.y1 - pane.y0) * 22.0 / (2 * 12 + 5 * 22), pad = row * 12 / 22;
  for (std::size_t i = 0; i < key.size(); ++i) {
    int red = 0, blue = 0, light = 0;
    for (int y = static_cast<int>(pane.y0 + pad + i * row); y < pane.y0 + pad + (i + 1) * row; ++y)
      for (int x = pane.x0; x < pane.x1; ++x) {
        const auto* p = &image.rgba[4 * (static_cast<std::size_t>(y) * width_ + x)];
        red += p[0] > p[2] + 80;
        blue += p[2] > p[0] + 80;
        light += p[0] > 180 && p[1] > 180 && p[2] > 180;
      }
    EXPECT_GT(red, 4) << i;
    EXPECT_EQ(blue > 4, key[i].mark == Mark::path || key[i].mark == Mark::scale) << i;
    EXPECT_GT(light, 20) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, KeyOn,
                         testing::Values(Size{1280, 720}, Size{3840, 2160}, Size{720, 1280}));

TEST(Key, PanesSuitTheBackdrop) {
  const Glyphs words;
  for (const Backdrop backdrop : {Backdrop::dark, Backdrop::light}) {
    Image image = grey(1280, 720);
    const auto key = key_of(10);
    for (const PixelBox& pane :
         {add_key(image, words, key, backdrop),
          add_legend(image, words, distance_colours(), {"a remark"}, backdrop)}) {
      int ground = 0, inked = 0;
      for (int y = pane.y0; y < pane.y1; ++y)
        for (int x = pane.x0; x < pane.x1; ++x) {
          const Pixel p = pixel(image, x, y);
          const bool bright = std::min({p.r, p.g, p.b}) > 215,
                     dark = std::max({p.r, p.g, p.b}) < 60;
          ground += backdrop == Backdrop::light ? bright : dark;
          inked += backdrop == Backdrop::light ? dark : bright;
        }
      EXPECT_GT(ground, (pane.x1 - pane.x0) * (pane.y1 - pane.y0) / 2);
      EXPECT_GT(inked, 300);
    }
  }
}

TEST(Key, IsOmittedWithoutEntriesOrSpace) {
  const Glyphs words;
  Image image = grey(1280, 720), small = grey(64, 48);
  EXPECT_EQ(add_key(image, words, {}).x1, 0);
  EXPECT_EQ(add_key(small, words, key_of(20)).x1, 0);
  EXPECT_TRUE(test::same_bytes(image, grey(1280, 720)));
  EXPECT_TRUE(test::same_bytes(small, grey(64, 48)));
}

}  // namespace
}  // namespace condyle
