// Autosaved sessions of processes that live, end and are killed.
#include "sim/session/autosave_folder.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "tests/support/program.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;
constexpr const char* ending = ".saved";

/// A process of its own that autosaves a text and then lives until it is killed.
class SavingProcess {
 public:
  SavingProcess(const fs::path& folder, const std::string& text) {
    int ends[2];
    if (::pipe(ends) != 0) return;
    process_ = ::fork();
    if (process_ == 0) {
      AutosaveFolder own(ending, folder);
      test::write_text(own.file(), text);
      [[maybe_unused]] const auto written = ::write(ends[1], "x", 1);
      for (;;) ::pause();
    }
    char written = 0;
    [[maybe_unused]] const auto got = ::read(ends[0], &written, 1);
    ::close(ends[0]);
    ::close(ends[1]);
  }
  ~SavingProcess() { kill(); }
  void kill() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    process_ = -1;
  }

 private:
  pid_t process_ = -1;
};

struct Autosaves : testing::Test {
  test::Folder folder;
  const fs::path place = fs::path(folder / "state") / "condyle";
  std::vector<std::string> there() const {
    std::vector<std::string> names;
    if (fs::exists(place))
      for (const auto& entry : fs::directory_iterator(place))
        names.push_back(entry.path().extension().string());
    std::sort(names.begin(), names.end());
    return names;
  }
};

TEST_F(Autosaves, AProcessThatEndsAsAskedLeavesNothing) {
  {
    AutosaveFolder own(ending, place);
    ASSERT_FALSE(own.file().empty()) << own.trouble();
    test::write_text(own.file(), "state");
    EXPECT_TRUE(own.take_orphans().empty());
    own.end();
    EXPECT_TRUE(own.file().empty());
  }
  EXPECT_TRUE(there().empty()) << testing::PrintToString(there());
  { const AutosaveFolder unused(ending, place); }
  EXPECT_TRUE(there().empty()) << "one that has saved nothing leaves nothing";
}

TEST_F(Autosaves, TwoProcessesHaveFilesOfTheirOwnAndALivingOneIsNoOrphan) {
  SavingProcess living(place, "its state");
  AutosaveFolder own(ending, place);
  test::write_text(own.file(), "own state");
  EXPECT_EQ(there().size(), 4u) << "two files with their locks";
  EXPECT_TRUE(own.take_orphans().empty());
  living.kill();
  const auto orphans = own.take_orphans();
  ASSERT_EQ(orphans.size(), 1u);
  EXPECT_EQ(test::read_text(orphans[0]), "its state");
  EXPECT_EQ(test::read_text(own.file()), "own state");
  AutosaveFolder other(ending, place);
  EXPECT_TRUE(other.take_orphans().empty()) << "it is taken by another window";
}

TEST_F(Autosaves, AnOrphanIsAdoptedDiscardedOrLeftAndTheNewestComesFirst) {
  for (const char* text : {"first", "second", "third"}) {
    SavingProcess killed(place, text);
    killed.kill();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // of another time
  }
  {
    AutosaveFolder own(ending, place);
    const auto orphans = own.take_orphans();
    ASSERT_EQ(orphans.size(), 3u);
    EXPECT_EQ(test::read_text(orphans[0]), "third");
    EXPECT_EQ(test::read_text(orphans[2]), "first");
    own.adopt(orphans[0]);
    EXPECT_EQ(test::read_text(own.file()), "third");
    EXPECT_FALSE(fs::exists(orphans[0]));
    own.discard(orphans[1]);
    EXPECT_FALSE(fs::exists(orphans[1]));
  }
  // What was adopted and not ended, and what was left, are offered again.
  AutosaveFolder next(ending, place);
  const auto orphans = next.take_orphans();
  ASSERT_EQ(orphans.size(), 2u);
  const fs::path kept = next.set_aside(orphans[0]);
  EXPECT_TRUE(fs::exists(kept));
  next.discard(orphans[1]);
  EXPECT_TRUE(next.take_orphans().empty());
  next.end();
  EXPECT_EQ(there(), std::vector<std::string>{".kept"});
}

TEST_F(Autosaves, AKilledProcessThatHadSavedNothingLeavesNoTrace) {
  SavingProcess killed(place, "state");
  killed.kill();
  for (const auto& entry : fs::directory_iterator(place))
    if (entry.path().extension() == ending) fs::remove(entry.path());
  ASSERT_EQ(there(), std::vector<std::string>{".lock"});
  AutosaveFolder own(ending, place);
  EXPECT_TRUE(own.take_orphans().empty());
  own.end();
  EXPECT_TRUE(there().empty());
}

TEST_F(Autosaves, AFolderThatCannotBeMadeIsNoFailure) {
  test::write_text(folder / "state", "a file in its place");
  AutosaveFolder own(ending, place);
  EXPECT_TRUE(own.file().empty());
  EXPECT_NE(own.trouble().find((folder / "state") + "/condyle"), std::string::npos)
      << own.trouble();
  EXPECT_TRUE(own.take_orphans().empty());
  own.end();
  const AutosaveFolder none(ending, {});
  EXPECT_FALSE(none.trouble().empty());
}

}  // namespace
}  // namespace condyle
