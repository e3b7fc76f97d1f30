#include "tests/support/display.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

namespace condyle {

bool has_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((std::filesystem::path(folder) / name).c_str(), X_OK) == 0) return true;
  return false;
}

TestDisplay::TestDisplay(int width, int height) {
  std::string folder = (std::filesystem::temp_directory_path() / "condyle-screen-XXXXXX").string();
  if (mkdtemp(folder.data())) folder_ = folder;
  const std::string screen = std::to_string(width) + "x" + std::to_string(height) + "x24";
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return;
  const pid_t parent = getpid();
  const std::string report_to = std::to_string(ends[1]);
  process_ = fork();
  if (process_ == 0) {
    // The screen ends with the test, however that ends.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);
    fcntl(ends[1], F_SETFD, 0);  // this end stays open across exec
    const int nothing = open("/dev/null", O_WRONLY);
    dup2(nothing, 1);
    dup2(nothing, 2);
    execlp("Xvfb", "Xvfb", "-displayfd", report_to.c_str(), "-screen", "0", screen.c_str(),
           "-fbdir", folder_.c_str(), "+extension", "GLX", "-nolisten", "tcp", "-noreset",
           static_cast<char*>(nullptr));
    _exit(127);
  }
  close(ends[1]);
  // Xvfb writes its number and a line end when it is ready.
  std::string number;
  char letter = 0;
  pollfd waiting{ends[0], POLLIN, 0};
  while (poll(&waiting, 1, 20000) > 0 && read(ends[0], &letter, 1) == 1 && letter != '\n')
    number += letter;
  close(ends[0]);
  if (number.empty() || letter != '\n') {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    process_ = -1;
    return;
  }
  setenv("DISPLAY", (":" + number).c_str(), 1);
}

TestDisplay::~TestDisplay() {
  if (process_ > 0) {
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
    unsetenv("DISPLAY");
  }
  std::error_code ignored;
  if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

test::Picture TestDisplay::picture() const {
  // An XWD file: a head of big-endian 32-bit numbers, a table of colours, rows of BGRX.
  std::ifstream file(folder_ / "Xvfb_screen0", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  const auto number = [&](std::size_t which) {
    std::uint32_t value = 0;
    for (std::size_t i = 4 * which; i < 4 * which + 4; ++i)
      value = value << 8 | static_cast<unsigned char>(bytes[i]);
    return std::size_t{value};
  };
  constexpr std::size_t head_numbers = 25, colour_bytes = 12;
  test::Picture picture;
  if (bytes.size() < 4 * head_numbers) return picture;
  const std::size_t width = number(4), height = number(5), row_bytes = number(12),
                    start = number(0) + colour_bytes * number(19);
  if (bytes.size() < start + row_bytes * height || row_bytes < 4 * width) return picture;
  picture.width = static_cast<int>(width);
  picture.height = static_cast<int>(height);
  picture.rgba.reserve(4 * width * height);
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x) {
      const auto* pixel =
          reinterpret_cast<const std::uint8_t*>(&bytes[start + y * row_bytes + 4 * x]);
      picture.rgba.insert(picture.rgba.end(), {pixel[2], pixel[1], pixel[0], 255});
    }
  return picture;
}

bool xdotool(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "xdotool");
  std::vector<char*> raw;
  for (std::string& argument : arguments) raw.push_back(argument.data());
  raw.push_back(nullptr);
  pid_t process = -1;
  if (posix_spawnp(&process, "xdotool", nullptr, nullptr, raw.data(), environ) != 0) return false;
  int status = 0;
  return waitpid(process, &status, 0) == process && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace condyle
