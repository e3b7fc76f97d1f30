#include "render/image/image.h"

#include <libdeflate.h>
#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <memory>

#include "engine/core/error.h"
#include "engine/core/files.h"

namespace condyle {
namespace {

constexpr int max_side = 16384;

struct Bytes {
  const std::string& content;
  std::size_t at = 0;
};

void append(png_structp png, png_bytep data, png_size_t size) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), size);
}

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

/// a - b, byte by byte.
std::uint32_t less(std::uint32_t a, std::uint32_t b) {
  constexpr std::uint32_t high = 0x80808080;
  return ((a | high) - (b & ~high)) ^ (~(a ^ b) & high);
}

/// Rows as PNG filters them, each pixel minus its left neighbour. `kept`: bytes per pixel, 3 or 4.
template <std::size_t kept>
std::vector<std::uint8_t> filtered(const Image& image) {
  const auto columns = static_cast<std::size_t>(image.width);
  const std::size_t size = (1 + kept * columns) * static_cast<std::size_t>(image.height);
  std::vector<std::uint8_t> rows(size + 4 - kept);  // four bytes are written for each pixel
  const std::uint8_t* from = image.rgba.data();
  std::uint8_t* to = rows.data();
  for (int row = 0; row < image.height; ++row) {
    *to++ = PNG_FILTER_VALUE_SUB;
    std::uint32_t before = 0;
    for (std::size_t x = 0; x < columns; ++x, from += 4, to += kept) {
      std::uint32_t pixel;
      std::memcpy(&pixel, from, 4);
      const std::uint32_t change = less(pixel, before);
      std::memcpy(to, &change, 4);
      before = pixel;
    }
  }
  rows.resize(size);
  return rows;
}

/// By libdeflate: in a third of libpng's own time, and reproducible for each version of it.
std::vector<std::uint8_t> deflated(const std::vector<std::uint8_t>& bytes) {
  constexpr int fastest = 1;
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> packer(
      libdeflate_alloc_compressor(fastest), libdeflate_free_compressor);
  if (!packer) throw MachineError("PNG: out of memory");
  std::vector<std::uint8_t> small(libdeflate_zlib_compress_bound(packer.get(), bytes.size()));
  const std::size_t size = libdeflate_zlib_compress(packer.get(), bytes.data(), bytes.size(),
                                                    small.data(), small.size());
  if (size == 0) throw MachineError("PNG: the picture could not be compressed");
  small.resize(size);
  return small;
}

// The two functions that libpng exits by longjmp have no object with a destructor.
bool write_chunks(png_structp png, png_infop info, const Image& image, bool opaque,
                  const std::vector<std::uint8_t>& pixels) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width),
               static_cast<png_uint_32>(image.height), 8,
               opaque ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGBA, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(png, info);
  const auto chunk = [&](const char* name, const std::uint8_t* data, std::size_t size) {
    png_write_chunk(png, reinterpret_cast<png_const_bytep>(name), data, size);
  };
  chunk("IDAT", pixels.data(), pixels.size());
  chunk("IEND", nullptr, 0);
  return true;
}

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
  const std::vector<std::uint8_t> pixels =
      deflated(opaque ? filtered<3>(image) : filtered<4>(image));
  std::string bytes, message;
  bytes.reserve(pixels.size() + 1000);
  png_structp png =
      png_create_write_struct(PNG_LIBPNG_VER_STRING, &message, keep_message, no_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  bool done = false;
  if (info) {
    png_set_write_fn(png, &bytes, append, nullptr);
    done = write_chunks(png, info, image, opaque, pixels);
  }
  png_destroy_write_struct(&png, &info);
  if (!done) throw MachineError("PNG: " + (message.empty() ? "out of memory" : message));
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
