#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "render/window/wishes.h"

namespace condyle {

/// What stands in fields and is not asked for yet. Only for this room.
struct Drafts {
  std::string motion_words;
  std::map<std::string, double> parameters, excitations;  // under the mouse
  struct RecordFields {
    std::string folder;
    int height = 1080;
    double frames_per_second = 30;
    bool film = true, turntable = false;
    bool running = false;  // a recording, in the pass before
  } record;
  std::string landmark_words, case_folder;
  struct OpenFields {
    bool open = false;
    std::string path;
    std::filesystem::path folder, listed;  // looked into; and the one that is listed
    std::vector<std::filesystem::path> folders, files;
  } files;
  std::optional<wish::Import> import;  // surfaces that wait for their roles
};

}  // namespace condyle
