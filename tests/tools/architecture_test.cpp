// Permitted includes: modules as in CMakeLists.txt, and the modules of each third-party library.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/support/places.h"
#include "tests/tools/source_tree.h"

namespace fs = std::filesystem;
using namespace condyle::test;

namespace {

const fs::path top = source_folder();
const std::vector<std::string> floors = {"engine", "sim", "render", "tools"};

bool is_below(const std::string& path, const std::string& folder) {
  return path == folder || path.starts_with(folder + "/");
}

/// The target whose folder holds this file; the files of one folder are one module. The commands in
/// folders of tools are part of the program.
std::string target_of(const std::map<std::string, Module>& all, const std::string& folder) {
  static const std::set<std::string> of_the_program = {"tools/bench", "tools/plan", "tools/demo",
                                                       "tools/appliance"};
  const std::string own = of_the_program.contains(folder) ? "tools" : folder;
  for (const auto& [target, module] : all)
    if (module.folder == own) return target;
  return "";
}

/// A third-party library: prefix of its headers; folders that may include it; whether our headers
/// may expose it; the CMake target that a module must link ("" for libraries of headers alone).
struct Library {
  std::string header;
  std::vector<std::string> homes;
  bool in_headers;
  std::string target;
};

const std::vector<Library> libraries = {
    {"Eigen/", {"engine", "sim", "render", "tools"}, true, ""},
    {"fmt/", {"engine", "sim", "render", "tools"}, true, "fmt::fmt"},
    {"nlohmann/", {"engine", "sim", "render", "tools"}, true, "nlohmann_json::nlohmann_json"},
    {"tiny_gltf.h", {"engine/gltf"}, false, "TinyGLTF::TinyGLTF"},
    {"tbb/", {"engine/core"}, false, "TBB::tbb"},
    {"meshoptimizer.h", {"engine/mesh"}, false, "meshoptimizer::meshoptimizer"},
    {"fcl/", {"engine/collide"}, false, "fcl"},
    {"bt", {"tools/bench/baseline"}, false, "PkgConfig::bullet"},
    {"Bullet", {"engine/rigid", "tools/bench/baseline"}, false, "PkgConfig::bullet"},
    {"stb/", {"engine/mesh_io", "render/image"}, false, ""},
    {"png.h", {"engine/mesh_io", "render/image"}, false, "PNG::PNG"},
    {"libdeflate.h", {"render/image"}, false, "PkgConfig::deflate"},
    {"zlib.h", {"engine/volume", "render/output"}, false, "ZLIB::ZLIB"},
    {"gdcm", {"engine/dicom"}, false, "gdcmMSFF"},
    {"epoxy/", {"render/gl", "render/window"}, true, "PkgConfig::epoxy"},
    {"GLFW/", {"render/window"}, true, "glfw"},
    {"imgui", {"render/window"}, true, "PkgConfig::imgui"},
    {"backends/imgui", {"render/window"}, false, "PkgConfig::imgui"},
    {"CLI/", {"tools"}, false, "CLI11::CLI11"},
    {"ceres/", {"tools/peers"}, false, "Ceres::ceres"},
    {"glog/", {"tools/peers"}, false, "Ceres::ceres"},
    {"gsl/", {"tools/peers"}, false, "PkgConfig::peers"},
    {"nlopt.h", {"tools/peers"}, false, "PkgConfig::peers"},
    {"cholmod.h", {"tools/factors"}, false, "cholmod"},
};

/// Headers of the operating system and of the compiler.
bool is_system_header(const std::string& header) {
  static const std::set<std::string> known = {"unistd.h",    "signal.h", "fcntl.h", "spawn.h",
                                              "sched.h",     "poll.h",   "stdio.h", "malloc.h",
                                              "immintrin.h", "dlfcn.h",  "link.h"};
  return header.find('.') == std::string::npos && header.find('/') == std::string::npos
             ? true
             : header.starts_with("sys/") || known.contains(header);
}

const Library* library_of(const std::string& header) {
  const auto found = std::find_if(libraries.begin(), libraries.end(), [&](const Library& library) {
    return header.starts_with(library.header);
  });
  return found == libraries.end() ? nullptr : &*found;
}

/// The modules that combine simulation and drawing: a recording renders a simulated motion, a
/// session shows a simulation in a front end and is saved with its plan, pictures of a plan show
/// its segments and the predicted face. All other drawing reads frames alone.
bool joins_sim_and_render(const std::string& folder) {
  return folder == "render/recording" || is_below(folder, "render/session") ||
         folder == "render/plan";
}

/// Whether the layer `from` may link the module in `folder`.
bool may_link(const std::string& from, const std::string& folder) {
  if (is_below(from, "engine")) return is_below(folder, "engine");
  if (is_below(from, "sim")) return is_below(folder, "engine") || is_below(folder, "sim");
  if (is_below(from, "render"))
    return is_below(folder, "engine") || is_below(folder, "render") || folder == "sim/frame" ||
           folder == "sim/choice" || (joins_sim_and_render(from) && is_below(folder, "sim"));
  return true;
}

}  // namespace

