// Sessions of the window: saved, opened again, saved by themselves and recovered after a kill.
#include <algorithm>

#include "window_session.h"

namespace condyle::test {
namespace {

/// A window whose state is saved.
class WindowSaving : public WindowSession {
 protected:
  void SetUp() override {
    WindowSession::SetUp();
    patient_ = box_case(folder_);
    write_text(folder_ / "down.csv",
               "time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n0.5,0,0,-10,1,0,0,0\n"
               "1,0,0,0,1,0,0,0\n");
  }
  void open_patient() {
    start({patient_, "--motion", folder_ / "down.csv"});
    ASSERT_TRUE(wait_until(idle)) << "the patient is loaded";
  }
  /// What a session holds, of the state of the window.
  static Json kept(const Json& s) {
    Json part;
    for (const char* name :
         {"edits", "measured_points", "camera", "camera_direction", "tool", "playing", "time_s",
          "speed", "loop", "panels", "landmark_mm", "X_CM_wanted", "X_RC_wanted", "X_RC", "case"})
      part[name] = s.contains(name) ? s[name] : Json();
    return part;
  }
  /// Changes a bit of everything: parts, look, measures, landmarks, hands, camera, clock, panels.
  void change_everything() {
    click("show:maxilla");
    EXPECT_TRUE(press("a"));
    EXPECT_TRUE(press("n"));
    ASSERT_TRUE(wait_for_item("measure"));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    const Region beside = view_region();  // the tool has its column
    for (const double x : {0.48, 0.54})
      EXPECT_TRUE(xdotool({"mousemove", px(beside.x + x * beside.width),
                           px(beside.y + 0.6 * beside.height), "click", "1", "sleep", "0.2"}));
    ASSERT_TRUE(wait_until([](const Json& s) { return s["measured"] == 2; }));
    click("obey-contact");
    click("left-tab:Look");
    click("tab:Record");
    EXPECT_TRUE(press("m"));
    ASSERT_TRUE(wait_for_item("handle:S"));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    const auto tip = rect("handle:L");
    drag(tip[0] + 3, tip[1] + 3, tip[0] + 43, tip[1] + 3);
    ASSERT_TRUE(wait_until([](const Json& s) { return s.contains("X_CM_wanted"); }));
    const Region free = view_region();
    drag(free.x + 0.1 * free.width, free.y + 0.1 * free.height, free.x + 0.3 * free.width,
         free.y + 0.2 * free.height);
    ASSERT_TRUE(
        wait_until([](const Json& s) { return double(s["camera_direction"][1]) > -0.999; }));
  }
  std::vector<fs::path> autosaves() const {
    std::vector<fs::path> files;
    const fs::path place = folder_ / "states/condyle";
    if (fs::exists(place))
      for (const auto& entry : fs::directory_iterator(place))
        if (entry.path().extension() == ".condyle-session") files.push_back(entry.path());
    return files;
  }
  /// Waits for an autosave that has these words.
  bool autosaved(const std::string& words = "\"format\"") {
    return wait_until([&](const Json&) {
      const auto files = autosaves();
      return std::any_of(files.begin(), files.end(), [&](const fs::path& file) {
        return read_text(file).find(words) != std::string::npos;
      });
    });
  }
  void quit() {
    EXPECT_TRUE(press("ctrl+q"));
    EXPECT_EQ(wait_for_end(), 0);
  }
  std::string patient_;
};

TEST_F(WindowSaving, ASavedSessionOpensAsItWas) {
  open_patient();
  change_everything();
  EXPECT_TRUE(press("ctrl+s"));
  ASSERT_TRUE(wait_for_item("session-path"));
  see("save-dialog");
  const std::string file = folder_ / "my.condyle-session";
  write_into("session-path", folder_ / "my");
  ASSERT_TRUE(wait_until([&](const Json& s) { return s["session"] == file && fs::exists(file); }))
      << state().value("trouble", "nothing was said");
  see("saved");
  const Json before = kept(state());
  const Json text = Json::parse(read_text(file));
  EXPECT_EQ(text["patient"]["folder"],
            fs::path(patient_).lexically_relative(folder_.path()).string());
  EXPECT_EQ(text["view"]["motion"]["file"], "down.csv");
  quit();
  EXPECT_TRUE(autosaves().empty()) << "nothing is left to recover";

  start({file});
  ASSERT_TRUE(wait_until([](const Json& s) { return idle(s) && s.contains("X_CM_wanted"); }));
  EXPECT_TRUE(wait_until([&](const Json& s) { return kept(s) == before; }))
      << Json::diff(before, kept(state())).dump(1);
  EXPECT_TRUE(wait_until([](const Json& s) {
    return std::abs(double(s["frame"]["mandible_mm"][0]) - double(s["X_CM_wanted"]["mm"][0])) < 0.1;
  })) << "the jaw is where the hand holds it";
  see("opened-again");
  // Ctrl+S saves in the same file; another window's file is replaced only when the user agrees.
  const auto time = fs::last_write_time(file);
  EXPECT_TRUE(press("l"));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_TRUE(press("ctrl+s"));
  EXPECT_TRUE(wait_until([&](const Json&) { return fs::last_write_time(file) != time; }));
  fs::copy_file(file, folder_ / "other.condyle-session");
  const std::string other = read_text(folder_ / "other.condyle-session");
  EXPECT_TRUE(press("p"));
  EXPECT_TRUE(press("ctrl+shift+s"));
  write_into("session-path", folder_ / "other.condyle-session");
  ASSERT_TRUE(wait_for_item("session-keep"));
  EXPECT_TRUE(press("Return"));
  ASSERT_TRUE(wait_for_item("session-keep", false));
  EXPECT_EQ(read_text(folder_ / "other.condyle-session"), other);
  EXPECT_TRUE(press("ctrl+shift+s"));
  write_into("session-path", folder_ / "other.condyle-session");
  click("session-replace");
  EXPECT_TRUE(wait_until(
      [&](const Json&) { return read_text(folder_ / "other.condyle-session") != other; }));
  quit();
}

TEST_F(WindowSaving, AKilledWindowIsRecoveredOrDiscarded) {
  open_patient();
  EXPECT_TRUE(autosaves().empty()) << "as it was opened, there is nothing to lose";
  change_everything();
  // More than one interval after the last change, an autosave has all of them.
  std::this_thread::sleep_for(std::chrono::seconds(5));
  ASSERT_TRUE(autosaved("\"body\": \"mandible\""));
  const Json killed = kept(state());
  ASSERT_TRUE(killed["X_CM_wanted"].is_object());
  kill_at_once();
  ASSERT_EQ(autosaves().size(), 1u);

  start({patient_, "--motion", "rest"});
  ASSERT_TRUE(wait_for_item("recover-open"));
  see("recover");
  EXPECT_NE(std::string(state()["asked"]).find("The session of"), std::string::npos)
      << state()["asked"];
  click("recover-open");
  ASSERT_TRUE(wait_until(idle));
  EXPECT_TRUE(wait_until([&](const Json& s) { return kept(s) == killed; }))
      << Json::diff(killed, kept(state())).dump(1);
  see("recovered");
  // Killed once more before anything is changed: nothing is lost.
  kill_at_once();
  start({patient_, "--motion", "rest"});
  ASSERT_TRUE(wait_for_item("recover-open"));
  EXPECT_TRUE(press("Escape"));  // kept for the next start
  ASSERT_TRUE(wait_until([](const Json& s) { return idle(s) && s["motion"] == "rest"; }));
  quit();
  EXPECT_EQ(autosaves().size(), 1u);
  start({patient_, "--motion", "rest"});
  click("recover-discard");
  ASSERT_TRUE(wait_until([](const Json& s) { return idle(s) && s["motion"] == "rest"; }));
  EXPECT_FALSE(state().contains("X_CM_wanted"));
  EXPECT_TRUE(autosaves().empty());
  quit();
  EXPECT_TRUE(fs::is_empty(folder_ / "states/condyle"));
}

TEST_F(WindowSaving, TwoWindowsKeepTheirOwnSessions) {
  open_patient();
  click("show:maxilla");
  ASSERT_TRUE(autosaved());
  const pid_t first = set_aside();
  start({patient_, "--motion", "rest"});
  ASSERT_TRUE(wait_until(idle)) << "no question: the other window lives";
  EXPECT_TRUE(press("l"));
  EXPECT_TRUE(wait_until([&](const Json&) { return autosaves().size() == 2; }));
  kill(first, SIGKILL);
  waitpid(first, nullptr, 0);
  kill_at_once();
  start({patient_, "--motion", "rest"});
  ASSERT_TRUE(wait_for_item("recover-discard"));
  EXPECT_NE(std::string(state()["asked"]).find("1 older one is kept"), std::string::npos)
      << state()["asked"];
  click("recover-discard");
  ASSERT_TRUE(wait_until([](const Json& s) {
    return s.contains("asked") && std::string(s["asked"]).find("older") == std::string::npos;
  })) << "the other one is offered";
  click("recover-open");
  ASSERT_TRUE(wait_until(idle));
  EXPECT_TRUE(wait_until([&](const Json& s) {
    return std::string(s["motion"]).ends_with("down.csv") &&
           s["edits"]["parts"].dump().find("0.0") != std::string::npos;
  })) << state()["edits"].dump();
  quit();
}

TEST_F(WindowSaving, SessionsThatCannotBeOpenedAreReportedAndThePatientStays) {
  open_patient();
  EXPECT_TRUE(press("ctrl+s"));
  const std::string file = folder_ / "good.condyle-session";
  write_into("session-path", file);
  ASSERT_TRUE(wait_until([&](const Json& s) { return s["session"] == file; }));
  const std::string good = read_text(file);
  const auto refused = [&](const std::string& text, const std::string& words) {
    const std::string bad = folder_ / "bad.condyle-session";
    write_text(bad, text);
    EXPECT_TRUE(press("ctrl+o"));
    write_into("open-path", bad);
    EXPECT_TRUE(wait_until([&](const Json& s) {
      return s.value("trouble", "").find(words) != std::string::npos;
    })) << words
        << "\n"
        << state().value("trouble", "nothing was said");
    EXPECT_TRUE(press("Return"));
    EXPECT_TRUE(wait_for_item("error", false));
    EXPECT_TRUE(wait_until([&](const Json& s) { return idle(s) && s["session"] == file; }));
    // The command line ends with exit code 2 before there is a window.
    const Outcome outcome = condyle({"view", bad});
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find("bad.condyle-session"), std::string::npos) << outcome.err;
    EXPECT_EQ(read_text(bad), text) << "nothing was changed";
  };
  refused(good.substr(0, good.size() / 2), "bad.condyle-session: line");
  Json newer = Json::parse(good);
  newer["version"] = 9;
  refused(newer.dump(), "bad.condyle-session: version: is 9");
  Json odd = Json::parse(good);
  odd["view"]["look"]["wipe_at"] = "left";
  refused(odd.dump(), "view.look.wipe_at: is \"left\"");
  // A patient that has changed: what does not fit is said, the rest is opened.
  Json other = Json::parse(good);
  other["case"]["parts"][0]["shape"] = "0123456789abcdef";
  write_text(folder_ / "changed.condyle-session", other.dump());
  EXPECT_TRUE(press("ctrl+o"));
  write_into("open-path", folder_ / "changed.condyle-session");
  EXPECT_TRUE(wait_until([&](const Json& s) {
    return s.value("trouble", "").find("The patient has changed since") != std::string::npos;
  })) << state().value("trouble", "nothing was said");
  see("another-shape");
  EXPECT_TRUE(press("Return"));
  EXPECT_TRUE(wait_until([&](const Json& s) {
    return idle(s) && s["session"] == folder_ / "changed.condyle-session";
  }));
  // A session is not saved over what is none.
  EXPECT_TRUE(press("ctrl+shift+s"));
  write_into("session-path", "/proc/no.condyle-session");
  ASSERT_TRUE(wait_for_item("error"));
  EXPECT_TRUE(press("Return"));
  quit();
}

/// A program of this name along PATH instead of the desktop's own.
class DialogStandIn {
 public:
  DialogStandIn(const std::string& folder, const std::string& script) : before_(getenv("PATH")) {
    fs::create_directories(folder);
    write_text(folder + "/zenity", "#!/bin/sh\n" + script);
    fs::permissions(folder + "/zenity", fs::perms::owner_all);
    setenv("PATH", (folder + ":" + before_).c_str(), 1);
  }
  ~DialogStandIn() { setenv("PATH", before_.c_str(), 1); }
  DialogStandIn(const DialogStandIn&) = delete;
  DialogStandIn& operator=(const DialogStandIn&) = delete;

