#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

namespace condyle {

/// What is wrong with one file of a series. The message names no path and no text of the file: both
/// may hold names of people.
struct DicomDamage : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The bytes of a file, of which only what is read is in memory; or of a text.
class DicomBytes {
 public:
  /// throws: DicomDamage.
  explicit DicomBytes(const std::filesystem::path& file);
  explicit DicomBytes(std::string content) : window_(std::move(content)), size_(window_.size()) {}

  std::uint64_t size() const { return size_; }
  bool has(std::uint64_t begin, std::uint64_t count) const {
    return begin <= size_ && count <= size_ - begin;
  }
  /// `count` bytes from `begin`, valid until the next call. throws: DicomDamage where the file ends
  /// before, without requesting memory.
  std::string_view read(std::uint64_t begin, std::size_t count);

 private:
  std::ifstream stream_;
  std::string window_;
  std::uint64_t window_begin_ = 0, size_ = 0;
};

}  // namespace condyle
