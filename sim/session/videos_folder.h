#pragma once

#include <filesystem>
#include <string>

namespace condyle {

/// A folder for new recordings, and what it is: "your videos folder".
struct VideosFolder {
  std::filesystem::path folder;
  std::string what;
};

/// The user's videos folder: XDG_VIDEOS_DIR of user-dirs.dirs, else ~/Videos where it exists, else
/// the home folder; the current folder without a home.
VideosFolder videos_folder();

}  // namespace condyle
