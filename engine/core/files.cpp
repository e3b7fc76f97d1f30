#include "engine/core/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <random>

#include "engine/core/error.h"

namespace condyle {
namespace fs = std::filesystem;

std::string read_file(const fs::path& file, std::size_t max_bytes) {
  std::error_code error;
  const auto status = fs::status(file, error);
  if (!fs::exists(status)) throw InputError(file, "", "no such file");
  if (!fs::is_regular_file(status)) throw InputError(file, "", "is not a regular file");
  const auto size = fs::file_size(file, error);
  if (error) throw InputError(file, "", "cannot be read: " + error.message());
  if (size > max_bytes)
    throw InputError(file, "",
                     "is " + std::to_string(size) + " bytes; at most " + std::to_string(max_bytes) +
                         " are read");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file, "", std::string("cannot be opened: ") + std::strerror(errno));
  std::string content(size, '\0');
  stream.read(content.data(), static_cast<std::streamsize>(size));
  if (static_cast<std::size_t>(stream.gcount()) != size)
    throw InputError(file, "", "could be read only in part");
  return content;
}

void write_file(const fs::path& file, std::string_view content) {
  static std::atomic<unsigned> written_files{0};  // threads may write the same file at once
  const fs::path beside =
      file.parent_path() / ("." + file.filename().string() + "." + std::to_string(::getpid()) +
                            "-" + std::to_string(written_files++) + ".part");
  const auto fail = [&](const char* act) {
    const std::string reason = std::strerror(errno);
    ::unlink(beside.c_str());
    throw MachineError(file.string() + ": " + act + ": " + reason);
  };
  const int descriptor = ::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor < 0) fail("cannot be written");
  while (!content.empty()) {
    const ssize_t written = ::write(descriptor, content.data(), content.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      const int reason = errno;
      ::close(descriptor);
      errno = reason;
      fail("cannot be written");
    }
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  if (::close(descriptor) != 0) fail("cannot be written");
  if (::rename(beside.c_str(), file.c_str()) != 0) fail("cannot be moved into place");
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder))
    throw MachineError(folder.string() + ": the folder cannot be created: " +
                       (error ? error.message() : "a file has this name"));
}

}  // namespace condyle
