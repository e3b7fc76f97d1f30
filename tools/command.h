#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): of a library
class App;
class Option;
}  // namespace CLI

namespace condyle {

/// Options of every command.
struct CommonOptions {
  bool json = false;     // the result as JSON on standard output
  bool quiet = false;    // no progress, notes and summary on standard error
  bool summary = true;   // false: progress alone
  bool verbose = false;  // also what the summary leaves to report.json
  int threads = 2;

  bool prints_summary() const { return summary && !quiet; }
};

/// The commands of the program. Each declares its options next to the function that it runs, which
/// owns their values.
class Commands {
 public:
  /// Returns the program's exit code.
  using Run = std::function<int(const CommonOptions&)>;

  explicit Commands(CLI::App& app) : app_(app) {}

  /// Adds a command of the program, or a subcommand. Its options belong to the group "Basics" until
  /// begin_group().
  CLI::App& add(const char* name, const char* what, const char* example, Run run);
  CLI::App& add_below(CLI::App& parent, const char* name, const char* what, const char* example,
                      Run run);
  /// Adds a command that requires a subcommand.
  CLI::App& add_parent(const char* name, const char* what, const char* example);

  /// Runs the command that was parsed; the first one where none is named.
  int run(const CommonOptions& common) const;

 private:
  CLI::App& app_;
  std::vector<std::pair<CLI::App*, Run>> runs_;
};

/// Puts the options added from now on under this heading of the command's help.
void begin_group(CLI::App& command, const char* name);

/// Restricts the option to numbers in this range, which its help shows; "nan" is refused.
CLI::Option* in_range(CLI::Option* option, double low, double high);

/// A keyword and its value.
template <class T>
using Choices = std::vector<std::pair<std::string, T>>;

/// "left|right|none", for the help of an option.
template <class T>
std::string words_of(const Choices<T>& choices) {
  std::string words;
  for (const auto& [word, value] : choices) words += (words.empty() ? "" : "|") + word;
  return words;
}

/// throws: CLI::ValidationError that lists the known words.
[[noreturn]] void refuse_word(const std::string& option, const std::string& word,
                              const std::string& known);

/// The value of a keyword. throws: CLI::ValidationError.
template <class T>
const T& chosen(const Choices<T>& choices, const std::string& option, const std::string& word) {
  for (const auto& [known, value] : choices)
    if (known == word) return value;
  refuse_word(option, word, words_of(choices));
}

}  // namespace condyle
