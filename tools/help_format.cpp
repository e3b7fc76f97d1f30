#include "tools/help_format.h"

#include <CLI/CLI.hpp>
#include <sstream>
#include <utility>

namespace condyle {
namespace {

constexpr std::size_t line_width = 90, name_width = 28;

/// Wraps a text between words to lines of `width` characters; each but the first begins with
/// `indent` spaces.
std::string wrapped(const std::string& text, std::size_t width, std::size_t indent) {
  std::istringstream words(text);
  std::string out, line;
  for (std::string word; words >> word;) {
    if (!line.empty() && line.size() + 1 + word.size() > width) {
      out += line + "\n" + std::string(indent, ' ');
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return out + line;
}

class HelpFormat : public CLI::Formatter {
 public:
  HelpFormat() {
    column_width(name_width);
    label("Positionals", "Arguments");
    label("SUBCOMMAND", "COMMAND");
  }

  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    std::string text = CLI::Formatter::make_help(app, std::move(name), mode);
    for (std::size_t at = 0; (at = text.find("\n\n\n", at)) != std::string::npos;)
      text.erase(at, 1);
    return text.substr(0, text.find_last_not_of('\n') + 1) + "\n";
  }

  std::string make_description(const CLI::App* app) const override {
    return wrapped(app->get_description(), line_width, 0) + "\n\n";
  }

  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    return row(make_option_name(option, is_positional) + make_option_opts(option),
               option->get_description());
  }

  std::string make_option_opts(const CLI::Option* option) const override {
    std::string words;
    if (option->get_type_size() != 0 && !option->get_positional())
      words = " " + value_of(option->get_type_name());
    if (option->get_expected_max() == CLI::detail::expected_max_vector_size) words += " ...";
    return option->get_required() ? words + " (required)" : words;
  }

  std::string make_subcommand(const CLI::App* command) const override {
    return row(command->get_display_name(true), command->get_description());
  }

 private:
  /// The library's names of C++ types.
  static std::string value_of(const std::string& type) {
    if (type == "FLOAT") return "NUMBER";
    if (type == "INT" || type == "UINT") return "N";
    return type;
  }

  static std::string row(const std::string& name, const std::string& what) {
    const std::string start = "  " + name;
    const std::string text = wrapped(what, line_width - name_width, name_width);
    const std::string gap = start.size() + 2 <= name_width
                                ? std::string(name_width - start.size(), ' ')
                                : "\n" + std::string(name_width, ' ');
    return text.empty() ? start + "\n" : start + gap + text + "\n";
  }
};

}  // namespace

std::shared_ptr<CLI::FormatterBase> help_format() { return std::make_shared<HelpFormat>(); }

}  // namespace condyle
