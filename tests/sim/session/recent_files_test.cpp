#include "sim/session/recent_files.h"

#include <gtest/gtest.h>
#include <unistd.h>

using namespace condyle;

TEST(RecentFiles, AreKeptInOrderWithoutDuplicatesAndReload) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("condyle-recent-" + std::to_string(::getpid()));
  const auto file = folder / "deep" / "recent";
  {
    RecentFiles recent(file);
    for (int i = 0; i < 14; ++i) recent.add("/data/case-" + std::to_string(i % 12));
    EXPECT_EQ(recent.list().front(), "/data/case-1");
  }
  RecentFiles again(file);
  ASSERT_EQ(again.list().size(), 10u);
  EXPECT_EQ(again.list()[0], "/data/case-1");
  EXPECT_EQ(again.list()[1], "/data/case-0");
  again.forget("/data/case-1");
  EXPECT_EQ(RecentFiles(file).list().front(), "/data/case-0");
  // Nothing is left beside it, and a list that cannot be written is no error.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(file.parent_path()), {}), 1);
  RecentFiles nowhere("/proc/condyle/recent");
  nowhere.add("/data/case-5");
  EXPECT_EQ(nowhere.list().size(), 1u);
  std::filesystem::remove_all(folder);
}
