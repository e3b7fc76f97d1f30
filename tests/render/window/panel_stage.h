#pragma once

#include <imgui.h>

#include <memory>
#include <string>
#include <vector>

#include "render/gl/framebuffer.h"
#include "render/gl/gl_context.h"
#include "render/image/image.h"
#include "render/window/panels/panels.h"
#include "tests/support/picture.h"

namespace condyle {

/// A closed box as a part, mm.
Part box_part(const std::string& name, Role role, const Eigen::Vector3d& low,
              const Eigen::Vector3d& high);

/// A small patient of boxes: skull, maxilla, teeth, mandible and face.
std::vector<Part> box_patient();

/// A frame of the box patient with the mouth open by this amount, with all readings.
FrameState box_frame(double time_s, double opening_mm);

/// Panels drawn off-screen, with a scripted mouse.
class PanelStage {
 public:
  PanelStage(int width, int height, float scale);
  ~PanelStage();

  /// Draws the panels once with the mouse at a position.
  void step(double x, double y, bool down);
  void rest(int pictures = 3);
  void set_light(bool light);
  /// Clicks the middle of an item; or drags between two fractions of its width.
  void click(const std::string& item);
  void slide(const std::string& item, double from, double to);
  /// Sets the keys that are held from now on.
  void hold(bool ctrl, bool shift);
  /// Clicks the field, or with Ctrl the slider, and enters a text.
  void enter(const std::string& item, const std::string& words, bool ctrl = false);

  /// The item as last drawn; fails the test when it is absent.
  DrawnItem item(const std::string& name) const;
  bool has(const std::string& name) const;
  /// The last panels as pixels.
  Image image();

  std::vector<Part> parts = box_patient();
  WindowScene scene;
  ViewState view;
  FrameState frame = box_frame(1.2, 23.4);
  Camera camera;
  std::vector<Command> commands;  // all so far
  PictureStatistics drawing = {.pictures_per_second = 24, .picture_ms = 31};
  std::string progress, recording, unfinished;
  std::vector<KeyEntry> key;
  bool can_cancel = false, kept = false;
  std::vector<PlotSet> plots;
  std::unique_ptr<Panels> panels;

 private:
  OffscreenContext context_;
  ImGuiContext* imgui_ = nullptr;
  int width_, height_;
  Framebuffer picture_;
};

}  // namespace condyle
