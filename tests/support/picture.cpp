#include "tests/support/picture.h"

#include <png.h>

#include <algorithm>
#include <cstdlib>

namespace condyle::test {

Picture::Picture(const std::string& file) {
  png_image head{};
  head.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&head, file.c_str())) return;
  head.format = PNG_FORMAT_RGBA;
  rgba.resize(PNG_IMAGE_SIZE(head));
  png_image_finish_read(&head, nullptr, rgba.data(), 0, nullptr);
  width = static_cast<int>(head.width);
  height = static_cast<int>(head.height);
}

void Picture::save(const std::filesystem::path& file) const {
  png_image head{};
  head.version = PNG_IMAGE_VERSION;
  head.width = static_cast<png_uint_32>(width);
  head.height = static_cast<png_uint_32>(height);
  head.format = PNG_FORMAT_RGBA;
  head.flags = PNG_IMAGE_FLAG_FAST;
  png_image_write_to_file(&head, file.c_str(), 0, rgba.data(), 0, nullptr);
}

double difference(const Picture& a, const Picture& b, const Region& region) {
  if (a.empty() || a.width != b.width || a.height != b.height) return 1;
  const int left = std::max(0, static_cast<int>(region.x)),
            top = std::max(0, static_cast<int>(region.y)),
            right = static_cast<int>(std::min<double>(a.width, region.x + region.width)),
            bottom = static_cast<int>(std::min<double>(a.height, region.y + region.height));
  long differing = 0, all = 0;
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x) {
      const auto i = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(a.width) +
                          static_cast<std::size_t>(x));
      int most = 0;
      for (std::size_t k = i; k < i + 4; ++k)
        most = std::max(most, std::abs(a.rgba[k] - b.rgba[k]));
      differing += most > 12;
      ++all;
    }
  return all ? static_cast<double>(differing) / static_cast<double>(all) : 0;
}

std::filesystem::path kept_pictures() {
  const auto folder =
      std::filesystem::path(CONDYLE_PROGRAM).parent_path() / "test-results" / "pictures";
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace condyle::test
