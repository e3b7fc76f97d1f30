#include "render/window/window.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <numbers>
#include <thread>

#include "engine/core/error.h"
#include "render/window/input/gizmos.h"
#include "tests/render/window/panel_stage.h"
#include "tests/support/display.h"
#include "tests/support/window_hints.h"

namespace condyle {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// A window on a virtual screen with a simulation of boxes. The window runs on the test's thread; a
/// script with real events runs on another one.
class RealWindow : public testing::Test {
 protected:
  struct Seen {
    ViewState view;
    Camera camera;
    std::vector<DrawnItem> items;
    ViewRect rect;
    double shown_opening_mm = 0;
    std::string said;
    int loops = 0;
  };

  void SetUp() override {
    if (!has_program("Xvfb") || !has_program("xdotool")) FAIL() << "install xvfb and xdotool";
    display_ = std::make_unique<TestDisplay>();
    ASSERT_TRUE(display_->running()) << "Xvfb did not start";
    folder_ =
        std::filesystem::temp_directory_path() / ("condyle-window-" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    options_ = {.title = "Condyle test", .picture_folder = folder_};
  }
  void TearDown() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  /// Runs the window until the script has ended or the person has closed it.
  void run(const std::function<void()>& script) {
    Window window(options_);
    window.set_scene({.parts = parts_,
                      .case_name = "Boxes",
                      .motion_name = "opening",
                      .duration_s = 4,
                      .max_opening_mm = 50,
                      .distance_colours = distance_colours(),
                      .bodies = movable_bodies(parts_, native_bodies()),
                      .motions = motions_,
                      .motion = {.spec = "opening", .parameters = {}, .excitations = {}}});
    // The lower teeth have their height as distance values.
    const TriMesh& teeth = parts_[3].mesh;
    const std::vector<Eigen::Vector3f> normals(teeth.vertices.size(), {0, -1, 0});
    window.set_map_surfaces({{.part = 3, .mesh = &teeth, .normals = normals}});
    std::vector<std::vector<float>> values(1);
    for (const auto& v : teeth.vertices) values[0].push_back(static_cast<float>(v.z() + 43) / 8);
    std::atomic<bool> done = false;
    std::thread person([&] {
      wait_until([](const Seen& seen) { return seen.loops > 5 && !seen.items.empty(); });
      script();
      done = true;
      Window::wake();
    });
    const auto start = Clock::now();
    while (window.open() && !done && Clock::now() - start < std::chrono::seconds(60)) {
      const ViewState request = window.poll();
      const double opening =
          request.opening_mm.value_or(20 - 20 * std::cos(request.time_s * std::numbers::pi / 2));
      FrameState frame = box_frame(request.time_s, opening);
      if (const auto hand = request.hands.at(mandible_body)) {
        frame.poses[mandible_body] = *hand;
        frame.state_hash += static_cast<std::uint64_t>(1e6 * (200 + hand->t.sum()));
      }
      window.show(frame, {.steps_per_second = 60},
                  request.distances ? values : std::vector<std::vector<float>>{});
      const std::lock_guard lock(mutex_);
      seen_ = {window.view(), window.camera(), window.items(), window.view_rect(),
               opening,       window.said(),   seen_.loops + 1};
    }
    closed_ = !window.open();
    picture_ = window.picture();
    test::Picture(picture_).save(test::kept_pictures() / ("window-" + name() + ".png"));
    person.join();
  }

  // For the script:
  Seen seen() {
    const std::lock_guard lock(mutex_);
    return seen_;
  }
  bool wait_until(const std::function<bool(const Seen&)>& law, double longest_s = 10) {
    const auto start = Clock::now();
    while (Clock::now() - start < std::chrono::duration<double>(longest_s)) {
      if (law(seen())) return true;
      std::this_thread::sleep_for(milliseconds(10));
    }
    return false;
  }
  /// The camera once every event of a drag has arrived.
  Camera settled_camera() {
    Camera last = seen().camera;
    for (int calm = 0; calm < 4;) {
      std::this_thread::sleep_for(milliseconds(50));
      const Camera now = seen().camera;
      const bool same = now.target == last.target && now.direction == last.direction &&
                        now.up == last.up && now.distance_mm == last.distance_mm;
      calm = same ? calm + 1 : 0;
      last = now;
    }
    return last;
  }
  /// The hand's target for the jaw, once every event of a drag has arrived.
  Eigen::Vector3d settled_jaw() {
    const auto jaw = [&] {
      const auto hand = seen().view.hands.at(mandible_body);
      return hand ? hand->t : Eigen::Vector3d::Zero().eval();
    };
    Eigen::Vector3d last = jaw();
    for (int calm = 0; calm < 6;) {
      std::this_thread::sleep_for(milliseconds(50));
      const Eigen::Vector3d now = jaw();
      calm = now == last ? calm + 1 : 0;
      last = now;
    }
    return last;
  }
  ViewRect place(const std::string& item_name) {
    for (const DrawnItem& item : seen().items)
      if (item.name == item_name) return item.rect;
    ADD_FAILURE() << "no item '" << item_name << "' is in the window";
    return {};
  }
  static std::string px(double value) { return std::to_string(std::lround(value)); }
  void click(const std::string& item) {
    const ViewRect r = place(item);
    EXPECT_TRUE(
        xdotool({"mousemove", px(r.x + r.width / 2), px(r.y + r.height / 2), "click", "1"}));
  }
  /// Presses at one position, moves in steps, releases at the other.
  void drag(double x0, double y0, double x1, double y1, const std::string& button,
            const std::string& key = {}) {
    if (!key.empty()) {
      EXPECT_TRUE(xdotool({"keydown", key}));
    }
    std::vector<std::string> moves = {"mousemove", px(x0), px(y0), "mousedown", button};
    for (int i = 1; i <= 5; ++i) {
      const double f = i / 5.0;
      moves.insert(moves.end(),
                   {"mousemove", px(x0 + f * (x1 - x0)), px(y0 + f * (y1 - y0)), "sleep", "0.03"});
    }
    moves.insert(moves.end(), {"mouseup", button});
    EXPECT_TRUE(xdotool(moves));
    if (!key.empty()) {
      EXPECT_TRUE(xdotool({"keyup", key}));
    }
  }
  void drag_in_view(double dx, double dy, const std::string& button, const std::string& key = {}) {
    const ViewRect r = seen().rect;
    const double x = r.x + r.width * 0.5, y = r.y + r.height * 0.4;
    drag(x, y, x + dx, y + dy, button, key);
  }
  bool press(const std::string& key) { return xdotool({"key", key}); }
  static std::string name() {
    return testing::UnitTest::GetInstance()->current_test_info()->name();
  }

  std::unique_ptr<TestDisplay> display_;
  std::filesystem::path folder_;
  WindowOptions options_;
  std::vector<Part> parts_ = box_patient();
  std::vector<std::string> motions_ = {};
  bool closed_ = false;
  Image picture_;  // the last

 private:
  std::mutex mutex_;
  Seen seen_;
};

double moved_mm(const Camera& a, const Camera& b) { return (a.target - b.target).norm(); }
double turned_rad(const Camera& a, const Camera& b) {
  return std::acos(std::clamp(a.direction.dot(b.direction), -1.0, 1.0));
}

TEST_F(RealWindow, SpacePlaysAndPauses) {
  run([&] {
    EXPECT_FALSE(seen().view.playing);
    EXPECT_TRUE(press("space"));
    EXPECT_TRUE(wait_until([](const Seen& s) { return s.view.playing && s.view.time_s > 0.2; }));
    EXPECT_TRUE(press("space"));
    EXPECT_TRUE(wait_until([](const Seen& s) { return !s.view.playing; }));
    const double time = seen().view.time_s;
    EXPECT_TRUE(press("Right"));
    EXPECT_TRUE(wait_until([&](const Seen& s) { return s.view.time_s > time; }));
    EXPECT_NEAR(seen().view.time_s, time + 1.0 / 30, 1e-9);
    EXPECT_TRUE(press("shift+Left"));
    EXPECT_TRUE(wait_until([&](const Seen& s) { return s.view.time_s < time; }));
  });
  EXPECT_FALSE(closed_);
}

TEST_F(RealWindow, PlayingKeepsTimeWithTheClock) {
  run([&] {
    click("play");
    ASSERT_TRUE(wait_until([](const Seen& s) { return s.view.playing; }));
    const double before = seen().view.time_s;
    const auto start = Clock::now();
    std::this_thread::sleep_for(milliseconds(1500));
    const double passed = std::chrono::duration<double>(Clock::now() - start).count();
    // On a busy machine the clock may wait for pictures, but it never runs ahead of real time.
    EXPECT_LT(seen().view.time_s - before, passed + 0.25);
    EXPECT_GT(seen().view.time_s - before, 0.5 * passed - 0.25);
  });
}

TEST_F(RealWindow, MouseMovesTheCameraAsInTheHelp) {
  run([&] {
    Camera before = settled_camera();
    drag_in_view(120, 30, "1");
    Camera after = settled_camera();
    EXPECT_GT(turned_rad(after, before), 0.2);
    EXPECT_DOUBLE_EQ(after.distance_mm, before.distance_mm);
    EXPECT_EQ(moved_mm(after, before), 0);

    before = after;
    drag_in_view(80, 0, "1", "shift");
    after = settled_camera();
    EXPECT_GT(moved_mm(after, before), 5);
    EXPECT_LT(turned_rad(after, before), 1e-6);

    before = after;
    drag_in_view(0, 80, "2");
    after = settled_camera();
    EXPECT_GT(moved_mm(after, before), 5);

    before = after;
    drag_in_view(0, 60, "3");
    after = settled_camera();
    EXPECT_GT(after.distance_mm, 1.1 * before.distance_mm);

    before = after;
    EXPECT_TRUE(xdotool({"click", "4"}));
    after = settled_camera();
    EXPECT_LT(after.distance_mm, before.distance_mm);

    before = after;
    drag_in_view(120, 0, "1", "ctrl");
    after = settled_camera();
    EXPECT_GT(std::abs(camera_angles(after).roll - camera_angles(before).roll), 0.2);
    EXPECT_LT(turned_rad(after, before), 1e-6);
  });
}

TEST_F(RealWindow, HandsMoveTheJawByHandlesByItselfAndByNumbers) {
  run([&] {
    EXPECT_TRUE(press("a"));
    EXPECT_TRUE(press("k"));  // the skin would hide the jaw
    EXPECT_TRUE(press("m"));
    ASSERT_TRUE(wait_until([](const Seen& s) {
      return std::any_of(s.items.begin(), s.items.end(),
                         [](const DrawnItem& i) { return i.name == "handle:S"; });
    }));
    const Camera before = settled_camera();
    // The upward arrow takes it down, and only that.
    const ViewRect tip = place("handle:S");
    drag(tip.x + 3, tip.y + 3, tip.x + 3, tip.y + 43, "1");
    ASSERT_TRUE(wait_until([](const Seen& s) {
      return s.view.hands.at(mandible_body) && s.view.hands.at(mandible_body)->t.z() < -5;
    }));
    const Eigen::Vector3d down = settled_jaw();
    EXPECT_EQ(down.head<2>().norm(), 0);
    EXPECT_EQ(moved_mm(settled_camera(), before), 0) << "the camera stays";
    // Gripped itself it moves.
    const ViewRect rest = place("handle:S");
    const double x = rest.x + 3 + 85, y = rest.y + 3 + 78 + 12;  // beside the rings
    drag(x, y, x + 30, y, "1");
    EXPECT_TRUE(wait_until([](const Seen& s) {
      return s.view.hands.at(mandible_body) && s.view.hands.at(mandible_body)->t.x() > 3;
    }));
    EXPECT_NEAR(settled_jaw().z(), down.z(), 1e-6);
    EXPECT_TRUE(press("ctrl+z"));
    EXPECT_TRUE(wait_until([&](const Seen& s) {
      return s.view.hands.at(mandible_body) && s.view.hands.at(mandible_body)->t == down;
    }));
    EXPECT_TRUE(press("ctrl+z"));
    EXPECT_TRUE(wait_until([](const Seen& s) { return !s.view.hands.at(mandible_body); }));
    // Digits and letters in a field are no shortcuts.
    click("shift:L");
    std::this_thread::sleep_for(milliseconds(200));
    EXPECT_TRUE(xdotool({"type", "3.5"}));
    EXPECT_TRUE(press("Return"));
    EXPECT_TRUE(wait_until([](const Seen& s) {
      return s.view.hands.at(mandible_body) &&
             std::abs(s.view.hands.at(mandible_body)->t.x() - 3.5) < 1e-9;
    })) << seen().view.hands.at(mandible_body).value_or(Pose{}).t.x();
    EXPECT_EQ(moved_mm(settled_camera(), before), 0);
    EXPECT_LT(turned_rad(settled_camera(), before), 1e-9);
  });
}

TEST_F(RealWindow, ClicksOnTheSurfaceMeasure) {
  run([&] {
    EXPECT_TRUE(press("a"));
    const Camera camera = settled_camera();
    EXPECT_TRUE(press("n"));
    ASSERT_TRUE(wait_until([](const Seen& s) { return s.view.tool == Tool::measure; }));
    // Two places of the face's flat front, 60 mm apart.
    const ViewRect rect = seen().rect;
    const auto click_at = [&](const Eigen::Vector3d& p) {
      const auto at = screen_place(camera, rect, p);
      EXPECT_TRUE(xdotool({"mousemove", px(at.x()), px(at.y()), "click", "1"}));
    };
    click_at({-30, -95, 40});
    ASSERT_TRUE(wait_until([](const Seen& s) { return s.view.measured.size() == 1; }));
    click_at({30, -95, 40});
    ASSERT_TRUE(wait_until([](const Seen& s) { return s.view.measured.size() == 2; }));
    std::vector<Eigen::Vector3d> places;
    for (const auto& point : seen().view.measured)
      places.push_back(place_of(point, parts_, box_frame(0, 0)));
    EXPECT_NEAR(measured(places).length_mm, 60, 2 * pixel_mm(camera, rect));
    EXPECT_EQ(moved_mm(settled_camera(), camera), 0);
    click("measure-clear");
    EXPECT_TRUE(wait_until([](const Seen& s) { return s.view.measured.empty(); }));
  });
}

TEST_F(RealWindow, KeysChooseTheStandardViews) {
  const auto looks = [&](const std::string& key, const Eigen::Vector3d& from) {
    EXPECT_TRUE(press(key)) << key;
    EXPECT_TRUE(
        wait_until([&](const Seen& s) { return (s.camera.direction - from).norm() < 1e-9; }, 5))
        << key << " looks from " << seen().camera.direction.transpose();
  };
  run([&] {
    looks("KP_1", {0, -1, 0});
    looks("KP_3", {1, 0, 0});
    looks("KP_7", {0, 0, 1});
    looks("p", {0, 1, 0});
    looks("r", {-1, 0, 0});
    looks("i", {0, 0, -1});
    looks("a", {0, -1, 0});
    looks("shift+a", {0, 1, 0});
    const ViewRect home = place("view:home");
    EXPECT_GT(home.width, 0);
    click("view:S");
    EXPECT_TRUE(wait_until([](const Seen& s) { return s.camera.direction.z() > 0.999; }));
    EXPECT_TRUE(press("Home"));
    EXPECT_TRUE(wait_until([](const Seen& s) { return s.camera.direction.z() < 0.5; }));
  });
}

TEST_F(RealWindow, OpeningSliderOpensTheMouth) {
  run([&] {
    const ViewRect r = place("opening");
    drag(r.x + r.width * 0.1, r.y + r.height / 2, r.x + r.width * 0.6, r.y + r.height / 2, "1");
    EXPECT_TRUE(wait_until([](const Seen& s) { return s.view.opening_mm.value_or(0) > 28; }));
    EXPECT_NEAR(seen().shown_opening_mm, 30, 1);
    // The drag on the panel must not turn the patient.
    EXPECT_EQ(seen().view.playing, false);
    click("release");
    EXPECT_TRUE(wait_until([](const Seen& s) { return !s.view.opening_mm.has_value(); }));
  });
}

TEST_F(RealWindow, KeyDShowsDistancesAndTheLegendIsNoPartOfTheView) {
  run([&] {
    EXPECT_TRUE(press("d"));
    ASSERT_TRUE(wait_until([](const Seen& s) {
      return s.view.distances && s.view.skin_opacity == 0 &&
             std::any_of(s.items.begin(), s.items.end(),
                         [](const DrawnItem& item) { return item.name == "legend"; });
    }));
    const ViewRect legend = place("legend");
    const Camera before = settled_camera();
    drag(legend.x + 20, legend.y + 20, legend.x + 120, legend.y + 20, "1");
    EXPECT_EQ(turned_rad(settled_camera(), before), 0);
    EXPECT_TRUE(press("a"));
    EXPECT_TRUE(wait_until([](const Seen& s) { return s.camera.direction.y() < -0.999; }));
    click("left-tab:Look");
    ASSERT_TRUE(wait_until([](const Seen& s) { return s.view.left_tab == LeftTab::look; }));
    std::this_thread::sleep_for(milliseconds(150));
    click("distances");
    EXPECT_TRUE(wait_until([](const Seen& s) { return !s.view.distances; }));
    click("distances");
    EXPECT_TRUE(wait_until([](const Seen& s) { return s.view.distances; }));
    EXPECT_TRUE(press("space"));
    EXPECT_TRUE(wait_until([](const Seen& s) { return s.view.time_s > 0.3; }));
    EXPECT_TRUE(press("space"));
    const ViewRect view = seen().rect;
    EXPECT_TRUE(xdotool({"mousemove", px(view.x + view.width / 2), px(view.y + view.height / 2)}));
    std::this_thread::sleep_for(milliseconds(300));
  });
  EXPECT_FALSE(closed_);
  // The view has red, white and blue, from the teeth.
  const ViewRect view = seen().rect;
  const ViewRect legend = place("legend");
  int red = 0, blue = 0;
  for (int y = static_cast<int>(view.y); y < view.y + view.height; ++y)
    for (int x = static_cast<int>(view.x); x < view.x + view.width; ++x) {
      if (legend.contains(x, y)) continue;
      const auto* p = &picture_.rgba[4 * (static_cast<std::size_t>(y) * picture_.width + x)];
      red += p[0] > p[2] + 60;
      blue += p[2] > p[0] + 40;
    }
  EXPECT_GT(red, 200);
  EXPECT_GT(blue, 200);
}

TEST_F(RealWindow, ClicksAreNotLostWhenTheMouseHurriesOn) {
  run([&] {
    const ViewRect play = place("play"), mandible = place("show:mandible");
    const Camera before = seen().camera;
    // All at once: far faster than pictures are drawn.
    EXPECT_TRUE(
        xdotool({"mousemove", px(mandible.x + 8), px(mandible.y + 8), "click", "1", "mousemove",
                 px(play.x + 8), px(play.y + 8), "click", "1", "mousemove", "640", "300"}));
    EXPECT_TRUE(wait_until([](const Seen& s) { return s.view.playing && !s.view.parts[4].shown; }));
    EXPECT_EQ(turned_rad(seen().camera, before), 0);
  });
}

TEST_F(RealWindow, CtrlQCloses) {
  run([&] {
    EXPECT_TRUE(press("ctrl+q"));
    std::this_thread::sleep_for(milliseconds(500));
  });
  EXPECT_TRUE(closed_);
}

TEST_F(RealWindow, HelpOpensAndEscapeCloses) {
  const auto has_help = [](const Seen& s) {
    for (const DrawnItem& item : s.items)
      if (item.name == "help") return true;
    return false;
  };
  run([&] {
    EXPECT_TRUE(press("F1"));
    EXPECT_TRUE(wait_until(has_help));
    const Camera before = settled_camera();
    drag_in_view(100, 0, "1");  // the dialog is in front of the patient
    EXPECT_EQ(turned_rad(settled_camera(), before), 0);
    EXPECT_TRUE(press("Escape"));
    EXPECT_TRUE(wait_until([&](const Seen& s) { return !has_help(s); }));
    drag_in_view(100, 0, "1");
    EXPECT_TRUE(wait_until([&](const Seen& s) { return turned_rad(s.camera, before) > 0.1; }));
  });
}

TEST_F(RealWindow, SavesThePictureAndTheWholeWindow) {
  options_.picture_folder = std::filesystem::relative(folder_);
  const auto saved = [&] {
    std::vector<Image> images;
    for (const auto& entry : std::filesystem::directory_iterator(folder_))
      if (entry.path().extension() == ".png") images.push_back(read_png(entry.path()));
    return images;
  };
  run([&] {
    const ViewRect view = seen().rect;
    EXPECT_TRUE(press("F12"));
    EXPECT_TRUE(wait_until([&](const Seen&) { return saved().size() == 1; }));
    EXPECT_TRUE(wait_until([&](const Seen& seen) {
      return seen.said.starts_with("Saved " + (folder_ / "condyle-").string());
    })) << seen().said;
    EXPECT_EQ(saved().at(0).width, std::lround(view.width));
    EXPECT_EQ(saved().at(0).height, std::lround(view.height));
    EXPECT_TRUE(press("shift+F12"));
    EXPECT_TRUE(wait_until([&](const Seen&) { return saved().size() == 2; }));
    bool whole = false;
    for (const Image& image : saved()) whole |= image.width == 1280 && image.height == 720;
    EXPECT_TRUE(whole);
  });
}

TEST_F(RealWindow, APictureThatCannotBeSavedIsASentence) {
  options_.picture_folder = folder_ / "missing" / "folder";
  run([&] {
    EXPECT_TRUE(press("F12"));
    EXPECT_TRUE(wait_until([](const Seen& s) {
      for (const DrawnItem& item : s.items)
        if (item.name == "error") return true;
      return false;
    }));
    EXPECT_TRUE(press("Escape"));
    EXPECT_TRUE(press("space"));
    EXPECT_TRUE(wait_until([](const Seen& s) { return s.view.playing; }));
  });
}

TEST_F(RealWindow, KeysDoNothingBehindABoxButCloseIt) {
  options_.picture_folder = folder_ / "missing" / "folder";
  const auto has = [](const char* name) {
    return [=](const Seen& s) {
      return std::any_of(s.items.begin(), s.items.end(),
                         [&](const DrawnItem& item) { return item.name == name; });
    };
  };
  run([&] {
    const Camera before = settled_camera();
    for (const char* closing : {"Return", "Escape", "KP_Enter"}) {
      EXPECT_TRUE(press("F12"));
      ASSERT_TRUE(wait_until(has("error")));
      for (const char* key : {"l", "a", "n", "k", "d", "m", "g", "space", "F1", "ctrl+z", "Tab"})
        EXPECT_TRUE(press(key));
      EXPECT_TRUE(wait_until(has("key-hint"))) << "the box says why keys do nothing";
      EXPECT_TRUE(press(closing));
      EXPECT_TRUE(wait_until([&](const Seen& s) { return !has("error")(s); })) << closing;
      const Seen now = seen();
      EXPECT_EQ(now.view.tool, Tool::look);
      EXPECT_FALSE(now.view.playing || now.view.distances || now.view.plots);
      EXPECT_EQ(now.view.skin_opacity, 1);
      EXPECT_FALSE(has("help")(now));
      EXPECT_EQ(turned_rad(settled_camera(), before), 0);
    }
    EXPECT_TRUE(press("shift+m"));  // as key N
    EXPECT_TRUE(wait_until([](const Seen& s) { return s.view.tool == Tool::measure; }));
    EXPECT_TRUE(press("F1"));
    ASSERT_TRUE(wait_until(has("help")));
    EXPECT_TRUE(press("b"));
    EXPECT_TRUE(press("F1"));
    EXPECT_TRUE(wait_until([&](const Seen& s) { return !has("help")(s); }));
    EXPECT_EQ(seen().view.tool, Tool::measure);
  });
}

TEST_F(RealWindow, EscapeFoldsAListThatIsUnfolded) {
  motions_ = {"opening", "chewing-left"};
  const auto unfolded = [](const Seen& s) {
    return std::any_of(s.items.begin(), s.items.end(),
                       [](const DrawnItem& item) { return item.name == "motion:chewing-left"; });
  };
  run([&] {
    click("tab:Motion");
    ASSERT_TRUE(wait_until([](const Seen& s) { return s.view.tab == SideTab::motion; }));
    std::this_thread::sleep_for(milliseconds(150));
    click("motion");
    ASSERT_TRUE(wait_until(unfolded));
    const ViewRect other = place("motion:chewing-left");
    EXPECT_TRUE(press("Escape"));
    EXPECT_TRUE(wait_until([&](const Seen& s) { return !unfolded(s); }));
    EXPECT_TRUE(xdotool({"mousemove", px(other.x + 20), px(other.y + 5), "click", "1"}));
    std::this_thread::sleep_for(milliseconds(300));
    EXPECT_EQ(seen().view.motion.spec, "opening");
  });
}

TEST_F(RealWindow, CtrlClickTypesASlidersNumberAndItsKeysAreNoCommands) {
  run([&] {
    const Camera before = settled_camera();
    const ViewRect r = place("skin");
    EXPECT_TRUE(xdotool({"keydown", "ctrl", "mousemove", px(r.x + r.width / 2),
                         px(r.y + r.height / 2), "click", "1", "keyup", "ctrl"}));
    ASSERT_TRUE(wait_until([](const Seen& s) {
      return std::any_of(s.items.begin(), s.items.end(),
                         [](const DrawnItem& item) { return item.name == "writing"; });
    }));
    EXPECT_EQ(seen().view.skin_opacity, 1) << "a click alone sets nothing";
    EXPECT_TRUE(xdotool({"type", "al30"}));
    EXPECT_TRUE(press("Return"));
    EXPECT_TRUE(wait_until([](const Seen& s) { return s.view.skin_opacity == 0.3; }))
        << seen().view.skin_opacity;
    EXPECT_EQ(turned_rad(settled_camera(), before), 0);
    EXPECT_TRUE(press("ctrl+z"));
    EXPECT_TRUE(wait_until([](const Seen& s) { return s.view.skin_opacity == 1; }));
  });
}

TEST_F(RealWindow, AnIdleWindowRests) {
  run([&] {
    const auto cpu_s = [] {
      rusage usage{};
      getrusage(RUSAGE_SELF, &usage);
      return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
             1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
    };
    // Until the full picture is drawn in the background and nothing moves.
    for (int i = 0; i < 40; ++i) {
      const double start = cpu_s();
      std::this_thread::sleep_for(milliseconds(1000));
      if (cpu_s() - start < 0.05) break;
    }
    const double before = cpu_s();
    const int loops = seen().loops;
    std::this_thread::sleep_for(milliseconds(2000));
    EXPECT_LT(cpu_s() - before, 0.1);
    EXPECT_LT(seen().loops - loops, 12);
    EXPECT_GT(seen().loops - loops, 0);
  });
}

TEST_F(RealWindow, SurvivesAnySize) {
  run([&] {
    const auto resize = [&](const char* w, const char* h) {
      EXPECT_TRUE(xdotool({"search", "--name", "Condyle test", "windowsize", w, h}));
      std::this_thread::sleep_for(milliseconds(300));
      const int loops = seen().loops;
      EXPECT_TRUE(wait_until([&](const Seen& s) { return s.loops > loops + 2; }));
    };
    resize("1", "1");
    resize("300", "900");
    resize("1280", "720");
    EXPECT_TRUE(wait_until([](const Seen& s) { return s.rect.width > 600; }));
    EXPECT_TRUE(press("space"));
    EXPECT_TRUE(wait_until([](const Seen& s) { return s.view.playing; }));
  });
}

TEST_F(RealWindow, AsksForTheLeastSizeThatItsPanelsNeed) {
  run([&] { EXPECT_EQ(min_window_size("Condyle test"), std::pair(800, 500)); });
}

TEST_F(RealWindow, PanelsGrowWhenTheWindowIsResizedTo4K) {
  display_.reset();
  display_ = std::make_unique<TestDisplay>(3840, 2160);
  ASSERT_TRUE(display_->running());
  run([&] {
    const double before = place("left").width;
    EXPECT_TRUE(
        xdotool({"search", "--name", "Condyle test", "windowsize", "--sync", "3840", "2160"}));
    EXPECT_TRUE(wait_until(
        [&](const Seen& s) {
          return std::any_of(s.items.begin(), s.items.end(), [&](const DrawnItem& item) {
            return item.name == "left" && std::abs(item.rect.width - 1.5 * before) < 1.5;
          });
        },
        30))
        << before << " " << place("left").width;
  });
}

TEST_F(RealWindow, AScaledInterfaceStillFits) {
  options_.arrangement.ui_scale = 1.4;
  options_.arrangement.width = 1000;
  options_.arrangement.height = 600;
  run([&] {
    const ViewRect view = seen().rect;
    EXPECT_GT(view.width, 300);
    for (const DrawnItem& item : seen().items) {
      EXPECT_LE(item.rect.x + item.rect.width, 1000.5) << item.name;
      EXPECT_LE(item.rect.y + item.rect.height, 600.5) << item.name;
    }
  });
}

TEST_F(RealWindow, CtrlKeysAndButtonsScaleThePanels) {
  options_.arrangement.width = 1180;  // where a little more than 1 fits
  options_.arrangement.height = 720;
  const auto wide = [&] { return place("left").width; };
  const auto becomes = [&](double width) {
    return wait_until([&](const Seen& s) {
      return std::any_of(s.items.begin(), s.items.end(), [&](const DrawnItem& item) {
        return item.name == "left" && std::abs(item.rect.width - width) < 1.5;
      });
    });
  };
  run([&] {
    const double standard = wide();
    EXPECT_TRUE(press("ctrl+minus"));
    EXPECT_TRUE(becomes(0.9 * standard)) << wide();
    EXPECT_TRUE(press("ctrl+minus"));
    EXPECT_TRUE(becomes(0.8 * standard)) << wide();
    EXPECT_TRUE(press("ctrl+equal"));
    EXPECT_TRUE(becomes(0.9 * standard)) << wide();
    EXPECT_TRUE(press("ctrl+0"));
    EXPECT_TRUE(becomes(standard)) << wide();
    // A scale that does not fit changes nothing, and one step down is visible at once.
    for (int i = 0; i < 4; ++i) EXPECT_TRUE(press("ctrl+equal"));
    std::this_thread::sleep_for(milliseconds(300));
    EXPECT_TRUE(becomes(standard)) << wide();
    EXPECT_TRUE(press("ctrl+minus"));
    EXPECT_TRUE(becomes(0.9 * standard)) << wide();
  });
}

TEST_F(RealWindow, ASecondWindowOpensAfterTheFirst) {
  for (int i = 0; i < 2; ++i) {
    run([&] { EXPECT_TRUE(press("space")); });
    EXPECT_FALSE(closed_);
  }
}

TEST(NoDisplay, IsReportedWithAnAlternative) {
  unsetenv("WAYLAND_DISPLAY");
  for (const char* display : {"", ":9321"}) {
    setenv("DISPLAY", display, 1);
    try {
      Window window;
      ADD_FAILURE() << "a window opened on DISPLAY='" << display << "'";
    } catch (const MachineError& error) {
      const std::string words = error.what();
      EXPECT_NE(words.find("no display was found"), std::string::npos) << words;
      EXPECT_NE(words.find("condyle record"), std::string::npos) << words;
    }
  }
  unsetenv("DISPLAY");
}

}  // namespace
}  // namespace condyle
