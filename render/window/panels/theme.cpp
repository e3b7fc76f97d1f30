#include "render/window/panels/theme.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

namespace condyle {
namespace {

struct FontFiles {
  const char* regular;
  const char* bold;
  float size;  // pixels at scale 1: families differ in apparent size
};
constexpr std::array<FontFiles, 3> font_files = {{
    {"/usr/share/fonts/opentype/inter/Inter-Regular.otf",
     "/usr/share/fonts/opentype/inter/Inter-SemiBold.otf", 15.5f},
    {"/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
     "/usr/share/fonts/truetype/noto/NotoSans-SemiBold.ttf", 17.0f},
    {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
     "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf", 14.0f},
}};

// Room that the panels need at scale 1, pixels.
constexpr double min_width = 1080, min_height = 700;

// Latin, its accents, Greek and Cyrillic: names of cases and parts are the user's.
constexpr std::array<ImWchar, 9> letters = {0x20,   0x24f,  0x370,  0x52f, 0x2010,
                                            0x205e, 0x2190, 0x2193, 0};

void load_fonts(Theme& theme) {
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.Clear();
  for (const FontFiles& files : font_files) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(files.regular, ignored) ||
        !std::filesystem::is_regular_file(files.bold, ignored))
      continue;
    const auto load = [&](const char* file, float relative, const ImWchar* which) {
      ImFontConfig config;
      config.OversampleH = 2;
      config.OversampleV = 1;
      const float pixels = std::round(files.size * theme.scale * relative);
      return atlas.AddFontFromFileTTF(file, pixels, &config, which);
    };
    theme.regular = load(files.regular, 1, letters.data());
    theme.small = load(files.regular, 0.86f, letters.data());
    theme.bold = load(files.bold, 1, letters.data());
    theme.large = load(files.bold, 2.1f, nullptr);  // numbers and single letters: Latin is enough
    if (theme.regular && theme.small && theme.bold && theme.large) {
      theme.font_file = files.regular;
      return;
    }
    atlas.Clear();  // a damaged file: try the next family
  }
  const auto built_in = [&](float pixels) {
    ImFontConfig config;
    config.SizePixels = std::round(pixels * theme.scale);
    return atlas.AddFontDefault(&config);
  };
  theme.regular = theme.bold = built_in(13);
  theme.small = built_in(12);
  theme.large = built_in(26);
}

}  // namespace

double default_scale(double screen_scale, int framebuffer_width) {
  constexpr int fine_width = 3840;
  return screen_scale == 1 && framebuffer_width >= fine_width ? 1.5 : 1;
}

float fitting_scale(double preferred, int width, int height) {
  const double most = std::min(width / min_width, height / min_height);
  const double scale = std::floor(std::min(preferred, most) * 20 + 1e-6) / 20;
  return static_cast<float>(std::clamp(scale, 0.5, 6.0));
}

Theme apply_theme(float scale, bool light) {
  colour::in_use = light ? &colour::light : &colour::dark;
  Theme theme;
  theme.light = light;
  theme.scale = scale;
  load_fonts(theme);

  ImGuiStyle style;
  style.WindowPadding = {14, 12};
  style.FramePadding = {8, 4};
  style.ItemSpacing = {8, 7};
  style.ItemInnerSpacing = {7, 5};
  style.ScrollbarSize = 10;
  style.GrabMinSize = 10;
  style.WindowRounding = 0;
  style.ChildRounding = 4;
  style.FrameRounding = 4;
  style.PopupRounding = 6;
  style.GrabRounding = 4;
  style.ScrollbarRounding = 5;
  style.WindowBorderSize = 0;
  style.PopupBorderSize = 1;
  style.ScaleAllSizes(scale);

  const auto set = [&](ImGuiCol which, std::uint32_t value) {
    style.Colors[which] = ImGui::ColorConvertU32ToFloat4(value);
  };
  ImGui::StyleColorsDark(&style);
  set(ImGuiCol_Text, palette().text);
  set(ImGuiCol_TextDisabled, palette().text_dim);
  set(ImGuiCol_WindowBg, palette().panel);
  set(ImGuiCol_ChildBg, colour::rgb(0, 0));
  set(ImGuiCol_PopupBg, palette().popup);
  set(ImGuiCol_Border, palette().panel_edge);
  set(ImGuiCol_FrameBg, palette().field);
  set(ImGuiCol_FrameBgHovered, palette().field_hovered);
  set(ImGuiCol_FrameBgActive, palette().field_hovered);
  set(ImGuiCol_Button, palette().field);
  set(ImGuiCol_ButtonHovered, palette().field_hovered);
  set(ImGuiCol_ButtonActive, palette().accent_dark);
  set(ImGuiCol_CheckMark, palette().accent);
  set(ImGuiCol_SliderGrab, palette().accent);
  set(ImGuiCol_SliderGrabActive, palette().accent);
  set(ImGuiCol_Header, palette().accent_dark);
  set(ImGuiCol_HeaderHovered, palette().field_hovered);
  set(ImGuiCol_HeaderActive, palette().accent_dark);
  set(ImGuiCol_Separator, palette().panel_edge);
  set(ImGuiCol_ScrollbarBg, colour::rgb(0, 0));
  set(ImGuiCol_ScrollbarGrab, palette().track);
  set(ImGuiCol_ModalWindowDimBg, colour::rgb(0x05070a, 150));
  ImGui::GetStyle() = style;
  return theme;
}

}  // namespace condyle
