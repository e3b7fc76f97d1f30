#pragma once

#include <cstdint>
#include <string>

struct ImFont;

namespace condyle {

/// Fonts and scale of the current ImGui context.
struct Theme {
  bool light = false;
  float scale = 1;  // 1 is a screen of about 96 dots per inch
  ImFont* regular = nullptr;
  ImFont* small = nullptr;
  ImFont* bold = nullptr;
  ImFont* large = nullptr;  // for readouts
  std::string font_file;    // empty when only ImGui's own font was found
};

/// Colours of the theme in use, as ImU32 (0xAABBGGRR). Signals are from the Okabe-Ito palette,
/// which colour-blind people can distinguish; each is also stated in words.
namespace colour {
constexpr std::uint32_t rgb(std::uint32_t hex, std::uint32_t alpha = 255) {
  return (alpha << 24) | ((hex & 0xff) << 16) | (hex & 0xff00) | (hex >> 16);
}
struct Palette {
  std::uint32_t window, panel, panel_edge, popup, floating;
  std::uint32_t field, field_hovered, well, track, outline;
  std::uint32_t text, text_dim, text_faint, bright;  // bright: hovered
  std::uint32_t accent, accent_dark, good, warning, bad;
  std::uint32_t letter, letter_edge, divider;      // on the view
  std::uint32_t cube_lit, cube_aslant, cube_edge;  // faces toward the viewer, and nearly edge-on
};
inline constexpr Palette dark = {
    .window = rgb(0x0f1215),
    .panel = rgb(0x191d22),
    .panel_edge = rgb(0x2b313a),
    .popup = rgb(0x20262d),
    .floating = rgb(0x191d22, 230),
    .field = rgb(0x262c34),
    .field_hovered = rgb(0x313944),
    .well = rgb(0x14181c),
    .track = rgb(0x3a424d),
    .outline = rgb(0x4a545f),
    .text = rgb(0xe4e8ec),
    .text_dim = rgb(0xa3aeba),
    .text_faint = rgb(0x838f9b),
    .bright = rgb(0xffffff),
    .accent = rgb(0x56b4e9),
    .accent_dark = rgb(0x2b6b93),
    .good = rgb(0x2fbf93),
    .warning = rgb(0xe69f00),
    .bad = rgb(0xe8713a),
    .letter = rgb(0xc4ccd4),
    .letter_edge = rgb(0x0f1215, 200),
    .divider = rgb(0xf0e442),
    .cube_lit = rgb(0x62686f, 235),
    .cube_aslant = rgb(0x343a41, 235),
    .cube_edge = rgb(0x8a96a3),
};
inline constexpr Palette light = {
    .window = rgb(0xccd3da),
    .panel = rgb(0xf3f5f7),
    .panel_edge = rgb(0xd0d7de),
    .popup = rgb(0xffffff),
    .floating = rgb(0xf3f5f7, 236),
    .field = rgb(0xe0e6eb),
    .field_hovered = rgb(0xd0d9e1),
    .well = rgb(0xe6ebef),
    .track = rgb(0xc3ccd5),
    .outline = rgb(0x9aa6b2),
    .text = rgb(0x1b232b),
    .text_dim = rgb(0x52606d),
    .text_faint = rgb(0x616d79),
    .bright = rgb(0x003f63),
    .accent = rgb(0x0072b2),
    .accent_dark = rgb(0x9fcdea),
    .good = rgb(0x007a5a),
    .warning = rgb(0x946200),
    .bad = rgb(0xb8400a),
    .letter = rgb(0x2b3640),
    .letter_edge = rgb(0xf3f5f7, 215),
    .divider = rgb(0x005b8f),
    .cube_lit = rgb(0xfbfcfd, 240),
    .cube_aslant = rgb(0xc4ccd4, 240),
    .cube_edge = rgb(0x6b7783),
};
/// Chosen by apply_theme; one window is open at a time.
inline const Palette* in_use = &dark;
}  // namespace colour
inline const colour::Palette& palette() { return *colour::in_use; }

/// The scale where none is given: larger on a 4K screen that does not report its own.
double default_scale(double screen_scale, int framebuffer_width);

/// The scale to use in a window of this size, pixels: the preferred one, or less where the panels
/// would not fit; in steps of 0.05, so that resizing does not load fonts at every pixel.
float fitting_scale(double preferred, int width, int height);

/// Loads the fonts at this scale and sets colours and spacing of the current ImGui context. The
/// renderer's font texture must be rebuilt afterwards. Searches Inter, Noto Sans and DejaVu Sans
/// (package fonts-dejavu-core) where Debian puts them; ImGui's own font is the last resort.
Theme apply_theme(float scale, bool light = false);

}  // namespace condyle
