#include "engine/volume/unpack.h"

#include <zlib.h>

#include <algorithm>
#include <limits>

#include "engine/core/error.h"

namespace condyle {
namespace {

constexpr std::size_t largest_ratio = 1032;  // of deflate
constexpr int largest_window = 15;
constexpr int any_header = largest_window + 32;  // gzip or zlib
constexpr int no_header = -largest_window;       // raw deflate
constexpr int gzip_header = largest_window + 16;

class Inflater {
 public:
  Inflater(std::string_view packed, const std::filesystem::path& file, int header = any_header)
      : left_(packed), file_(file) {
    if (inflateInit2(&stream_, header) != Z_OK)
      throw MachineError("no memory to decompress " + file.string());
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  /// Fills the buffer as far as the stream goes. Returns how many bytes were written.
  std::size_t fill(char* buffer, std::size_t size) {
    constexpr std::size_t most = std::numeric_limits<uInt>::max();
    std::size_t written = 0;
    while (written < size && !ended_) {
      const std::size_t in = std::min(left_.size(), most), out = std::min(size - written, most);
      stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(left_.data()));
      stream_.avail_in = static_cast<uInt>(in);
      stream_.next_out = reinterpret_cast<Bytef*>(buffer + written);
      stream_.avail_out = static_cast<uInt>(out);
      const int status = inflate(&stream_, Z_NO_FLUSH);
      left_.remove_prefix(in - stream_.avail_in);
      written += out - stream_.avail_out;
      if (status == Z_MEM_ERROR) throw MachineError("no memory to decompress " + file_.string());
      if (status == Z_STREAM_END) {
        // Members of a gzip file follow one another.
        ended_ = !left_.starts_with("\x1f\x8b");
        if (!ended_) inflateReset(&stream_);
        continue;
      }
      if (status == Z_BUF_ERROR || (status == Z_OK && in == 0)) break;  // it ends early
      if (status != Z_OK) throw InputError(file_, "", "its compressed data is damaged");
    }
    return written;
  }

  /// Whether the stream has ended.
  bool ended() const { return ended_; }
  /// Whether the stream has ended, its checksum was right, and nothing follows.
  bool complete() const { return ended_ && left_.empty(); }

 private:
  std::string_view left_;
  const std::filesystem::path& file_;
  z_stream stream_{};
  bool ended_ = false;
};

}  // namespace

std::string unpack(std::string_view packed, std::size_t size, const std::filesystem::path& file) {
  const std::string promised = std::to_string(size) + " bytes that its header states";
  if (size / largest_ratio > packed.size())
    throw InputError(file, "", "its compressed data is too short for the " + promised);
  std::string content(size, '\0');
  Inflater inflater(packed, file);
  if (inflater.fill(content.data(), size) < size)
    throw InputError(file, "", "its compressed data ends before the " + promised);
  char more = 0;
  if (inflater.fill(&more, 1) > 0)
    throw InputError(file, "", "its compressed data holds more than the " + promised);
  if (!inflater.complete())
    throw InputError(file, "", "its compressed data does not end with its checksum");
  return content;
}

std::string unpack_start(std::string_view packed, std::size_t size,
                         const std::filesystem::path& file) {
  std::string content(size, '\0');
  content.resize(Inflater(packed, file).fill(content.data(), size));
  return content;
}

std::string unpack_deflate(std::string_view packed, std::size_t most,
                           const std::filesystem::path& file) {
  constexpr std::size_t block = std::size_t{1} << 20;
  Inflater inflater(packed, file, no_header);
  std::string content;
  while (!inflater.ended()) {
    const std::size_t begin = content.size();
    content.resize(begin + block);
    const std::size_t written = inflater.fill(content.data() + begin, block);
    content.resize(begin + written);
    if (content.size() > most)
      throw InputError(file, "",
                       "its compressed data holds more than " + std::to_string(most) + " bytes");
    if (written < block && !inflater.ended())
      throw InputError(file, "", "its compressed data ends early");
  }
  return content;
}

void append_gzip(std::string& content, std::string_view bytes) {
  constexpr std::size_t most = std::numeric_limits<uInt>::max(), block = std::size_t{1} << 20;
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, gzip_header, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw MachineError("no memory to compress a volume");
  for (int status = Z_OK; status != Z_STREAM_END;) {
    const std::size_t in = std::min(bytes.size(), most), begin = content.size();
    content.resize(begin + block);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(in);
    stream.next_out = reinterpret_cast<Bytef*>(content.data() + begin);
    stream.avail_out = static_cast<uInt>(block);
    status = deflate(&stream, in == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
    bytes.remove_prefix(in - stream.avail_in);
    content.resize(begin + block - stream.avail_out);
  }
  deflateEnd(&stream);
}

}  // namespace condyle
