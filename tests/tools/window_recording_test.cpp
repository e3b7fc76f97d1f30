// A recording that is stopped, quit or requested again: nothing is lost, and it is resumed to the
// same bits.
#include <map>

#include "tests/tools/window_session.h"

namespace condyle::test {
namespace {

using Files = std::map<std::string, std::string>;

Files files_of(const fs::path& folder) {
  Files files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      files[fs::relative(entry.path(), folder).string()] = read_text(entry.path());
  files.erase("recording.json");
  return files;
}

TEST_F(WindowSession, AStoppedOrQuitRecordingIsResumedBitIdentically) {
  const std::vector<std::string> command = {box_case(folder_), "--motion",
                                            "open 8 over 1; close over 1"};
  const auto ready = [&] {
    start(command);
    ASSERT_TRUE(wait_until(idle));
    click("tab:Record");
    click("record-height:720");
  };
  const auto record = [&](const std::string& folder) {
    write_into("record-folder", folder);
    click("record");
  };
  const auto begun = [&](const std::string& folder) {
    return wait_until([&](const Json&) { return fs::exists(folder + "/frames/000003.png"); });
  };
  const auto asked = [&](const std::string& words) {
    return wait_until([&](const Json& s) {
      return s.contains("asked") && s["asked"].get<std::string>().find(words) != std::string::npos;
    });
  };
  const auto not_asked = [&] {
    return wait_until([](const Json& s) { return !s.contains("asked"); });
  };
  const auto said = [&](const std::string& words) {
    return wait_until([&](const Json& s) {
      return s.contains("said") && s["said"].get<std::string>().find(words) != std::string::npos;
    });
  };
  const std::string whole = folder_ / "whole", stopped = folder_ / "stopped";
  ready();
  record(whole);
  ASSERT_TRUE(said("Recorded " + whole)) << state()["said"];
  const Files expected = files_of(whole);
  ASSERT_EQ(expected.size(), 61u + 2u);  // with film and hashes

  // Quitting asks, and loses nothing when the user declines.
  record(stopped);
  ASSERT_TRUE(begun(stopped));
  EXPECT_TRUE(press("ctrl+q"));
  ASSERT_TRUE(asked(stopped)) << state();
  see_now("quit-asks");
  EXPECT_TRUE(press("Return"));
  ASSERT_TRUE(not_asked());
  EXPECT_EQ(state()["busy_with"], "recording");

  click("record-cancel");
  ASSERT_TRUE(said(" of 61 pictures are in " + stopped)) << state()["said"];
  ASSERT_TRUE(wait_for_item("record-resume"));
  EXPECT_FALSE(fs::exists(stopped + "/film.mp4"));
  see("stopped");
  const Files parts = files_of(stopped);
  ASSERT_LT(parts.size(), 61u);
  // Another view would replace the recording: only if the user confirms.
  EXPECT_TRUE(press("l"));
  record(stopped);
  ASSERT_TRUE(asked("it differs in: camera")) << state();
  see_now("another-there");
  EXPECT_TRUE(press("Escape"));
  ASSERT_TRUE(not_asked());
  EXPECT_EQ(files_of(stopped), parts);
  // It is resumed with its own settings.
  click("record-resume");
  ASSERT_TRUE(said("Recorded " + stopped)) << state()["said"];
  EXPECT_EQ(files_of(stopped), expected);
  EXPECT_TRUE(wait_for_item("record-resume", false));

  // Quit, and resumed in the next run with the same view.
  const std::string left = folder_ / "left";
  record(left);
  ASSERT_TRUE(begun(left));
  EXPECT_TRUE(press("ctrl+q"));
  click("question:quit");
  EXPECT_EQ(wait_for_end(), 0);
  ASSERT_FALSE(fs::exists(left + "/film.mp4"));
  ready();
  record(left);
  ASSERT_TRUE(asked("it differs in: camera")) << "the next run begins with the default view";
  EXPECT_TRUE(press("Return"));
  ASSERT_TRUE(not_asked());
  EXPECT_TRUE(press("l"));
  click("record");  // its folder still stands there
  ASSERT_TRUE(asked(" of 61 pictures are in " + left)) << state();
  see_now("same-there");
  click("question:resume");
  ASSERT_TRUE(said("Recorded " + left)) << state()["said"];
  const std::string again = folder_ / "again";
  record(again);
  ASSERT_TRUE(begun(again));
  EXPECT_TRUE(press("ctrl+q"));
  click("question:when-done");
  EXPECT_EQ(wait_for_end(), 0);
  EXPECT_EQ(files_of(left), files_of(again));
}

}  // namespace
}  // namespace condyle::test
