#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/case/case.h"
#include "sim/plan/plan.h"
#include "tools/command.h"

/// What the commands of `condyle plan` share. Each declares its options next to its run function.
namespace condyle {

void add_plan_new(Commands& commands, CLI::App& plan);
void add_plan_cut(Commands& commands, CLI::App& plan);
void add_plan_move(Commands& commands, CLI::App& plan);
void add_plan_trim(Commands& commands, CLI::App& plan);
void add_plan_zone(Commands& commands, CLI::App& plan);
void add_plan_occlude(Commands& commands, CLI::App& plan);
void add_plan_edit(Commands& commands, CLI::App& plan);  // in plan_cut.cpp
void add_plan_show(Commands& commands, CLI::App& plan);  // in plan_apply.cpp
void add_plan_apply(Commands& commands, CLI::App& plan);
void add_plan_remove(Commands& commands, CLI::App& plan);  // in plan_steps.cpp, as is the next
void add_plan_reorder(Commands& commands, CLI::App& plan);
void add_plan_note(Commands& commands, CLI::App& plan);
void add_plan_undo(Commands& commands, CLI::App& plan);
void add_plan_redo(Commands& commands, CLI::App& plan);  // in plan_undo.cpp
void add_plan_resect(Commands& commands, CLI::App& plan);
void add_plan_graft(Commands& commands, CLI::App& plan);  // in plan_graft.cpp
void add_plan_compare(Commands& commands, CLI::App& plan);

/// Adds the positional PLAN.
void add_plan_argument(CLI::App& command, std::filesystem::path& file);
/// Adds the positional STEP, the number of a step.
void add_step_argument(CLI::App& command, int& step);
/// Adds --case, the case of the plan; `absent` says what holds without it.
void add_plan_case(CLI::App& command, std::string& patient,
                   const char* absent = "the built-in head that the plan names");

/// The case in the folder, or a built-in head by its name; empty: the built-in head that the plan
/// was made for, else the built-in patient.
Case open_planned(const std::string& patient, const std::optional<Plan>& plan,
                  const CommonOptions& common);

/// The case where it is given, else the built-in head that the plan names; absent where the plan is
/// for another.
std::optional<Case> case_of_plan(const std::string& patient, const Plan& plan,
                                 const CommonOptions& common);

void print_plan_notes(const CommonOptions& common, const std::vector<std::string>& notes);

/// Prints the steps of a plan that was saved, or all of it as JSON.
void print_edited(const Plan& plan, const std::filesystem::path& file, const CommonOptions& common);
/// Saves and prints an edited plan. What the file held before goes to the plan's history; `edit`
/// says what was done, such as "move maxilla".
void finish_edit(const Plan& plan, const std::filesystem::path& file, const std::string& edit,
                 const CommonOptions& common);

/// Refuses a segment that no step makes. Pieces that were imported are known by their names.
/// throws: InputError that lists the known ones.
void check_segment(const Plan& plan, const std::string& segment);

}  // namespace condyle
