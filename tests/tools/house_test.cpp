// The arrows of the house run one way: tools > render > sim/frame, tools > sim > engine.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace fs = std::filesystem;

namespace {

const fs::path top = CONDYLE_SOURCE_DIR;

struct Source {
  std::string path;  // from the top
  std::vector<std::string> own_includes, library_includes;
};

std::vector<Source> sources() {
  std::vector<Source> found;
  const std::regex own("^\\s*#\\s*include\\s*\"([^\"]+)\""),
      library("^\\s*#\\s*include\\s*<([^>]+)>");
  for (const char* room : {"engine", "sim", "render", "tools"})
    for (const auto& entry : fs::recursive_directory_iterator(top / room)) {
      const auto extension = entry.path().extension();
      if (extension != ".h" && extension != ".cpp") continue;
      Source source{fs::relative(entry.path(), top).generic_string(), {}, {}};
      std::ifstream stream(entry.path());
      for (std::string line; std::getline(stream, line);) {
        std::smatch match;
        if (std::regex_search(line, match, own)) source.own_includes.push_back(match[1]);
        if (std::regex_search(line, match, library)) source.library_includes.push_back(match[1]);
      }
      found.push_back(source);
    }
  return found;
}

bool starts_with(const std::string& text, const std::string& start) {
  return text.rfind(start, 0) == 0;
}

/// Whether `from` may include `target`, both given from the top.
bool allowed(const std::string& from, const std::string& target) {
  if (starts_with(from, "engine/")) return starts_with(target, "engine/");
  if (starts_with(from, "sim/frame/"))
    return starts_with(target, "engine/") || starts_with(target, "sim/frame/");
  if (starts_with(from, "sim/"))
    return starts_with(target, "engine/") || starts_with(target, "sim/");
  if (starts_with(from, "render/"))
    return starts_with(target, "engine/") || starts_with(target, "render/") ||
           starts_with(target, "sim/frame/");
  return true;
}

}  // namespace

TEST(House, IncludesRunDownwardOnly) {
  const auto all = sources();
  ASSERT_GT(all.size(), 40u);
  int checked = 0;
  for (const auto& source : all)
    for (const auto& target : source.own_includes) {
      EXPECT_TRUE(allowed(source.path, target)) << source.path << " includes " << target;
      EXPECT_TRUE(fs::exists(top / target))
          << source.path << " includes " << target << " from elsewhere";
      ++checked;
    }
  EXPECT_GT(checked, 100);
  EXPECT_FALSE(allowed("engine/mesh/x.h", "sim/case/case.h"));
  EXPECT_FALSE(allowed("render/x.cpp", "sim/simulator/simulator.h"));
}

TEST(House, EachLibraryHasOneRoom) {
  const std::map<std::string, std::vector<std::string>> homes = {
      {"fcl/", {"engine/collide/"}},
      {"openvdb/", {"engine/field/"}},
      {"assimp/", {"engine/mesh_io/"}},
      {"imgui", {"render/window/"}},
      {"GLFW/", {"render/window/"}},
      {"epoxy/egl", {"render/"}},
      {"epoxy/gl", {"render/"}},
      {"stb/", {"render/", "engine/mesh_io/"}},
      {"CLI/", {"tools/main.cpp", "tools/shared_options.cpp"}}};
  std::set<std::string> seen;
  for (const auto& source : sources())
    for (const auto& header : source.library_includes)
      for (const auto& [library, rooms] : homes) {
        if (!starts_with(header, library)) continue;
        seen.insert(library);
        bool home = false;
        for (const auto& room : rooms) home |= starts_with(source.path, room);
        EXPECT_TRUE(home) << source.path << " includes <" << header << ">";
        EXPECT_TRUE(source.path.ends_with(".cpp") || starts_with(source.path, "render/"))
            << "a header shows <" << header << ">: " << source.path;
      }
  EXPECT_GE(seen.size(), 6u);
}

TEST(House, TopLevelIsFixed) {
  const std::set<std::string> rooms = {"CMakeLists.txt", "engine", "sim",      "render",
                                       "tools",          "tests",  "README.md"};
  std::set<std::string> found;
  for (const auto& entry : fs::directory_iterator(top)) {
    const auto name = entry.path().filename().string();
    if (name.front() == '.' || name == "build" || name == "out")
      continue;  // the last two are ignored
    found.insert(name);
  }
  EXPECT_EQ(found, rooms);
}
