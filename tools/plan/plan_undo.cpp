#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "sim/plan/plan_history_file.h"
#include "tools/plan/plan_command.h"

namespace condyle {
namespace {

/// Prints "undone: move maxilla", notes, and the plan as it is now.
int print_reversed(const char* what, const ReversedEdit& reversed,
                   const std::filesystem::path& file, const CommonOptions& common) {
  if (common.prints_summary()) fmt::print(stderr, "{}: {}\n", what, reversed.edit);
  print_edited(reversed.plan, file, common);
  print_plan_notes(common, reversed.notes);
  return 0;
}

}  // namespace

void add_plan_undo(Commands& commands, CLI::App& plan) {
  const auto file = std::make_shared<std::filesystem::path>();
  CLI::App& command =
      commands.add_below(plan, "undo", "Undo the last edit of a plan",
                         "condyle plan undo plan.json", [file](const CommonOptions& common) {
                           return print_reversed("undone", undo_edit(*file), *file, common);
                         });
  add_plan_argument(command, *file);
}

void add_plan_redo(Commands& commands, CLI::App& plan) {
  const auto file = std::make_shared<std::filesystem::path>();
  CLI::App& command =
      commands.add_below(plan, "redo", "Repeat the edit that was undone last",
                         "condyle plan redo plan.json", [file](const CommonOptions& common) {
                           return print_reversed("redone", redo_edit(*file), *file, common);
                         });
  add_plan_argument(command, *file);
}

}  // namespace condyle
