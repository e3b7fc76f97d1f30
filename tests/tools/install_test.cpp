// The simulator as a CMake package that another project finds.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/support/places.h"
#include "tests/support/program.h"

using namespace condyle::test;

namespace {

/// Runs a command line of the shell; the log holds what it printed.
void expect_success(const std::string& command, const std::string& log) {
  EXPECT_EQ(std::system((command + " >" + log + " 2>&1").c_str()), 0) << command << "\n"
                                                                      << read_text(log);
}

}  // namespace

TEST(Install, AProgramOutsideTheTreeLinksTheSimulator) {
  const Folder folder;
  const std::string log = folder / "log", prefix = folder / "prefix", build = folder / "build";
  const std::string tree = program_file().parent_path().string();
  expect_success("cmake --install " + tree + " --component development --prefix " + prefix, log);
  expect_success("cmake -S " + (source_folder() / "tests/tools/outside").string() + " -B " + build +
                     " -DCMAKE_BUILD_TYPE=Debug -DCMAKE_PREFIX_PATH=" + prefix,
                 log);
  expect_success("cmake --build " + build, log);
  expect_success(build + "/outside " + box_case(folder), log);
  EXPECT_EQ(read_text(log), "clearance 1.000 mm\n");
}
