// Files and functions stay small enough to be read at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/tools/source_tree.h"

using namespace condyle::test;

namespace {
constexpr int max_function_lines = 90, max_file_lines = 600;
// Functions and files that were longer when the law was written. Parting one lowers its number.
constexpr std::size_t longer_functions = 0, longer_files = 2;
}  // namespace

TEST(SourceSize, FunctionsHaveAtMost90Lines) {
  int counted = 0;
  std::vector<std::string> longer;
  for (const auto& file : source_files({"engine", "sim", "render", "tools"}))
    for (const auto& function : function_lengths(file.text)) {
      if (function.lines > max_function_lines)
        longer.push_back(file.path + ":" + std::to_string(function.first_line) + " has " +
                         std::to_string(function.lines));
      ++counted;
    }
  EXPECT_GT(counted, 3000);
  EXPECT_LE(longer.size(), longer_functions) << testing::PrintToString(longer);
}

TEST(SourceSize, FilesHaveAtMost600Lines) {
  std::vector<std::string> longer;
  for (const auto& file : source_files({"engine", "sim", "render", "tools", "tests"}))
    if (std::count(file.text.begin(), file.text.end(), '\n') > max_file_lines)
      longer.push_back(file.path);
  EXPECT_LE(longer.size(), longer_files) << testing::PrintToString(longer);
}

TEST(SourceSize, LinesOfFunctionsAreCounted) {
  const std::string text =
      "namespace n {\n"
      "struct S {\n"
      "  S() : a_(1), b_{2} {\n"
      "    f(\"{\");  // {\n"
      "  }\n"
      "  int a_, b_;\n"
      "};\n"
      "const int table[] = {\n"
      "    1,\n"
      "};\n"
      "template <class T>\n"
      "auto g(T t) -> int {\n"
      "  if (t) {\n"
      "    return [] { return 1; }();\n"
      "  }\n"
      "  return '{';\n"
      "}\n"
      "}\n";
  const auto found = function_lengths(text);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].first_line, 3);
  EXPECT_EQ(found[0].lines, 3);
  EXPECT_EQ(found[1].first_line, 12);
  EXPECT_EQ(found[1].lines, 6);
}
