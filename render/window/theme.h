#pragma once

#include <cstdint>
#include <string>

struct ImFont;

namespace condyle {

/// Fonts and the size of everything in the current ImGui context.
struct Theme {
  float scale = 1;  // 1 is a screen of about 96 dots per inch
  ImFont* regular = nullptr;
  ImFont* small = nullptr;
  ImFont* bold = nullptr;
  ImFont* large = nullptr;  // for readouts
  std::string font_file;    // empty when only ImGui's own font was found
};

/// Colours of the dark theme, as ImU32 (0xAABBGGRR). Signals are from the Okabe-Ito palette, which
/// colour-blind people can tell apart; each is always said in words too.
namespace colour {
constexpr std::uint32_t rgb(std::uint32_t hex, std::uint32_t alpha = 255) {
  return (alpha << 24) | ((hex & 0xff) << 16) | (hex & 0xff00) | (hex >> 16);
}
constexpr std::uint32_t window = rgb(0x0f1215), panel = rgb(0x191d22), panel_edge = rgb(0x2b313a);
constexpr std::uint32_t field = rgb(0x262c34), field_hovered = rgb(0x313944);
constexpr std::uint32_t text = rgb(0xe4e8ec), text_dim = rgb(0x97a3b0), text_faint = rgb(0x6b7783);
constexpr std::uint32_t accent = rgb(0x56b4e9), accent_dark = rgb(0x2b6b93);
constexpr std::uint32_t good = rgb(0x2fbf93), warning = rgb(0xe69f00), bad = rgb(0xe8713a);
}  // namespace colour

/// The scale to use in a window of this size, pixels: the wanted one, or less where the panels
/// would not fit; in steps of 0.05, so that resizing does not load fonts at every pixel.
float fitting_scale(double wanted, int width, int height);

/// Loads the fonts at this scale and sets colours and spacing of the current ImGui context. The
/// renderer's font texture must be made anew afterwards. Looks for Inter, Noto Sans and DejaVu Sans
/// (package fonts-dejavu-core) where Debian puts them; ImGui's own font is the last resort.
Theme apply_theme(float scale);

}  // namespace condyle
