#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/plan/plan_history.h"

/// The history of a plan, in a file beside that of the plan. The file of the plan decides: of a
/// command that was interrupted between the two files, the plan is as before it, and its edit can
/// be redone. A history that cannot be read is set aside and never keeps a plan from being edited.
namespace condyle {

/// Format and version stated in a history file.
constexpr const char* plan_history_format = "condyle plan history";
constexpr int plan_history_version = 1;
constexpr std::size_t max_history_bytes = std::size_t{32} << 20;

/// "plan.json.history" of "plan.json".
std::filesystem::path history_file_of(const std::filesystem::path& plan);

/// The text of a history file. The oldest plans, then those undone last, are left out until it has
/// at most `max_bytes`; the present plan stays.
std::string history_json(const PlanHistory& history, std::size_t max_bytes = max_history_bytes);

/// throws: InputError as parse_plan(), naming the file of the history.
PlanHistory parse_history(const std::filesystem::path& file, std::string_view text);

/// Saves an edited plan. What the file held before, also if it was edited by hand, goes to the
/// history; a file that is no plan is set aside. Returns notes for people. throws: InputError for a
/// plan that could not be read back, before anything is written; MachineError for the plan's file.
std::vector<std::string> save_edit(const Plan& next, const std::filesystem::path& file,
                                   const std::string& edit);

/// An edit that was undone or redone, and the plan that the file holds now.
struct ReversedEdit {
  Plan plan;
  std::string edit;
  std::vector<std::string> notes = {};  // for people
};

/// Undoes the last edit. A file that is no plan, or that was deleted, is set aside and replaced by
/// the plan as last saved. throws: InputError if there is nothing to undo; MachineError.
ReversedEdit undo_edit(const std::filesystem::path& file);
/// Repeats the edit that was undone last. throws: InputError if there is none; MachineError.
ReversedEdit redo_edit(const std::filesystem::path& file);

}  // namespace condyle