TEST(Architecture, EveryFileBelongsToAModule) {
  const auto all = modules();
  ASSERT_GT(all.size(), 20u);
  for (const auto& file : source_files(floors))
    EXPECT_NE(target_of(all, file.folder), "") << file.path << " is in no folder of add_module";
}

TEST(Architecture, ModulesLinkDownwardWithoutCycles) {
  const auto all = modules();
  int checked = 0;
  for (const auto& [target, module] : all)
    for (const auto& link : module.links) {
      if (!all.contains(link) || link == target) continue;
      ++checked;
      EXPECT_TRUE(may_link(module.folder, all.at(link).folder)) << target << " links " << link;
      EXPECT_FALSE(all.at(link).reachable.contains(target)) << target << " and " << link;
    }
  EXPECT_GT(checked, 30);
  EXPECT_FALSE(may_link("engine/mesh", "sim/case"));
  EXPECT_FALSE(may_link("render/scene", "sim/simulator"));
}

TEST(Architecture, FilesIncludeOnlyWhatTheirModuleLinks) {
  const auto all = modules();
  int checked = 0;
  for (const auto& file : source_files(floors)) {
    const std::string from = target_of(all, file.folder);
    if (from.empty()) continue;  // reported above
    for (const auto& header : file.quoted_includes) {
      ASSERT_TRUE(fs::exists(top / header))
          << file.path << " includes " << header << ", which is not named from the top of the tree";
      const std::string to = target_of(all, fs::path(header).parent_path().generic_string());
      const bool peers_of_the_bench = from == "condyle-peers" && is_below(header, "tools");
      EXPECT_TRUE(all.at(from).reachable.contains(to) || peers_of_the_bench)
          << file.path << " includes " << header << "; " << from << " does not link " << to;
      ++checked;
    }
    for (const auto& header : file.angle_includes)
      for (const auto& floor : floors)
        EXPECT_FALSE(is_below(header, floor))
            << file.path << " includes <" << header << ">; own files are quoted";
  }
  EXPECT_GT(checked, 1000);
  EXPECT_FALSE(all.at("sim_contact").reachable.contains("sim_motion"));
}

TEST(Architecture, EachLibraryStaysInItsHomes) {
  const auto all = modules();
  std::set<std::string> seen;
  for (const auto& file : source_files(floors))
    for (const auto& header : file.angle_includes) {
      if (is_system_header(header)) continue;
      const Library* library = library_of(header);
      ASSERT_NE(library, nullptr) << file.path << " includes <" << header
                                  << ">: give that library a row and a home";
      const std::string from = target_of(all, file.folder);
      EXPECT_TRUE(library->target.empty() || from.empty() ||
                  all.at(from).reachable.contains(library->target))
          << file.path << " includes <" << header << ">; " << from << " does not link "
          << library->target;
      EXPECT_TRUE(library->in_headers || file.path.ends_with(".cpp"))
          << "a header shows <" << header << ">: " << file.path;
      bool at_home = false;
      for (const auto& home : library->homes)
        if (is_below(file.folder, home)) {
          at_home = true;
          seen.insert(library->header + " in " + home);
        }
      EXPECT_TRUE(at_home) << file.path << " includes <" << header << ">";
    }
  for (const auto& library : libraries)
    for (const auto& home : library.homes)
      EXPECT_TRUE(seen.contains(library.header + " in " + home))
          << "no file in " << home << " includes <" << library.header << "...>: remove the home";
}

// Two types of one name in one namespace are one type to the linker, which then merges the code of
// templates over them.
TEST(Architecture, EachTypeIsDefinedOnce) {
  const std::regex name_space("^namespace ([\\w:]+) \\{"),
      type(
          "^(?:struct|class|enum class) (?:alignas\\([^)]*\\) )?(\\w+)(?: final)?(?: : [^{]*)? "
          "\\{");
  std::map<std::string, std::string> home;
  for (const char* folder : {"engine", "sim", "render", "tools"})
    for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
      if (entry.path().extension() != ".h") continue;
      std::ifstream stream(entry.path());
      std::string inside;
      for (std::string line; std::getline(stream, line);) {
        std::smatch match;
        if (std::regex_search(line, match, name_space)) inside = match[1];
        if (!std::regex_search(line, match, type)) continue;
        const auto [known, is_new] =
            home.emplace(inside + "::" + match[1].str(), entry.path().string());
        EXPECT_TRUE(is_new) << known->first << " is defined in " << known->second << " and "
                            << entry.path();
      }
    }
  EXPECT_GT(home.size(), 300u);
}

TEST(Architecture, TopLevelIsFixed) {
  const std::set<std::string> expected = {"CMakeLists.txt", "engine", "sim",      "render",
                                          "tools",          "tests",  "README.md"};
  std::set<std::string> found;
  for (const auto& entry : fs::directory_iterator(top)) {
    const auto name = entry.path().filename().string();
    if (name.front() == '.' || name == "build" || name == "out") continue;  // ignored by git
    found.insert(name);
  }
  EXPECT_EQ(found, expected);
}
