#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace condyle {

/// The content of a gzip or zlib stream, which must have `size` bytes. A size that no stream of
/// this length can have is refused before memory is requested. throws: InputError naming the file
/// for a damaged stream, one that ends early, and one that holds more or is followed by more.
std::string unpack(std::string_view packed, std::size_t size, const std::filesystem::path& file);

/// The first `size` bytes of the content, or all if there are fewer.
std::string unpack_start(std::string_view packed, std::size_t size,
                         const std::filesystem::path& file);

/// The content of a raw deflate stream, which has no header and no checksum; bytes after its end
/// are ignored. throws: InputError naming the file for a damaged stream, one that ends early, and
/// one with more than `most` bytes.
std::string unpack_deflate(std::string_view packed, std::size_t most,
                           const std::filesystem::path& file);

/// Appends the bytes as a gzip stream, compressed quickly.
void append_gzip(std::string& content, std::string_view bytes);

}  // namespace condyle
