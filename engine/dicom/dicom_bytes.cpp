#include "engine/dicom/dicom_bytes.h"

#include <algorithm>

namespace condyle {
namespace {
constexpr std::size_t window_bytes = std::size_t{1} << 14;
}

DicomBytes::DicomBytes(const std::filesystem::path& file) : stream_(file, std::ios::binary) {
  std::error_code error;
  size_ = std::filesystem::file_size(file, error);
  if (!stream_ || error) throw DicomDamage("cannot be read");
}

std::string_view DicomBytes::read(std::uint64_t begin, std::size_t count) {
  if (!has(begin, count)) throw DicomDamage("ends early");
  if (begin < window_begin_ || begin + count > window_begin_ + window_.size()) {
    const auto size = static_cast<std::size_t>(
        std::min<std::uint64_t>(std::max(count, window_bytes), size_ - begin));
    window_.resize(size);
    window_begin_ = begin;
    stream_.clear();
    stream_.seekg(static_cast<std::streamoff>(begin));
    stream_.read(window_.data(), static_cast<std::streamsize>(size));
    if (static_cast<std::size_t>(stream_.gcount()) != size) throw DicomDamage("cannot be read");
  }
  return std::string_view(window_).substr(static_cast<std::size_t>(begin - window_begin_), count);
}

}  // namespace condyle
