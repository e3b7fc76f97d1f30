#include "sim/frame/frame_file.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "sim/frame/frame_fields.h"
#include "sim/frame/state_hash.h"

namespace condyle {
namespace {

static_assert(std::endian::native == std::endian::little);
constexpr std::string_view magic = "CONDYLEF";
constexpr std::uint32_t frame_version = 3;
constexpr std::size_t max_frame_bytes = std::size_t{1} << 30;

class Writer {
 public:
  template <class T>
  void operator()(const T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
      add(&value, sizeof value);
    else
      add(value.data(), sizeof(typename T::Scalar) * static_cast<std::size_t>(value.size()));
  }
  template <class List>
  void size_of(const List& list) {
    (*this)(static_cast<std::uint64_t>(list.size()));
  }
  template <class Vector>
  void values(const std::vector<Vector>& list) {
    size_of(list);
    add(list.data(), list.size() * sizeof(Vector));
  }
  void add(const void* data, std::size_t size) {
    bytes.append(static_cast<const char*>(data), size);
  }

  std::string bytes;
};

class Reader {
 public:
  Reader(std::string_view bytes, const std::filesystem::path& file) : bytes_(bytes), file_(file) {}

  template <class T>
  void operator()(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      unsigned char byte = 0;
      take(&byte, 1);
      if (byte > 1) refuse("has " + std::to_string(byte) + " where 0 or 1 is expected");
      value = byte == 1;
    } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      take(&value, sizeof value);
    } else {
      take(value.data(), sizeof(typename T::Scalar) * static_cast<std::size_t>(value.size()));
    }
  }
  template <class List>
  void size_of(List& list) {
    // Each item takes at least one byte: a damaged length cannot request more memory than the file
    // has.
    list.resize(length(1));
  }
  template <class Vector>
  void values(std::vector<Vector>& list) {
    list.resize(length(sizeof(Vector)));
    take(list.data(), list.size() * sizeof(Vector));
  }
  void take(void* data, std::size_t size) {
    if (size > bytes_.size() - at_)
      refuse("ends after " + std::to_string(bytes_.size()) + " bytes, within a value");
    if (size > 0) std::memcpy(data, bytes_.data() + at_, size);
    at_ += size;
  }
  std::size_t left() const { return bytes_.size() - at_; }
  [[noreturn]] void refuse(const std::string& problem) const {
    throw InputError(file_, "byte " + std::to_string(at_), problem);
  }

 private:
  std::size_t length(std::size_t item_bytes) {
    std::uint64_t count = 0;
    (*this)(count);
    if (count > left() / item_bytes)
      refuse("a list of " + std::to_string(count) + " items is longer than the file");
    return static_cast<std::size_t>(count);
  }

  std::string_view bytes_;
  const std::filesystem::path& file_;
  std::size_t at_ = 0;
};

}  // namespace

std::string frame_bytes(const FrameState& frame) {
  Writer writer;
  writer.add(magic.data(), magic.size());
  writer(frame_version);
  for (const double ms : frame.times.ms) writer(ms);
  writer(frame.lids.left);
  writer(frame.lids.right);
  visit_frame(frame, writer);
  writer(frame.state_hash);
  writer(state_hash(frame));
  return std::move(writer.bytes);
}

FrameState frame_of_bytes(std::string_view bytes, const std::filesystem::path& file) {
  if (bytes.substr(0, magic.size()) != magic)
    throw InputError(file, "", "is not a Condyle frame: it does not begin with \"CONDYLEF\"");
  Reader reader(bytes, file);
  char skipped[magic.size()];
  reader.take(skipped, magic.size());
  std::uint32_t version = 0;
  reader(version);
  if (version != frame_version)
    throw InputError(file, "version",
                     "is " + std::to_string(version) + "; this program reads version " +
                         std::to_string(frame_version));
  FrameState frame;
  for (double& ms : frame.times.ms) reader(ms);
  for (double* const closure : {&frame.lids.left, &frame.lids.right}) {
    reader(*closure);
    if (!(*closure >= -1 && *closure <= 1))
      reader.refuse("a closure of lids of " + std::to_string(*closure) + " is not within -1 to 1");
  }
  visit_frame(frame, reader);
  std::uint64_t written = 0;
  reader(frame.state_hash);
  reader(written);
  if (reader.left() > 0)
    reader.refuse(std::to_string(reader.left()) + " bytes follow the end of the frame");
  if (state_hash(frame) != written)
    throw InputError(file, "", "is damaged: its content does not match its hash");
  return frame;
}

void write_frame(const FrameState& frame, const std::filesystem::path& file) {
  write_file(file, frame_bytes(frame));
}

FrameState read_frame(const std::filesystem::path& file) {
  return frame_of_bytes(read_file(file, max_frame_bytes), file);
}

}  // namespace condyle
