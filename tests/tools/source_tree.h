#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace condyle::test {

/// A file with C++ code (.h, .cpp, .inc). Paths are given from the top of the source tree.
struct SourceFile {
  std::string path, folder, text;
  std::vector<std::string> quoted_includes, angle_includes;  // in the order of the file
};

/// Those below the folders `roots`, sorted by path.
std::vector<SourceFile> source_files(const std::vector<std::string>& roots);

/// One add_module line of CMakeLists.txt.
struct Module {
  std::string folder;               // engine/mesh; its target is engine_mesh
  std::vector<std::string> links;   // targets as written: other modules and libraries
  std::set<std::string> reachable;  // itself and what it links, directly or through modules
};

/// By target name. The programs are modules too: `condyle` in tools, `condyle-peers` in
/// tools/peers, `condyle-factors` in tools/factors.
std::map<std::string, Module> modules();

/// A function whose text from its first brace to its last takes `lines` lines.
struct FunctionLength {
  int first_line, lines;
};
/// Functions of a file, with the lambdas inside them. Constructors and members of classes count.
std::vector<FunctionLength> function_lengths(const std::string& text);

}  // namespace condyle::test
