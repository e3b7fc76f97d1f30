// The help of the program and its commands, as a new user reads it.
#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/program.h"

namespace condyle::test {
namespace {

constexpr std::size_t widest_line = 100;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

bool has_line(const std::string& text, const std::string& line) {
  for (const auto& one : lines_of(text))
    if (one == line) return true;
  return false;
}

}  // namespace

TEST(Help, IsWrappedAndFreeOfTheLibrarysTypes) {
  int commands = 0;
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"view"},
                                             {"record"},
                                             {"run"},
                                             {"check"},
                                             {"occlude"},
                                             {"release"},
                                             {"import"},
                                             {"import", "meshes"},
                                             {"plan", "new"},
                                             {"plan", "cut"},
                                             {"plan", "move"},
                                             {"plan", "apply"},
                                             {"predict"},
                                             {"compare"},
                                             {"info"},
                                             {"phantom"},
                                             {"bench", "tissue"},
                                             {}}) {
    auto words = command;
    words.push_back("--help");
    const auto outcome = condyle(words);
    EXPECT_EQ(outcome.code, 0);
    for (const char* type : {"FLOAT", " INT", "ENUM", "{false}", "->", "TEXT:"})
      EXPECT_EQ(outcome.out.find(type), std::string::npos) << type << "\n" << outcome.out;
    for (const auto& line : lines_of(outcome.out)) EXPECT_LE(line.size(), widest_line) << line;
    ++commands;
  }
  EXPECT_EQ(commands, 18);
}

TEST(Help, GroupsOptionsAndShowsTheirRanges) {
  const std::string record = condyle({"record", "--help"}).out;
  for (const char* group : {"Basics:", "Camera:", "Look:", "Tissue:", "Motion:", "Muscles:"})
    EXPECT_TRUE(has_line(record, group)) << group << "\n" << record;
  EXPECT_LT(record.find("Camera:"), record.find("Muscles:"));
  EXPECT_NE(condyle({"check", "--help"}).out.find("--margin 0..50"), std::string::npos);
  const std::string run = condyle({"run", "--help"}).out;
  for (const char* words : {"--bennett 0..40", "--opening 1..80", "--muscle-law hill|peck",
                            "--bolus none|left|right", "--duration 0.2..3600"})
    EXPECT_NE(run.find(words), std::string::npos) << words << "\n" << run;
}

TEST(Help, ExamplesStandOnLinesOfTheirOwn) {
  const std::string help = condyle({"--help"}).out;
  const auto lines = lines_of(help.substr(help.find("Examples")));
  int examples = 0;
  for (std::size_t i = 1; i < lines.size() && !lines[i].empty(); i += 2) {
    EXPECT_TRUE(lines[i].starts_with("  ") && lines[i].ends_with(":")) << lines[i];
    EXPECT_TRUE(lines[i + 1].starts_with("    condyle")) << lines[i + 1];
    EXPECT_EQ(lines[i + 1].find("  ", 4), std::string::npos) << "no second column";
    ++examples;
  }
  EXPECT_EQ(examples, 6);
}

TEST(Help, AWrongWordListsTheKnownOnes) {
  const auto law = condyle({"run", "--motion", "opening", "--out", "x", "--muscle-law", "hil"});
  EXPECT_EQ(law.code, 2);
  EXPECT_NE(law.err.find("hill|peck"), std::string::npos) << law.err;
  const auto verb = condyle({"chek"});
  EXPECT_EQ(verb.code, 2);
  EXPECT_NE(verb.err.find("did you mean \"check\"?"), std::string::npos) << verb.err;
}

}  // namespace condyle::test
