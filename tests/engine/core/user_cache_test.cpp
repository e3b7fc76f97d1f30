#include "engine/core/user_cache.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>

#include "engine/core/archive.h"
#include "engine/core/files.h"
#include "tests/support/program.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

fs::path only_file(const fs::path& folder) {
  const fs::directory_iterator first(folder);
  EXPECT_EQ(std::distance(begin(first), fs::directory_iterator()), 1);
  return fs::directory_iterator(folder)->path();
}

TEST(ResultCache, GivesBackWhatWasWrittenUnderTheSameInputs) {
  const test::Folder folder;
  const ResultCache cache(folder.path() / "made", "numbers");
  EXPECT_FALSE(cache.read(7));
  cache.write(7, "a result");
  EXPECT_EQ(cache.read(7), "a result");
  EXPECT_FALSE(cache.read(8));
  cache.write(7, "");
  EXPECT_EQ(cache.read(7), "");
  EXPECT_TRUE(only_file(folder.path() / "made").filename().string().starts_with("numbers-"));
}

TEST(ResultCache, ADamagedFileIsAbsent) {
  const test::Folder folder;
  const ResultCache cache(folder.path(), "numbers");
  cache.write(7, "a result of some length");
  const fs::path file = only_file(folder.path());
  const std::string whole = read_file(file);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 4);
    write_file(file, damaged);
    EXPECT_FALSE(cache.read(7)) << "byte " << i;
    write_file(file, whole.substr(0, i));
    EXPECT_FALSE(cache.read(7)) << i << " bytes";
  }
  write_file(file, whole + "x");
  EXPECT_FALSE(cache.read(7));
  write_file(file, whole);
  EXPECT_EQ(cache.read(7), "a result of some length");
}

TEST(ResultCache, AFileUnderTheNameOfAnotherIsAbsent) {
  const test::Folder folder;
  const ResultCache cache(folder.path(), "numbers");
  cache.write(7, "of seven");
  const fs::path of_seven = only_file(folder.path());
  const std::string bytes = read_file(of_seven);
  fs::remove(of_seven);
  cache.write(8, "of eight");
  write_file(only_file(folder.path()), bytes);
  EXPECT_FALSE(cache.read(8));
}

TEST(ResultCache, KeepsTheFilesThatWereUsedLastUpToItsLimit) {
  const test::Folder folder;
  const std::string result(100, 'r');
  const std::uintmax_t three_files = 3 * (result.size() + 16) + 50;  // each with its key and hash
  const ResultCache cache(folder.path(), "numbers", three_files),
      other(folder.path(), "letters", three_files);
  other.write(1, result);
  for (std::uint64_t i = 0; i < 5; ++i) {
    cache.write(i, result);
    // Each file older than the next by more than a clock's step.
    for (const auto& entry : fs::directory_iterator(folder.path()))
      fs::last_write_time(entry.path(),
                          fs::last_write_time(entry.path()) - std::chrono::seconds(10));
    EXPECT_TRUE(cache.read(0));  // what is read is kept
  }
  EXPECT_TRUE(cache.read(0));
  EXPECT_FALSE(cache.read(1));
  EXPECT_FALSE(cache.read(2));
  EXPECT_TRUE(cache.read(3));
  EXPECT_TRUE(cache.read(4));
  EXPECT_FALSE(other.read(1));  // files of every kind count
}

TEST(ResultCache, WhatWasLeftHalfWrittenIsRemovedAfterAnHour) {
  const test::Folder folder;
  const fs::path old = folder.path() / ".numbers-1.bin.77-0.part",
                 fresh = folder.path() / ".numbers-2.bin.77-1.part",
                 other = folder.path() / "notes.txt", whole = folder.path() / "field-1.bin";
  for (const fs::path& file : {old, fresh, other, whole}) write_file(file, "content");
  const auto long_ago = fs::file_time_type::clock::now() - std::chrono::hours(2);
  for (const fs::path& file : {old, other, whole}) fs::last_write_time(file, long_ago);
  limit_cache(folder.path());
  EXPECT_FALSE(fs::exists(old));
  EXPECT_TRUE(fs::exists(fresh) && fs::exists(other) && fs::exists(whole));
  limit_cache(folder.path(), 3);
  EXPECT_TRUE(fs::exists(fresh) && fs::exists(other));
  EXPECT_FALSE(fs::exists(whole));
}

TEST(ResultCache, WithoutAFolderNothingIsKept) {
  const ResultCache nowhere({}, "numbers");
  nowhere.write(1, "result");
  EXPECT_FALSE(nowhere.read(1));
  const test::Folder folder;
  const fs::path file = folder.path() / "file";
  write_file(file, "not a folder");
  const ResultCache in_file(file, "numbers");
  EXPECT_NO_THROW(in_file.write(1, "result"));
  EXPECT_FALSE(in_file.read(1));
}

struct Inner {
  std::string name;
  std::optional<double> value;
};
struct Outer {
  int count = 0;
  std::vector<Inner> list;
  std::vector<std::vector<int>> rows;
};
template <class Archive>
void fields(Archive& archive, Inner& inner) {
  archive(inner.name, inner.value);
}
template <class Archive>
void fields(Archive& archive, Outer& outer) {
  archive(outer.count, outer.list, outer.rows);
}

TEST(Archive, ReadsWhatItWroteAndNothingLess) {
  Outer outer{3, {{"one", 1.5}, {"", std::nullopt}}, {{1, 2}, {}, {3}}};
  ArchiveWriter writer;
  writer(outer);
  const std::string bytes = writer.take();
  Outer again;
  ArchiveReader reader(bytes);
  reader(again);
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(again.count, 3);
  ASSERT_EQ(again.list.size(), 2u);
  EXPECT_EQ(again.list[0].name, "one");
  EXPECT_EQ(again.list[0].value, 1.5);
  EXPECT_FALSE(again.list[1].value);
  EXPECT_EQ(again.rows, outer.rows);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ArchiveReader part(std::string_view(bytes).substr(0, size));
    Outer unfinished;
    part(unfinished);
    EXPECT_FALSE(part.complete()) << size;
  }
  const std::string longer = bytes + "x";
  ArchiveReader rest(longer);
  rest(again);
  EXPECT_FALSE(rest.complete());
}

TEST(Archive, MeasuresTheMemoryOfLists) {
  Outer outer;
  outer.rows = {std::vector<int>(100), std::vector<int>(28)};
  ArchiveMeasure measure;
  measure(outer);
  EXPECT_EQ(measure.held(), outer.rows.capacity() * sizeof(std::vector<int>) + 128 * sizeof(int));
}

}  // namespace
}  // namespace condyle
