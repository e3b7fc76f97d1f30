#pragma once

#include <filesystem>
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
void add_plan_show(Commands& commands, CLI::App& plan);  // in plan_apply.cpp
void add_plan_apply(Commands& commands, CLI::App& plan);
void add_plan_remove(Commands& commands, CLI::App& plan);  // in plan_steps.cpp
void add_plan_compare(Commands& commands, CLI::App& plan);

/// Adds the positional PLAN.
void add_edited_plan(CLI::App& command, std::filesystem::path& file);
/// Adds --case, the case of the plan; `absent` says what holds without it.
void add_plan_case(CLI::App& command, std::string& patient,
                   const char* absent = "the built-in patient");

/// The case in the folder, or a built-in head by its name; empty: the built-in patient.
Case open_planned(const std::string& patient, const CommonOptions& common);

void print_plan_notes(const CommonOptions& common, const std::vector<std::string>& notes);

/// Saves an edited plan, and prints its steps, or all of it as JSON.
void finish_edit(const Plan& plan, const std::filesystem::path& file, const CommonOptions& common);

/// Refuses a segment that no step makes. Pieces that were imported are known by their names.
/// throws: InputError that lists the known ones.
void check_segment(const Plan& plan, const std::string& segment);

}  // namespace condyle
