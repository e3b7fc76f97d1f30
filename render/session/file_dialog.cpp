#include "render/session/file_dialog.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <utility>

#include "engine/core/error.h"

extern char** environ;

namespace condyle {
namespace fs = std::filesystem;
namespace {

using Purpose = request::Browse::Purpose;

constexpr std::size_t most_words = std::size_t{1} << 20;  // of the answer, bytes
constexpr const char* openable =
    "*.condyle-session case.json *.mrk.json *.json *.stl *.ply *.obj *.glb *.gltf *.csv *.motion "
    "*.mot *.sto *.trc *.raw *.txt *.nrrd *.nhdr *.mha *.mhd *.nii *.nii.gz *.dcm *.DCM";

fs::path in_search_path(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path file = fs::path(folder.empty() ? "." : folder) / name;
    std::error_code ignored;
    if (fs::is_regular_file(file, ignored) && ::access(file.c_str(), X_OK) == 0) return file;
  }
  return {};
}

const char* title_of(Purpose purpose) {
  switch (purpose) {
    case Purpose::open:
      return "Open a session, a patient, a motion, surfaces or a scan";
    case Purpose::save_session:
      return "Save the session";
    case Purpose::record_folder:
      return "Folder for the recording";
  }
  return "";
}

}  // namespace

fs::path FileDialog::program() {
  const char* desktop = std::getenv("XDG_CURRENT_DESKTOP");
  const bool is_kde = desktop && std::string(desktop).find("KDE") != std::string::npos;
  for (const char* name : {is_kde ? "kdialog" : "zenity", "zenity", "qarma", "kdialog"})
    if (fs::path file = in_search_path(name); !file.empty()) return file;
  return {};
}

std::vector<std::string> dialog_arguments(const fs::path& program, const request::Browse& asked) {
  const std::string title = std::string("--title=") + title_of(asked.purpose);
  const std::string start = asked.start.string();
  if (program.filename() == "kdialog") {
    const std::string kde_title = title_of(asked.purpose);
    if (asked.purpose == Purpose::record_folder)
      return {"--title", kde_title, "--getexistingdirectory", start};
    if (asked.purpose == Purpose::save_session)
      return {"--title", kde_title, "--getsavefilename", start, "*.condyle-session"};
    return {"--title",           kde_title, "--multiple", "--separate-output",
            "--getopenfilename", start,     openable};
  }
  std::vector<std::string> words = {"--file-selection", title, "--filename=" + start};
  if (asked.purpose == Purpose::record_folder) words.emplace_back("--directory");
  if (asked.purpose == Purpose::save_session)
    words.insert(words.end(),
                 {"--save", "--confirm-overwrite", "--file-filter=Sessions | *.condyle-session"});
  if (asked.purpose == Purpose::open)
    words.insert(words.end(), {"--multiple", "--separator=\n",
                               std::string("--file-filter=Known files | ") + openable,
                               "--file-filter=All files | *"});
  return words;
}

FileDialog::~FileDialog() {
  if (child_ > 0) {
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
  }
  if (pipe_ >= 0) ::close(pipe_);
}

void FileDialog::show(const request::Browse& asked) {
  if (open()) return;
  const fs::path dialog = program();
  if (dialog.empty()) throw MachineError("the desktop has no file dialog: install zenity");
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    throw MachineError(std::string("no pipe to the file dialog: ") + std::strerror(errno));
  ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  std::vector<std::string> words = dialog_arguments(dialog, asked);
  words.insert(words.begin(), dialog.string());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
  posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
  const int error =
      ::posix_spawn(&child_, dialog.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (error != 0) {
    ::close(ends[0]);
    child_ = -1;
    throw MachineError(dialog.string() + " cannot be started: " + std::strerror(error));
  }
  pipe_ = ends[0];
  asked_ = asked;
  words_.clear();
}

void FileDialog::read_more() {
  char buffer[4096];
  for (ssize_t got = 0; (got = ::read(pipe_, buffer, sizeof buffer)) > 0;)
    if (words_.size() < most_words) words_.append(buffer, static_cast<std::size_t>(got));
}

std::optional<FileDialog::Answer> FileDialog::take() {
  if (!open()) return std::nullopt;
  read_more();
  int status = 0;
  if (::waitpid(child_, &status, WNOHANG) != child_) return std::nullopt;
  read_more();
  child_ = -1;
  ::close(std::exchange(pipe_, -1));
  Answer answer{.asked = asked_};
  constexpr int cancelled = 1;
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  if (code != 0 && code != cancelled)
    answer.trouble = fmt::format("{} ended with {}", program().string(),
                                 code < 0 ? "a signal" : fmt::format("code {}", code));
  if (code != 0) return answer;
  std::istringstream lines(words_);
  for (std::string line; std::getline(lines, line);)
    if (!line.empty()) answer.files.emplace_back(line);
  return answer;
}

}  // namespace condyle
