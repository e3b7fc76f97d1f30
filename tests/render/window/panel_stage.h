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

/// A frame of the box patient with the mouth open by so much, every reading filled in.
FrameState box_frame(double time_s, double opening_mm);

/// Panels drawn off the screen, with a scripted mouse.
class PanelStage {
 public:
  PanelStage(int width, int height, float scale);
  ~PanelStage();

  /// One picture of the panels with the mouse there.
  void step(double x, double y, bool down);
  void rest(int pictures = 3);
  void set_light(bool light);
  /// Presses and releases the middle of an item; or slides from one part of its width to another.
  void click(const std::string& item);
  void slide(const std::string& item, double from, double to);
  /// Keys that are held from now on.
  void hold(bool ctrl, bool shift);
  /// Clicks the field, or with Ctrl the slider, and enters words there.
  void enter(const std::string& item, const std::string& words, bool ctrl = false);

  /// The item as last drawn; fails the test when it is not there.
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
