#include "engine/core/files.h"

#include <gtest/gtest.h>

#include <atomic>

#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/parallel.h"
#include "tests/support/program.h"

namespace condyle::test {

TEST(Files, ReadReturnsWhatWasWritten) {
  const Folder folder;
  const std::string text("a\0b\n", 4);
  write_file(folder.path() / "x", text);
  EXPECT_EQ(read_file(folder.path() / "x"), text);
  write_file(folder.path() / "x", "new");
  EXPECT_EQ(read_file(folder.path() / "x"), "new");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(Files, TroubleIsNamed) {
  const Folder folder;
  EXPECT_THROW(read_file(folder.path() / "none"), InputError);
  EXPECT_THROW(read_file(folder.path()), InputError);
  write_file(folder.path() / "x", "12345");
  EXPECT_THROW(read_file(folder.path() / "x", 4), InputError);
  EXPECT_THROW(write_file(folder.path() / "no" / "x", ""), MachineError);
  EXPECT_THROW(make_folder(folder.path() / "x" / "y"), MachineError);
  try {
    read_file(folder.path() / "none");
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("none"), std::string::npos);
  }
}

TEST(Parallel, CallsEachIndexOnce) {
  for (const int threads : {1, 2, 4}) {
    std::vector<std::atomic<int>> calls(1000);
    parallel_for(calls.size(), threads, [&](std::size_t i) { ++calls[i]; });
    for (const auto& count : calls) EXPECT_EQ(count, 1);
  }
}

TEST(Hash, KnownValueAndChaining) {
  EXPECT_EQ(hash_bytes("a", 1), 0xaf63dc4c8601ec8cull);  // FNV-1a reference
  EXPECT_EQ(hash_bytes("b", 1, hash_bytes("a", 1)), hash_bytes("ab", 2));
}

}  // namespace condyle::test
