#include "render/image.h"

#include <libdeflate.h>
#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "engine/core/error.h"
#include "engine/core/files.h"

namespace condyle {
namespace {

constexpr int max_side = 16384;

struct Bytes {
  const std::string& content;
  std::size_t at = 0;
};

void take(png_structp png, png_bytep data, png_size_t size) {
  auto& bytes = *static_cast<Bytes*>(png_get_io_ptr(png));
  if (size > bytes.content.size() - bytes.at) png_error(png, "the file ends early");
  std::memcpy(data, bytes.content.data() + bytes.at, size);
  bytes.at += size;
}

void keep_message(png_structp png, png_const_charp message) {
  *static_cast<std::string*>(png_get_error_ptr(png)) = message;
  png_longjmp(png, 1);
}

void no_warning(png_structp, png_const_charp) {}

void put_number(std::string& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 255);
}

/// A chunk of a PNG file: its length, name, content and checksum.
void put_chunk(std::string& bytes, const char* name, const std::string& content) {
  put_number(bytes, static_cast<std::uint32_t>(content.size()));
  const std::size_t checked = bytes.size();
  bytes.append(name, 4).append(content);
  put_number(bytes, libdeflate_crc32(0, bytes.data() + checked, bytes.size() - checked));
}

/// Rows of RGB or RGBA as PNG compresses them: behind the filter's number each pixel less the one
/// to its left.
template <int channels>
std::vector<std::uint8_t> filtered(const Image& image) {
  constexpr std::uint8_t sub = 1;
  const auto width = static_cast<std::size_t>(image.width);
  std::vector<std::uint8_t> rows((channels * width + 1) * static_cast<std::size_t>(image.height));
  std::uint8_t* out = rows.data();
  const std::uint8_t* in = image.rgba.data();
  for (int y = 0; y < image.height; ++y, in += 4 * width) {
    *out++ = sub;
    for (int k = 0; k < channels; ++k) *out++ = in[k];
    for (std::size_t x = 4; x < 4 * width; x += 4)
      for (std::size_t k = 0; k < channels; ++k)
        *out++ = static_cast<std::uint8_t>(in[x + k] - in[x + k - 4]);
  }
  return rows;
}

/// Takes half of zlib's time for about the same size.
std::string compressed(const std::vector<std::uint8_t>& rows) {
  constexpr int fastest = 1;
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      libdeflate_alloc_compressor(fastest), libdeflate_free_compressor);
  if (!compressor) throw MachineError("PNG: out of memory");
  std::string bytes(libdeflate_zlib_compress_bound(compressor.get(), rows.size()), '\0');
  bytes.resize(libdeflate_zlib_compress(compressor.get(), rows.data(), rows.size(), bytes.data(),
                                        bytes.size()));
  return bytes;
}

// What libpng leaves by longjmp holds no object with a destructor of its own.
bool decompress(png_structp png, png_infop info, Image& image) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_user_limits(png, max_side, max_side);
  png_read_info(png, info);
  const int type = png_get_color_type(png, info);
  png_set_expand(png);
  png_set_scale_16(png);
  if (!(type & PNG_COLOR_MASK_COLOR)) png_set_gray_to_rgb(png);
  png_set_add_alpha(png, 255, PNG_FILLER_AFTER);
  const int passes = png_set_interlace_handling(png);
  png_read_update_info(png, info);
  image.width = static_cast<int>(png_get_image_width(png, info));
  image.height = static_cast<int>(png_get_image_height(png, info));
  const std::size_t stride = std::size_t{4} * image.width;
  if (png_get_rowbytes(png, info) != stride) png_error(png, "its pixels have an unknown form");
  image.rgba.assign(stride * image.height, 0);
  for (int pass = 0; pass < passes; ++pass)
    for (int row = 0; row < image.height; ++row)
      png_read_row(png, image.rgba.data() + stride * row, nullptr);
  png_read_end(png, nullptr);
  return true;
}

}  // namespace

Image averaged(const Image& image, int n) {
  Image small;
  small.width = image.width / n;
  small.height = image.height / n;
  small.rgba.resize(std::size_t{4} * small.width * small.height);
  const unsigned count = static_cast<unsigned>(n * n);
  std::vector<unsigned> sums(std::size_t{4} * small.width);
  for (int y = 0; y < small.height; ++y) {
    std::fill(sums.begin(), sums.end(), count / 2);
    for (int j = 0; j < n; ++j) {
      const auto* row = &image.rgba[std::size_t{4} * image.width * (y * n + j)];
      for (int x = 0; x < n * small.width; ++x)
        for (int k = 0; k < 4; ++k) sums[4 * (x / n) + k] += row[4 * x + k];
    }
    for (std::size_t i = 0; i < sums.size(); ++i)
      small.rgba[std::size_t{4} * small.width * y + i] = static_cast<std::uint8_t>(sums[i] / count);
  }
  return small;
}

std::string encode_png(const Image& image) {
  if (image.width < 1 || image.height < 1 ||
      image.rgba.size() != std::size_t{4} * image.width * image.height)
    throw MachineError("a picture without its pixels cannot be written as PNG");
  bool opaque = true;
  for (std::size_t i = 3; opaque && i < image.rgba.size(); i += 4) opaque = image.rgba[i] == 255;
  constexpr char bits = 8, rgb = 2, rgba = 6, perceptual = 0;
  std::string header;
  put_number(header, static_cast<std::uint32_t>(image.width));
  put_number(header, static_cast<std::uint32_t>(image.height));
  header += bits;
  header += opaque ? rgb : rgba;
  header.append(3, '\0');  // the usual compression and filters, not interlaced
  std::string bytes = "\x89PNG\r\n\x1a\n";
  put_chunk(bytes, "IHDR", header);
  put_chunk(bytes, "sRGB", std::string(1, perceptual));
  put_chunk(bytes, "IDAT", compressed(opaque ? filtered<3>(image) : filtered<4>(image)));
  put_chunk(bytes, "IEND", {});
  return bytes;
}

void write_png(const std::filesystem::path& file, const Image& image) {
  write_file(file, encode_png(image));
}

Image read_png(const std::filesystem::path& file) {
  const std::string content = read_file(file, std::size_t{2} << 30);
  if (content.size() < 8 ||
      png_sig_cmp(reinterpret_cast<png_const_bytep>(content.data()), 0, 8) != 0)
    throw InputError(file, "", "is not a PNG picture");
  Bytes bytes{content};
  Image image;
  std::string message;
  png_structp png =
      png_create_read_struct(PNG_LIBPNG_VER_STRING, &message, keep_message, no_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  bool done = false;
  if (info) {
    png_set_read_fn(png, &bytes, take);
    done = decompress(png, info, image);
  }
  png_destroy_read_struct(&png, &info, nullptr);
  if (!done)
    throw InputError(file, "",
                     "is damaged (" + (message.empty() ? "out of memory" : message) + ")");
  return image;
}

}  // namespace condyle
