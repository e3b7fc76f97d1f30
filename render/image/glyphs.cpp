#include "render/image/glyphs.h"

#define STBTT_STATIC
#define STB_TRUETYPE_IMPLEMENTATION
#include <stb/stb_truetype.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <vector>

#include "engine/core/files.h"
#include "render/image/raster_2d.h"

namespace condyle {
namespace {

const char* const font_files[] = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                  "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf"};
constexpr std::size_t max_font_bytes = std::size_t{64} << 20;

/// The code point at `at`, which is advanced; invalid bytes yield a question mark.
int next_letter(const std::string& text, std::size_t& at) {
  const auto lead = static_cast<unsigned char>(text[at++]);
  if (lead < 0x80) return lead;
  const int more = lead >= 0xf0 ? 3 : lead >= 0xe0 ? 2 : lead >= 0xc0 ? 1 : -1;
  if (more < 0) return '?';
  int code = lead & (0x3f >> more);
  for (int i = 0; i < more; ++i) {
    if (at >= text.size() || (static_cast<unsigned char>(text[at]) & 0xc0) != 0x80) return '?';
    code = code << 6 | (static_cast<unsigned char>(text[at++]) & 0x3f);
  }
  return code;
}

}  // namespace

struct Glyphs::Font {
  std::string bytes;
  stbtt_fontinfo info;
};

Glyphs::Glyphs() {
  for (const char* file : font_files) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) continue;
    auto font = std::make_unique<Font>();
    font->bytes = read_file(file, max_font_bytes);
    const auto* data = reinterpret_cast<const unsigned char*>(font->bytes.data());
    const int offset = stbtt_GetFontOffsetForIndex(data, 0);
    if (offset < 0 || !stbtt_InitFont(&font->info, data, offset)) continue;
    font_ = std::move(font);
    return;
  }
}

Glyphs::~Glyphs() = default;

bool Glyphs::has_font() const { return font_ != nullptr; }

double Glyphs::width(const std::string& text, double height) const {
  if (!font_) return 0;
  const float scale = stbtt_ScaleForPixelHeight(&font_->info, static_cast<float>(height));
  double x = 0;
  for (std::size_t at = 0; at < text.size();) {
    int advance = 0, bearing = 0;
    stbtt_GetCodepointHMetrics(&font_->info, next_letter(text, at), &advance, &bearing);
    x += scale * static_cast<float>(advance);
  }
  return x;
}

std::vector<std::string> Glyphs::lines(const std::string& text, double height, double most) const {
  std::vector<std::string> lines(1);
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    auto& line = lines.back();
    const std::string longer = line.empty() ? word : line + ' ' + word;
    if (line.empty() || width(longer, height) <= most)
      line = longer;
    else
      lines.push_back(word);
  }
  return lines;
}

void Glyphs::write(Image& image, double x, double y, double height, const std::string& text,
                   const Eigen::Vector3f& color) const {
  if (!font_) return;
  const float scale = stbtt_ScaleForPixelHeight(&font_->info, static_cast<float>(height));
  for (std::size_t at = 0; at < text.size();) {
    const int letter = next_letter(text, at);
    int advance = 0, bearing = 0, x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    stbtt_GetCodepointHMetrics(&font_->info, letter, &advance, &bearing);
    const double left = std::floor(x);
    const auto shift = static_cast<float>(x - left);
    stbtt_GetCodepointBitmapBoxSubpixel(&font_->info, letter, scale, scale, shift, 0, &x0, &y0, &x1,
                                        &y1);
    const int columns = x1 - x0, rows = y1 - y0;
    if (columns > 0 && rows > 0) {
      std::vector<unsigned char> cover(static_cast<std::size_t>(columns) * rows);
      stbtt_MakeCodepointBitmapSubpixel(&font_->info, cover.data(), columns, rows, columns, scale,
                                        scale, shift, 0, letter);
      for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
          const int px = static_cast<int>(left) + x0 + i;
          const int py = static_cast<int>(std::lround(y)) + y0 + j;
          if (px < 0 || py < 0 || px >= image.width || py >= image.height) continue;
          const float a =
              static_cast<float>(cover[static_cast<std::size_t>(j) * columns + i]) / 255;
          lay_over(&image.rgba[4 * (static_cast<std::size_t>(py) * image.width + px)], color, a);
        }
    }
    x += scale * static_cast<float>(advance);
  }
}

}  // namespace condyle
