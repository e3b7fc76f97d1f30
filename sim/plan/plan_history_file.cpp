#include "sim/plan/plan_history_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "sim/case/json_file.h"
#include "sim/plan/plan_file.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;
using Notes = std::vector<std::string>;

constexpr const char* by_hand = "edit by hand";

/// Renames a damaged file to the first free name. Returns whether it is out of the way.
bool set_aside(const fs::path& file, const std::string& reason, Notes& notes) {
  std::error_code error;
  fs::path aside;
  for (int i = 1; i == 1 || fs::exists(fs::symlink_status(aside, error)); ++i) {
    aside = file;
    aside += i == 1 ? ".damaged" : fmt::format(".damaged-{}", i);
  }
  fs::rename(file, aside, error);
  notes.push_back(
      error ? fmt::format("{}; it cannot be moved: {}", reason, error.message())
            : fmt::format("{}; it is set aside as {}", reason, aside.filename().string()));
  return !error;
}

bool is_there(const fs::path& file) {
  std::error_code ignored;
  return fs::exists(fs::symlink_status(file, ignored));
}

/// A plan's file and the history beside it, as they are found.
struct FoundHistory {
  std::optional<Plan> plan;  // absent: the file is missing, or no plan
  std::string problem;       // of that file
  std::optional<PlanHistory> history;
  bool can_be_written = true;
};

/// The history beside the file, with what the file holds as its present plan.
FoundHistory find_history(const fs::path& file, Notes& notes) {
  FoundHistory found;
  try {
    found.plan = load_plan(file);
  } catch (const InputError& error) {
    found.problem = error.what();
  }
  const fs::path beside = history_file_of(file);
  if (is_there(beside)) {
    try {
      found.history = parse_history(beside, read_file(beside, max_history_bytes));
      if (found.plan && !found.history->step_to(*found.plan)) {
        if (found.plan->geometry.parts != found.history->plan().geometry.parts)
          throw InputError(beside, "", "is the history of a plan for another case");
        found.history->edit(*found.plan, by_hand);
      }
    } catch (const InputError& error) {
      found.history.reset();
      found.can_be_written = set_aside(beside, error.what(), notes);
    }
  }
  if (!found.history && found.plan) found.history.emplace(*found.plan);
  return found;
}

/// Writes the history first: if the program ends before the plan is written, the plan is the one
/// before the present one of the history, or after it.
void write_both(const FoundHistory& found, const std::string& plan, const fs::path& file,
                Notes& notes) {
  if (found.history && found.can_be_written) {
    try {
      write_file(history_file_of(file), history_json(*found.history));
    } catch (const MachineError& error) {
      notes.push_back(fmt::format("the history of the plan is not saved: {}", error.what()));
    }
  }
  write_file(file, plan);
}

/// A problem, and what was found on the way.
InputError refusal(const std::string& problem, const Notes& notes) {
  return InputError(
      fmt::format("{}{}{}", problem, notes.empty() ? "" : "; ", fmt::join(notes, "; ")));
}

ReversedEdit reverse_edit(const fs::path& file, FoundHistory& found, Notes notes, bool undo) {
  const auto edit = undo ? found.history->undo() : found.history->redo();
  if (!edit)
    throw refusal(file.string() + ": there is nothing to " + (undo ? "undo" : "redo"), notes);
  const Plan& plan = found.history->plan();
  write_both(found, checked_plan_json(plan, file), file, notes);
  return {plan, *edit, std::move(notes)};
}

}  // namespace

fs::path history_file_of(const fs::path& plan) {
  fs::path file = plan;
  file += ".history";
  return file;
}

std::string history_json(const PlanHistory& history, std::size_t max_bytes) {
  std::vector<std::string> texts;
  std::size_t size = 200;  // of the first lines and the last
  for (const auto& entry : history.entries()) {
    const nlohmann::json edit = entry.edit;
    texts.push_back(
        "{\"edit\": " + edit.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) +
        ", \"plan\": " + plan_json(entry.plan) + "}");
    size += texts.back().size() + 2;
  }
  std::size_t first = 0, end = texts.size();
  while (size > max_bytes && end - first > 1)
    size -= 2 + (first < history.now() ? texts[first++] : texts[--end]).size();
  std::string text =
      fmt::format("{{\"format\": \"{}\", \"version\": {}, \"now\": {},\n\"plans\": [\n",
                  plan_history_format, plan_history_version, history.now() - first);
  for (std::size_t i = first; i < end; ++i) text += texts[i] + (i + 1 < end ? ",\n" : "\n");
  return text + "]}\n";
}

PlanHistory parse_history(const fs::path& file, std::string_view text) {
  const JsonFile json(file, text);
  const JsonItem root = json.root();
  if (root.at("format").text() != plan_history_format)
    root.at("format").refuse("is \"" + root.at("format").text().substr(0, 40) +
                             "\"; the file is no history of a plan");
  constexpr int most = std::numeric_limits<int>::max();
  const int version = root.at("version").integer(1, most);
  if (version > plan_history_version)
    root.at("version").refuse(fmt::format("is {}; this program reads histories up to version {}",
                                          version, plan_history_version));
  root.only_keys({"format", "version", "now", "plans"});
  const JsonItem plans = root.at("plans");
  std::vector<PlanHistory::Entry> entries;
  for (std::size_t i = 0; i < plans.size(); ++i) {
    const JsonItem item = plans.at(i);
    item.only_keys({"edit", "plan"});
    entries.push_back({parse_plan(file, item.at("plan").value().dump()), item.at("edit").text()});
  }
  const int now = root.at("now").integer(0, most);
  try {
    return {std::move(entries), static_cast<std::size_t>(now)};
  } catch (const InputError& error) {
    throw InputError(file, "now", error.what());
  }
}

Notes save_edit(const Plan& next, const fs::path& file, const std::string& edit) {
  const std::string text = checked_plan_json(next, file);
  Notes notes;
  FoundHistory found = find_history(file, notes);
  if (!found.plan && is_there(file)) set_aside(file, found.problem, notes);
  if (found.history) found.history->edit(next, edit);
  write_both(found, text, file, notes);
  return notes;
}

ReversedEdit undo_edit(const fs::path& file) {
  Notes notes;
  FoundHistory found = find_history(file, notes);
  if (!found.history) throw refusal(found.problem, notes);
  if (found.plan) return reverse_edit(file, found, std::move(notes), true);
  if (is_there(file) && !set_aside(file, found.problem, notes)) throw InputError(notes.back());
  const Plan& plan = found.history->plan();
  write_file(file, checked_plan_json(plan, file));
  return {plan, by_hand, std::move(notes)};
}

ReversedEdit redo_edit(const fs::path& file) {
  Notes notes;
  FoundHistory found = find_history(file, notes);
  if (!found.plan) throw refusal(found.problem, notes);
  return reverse_edit(file, found, std::move(notes), false);
}

}  // namespace condyle
