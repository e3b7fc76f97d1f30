#include "sim/session/videos_folder.h"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <string_view>

#include "engine/core/files.h"

namespace condyle {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t largest_dirs_file = std::size_t{1} << 16;

std::optional<fs::path> absolute_variable(const char* name) {
  const char* value = std::getenv(name);
  if (!value || !fs::path(value).is_absolute()) return std::nullopt;
  return fs::path(value);
}

/// The value of a line XDG_VIDEOS_DIR="$HOME/Videos", in which a backslash quotes a character. By
/// the specification it begins with $HOME/ or /.
std::optional<fs::path> value_of(std::string_view line, const fs::path& home) {
  constexpr std::string_view key = "XDG_VIDEOS_DIR=\"";
  line.remove_prefix(std::min(line.size(), line.find_first_not_of(" \t")));
  if (!line.starts_with(key)) return std::nullopt;
  std::string value;
  bool is_closed = false;
  for (std::size_t i = key.size(); i < line.size() && !is_closed; ++i) {
    if (line[i] == '\\' && i + 1 < line.size())
      value += line[++i];
    else if (line[i] == '"')
      is_closed = true;
    else
      value += line[i];
  }
  if (!is_closed) return std::nullopt;
  if (value.starts_with("$HOME/")) return home / fs::path(value.substr(6));
  if (value == "$HOME") return home;
  return value.starts_with('/') ? std::optional<fs::path>(value) : std::nullopt;
}

std::optional<fs::path> named_folder(const fs::path& home) {
  const fs::path config = absolute_variable("XDG_CONFIG_HOME").value_or(home / ".config");
  std::optional<fs::path> folder;
  try {
    std::istringstream lines(read_file(config / "user-dirs.dirs", largest_dirs_file));
    for (std::string line; std::getline(lines, line);)
      if (const auto value = value_of(line, home))
        folder = value;              // as in a shell, the last counts
  } catch (const std::exception&) {  // no such file
  }
  return folder;
}

}  // namespace

VideosFolder videos_folder() {
  const auto home = absolute_variable("HOME");
  if (!home) return {".", "the current folder"};
  const auto named = named_folder(*home);
  // The home folder itself means that there is no videos folder.
  if (named && named->lexically_normal() != (*home / "").lexically_normal() &&
      named->lexically_normal() != home->lexically_normal())
    return {named->lexically_normal(), "your videos folder"};
  std::error_code ignored;
  if (fs::is_directory(*home / "Videos", ignored)) return {*home / "Videos", "your videos folder"};
  return {*home, "your home folder"};
}

}  // namespace condyle
