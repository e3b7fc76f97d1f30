#include "engine/dicom/isolated.h"

#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "engine/core/error.h"

namespace condyle {
namespace {

constexpr std::size_t spare_memory = std::size_t{1} << 28;
constexpr rlim_t most_seconds = 60;
constexpr std::size_t longest_messages = 4096;

/// Memory that a process shares with its copies.
class SharedBuffer {
 public:
  explicit SharedBuffer(std::size_t size) : size_(size) {
    begin_ = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (begin_ == MAP_FAILED) throw MachineError("no memory to decompress a slice");
  }
  ~SharedBuffer() { ::munmap(begin_, size_); }
  SharedBuffer(const SharedBuffer&) = delete;
  SharedBuffer& operator=(const SharedBuffer&) = delete;
  char* begin() const { return static_cast<char*>(begin_); }

 private:
  void* begin_;
  std::size_t size_;
};

/// A file in memory for what the copy prints.
class MessageFile {
 public:
  MessageFile() : descriptor_(::memfd_create("messages", MFD_CLOEXEC)) {
    if (descriptor_ < 0)
      throw MachineError(std::string("no memory for messages: ") + std::strerror(errno));
  }
  ~MessageFile() { ::close(descriptor_); }
  MessageFile(const MessageFile&) = delete;
  MessageFile& operator=(const MessageFile&) = delete;
  int descriptor() const { return descriptor_; }
  std::string text() const {
    std::string text(longest_messages, '\0');
    const ssize_t count = ::pread(descriptor_, text.data(), text.size(), 0);
    text.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    return text;
  }

 private:
  int descriptor_;
};

std::size_t memory_of_this_process() {
  std::size_t pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%zu", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

void limit(int resource, rlim_t value) {
  const struct rlimit limits { value, value };
  ::setrlimit(static_cast<__rlimit_resource>(resource), &limits);
}

/// In the copy.
[[noreturn]] void run_and_exit(const std::function<bool(char*)>& work, char* buffer, int messages,
                               std::size_t memory) {
  ::dup2(messages, STDOUT_FILENO);
  ::dup2(messages, STDERR_FILENO);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, most_seconds);
  if (memory > 0) limit(RLIMIT_AS, memory);
  bool done = false;
  try {
    done = work(buffer);
  } catch (...) {
    done = false;
  }
  ::_exit(done ? 0 : 1);
}

}  // namespace

std::optional<IsolatedResult> run_isolated(std::size_t size,
                                           const std::function<bool(char*)>& work) {
  const SharedBuffer buffer(size);
  const MessageFile messages;
  const std::size_t present = memory_of_this_process();
  const std::size_t memory = present > 0 ? present + 4 * size + spare_memory : 0;
  const pid_t copy = ::fork();
  if (copy < 0)
    throw MachineError(std::string("no process can be started: ") + std::strerror(errno));
  if (copy == 0) run_and_exit(work, buffer.begin(), messages.descriptor(), memory);
  int status = 0;
  while (::waitpid(copy, &status, 0) < 0)
    if (errno != EINTR)
      throw MachineError(std::string("a process was lost: ") + std::strerror(errno));
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return std::nullopt;
  return IsolatedResult{std::string(buffer.begin(), size), messages.text()};
}

}  // namespace condyle
