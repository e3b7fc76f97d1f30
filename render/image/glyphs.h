#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "render/image/image.h"

namespace condyle {

/// Renders text into a picture with a system font.
class Glyphs {
 public:
  Glyphs();
  ~Glyphs();
  Glyphs(const Glyphs&) = delete;
  Glyphs& operator=(const Glyphs&) = delete;

  /// Without a font nothing is drawn and every width is 0.
  bool has_font() const;

  /// Pixels; text is UTF-8.
  double width(const std::string& text, double height) const;

  /// Wrapped between words so that each line is at most `most` pixels wide, except single long
  /// words.
  std::vector<std::string> lines(const std::string& text, double height, double most) const;

  /// `x`, `y`: left end of the baseline, pixels from the top left. Color: sRGB, 0 to 1.
  void write(Image& image, double x, double y, double height, const std::string& text,
             const Eigen::Vector3f& color = Eigen::Vector3f::Constant(0.13f)) const;

 private:
  struct Font;
  std::unique_ptr<Font> font_;
};

}  // namespace condyle
