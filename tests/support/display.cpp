#include "tests/support/display.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>

namespace condyle {

bool has_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((std::filesystem::path(folder) / name).c_str(), X_OK) == 0) return true;
  return false;
}

TestDisplay::TestDisplay() {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return;
  const pid_t parent = getpid();
  const std::string report_to = std::to_string(ends[1]);
  process_ = fork();
  if (process_ == 0) {
    // The screen goes when the test goes, however it ends.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);
    fcntl(ends[1], F_SETFD, 0);  // this end stays open across exec
    const int nothing = open("/dev/null", O_WRONLY);
    dup2(nothing, 1);
    dup2(nothing, 2);
    execlp("Xvfb", "Xvfb", "-displayfd", report_to.c_str(), "-screen", "0", "1280x720x24",
           "+extension", "GLX", "-nolisten", "tcp", "-noreset", static_cast<char*>(nullptr));
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
  if (process_ <= 0) return;
  kill(process_, SIGTERM);
  waitpid(process_, nullptr, 0);
  unsetenv("DISPLAY");
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
