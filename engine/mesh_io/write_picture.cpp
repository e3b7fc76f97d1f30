#include <png.h>

#include <string>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/mesh_io/picture_files.h"

namespace condyle {
namespace {

void write_png(const std::filesystem::path& file, int width, int height, png_uint_32 format,
               const void* pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = format;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels, 0, nullptr))
    throw MachineError(file.string() + ": the PNG could not be written: " + image.message);
  bytes.resize(size);
  write_file(file, bytes);
}

}  // namespace

void write_picture(const ColourPicture& picture, const std::filesystem::path& file) {
  write_png(file, picture.width, picture.height, PNG_FORMAT_RGB, picture.rgb.data());
}

void write_picture(const GreyPicture& picture, const std::filesystem::path& file) {
  write_png(file, picture.width, picture.height, PNG_FORMAT_LINEAR_Y, picture.values.data());
}

}  // namespace condyle
