#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "render/window/view/part_menu.h"
#include "render/window/view/ui_commands.h"
#include "render/window/view/view_state.h"

namespace condyle {

/// Text in the number_field being edited.
struct NumberEntry {
  std::string field;
  double number = 0;
};

/// The content of input fields that has not been submitted. Only for this module.
struct PanelFormState {
  std::string motion_words;
  std::map<std::string, double> parameters, excitations;  // being dragged
  bool both_sides = true;                                 // of an expression at once
  struct RecordFields {
    std::string folder;
    bool running = false;  // whether a recording ran in the previous pass
  } record;
  std::string landmark_words, case_folder;
  struct PlanFields {
    int step = 0;          // selected, by id; 0: none
    int with_handles = 0;  // whose handles were requested
    std::string file;
    std::filesystem::path known;                       // the plan's file when `file` was filled
    bool displacements = false, cephalometry = false;  // unfolded tables
  } plan;
  std::optional<NumberEntry> number;
  struct OpenFields {
    bool open = false;
    std::string path;
    std::filesystem::path folder, listed;  // current one; the one that is listed
    std::vector<std::filesystem::path> folders, files;
    std::set<std::size_t> chosen;  // indices of selected files
    bool holds_scan = false;       // the listed folder has DICOM files
    std::size_t anchor = 0;        // start of a Shift+click range
    bool accepted = false;         // Enter: open the selection

    /// Selects a clicked file: it alone; with Ctrl it is toggled, with Shift all up to it are
    /// added.
    void choose(std::size_t file, bool ctrl, bool shift);
    /// The selected files, in the order of the list.
    std::vector<std::filesystem::path> chosen_files() const;
  } files;
  std::optional<PartMenu> part_menu;
  DrawnCut previewed_cut;                 // whose preview was requested
  std::optional<DrawnCut> requested_cut;  // to become a step of the plan
  struct SessionFields {
    bool open = false;
    std::string path;
    bool accepted = false;  // Enter: save
  } session;
  struct CtFields {
    enum class Click { cross, skull, jaw };
    int opened = 0;              // the import that the fields belong to
    CtChoice choice;             // as the user has changed it
    CtChoice asked;              // that was requested last
    int series = 0;              // chosen in the list
    Click click = Click::cross;  // what a click on a slice sets
    std::string folder;          // of the patient
  } ct;
  std::optional<Question> question;
  std::optional<request::Import> import;  // surfaces that wait for their roles
};

}  // namespace condyle
