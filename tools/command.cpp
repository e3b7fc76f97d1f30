#include "tools/command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>

#include "engine/core/error.h"

namespace condyle {
namespace {

CLI::App& new_command(CLI::App& parent, const char* name, const char* what, const char* example) {
  CLI::App* command = parent.add_subcommand(name, what);
  command->footer(
      fmt::format("Example\n  {}\n\nEvery command also takes --json, --quiet, "
                  "--verbose and --threads: condyle --help",
                  example));
  command->group("Commands");
  begin_group(*command, "Basics");
  command->get_help_ptr()->group("Basics");
  return *command;
}

/// "0.5", and 1000000 in full.
std::string number_words(double value) {
  return value == static_cast<double>(static_cast<long>(value))
             ? fmt::format("{}", static_cast<long>(value))
             : fmt::format("{:g}", value);
}

}  // namespace

CLI::App& Commands::add(const char* name, const char* what, const char* example, Run run) {
  return add_below(app_, name, what, example, std::move(run));
}

CLI::App& Commands::add_below(CLI::App& parent, const char* name, const char* what,
                              const char* example, Run run) {
  CLI::App& command = new_command(parent, name, what, example);
  runs_.emplace_back(&command, std::move(run));
  return command;
}

CLI::App& Commands::add_parent(const char* name, const char* what, const char* example) {
  CLI::App& command = new_command(app_, name, what, example);
  command.require_subcommand(1);
  return command;
}

int Commands::run(const CommonOptions& common) const {
  for (const auto& [command, run] : runs_)
    if (command->parsed()) return run(common);
  return runs_.front().second(common);
}

void begin_group(CLI::App& command, const char* name) { command.option_defaults()->group(name); }

CLI::Option* in_range(CLI::Option* option, double low, double high) {
  const std::string first = number_words(low), last = number_words(high);
  option->type_name(first + ".." + last);
  return option->check(CLI::Validator(
      [=](std::string& text) {
        char* end = nullptr;
        const double value = std::strtod(text.c_str(), &end);
        if (end != text.c_str() && *end == '\0' && value >= low && value <= high)
          return std::string();
        return fmt::format("\"{}\" is not a number from {} to {}", text, first, last);
      },
      ""));
}

void refuse_word(const std::string& option, const std::string& word, const std::string& known) {
  throw CLI::ValidationError(option, fmt::format("\"{}\" is unknown; known are {}", word, known));
}

}  // namespace condyle
