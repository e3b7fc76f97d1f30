#include "tests/tools/source_tree.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>

#include "tests/support/places.h"
#include "tests/support/program.h"

namespace condyle::test {
namespace fs = std::filesystem;
namespace {

const fs::path top = source_folder();

SourceFile source_file(const fs::path& path) {
  static const std::regex include("^\\s*#\\s*include\\s*([\"<])([^\">]+)[\">]");
  const fs::path from_top = fs::relative(path, top);
  SourceFile file{
      from_top.generic_string(), from_top.parent_path().generic_string(), read_text(path), {}, {}};
  std::istringstream lines(file.text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (!std::regex_search(line, match, include)) continue;
    (match[1] == "\"" ? file.quoted_includes : file.angle_includes).push_back(match[2]);
  }
  return file;
}

std::vector<std::string> words(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

/// The arguments of each call of a CMake command, in the order of the file.
std::vector<std::vector<std::string>> calls(const std::string& cmake, const std::string& command) {
  std::vector<std::vector<std::string>> found;
  const std::regex call("(^|\\n)\\s*" + command + "\\(([^)]*)\\)");
  for (std::sregex_iterator i(cmake.begin(), cmake.end(), call), end; i != end; ++i)
    found.push_back(words((*i)[2]));
  return found;
}

void collect(const std::map<std::string, Module>& all, const std::string& target,
             std::set<std::string>& reachable) {
  if (!reachable.insert(target).second) return;
  const auto module = all.find(target);
  if (module == all.end()) return;
  for (const auto& link : module->second.links) collect(all, link, reachable);
}

/// The text with comments, strings and characters replaced by spaces; line ends stay.
std::string code_alone(const std::string& text) {
  static const std::regex other(
      "//[^\\n]*|/\\*[^]*?\\*/|R\"([^(\\s]*)\\([^]*?\\)\\1\"|\"(\\\\.|[^\"\\\\\\n])*\"|"
      "\\b\\d[\\d']*|'(\\\\.|[^'\\\\\\n])+'",
      std::regex::ECMAScript | std::regex::optimize);
  std::string code = text;
  for (std::sregex_iterator i(text.begin(), text.end(), other), end; i != end; ++i)
    for (auto at = i->position(); at < i->position() + i->length(); ++at)
      if (char& c = code[static_cast<std::size_t>(at)]; c != '\n') c = ' ';
  return code;
}

/// Whether a brace after `head`, the text since the last brace or semicolon, opens a function.
bool opens_function(const std::string& head, bool after_brace) {
  static const std::regex signature(
      "\\)\\s*(const|noexcept|override|final|mutable|try|->[\\w:<>&\\s*,]+|:[^:][^]*\\))*\\s*$");
  const bool blank = head.find_first_not_of(" \n") == std::string::npos;
  if (blank) return after_brace;  // a constructor whose last member is initialized with braces
  return std::regex_search(head, signature);
}

}  // namespace

std::vector<SourceFile> source_files(const std::vector<std::string>& roots) {
  std::vector<SourceFile> found;
  for (const auto& root : roots)
    for (const auto& entry : fs::recursive_directory_iterator(top / root)) {
      const auto extension = entry.path().extension();
      if (extension == ".h" || extension == ".cpp" || extension == ".inc")
        found.push_back(source_file(entry.path()));
    }
  std::sort(found.begin(), found.end(),
            [](const SourceFile& a, const SourceFile& b) { return a.path < b.path; });
  return found;
}

std::map<std::string, Module> modules() {
  const std::string cmake = read_text(top / "CMakeLists.txt");
  std::map<std::string, Module> all;
  for (auto& arguments : calls(cmake, "add_module")) {
    const std::string folder = arguments.front();
    std::string target = folder;
    std::replace(target.begin(), target.end(), '/', '_');
    arguments.erase(arguments.begin());
    all[target] = {folder, arguments, {}};
  }
  for (auto& arguments : calls(cmake, "target_link_libraries")) {
    const std::string target = arguments.front();
    static const std::map<std::string, std::string> programs = {
        {"condyle", "tools"},
        {"condyle-peers", "tools/peers"},
        {"condyle-factors", "tools/factors"}};
    if (const auto program = programs.find(target); program != programs.end())
      all[target] = {program->second, arguments, {}};
  }
  for (auto& [target, module] : all) collect(all, target, module.reachable);
  return all;
}

std::vector<FunctionLength> function_lengths(const std::string& text) {
  struct Block {
    bool function;
    int line;
  };
  const std::string code = code_alone(text);
  std::vector<FunctionLength> found;
  std::vector<Block> open;
  int line = 1, functions_open = 0;
  std::size_t head = 0;  // where the text since the last brace or semicolon begins
  for (std::size_t i = 0; i < code.size(); ++i) {
    const char c = code[i];
    if (c == '\n') ++line;
    if (c != '{' && c != '}' && c != ';') continue;
    if (c == '{') {
      const bool function =
          functions_open == 0 &&
          opens_function(code.substr(head, i - head), head > 0 && code[head - 1] == '}');
      open.push_back({function, line});
      functions_open += function;
    } else if (c == '}' && !open.empty()) {
      if (open.back().function) {
        found.push_back({open.back().line, line - open.back().line + 1});
        --functions_open;
      }
      open.pop_back();
    }
    head = i + 1;
  }
  return found;
}

}  // namespace condyle::test
