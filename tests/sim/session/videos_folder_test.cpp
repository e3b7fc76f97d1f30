#include "sim/session/videos_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>

#include "sim/session/autosave_folder.h"
#include "tests/support/program.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

/// An environment variable for the life of the object.
class Variable {
 public:
  Variable(const char* name, const std::optional<std::string>& value) : name_(name) {
    if (const char* now = std::getenv(name)) before_ = now;
    set(value);
  }
  ~Variable() { set(before_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;
  void set(const std::optional<std::string>& value) const {
    if (value)
      ::setenv(name_, value->c_str(), 1);
    else
      ::unsetenv(name_);
  }

 private:
  const char* name_;
  std::optional<std::string> before_;
};

TEST(VideosFolder, IsNamedByUserDirsElseVideosElseHome) {
  const test::Folder home;
  const Variable own("HOME", home.path().string()), config("XDG_CONFIG_HOME", std::nullopt);
  EXPECT_EQ(videos_folder().folder, home.path());
  EXPECT_EQ(videos_folder().what, "your home folder");
  fs::create_directories(home / "Videos");
  EXPECT_EQ(videos_folder().folder, home.path() / "Videos");
  fs::create_directories(home / ".config");
  const auto says = [&](const std::string& text) {
    test::write_text(home / ".config/user-dirs.dirs", text);
    return videos_folder().folder;
  };
  EXPECT_EQ(
      says("# a comment\nXDG_MUSIC_DIR=\"$HOME/Music\"\nXDG_VIDEOS_DIR=\"$HOME/Mes films\"\n"),
      home.path() / "Mes films");
  EXPECT_EQ(videos_folder().what, "your videos folder");
  EXPECT_EQ(says("XDG_VIDEOS_DIR=\"/data/\\$films\"\n"), fs::path("/data/$films"));
  EXPECT_EQ(says("XDG_VIDEOS_DIR=\"$HOME/a\"\nXDG_VIDEOS_DIR=\"$HOME/b\"\n"), home.path() / "b");
  // Home itself means that there is none; the same for what is no path.
  for (const char* none :
       {"XDG_VIDEOS_DIR=\"$HOME/\"\n", "XDG_VIDEOS_DIR=\"$HOME\"\n", "XDG_VIDEOS_DIR=\"Videos\"\n",
        "XDG_VIDEOS_DIR=\"$HOME/half\n", "#XDG_VIDEOS_DIR=\"$HOME/no\"\n", ""})
    EXPECT_EQ(says(none), home.path() / "Videos") << none;
  const test::Folder other;
  test::write_text(other / "user-dirs.dirs", "XDG_VIDEOS_DIR=\"$HOME/films\"\n");
  config.set(other.path().string());
  EXPECT_EQ(videos_folder().folder, home.path() / "films");
  own.set(std::nullopt);
  EXPECT_EQ(videos_folder().folder, ".");
}

TEST(StateFolder, FollowsTheSpecification) {
  const Variable own("HOME", "/home/somebody"), state("XDG_STATE_HOME", "/var/state");
  EXPECT_EQ(state_folder(), "/var/state/condyle");
  state.set("relative");
  EXPECT_EQ(state_folder(), "/home/somebody/.local/state/condyle");
  state.set(std::nullopt);
  own.set(std::nullopt);
  EXPECT_TRUE(state_folder().empty());
}

}  // namespace
}  // namespace condyle
