#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "render/window/view/ui_commands.h"

namespace condyle {

/// In the number_field that is written in.
struct NumberEntry {
  std::string field;
  double number = 0;
};

/// The content of input fields that has not been submitted. Only for this module.
struct PanelFormState {
  std::string motion_words;
  std::map<std::string, double> parameters, excitations;  // under the mouse
  struct RecordFields {
    std::string folder;
    bool running = false;  // a recording, in the pass before
  } record;
  std::string landmark_words, case_folder;
  std::optional<NumberEntry> number;
  struct OpenFields {
    bool open = false;
    std::string path;
    std::filesystem::path folder, listed;  // open; and the one that is listed
    std::vector<std::filesystem::path> folders, files;
    std::set<std::size_t> chosen;  // of the files
    std::size_t anchor = 0;        // where Shift+click begins
    bool accepted = false;         // Enter: what is chosen shall be opened

    /// A click on a file: it alone, with Ctrl it too or not any more, with Shift all up to it.
    void choose(std::size_t file, bool ctrl, bool shift);
    /// Those that are chosen, in the order of the list.
    std::vector<std::filesystem::path> chosen_files() const;
  } files;
  std::optional<Question> question;
  std::optional<request::Import> import;  // surfaces that wait for their roles
};

}  // namespace condyle
