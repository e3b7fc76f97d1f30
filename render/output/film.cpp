#include "render/output/film.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/error.h"

extern char** environ;

namespace condyle {
namespace {

std::vector<std::string> words_for(const std::filesystem::path& beside, int width, int height,
                                   double frames_per_second) {
  return {"ffmpeg",
          "-nostdin",
          "-hide_banner",
          "-loglevel",
          "error",
          "-y",
          "-f",
          "rawvideo",
          "-pix_fmt",
          "rgba",
          "-video_size",
          fmt::format("{}x{}", width, height),
          "-framerate",
          fmt::format("{:.6g}", frames_per_second),
          "-i",
          "pipe:0",
          "-vf",
          "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv:flags=+bitexact+"
          "accurate_rnd,format=yuv420p",
          "-colorspace",
          "bt709",
          "-color_primaries",
          "bt709",
          "-color_trc",
          "bt709",
          "-color_range",
          "tv",
          "-c:v",
          "libx264",
          "-preset",
          "veryfast",
          "-crf",
          "18",
          "-threads",
          "2",
          "-filter_threads",
          "1",
          "-fflags",
          "+bitexact",
          "-flags:v",
          "+bitexact",
          "-map_metadata",
          "-1",
          "-movflags",
          "+faststart",
          "-f",
          "mp4",
          "file:" + beside.string()};
}

/// Writes everything; a closed reader is an error of this call, not a signal to the program.
bool write_whole(int pipe, const std::uint8_t* data, std::size_t size) {
  sigset_t broken, before;
  sigemptyset(&broken);
  sigaddset(&broken, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &broken, &before);
  bool whole = true;
  while (size > 0 && whole) {
    const ssize_t done = ::write(pipe, data, size);
    if (done > 0) {
      data += done;
      size -= static_cast<std::size_t>(done);
    } else if (done < 0 && errno != EINTR) {
      whole = false;
      const timespec at_once{};
      while (errno == EPIPE && sigtimedwait(&broken, nullptr, &at_once) < 0 && errno == EINTR) {
      }
    }
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return whole;
}

}  // namespace

struct Film::State {
  std::filesystem::path file, beside;
  pid_t child = 0;
  int pipe = -1;
  std::FILE* words = nullptr;  // output of ffmpeg

  ~State() {
    close_pipe();
    if (child > 0) {
      ::kill(child, SIGKILL);
      wait();
    }
    if (words) std::fclose(words);
    if (!beside.empty()) ::unlink(beside.c_str());
  }

  void close_pipe() {
    if (pipe >= 0) ::close(pipe);
    pipe = -1;
  }

  int wait() {
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    child = 0;
    return status;
  }

  std::string last_words() const {
    std::string last, line;
    std::rewind(words);
    for (int c = std::fgetc(words); c != EOF; c = std::fgetc(words)) {
      if (c != '\n' && c != '\r') {
        if (line.size() < 500) line += static_cast<char>(c);
      } else if (!line.empty()) {
        last = std::exchange(line, {});
      }
    }
    return line.empty() ? last : line;
  }

  /// Waits for the end and returns the error, if any.
  std::string outcome() {
    const int status = wait();
    if (WIFSIGNALED(status))
      return "ffmpeg was stopped by signal " + std::to_string(WTERMSIG(status));
    if (WEXITSTATUS(status) == 0) return {};
    const std::string said = last_words();
    return "ffmpeg reports: " +
           (said.empty() ? "nothing, exit code " + std::to_string(WEXITSTATUS(status)) : said);
  }
};

Film::Film(const std::filesystem::path& file, int width, int height, double frames_per_second)
    : state_(std::make_unique<State>()) {
  auto& s = *state_;
  s.file = std::filesystem::absolute(file);
  s.words = std::tmpfile();
  int ends[2];
  if (!s.words || ::pipe2(ends, O_CLOEXEC) != 0)
    throw MachineError(std::string("no pipe to ffmpeg: ") + std::strerror(errno));
  s.pipe = ends[1];
  const auto beside = s.file.parent_path() / ("." + s.file.filename().string() + "." +
                                              std::to_string(::getpid()) + ".part");
  const auto words = words_for(beside, width, height, frames_per_second);
  std::vector<char*> arguments;
  for (const auto& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[0], 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ::fileno(s.words), 2);
  const int refused =
      ::posix_spawnp(&s.child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[0]);
  if (refused != 0) {
    s.child = 0;
    throw MachineError(std::string("the program ffmpeg cannot be started (") +
                       std::strerror(refused) + ")");
  }
  s.beside = beside;
}

Film::~Film() = default;

void Film::add(const Image& picture) {
  auto& s = *state_;
  if (s.pipe >= 0 && write_whole(s.pipe, picture.rgba.data(), picture.rgba.size())) return;
  const std::string pipe_trouble = std::strerror(errno);
  s.close_pipe();
  const std::string said = s.child > 0 ? s.outcome() : std::string();
  throw MachineError(said.empty() ? "ffmpeg accepts no more pictures: " + pipe_trouble : said);
}

void Film::finish() {
  auto& s = *state_;
  s.close_pipe();
  const std::string trouble = s.outcome();
  if (!trouble.empty()) throw MachineError(trouble);
  if (::rename(s.beside.c_str(), s.file.c_str()) != 0)
    throw MachineError(std::string("it cannot be moved into place: ") + std::strerror(errno));
  s.beside.clear();
}

}  // namespace condyle
