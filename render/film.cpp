#include "render/film.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include "engine/core/error.h"

extern char** environ;

namespace condyle {
namespace {

struct Outcome {
  int status = 0;          // of waitpid
  std::string last_words;  // last line of standard error
};

/// Runs a program without a shell in `folder`, its standard error read to the end.
/// throws: MachineError when it cannot be started.
Outcome run_in(const std::filesystem::path& folder, const std::vector<std::string>& words) {
  std::vector<char*> arguments;
  for (const auto& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  int pipe_ends[2];
  if (::pipe2(pipe_ends, O_CLOEXEC) != 0)
    throw MachineError(std::string("no pipe to ffmpeg: ") + std::strerror(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, pipe_ends[1], 2);
  pid_t child = 0;
  const int refused =
      ::posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(pipe_ends[1]);
  if (refused != 0) {
    ::close(pipe_ends[0]);
    throw MachineError(std::string("the program ffmpeg cannot be started (") +
                       std::strerror(refused) + ")");
  }
  Outcome outcome;
  std::string line;
  char block[4096];
  for (;;) {
    const ssize_t size = ::read(pipe_ends[0], block, sizeof block);
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) break;
    for (ssize_t i = 0; i < size; ++i) {
      if (block[i] != '\n' && block[i] != '\r') {
        if (line.size() < 500) line += block[i];
      } else {
        if (!line.empty()) outcome.last_words = line;
        line.clear();
      }
    }
  }
  if (!line.empty()) outcome.last_words = line;
  ::close(pipe_ends[0]);
  while (::waitpid(child, &outcome.status, 0) < 0 && errno == EINTR) {
  }
  return outcome;
}

}  // namespace

void make_film(const std::filesystem::path& folder, const std::filesystem::path& film, int frames,
               double frames_per_second) {
  const auto beside = std::filesystem::absolute(film).parent_path() /
                      ("." + film.filename().string() + "." + std::to_string(::getpid()) + ".part");
  // The frames are named relative to the folder, for a % in its own name would be read as a number.
  const std::vector<std::string> words = {
      "ffmpeg",
      "-nostdin",
      "-hide_banner",
      "-loglevel",
      "error",
      "-y",
      "-f",
      "image2",
      "-framerate",
      fmt::format("{:.6g}", frames_per_second),
      "-start_number",
      "0",
      "-i",
      "frames/%06d.png",
      "-frames:v",
      std::to_string(frames),
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
  const auto fail = [&](const std::string& reason) {
    ::unlink(beside.c_str());
    throw MachineError(film.string() + ": no film was made: " + reason + "; the frames in " +
                       (folder / "frames").string() +
                       " are whole: install ffmpeg ('apt-get install ffmpeg') or mend the cause, "
                       "then go on with --resume");
  };
  Outcome outcome;
  try {
    outcome = run_in(folder, words);
  } catch (const MachineError& error) {
    fail(error.what());
  }
  if (WIFSIGNALED(outcome.status))
    fail("ffmpeg was stopped by signal " + std::to_string(WTERMSIG(outcome.status)));
  if (WEXITSTATUS(outcome.status) != 0)
    fail("ffmpeg says: " +
         (outcome.last_words.empty()
              ? "nothing, exit code " + std::to_string(WEXITSTATUS(outcome.status))
              : outcome.last_words));
  if (::rename(beside.c_str(), film.c_str()) != 0)
    fail(std::string("it cannot be put in place: ") + std::strerror(errno));
}

}  // namespace condyle
