// The manual's pages and command lines, as a new user would follow them.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "tests/support/places.h"
#include "tests/support/program.h"

namespace fs = std::filesystem;
using condyle::test::Folder;
using condyle::test::read_text;

namespace {

const fs::path checkout = condyle::test::source_folder();

std::vector<fs::path> manual_files() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(checkout / "tools/manual"))
    if (entry.path().extension() == ".md") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// Words of a command line; double quotes hold words together.
std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> words;
  bool quoted = false, open = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (c == ' ' && !quoted) open = false;
    if (c == '"' || (c == ' ' && !quoted)) continue;
    if (!open) words.emplace_back();
    open = true;
    words.back() += c;
  }
  return words;
}

/// The commands of a page: lines of its blocks marked `sh`, and in README all that begin with
/// build/condyle.
std::vector<std::vector<std::string>> commands_of(const fs::path& file) {
  std::vector<std::vector<std::string>> commands;
  std::istringstream text(read_text(file));
  bool block = false;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("```"))
      block = line == "```sh" || (line == "```" && !block && file.filename() == "README.md");
    if (!block) continue;
    for (std::string more; line.ends_with('\\') && std::getline(text, more);)
      line = line.substr(0, line.size() - 1) + more;
    for (const std::string program : {"condyle ", "build/condyle "})
      if (line.starts_with(program)) commands.push_back(split(line.substr(program.size())));
  }
  return commands;
}

bool has(const std::vector<std::string>& words, const std::string& word) {
  return std::any_of(words.begin(), words.end(),
                     [&](const std::string& each) { return each.find(word) != std::string::npos; });
}

/// The same command with few and small pictures, without tissue unless it requests some.
std::vector<std::string> shortened(std::vector<std::string> words, const Folder& folder) {
  const std::string verb = words.front();
  for (std::size_t i = 1; i < words.size(); ++i)
    if (words[i - 1] == "--out")
      words[i] = folder / words[i];
    else if (words[i] == "patient" || words[i].starts_with("sample/") ||
             words[i].starts_with("out/"))
      words[i] = folder / words[i];
    else if (words[i].starts_with("muscles:"))
      words[i] = "muscles:" + (folder / words[i].substr(8));
  const bool steps = verb == "record" || verb == "run";
  if ((steps || verb == "check") && !has(words, "--frames"))
    words.insert(words.end(), {"--frames", "3"});
  if (verb == "record") words.insert(words.end(), {"--size", "160x120"});
  if (steps && !has(words, "displacement") && !has(words, "before-after") &&
      !has(words, "--expression"))
    words.push_back("--no-tissue");
  return words;
}

}  // namespace

TEST(Manual, EachPageIsPrintedAsItStands) {
  const auto index = condyle::test::condyle({"help"});
  EXPECT_EQ(index.code, 0);
  ASSERT_GE(manual_files().size(), 9u);
  for (const auto& file : manual_files()) {
    const std::string subject = file.stem().string();
    const auto page = condyle::test::condyle({"help", subject});
    EXPECT_EQ(page.code, 0) << subject;
    EXPECT_EQ(page.out, read_text(file));
    EXPECT_NE(index.out.find("  " + subject + " "), std::string::npos) << index.out;
    EXPECT_NE(read_text(checkout / "README.md").find("tools/manual/" + subject + ".md"),
              std::string::npos)
        << "README does not lead to " << subject;
  }
  const auto unknown = condyle::test::condyle({"help", "cooking"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_NE(unknown.err.find("motions"), std::string::npos) << unknown.err;
}

TEST(Manual, CommandLinesWork) {
  Folder folder;
  int run = 0;
  std::vector<fs::path> files = manual_files();
  files.push_back(checkout / "README.md");
  for (const auto& file : files)
    for (const auto& words : commands_of(file)) {
      if (words.front() == "view") continue;
      const auto command = shortened(words, folder);
      const auto outcome = condyle::test::condyle(command);
      std::string line;
      for (const auto& word : command) line += word + " ";
      EXPECT_EQ(outcome.code, 0) << file.filename() << ": " << line << "\n" << outcome.err;
      ++run;
    }
  EXPECT_GE(run, 23);
}
