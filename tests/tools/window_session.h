#pragma once

#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "tests/support/display.h"
#include "tests/support/places.h"
#include "tests/support/program.h"

namespace condyle::test {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// `condyle view` running on its own virtual screen.
class WindowSession : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(has_program("Xvfb") && has_program("xdotool")) << "install xvfb and xdotool";
    display_ = std::make_unique<TestDisplay>();
    ASSERT_TRUE(display_->running());
    setenv("XDG_CONFIG_HOME", (folder_ / "config").c_str(), 1);
    setenv("XDG_STATE_HOME", (folder_ / "states").c_str(), 1);
    for (const auto& entry : fs::directory_iterator(kept_pictures()))  // of an earlier run
      if (entry.path().filename().string().starts_with(test_name() + "-")) fs::remove(entry.path());
  }
  void TearDown() override {
    if (program_ > 0) {
      kill(program_, SIGKILL);
      waitpid(program_, nullptr, 0);
    }
    unsetenv("XDG_CONFIG_HOME");
    unsetenv("XDG_STATE_HOME");
    report_time_away();
  }
  /// The interface thread leaves all long work to other threads. On an idle machine it is away from
  /// mouse and keyboard for less than 0.1 s, on a shared one longer.
  void report_time_away() {
    const Json now = state();
    if (now.empty()) return;
    const int away = now["longest_away_ms"], work = now["longest_work_ms"];
    std::printf("longest time away from mouse and keyboard: %d ms, without OpenGL %d ms\n", away,
                work);
    EXPECT_LT(away, 800);
  }
  void start(std::vector<std::string> arguments) {
    ++starts_;  // a program that was set aside goes on writing its own state file
    arguments.insert(arguments.begin(), {program_file().string(), "--threads", "1", "view"});
    arguments.insert(arguments.end(), {"--state-file", state_file()});
    std::vector<char*> words;
    for (auto& word : arguments) words.push_back(word.data());
    words.push_back(nullptr);
    ASSERT_EQ(posix_spawn(&program_, words[0], nullptr, nullptr, words.data(), environ), 0);
  }
  Json state() {
    const std::string file = state_file();
    return fs::exists(file) ? Json::parse(read_text(file)) : Json::object();
  }
  bool wait_until(const std::function<bool(const Json&)>& law, double longest_s = 120) {
    const auto start = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - start < std::chrono::duration<double>(longest_s)) {
      const Json now = state();
      if (!now.empty() && law(now)) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
    }
    std::printf("after %g s: %s\n", longest_s, summary(state()).dump().c_str());
    return false;
  }
  /// What a wait that failed prints of the state.
  static Json summary(Json s) {
    for (const char* name : {"items", "recent", "landmark_mm", "measured_points"}) s.erase(name);
    return s;
  }
  bool wait_for_item(const std::string& name, bool there = true) {
    return wait_until([&](const Json& s) { return s["items"].contains(name) == there; });
  }
  std::array<double, 4> rect(const std::string& name) {
    const Json now = state();
    if (!now["items"].contains(name)) {
      ADD_FAILURE() << "no item '" << name << "' is in the window";
      return {};
    }
    return now["items"][name];
  }
  static std::string px(double value) { return std::to_string(std::lround(value)); }
  void click(const std::string& name) {
    ASSERT_TRUE(wait_for_item(name)) << name;
    const auto r = rect(name);
    EXPECT_TRUE(xdotool({"mousemove", px(r[0] + r[2] / 2), px(r[1] + r[3] / 2), "click", "1"}));
  }
  void drag(double x0, double y0, double x1, double y1) {
    std::vector<std::string> moves = {"mousemove", px(x0), px(y0), "mousedown", "1"};
    for (int i = 1; i <= 5; ++i)
      moves.insert(moves.end(), {"mousemove", px(x0 + (x1 - x0) * i / 5),
                                 px(y0 + (y1 - y0) * i / 5), "sleep", "0.03"});
    moves.insert(moves.end(), {"mouseup", "1"});
    EXPECT_TRUE(xdotool(moves));
  }
  pid_t program() const { return program_; }
  static bool press(const std::string& key) { return xdotool({"key", key}); }
  void kill_at_once() {
    kill(program_, SIGKILL);
    waitpid(std::exchange(program_, -1), nullptr, 0);
  }
  /// Leaves the program running, for another one to be started; the caller kills it.
  pid_t set_aside() { return std::exchange(program_, -1); }
  int wait_for_end() {
    int status = 0;
    for (int i = 0; i < 400; ++i) {
      if (waitpid(program_, &status, WNOHANG) == program_) {
        program_ = -1;
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return -1;
  }

  /// Selects the body that handles and numbers move.
  void choose_body(const std::string& name) {
    click("body");
    click("body:" + name);
    EXPECT_TRUE(wait_until([&](const Json& s) { return s["chosen"] == name; })) << name;
  }
  /// Replaces the text of a field.
  void write_into(const std::string& field, const std::string& words) {
    click(field);
    ASSERT_TRUE(wait_for_item("writing"));
    EXPECT_TRUE(press("ctrl+a"));
    EXPECT_TRUE(xdotool({"type", "--", words}));
    EXPECT_TRUE(press("Return"));
  }
  Picture display_picture() const { return display_->picture(); }
  /// The screen once nothing changes any more.
  Picture settled_picture() {
    Picture last = display_->picture();
    int calm = 0;
    for (int i = 0; i < 60 && calm < 2; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
      Picture now = display_->picture();
      const bool same = difference(now, last) < 2e-4;
      calm = same && state()["picture_finished"] == true ? calm + 1 : 0;
      last = std::move(now);
    }
    return last;
  }
  Region view_region() {
    const std::array<double, 4> view = state()["view"];
    return {view[0], view[1], view[2], view[3]};
  }
  /// Stores the picture of a step (SESSION-NUMBER-STEP.png), also of one that fails. Returns the
  /// fraction of the 3-D view that differs from the step before; 1 for the first.
  double see(const std::string& step) { return keep(step, settled_picture()); }
  /// The same for a moving picture.
  double see_now(const std::string& step) {
    std::this_thread::sleep_for(std::chrono::milliseconds(150));  // until it is on the screen
    return keep(step, display_->picture());
  }
  /// The screen once more than a fraction of an item's pixels differ from the step before; after
  /// 20 s as it is. A busy machine shows an item, and gives it its size, after the state names it.
  /// Returns the item's region.
  Region see_changed(const std::string& step, const std::string& item, double fraction) {
    Region region = region_of(item);
    Picture now = display_->picture();
    for (int i = 0; i < 100 && !(difference(now, seen_, region) > fraction); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      region = region_of(item);
      now = display_->picture();
    }
    keep(step, std::move(now));
    return region;
  }
  Region region_of(const std::string& item) {
    const auto r = rect(item);
    return {r[0], r[1], r[2], r[3]};
  }

  static std::string test_name() {
    return testing::UnitTest::GetInstance()->current_test_info()->name();
  }

  Folder folder_;
  Picture seen_, seen_before_;  // at the last step and at the one before

 private:
  double keep(const std::string& step, Picture now) {
    now.save(kept_pictures() /
             (test_name() + "-" + std::to_string(10 + steps_++) + "-" + step + ".png"));
    const double changed = difference(now, seen_, view_region());
    seen_before_ = std::exchange(seen_, std::move(now));
    return changed;
  }

  std::string state_file() const {
    return folder_ / ("state-" + std::to_string(starts_) + ".json");
  }

  int steps_ = 0;
  int starts_ = 0;
  std::unique_ptr<TestDisplay> display_;
  pid_t program_ = -1;
};

/// Whether the patient is loaded and no background work runs.
inline bool idle(const Json& s) { return s["busy_with"] == "" && s.contains("frame"); }

}  // namespace condyle::test
