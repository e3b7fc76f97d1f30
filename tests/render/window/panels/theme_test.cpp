#include "render/window/panels/theme.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/render/window/panel_stage.h"

namespace condyle {
namespace {

/// Relative luminance of an ImU32 (WCAG 2.1).
double luminance(std::uint32_t c) {
  const auto linear = [&](int shift) {
    const double v = ((c >> shift) & 255) / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(0) + 0.7152 * linear(8) + 0.0722 * linear(16);
}

double contrast(std::uint32_t a, std::uint32_t b) {
  const double la = luminance(a), lb = luminance(b);
  return (std::max(la, lb) + 0.05) / (std::min(la, lb) + 0.05);
}

TEST(Theme, WordsCanBeReadInBothThemes) {
  for (const auto* p : {&colour::dark, &colour::light}) {
    for (const auto ground : {p->panel, p->popup, p->field})
      EXPECT_GE(contrast(p->text, ground), 7);
    EXPECT_GE(contrast(p->text, p->accent_dark), 4.5);
    for (const auto face : {p->cube_lit, p->cube_aslant, p->floating})
      EXPECT_GE(contrast(p->text, face), 4.5);
    EXPECT_GE(contrast(p->text_dim, p->panel), 5.5);
    for (const auto ink : {p->text_dim, p->text_faint, p->good, p->warning, p->bad, p->accent})
      EXPECT_GE(contrast(ink, p->panel), 4.5);
  }
  // On the view: its backgrounds' corners and middles.
  for (const auto ground : {colour::rgb(0x16171a), colour::rgb(0x4b4e53)}) {
    EXPECT_GE(contrast(colour::dark.letter, ground), 4.5);
    EXPECT_GE(contrast(colour::dark.divider, ground), 4.5);
  }
  for (const auto ground : {colour::rgb(0xbdc3c9), colour::rgb(0xe7e9ec)}) {
    EXPECT_GE(contrast(colour::light.letter, ground), 4.5);
    EXPECT_GE(contrast(colour::light.divider, ground), 3.5);
  }
}

TEST(Theme, TextOnTheViewTurnsLightAndDark) {
  PanelStage stage(1280, 720, 1);
  stage.key.push_back({"A line", {{0.94f, 0.89f, 0.26f}}, KeyEntry::Mark::line});
  stage.rest();
  struct Shades {
    double bright, dark;  // shares of the item
  };
  const auto shades = [&](const std::string& item) {
    const Image image = stage.image();
    const ViewRect r = stage.item(item).rect;
    double bright = 0, dark = 0;
    for (int y = static_cast<int>(r.y); y < static_cast<int>(r.y + r.height); ++y)
      for (int x = static_cast<int>(r.x); x < static_cast<int>(r.x + r.width); ++x) {
        const auto* p = &image.rgba[4 * (static_cast<std::size_t>(y) * image.width + x)];
        bright += std::min({p[0], p[1], p[2]}) > 175;
        dark += std::max({p[0], p[1], p[2]}) < 110;
      }
    return Shades{bright / (r.width * r.height), dark / (r.width * r.height)};
  };
  EXPECT_LT(shades("cube").bright, 0.1);
  EXPECT_GT(shades("key").dark, 0.6);
  stage.set_light(true);
  stage.rest();
  EXPECT_GT(shades("cube").bright, 0.3);
  EXPECT_GT(shades("key").bright, 0.6);
  stage.set_light(false);
}

TEST(Theme, PanelsTurnLightAndDark) {
  PanelStage stage(1280, 720, 1);
  stage.rest();
  const auto brightness = [&] {
    const Image image = stage.image();
    double sum = 0;  // of the left panel
    for (int y = 100; y < 600; ++y)
      for (int x = 4; x < 240; ++x)
        sum += image.rgba[4 * (static_cast<std::size_t>(y) * image.width + x)];
    return sum / (500 * 236);
  };
  EXPECT_LT(brightness(), 80);
  stage.set_light(true);
  stage.rest();
  EXPECT_GT(brightness(), 190);
  stage.set_light(false);
  stage.rest();
  EXPECT_LT(brightness(), 80);
}

}  // namespace
}  // namespace condyle