 private:
  std::string before_;
};

TEST_F(WindowSaving, TheDialogOfTheDesktopAnswersFailsOrHangsWithoutBlocking) {
  const std::string said = folder_ / "answer", asked = folder_ / "asked";
  const DialogStandIn dialog(folder_ / "bin", "echo \"$@\" >" + asked + "\n. " + said + "\n");
  open_patient();
  const auto browse = [&](const std::string& answer) {
    write_text(said, answer);
    EXPECT_TRUE(press("ctrl+o"));
    click("open-browse");
  };
  browse("echo " + folder_ / "down.csv" + "\n");
  EXPECT_TRUE(
      wait_until([&](const Json& s) { return idle(s) && s["motion"] == folder_ / "down.csv"; }));
  browse("exit 1\n");  // cancelled
  std::this_thread::sleep_for(std::chrono::milliseconds(600));
  EXPECT_FALSE(state().contains("trouble"));
  browse("kill -9 $$\n");
  EXPECT_TRUE(wait_until([](const Json& s) {
    return s.value("trouble", "").find("ended with a signal") != std::string::npos;
  }));
  EXPECT_TRUE(press("Return"));
  EXPECT_TRUE(wait_for_item("error", false));
  // One that never answers: the window is used meanwhile, and closes it.
  browse("exec sleep 1000\n");
  click("play");
  EXPECT_TRUE(wait_until([](const Json& s) { return s["playing"] == true && s["time_s"] > 0.1; }));
  click("play");
  EXPECT_TRUE(press("ctrl+o"));
  click("open-browse");
  EXPECT_TRUE(wait_until(
      [](const Json& s) { return s.value("said", "").find("open already") != std::string::npos; }));
  quit();
}

TEST_F(WindowSaving, TheDialogSavesASessionAndChoosesAFolder) {
  const DialogStandIn dialog(folder_ / "bin", "case \"$*\" in *--directory*) echo " +
                                                  (folder_ / "films") + ";; *) echo " +
                                                  (folder_ / "by-dialog") + ";; esac\n");
  open_patient();
  EXPECT_TRUE(press("ctrl+s"));
  click("session-browse");
  const std::string file = folder_ / "by-dialog.condyle-session";
  EXPECT_TRUE(wait_until([&](const Json& s) { return s["session"] == file && fs::exists(file); }));
  click("tab:Record");
  see("record-panel");
  click("record-browse");
  click("record-height:720");
  std::this_thread::sleep_for(std::chrono::milliseconds(600));
  click("record");
  EXPECT_TRUE(wait_until(
      [&](const Json& s) { return idle(s) && fs::exists(folder_ / "films/film.mp4"); }, 90));
  quit();
}

}  // namespace
}  // namespace condyle::test
