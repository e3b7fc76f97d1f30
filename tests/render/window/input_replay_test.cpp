// A list of inputs performed in a real window.
#include "render/window/input_replay.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>

#include "engine/core/error.h"
#include "tests/render/window/panel_stage.h"
#include "tests/support/display.h"

namespace condyle {
namespace {

class Replayed : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(has_program("Xvfb") && has_program("xdotool")) << "install xvfb and xdotool";
    display_ = std::make_unique<TestDisplay>();
    ASSERT_TRUE(display_->running());
    std::filesystem::create_directories(folder_);
    window_.emplace(WindowOptions{.title = "Condyle test", .picture_folder = folder_});
    window_->set_scene({.parts = parts_,
                        .case_name = "Boxes",
                        .duration_s = 4,
                        .bodies = movable_bodies(parts_, native_bodies())});
  }
  void TearDown() override {
    window_.reset();
    std::filesystem::remove_all(folder_);
  }
  void turn_window() {
    window_->poll();
    FrameState frame = box_frame(0, 0);
    if (const auto hand = window_->view().hands.at(mandible_body)) {
      frame.poses[mandible_body] = *hand;
      frame.state_hash = static_cast<std::uint64_t>(1e6 * (200 + hand->t.sum()));
    }
    window_->show(frame);
  }
  /// Returns whether the whole list was performed.
  bool perform(const std::string& list, double patience_s = 30,
               const std::function<void()>& meanwhile = {}) {
    InputReplay replay(*window_, parse_input_steps(list, "list"), folder_, patience_s);
    const auto start = std::chrono::steady_clock::now();
    for (int turn = 0; replay.turn(false); ++turn) {
      turn_window();
      if (turn == 20 && meanwhile) meanwhile();
      if (std::chrono::steady_clock::now() - start > std::chrono::seconds(120)) return false;
    }
    for (int i = 0; i < 5; ++i) turn_window();
    return replay.done();
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("condyle-replay-" + std::to_string(getpid()));
  std::vector<Part> parts_ = box_patient();
  std::unique_ptr<TestDisplay> display_;
  std::optional<Window> window_;
};

TEST_F(Replayed, ClicksKeysTextAndDragsArriveAsFromTheUser) {
  ASSERT_TRUE(perform("say The jaw is moved\nkey m\nenter shift:P -2.5\npicture moved"));
  const auto hand = window_->view().hands.at(mandible_body);
  ASSERT_TRUE(hand);
  EXPECT_NEAR(hand->t.y(), -2.5, 1e-9);
  EXPECT_GT(std::filesystem::file_size(folder_ / "moved.png"), 10000u);
  ASSERT_TRUE(perform("drag handle:S 0 -20"));
  EXPECT_GT(window_->view().hands.at(mandible_body)->t.z() - hand->t.z(), 1);
  const double near_mm = window_->camera().distance_mm;
  ASSERT_TRUE(perform("wheel handle:S -3"));
  EXPECT_LT(window_->camera().distance_mm, near_mm);
  EXPECT_FALSE(window_->replaying());
}

TEST_F(Replayed, AnItemThatDoesNotAppearEndsTheListWithItsLine) {
  try {
    perform("key m\nclick no-such-item", 1);
    FAIL() << "performed";
  } catch (const MachineError& error) {
    EXPECT_STREQ(error.what(), "line 2 of the list: \"no-such-item\" is not in the window");
  }
}

TEST_F(Replayed, EscEndsItAndTheUsersOwnInputIsIgnoredBefore) {
  const auto meanwhile = [&] {
    EXPECT_TRUE(xdotool({"key", "m"}));  // would open the tool that moves bodies
    for (int i = 0; i < 20; ++i) turn_window();
    EXPECT_EQ(window_->view().tool, Tool::look);
    EXPECT_TRUE(xdotool({"key", "Escape"}));
  };
  EXPECT_FALSE(perform("wait no-such-item", 60, meanwhile));
  EXPECT_TRUE(xdotool({"key", "m"}));
  for (int i = 0; i < 20; ++i) turn_window();
  EXPECT_EQ(window_->view().tool, Tool::move);
}

TEST_F(Replayed, EscInADragReleasesTheButton) {
  ASSERT_TRUE(perform("key m"));
  InputReplay replay(*window_, parse_input_steps("drag handle:S 0 -60", "list"), folder_);
  const auto moved = [&] {
    const auto hand = window_->view().hands.at(mandible_body);
    return hand ? hand->t.norm() : 0.0;
  };
  for (int turn = 0; turn < 2000 && moved() == 0 && replay.turn(false); ++turn) turn_window();
  ASSERT_GT(moved(), 0);
  EXPECT_TRUE(xdotool({"key", "Escape"}));
  for (int i = 0; i < 20; ++i) turn_window();
  EXPECT_FALSE(replay.turn(false));
  const double there = moved();
  EXPECT_TRUE(xdotool({"mousemove", "700", "200", "mousemove", "500", "500"}));
  for (int i = 0; i < 20; ++i) turn_window();
  EXPECT_EQ(moved(), there) << "the user's pointer drags nothing";
}

TEST_F(Replayed, WorkThatBeginsLaterIsAwaited) {
  InputReplay replay(*window_, parse_input_steps("key m\nkey m", "list"), folder_);
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed_s = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  // The first key opens the tool; work begins 0.3 s later and takes 2 s.
  double opened_s = -1, closed_s = -1;
  while (closed_s < 0 && elapsed_s() < 60) {
    const bool busy = opened_s >= 0 && elapsed_s() > opened_s + 0.3 && elapsed_s() < opened_s + 2.3;
    replay.turn(busy);
    turn_window();
    const bool open = window_->view().tool == Tool::move;
    if (open && opened_s < 0) opened_s = elapsed_s();
    if (!open && opened_s >= 0) closed_s = elapsed_s();
  }
  EXPECT_GT(closed_s, opened_s + 2.3);
}

}  // namespace
}  // namespace condyle
