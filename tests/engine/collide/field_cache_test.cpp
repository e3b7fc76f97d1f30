#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <thread>

#include "engine/collide/distance_field.h"
#include "engine/core/files.h"
#include "tests/support/program.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder)) found.push_back(entry.path());
  return found;
}

/// Starts work in a separate process, whose exit code is 0 when the work returns true.
pid_t start(const std::function<bool()>& work) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  bool good = false;
  try {
    good = work();
  } catch (...) {
  }
  ::_exit(good ? 0 : 1);
}

int end_of(pid_t child) {
  int status = -1;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

TEST(FieldCacheUnderStress, ProcessesThatMakeTheSameFieldAtOnceLeaveOneWholeFile) {
  const TriMesh mesh = test::sphere(3, 5);
  const auto expected = DistanceField(mesh, {}).hash();
  const test::Folder folder, alone;
  cached_field(alone.path(), mesh, {});
  const std::string whole = read_file(files_in(alone.path()).front());
  for (int round = 0; round < 3; ++round) {
    std::vector<pid_t> children;
    for (int k = 0; k < 4; ++k)
      children.push_back(
          start([&] { return cached_field(folder.path(), mesh, {}).hash() == expected; }));
    for (const pid_t child : children) EXPECT_EQ(end_of(child), 0);
    const auto files = files_in(folder.path());
    ASSERT_EQ(files.size(), 1u);  // and nothing half written beside it
    EXPECT_EQ(read_file(files.front()), whole);
    write_file(files.front(), whole.substr(0, whole.size() / 2));  // damaged for the next round
  }
}

TEST(FieldCacheUnderStress, ThreadsThatMakeTheSameFieldAtOnceLeaveOneWholeFile) {
  const TriMesh mesh = test::sphere(3, 5);
  const auto expected = DistanceField(mesh, {}).hash();
  const test::Folder folder;
  for (int round = 0; round < 5; ++round) {
    std::vector<std::uint64_t> hashes(4);
    std::vector<std::thread> threads;
    for (auto& hash : hashes)
      threads.emplace_back([&] { hash = cached_field(folder.path(), mesh, {}).hash(); });
    for (auto& thread : threads) thread.join();
    for (const auto hash : hashes) EXPECT_EQ(hash, expected);
    const auto files = files_in(folder.path());
    ASSERT_EQ(files.size(), 1u);
    const fs::path file = files.front();
    const std::string kept = read_file(file);
    fs::remove(file);
    cached_field(folder.path(), mesh, {});
    EXPECT_EQ(kept, read_file(file));
    fs::remove(file);
  }
}

TEST(FieldCacheUnderStress, AFullDiskOnlyCostsTime) {
  const TriMesh mesh = test::sphere(3, 5);
  const auto expected = DistanceField(mesh, {}).hash();
  const test::Folder folder;
  const auto on_full_disk = [&] {
    ::signal(SIGXFSZ, SIG_IGN);  // writes then fail with EFBIG, as on a full disk
    const rlimit limit{100000, 100000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    return cached_field(folder.path(), mesh, {}).hash() == expected;
  };
  EXPECT_EQ(end_of(start(on_full_disk)), 0);
  EXPECT_TRUE(files_in(folder.path()).empty());  // nor is anything left of the attempt
  cached_field(folder.path(), mesh, {});
  ASSERT_EQ(files_in(folder.path()).size(), 1u);
  EXPECT_GT(fs::file_size(files_in(folder.path()).front()), 100000u);
  EXPECT_EQ(end_of(start(on_full_disk)), 0);  // an existing file is read
}

TEST(FieldCacheUnderStress, AFolderThatMayNotBeWrittenOnlyCostsTime) {
  const TriMesh mesh = test::sphere(3, 5);
  const auto expected = DistanceField(mesh, {}).hash();
  const test::Folder folder;
  fs::permissions(folder.path(), fs::perms(0555));
  const auto as_a_plain_user = [&] {
    if (::geteuid() == 0 && ::setuid(65534) != 0) return false;  // no folder is closed to root
    return ::access(folder.path().c_str(), W_OK) != 0 &&
           cached_field(folder.path(), mesh, {}).hash() == expected &&
           cached_field(folder.path() / "below", mesh, {}).hash() == expected;
  };
  EXPECT_EQ(end_of(start(as_a_plain_user)), 0);
  EXPECT_TRUE(files_in(folder.path()).empty());
  fs::permissions(folder.path(), fs::perms(0755));
}

TEST(FieldCacheUnderStress, AFileOfAnotherMeshIsNotTaken) {
  const TriMesh mesh = test::sphere(3, 5), other = test::sphere(3, 6);
  const test::Folder folder, others;
  cached_field(folder.path(), mesh, {});
  cached_field(others.path(), other, {});
  const fs::path file = files_in(folder.path()).front();
  write_file(file, read_file(files_in(others.path()).front()));
  EXPECT_EQ(cached_field(folder.path(), mesh, {}).hash(), DistanceField(mesh, {}).hash());
}

}  // namespace
}  // namespace condyle
