#include "tests/render/window/panel_stage.h"

#include <backends/imgui_impl_opengl3.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "engine/core/hash.h"

namespace condyle {

using Eigen::Vector3d;

Part box_part(const std::string& name, Role role, const Vector3d& low, const Vector3d& high) {
  Part part;
  part.name = name;
  part.role = role;
  part.body = default_body(role);
  for (int corner = 0; corner < 8; ++corner)
    part.mesh.vertices.emplace_back(corner & 1 ? high.x() : low.x(),
                                    corner & 2 ? high.y() : low.y(),
                                    corner & 4 ? high.z() : low.z());
  part.mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                         {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return part;
}

std::vector<Part> box_patient() {
  return {box_part("skull", Role::skull, {-70, -60, 0}, {70, 100, 120}),
          box_part("maxilla", Role::maxilla, {-30, -80, -30}, {30, -20, -2}),
          box_part("upper_teeth", Role::upper_teeth, {-25, -82, -38}, {25, -50, -30}),
          box_part("lower_teeth", Role::lower_teeth, {-25, -80, -47}, {25, -50, -39}),
          box_part("mandible", Role::mandible, {-45, -80, -75}, {45, 0, -48}),
          box_part("face", Role::face, {-80, -95, -90}, {80, 60, 130})};
}

FrameState box_frame(double time_s, double opening_mm) {
  FrameState frame;
  frame.time_s = time_s;
  const double angle = opening_mm / 90;
  frame.poses[mandible_body].R = Eigen::AngleAxisd(angle, Vector3d::UnitX());
  const Vector3d hinge(0, 10, -10);
  frame.poses[mandible_body].t =
      hinge - frame.poses[mandible_body].R * hinge + Vector3d(0, -0.2, -0.1) * opening_mm;
  frame.X_PB_target = frame.poses.X_CB;
  frame.measures.opening_mm = opening_mm;
  frame.measures.interincisal_mm = opening_mm + 1.5;
  frame.measures.rotation_deg = angle * 180 / std::numbers::pi;
  frame.measures.left_condyle = frame.poses[mandible_body] * Vector3d(50, 10, -10);
  frame.measures.right_condyle = frame.poses[mandible_body] * Vector3d(-50, 10, -10);
  const auto pair = [](int a, int b, double distance, double depth, double rest) {
    PairContact contact;
    contact.part_a = a;
    contact.part_b = b;
    contact.distance_mm = distance;
    contact.touching = distance == 0;
    contact.depth_mm = depth;
    contact.rest_depth_mm = rest;
    if (contact.touching) contact.contacts.push_back({{0, -80, -38}, {0, 0, -1}});
    return contact;
  };
  frame.contacts.pairs = {
      pair(0, 4, 2.5, 0, 0),  pair(1, 4, 11.25, 0, 0),
      pair(0, 3, 31.0, 0, 0), pair(2, 3, opening_mm > 1 ? opening_mm - 1 : 0, 0, 0.12),
      pair(2, 4, 18, 0, 0),   pair(1, 3, 0, 0.35, 0.1)};
  frame.tissue.nodes.assign(2048, Vector3d::Zero());
  frame.tissue.iterations = 12;
  frame.tissue.energy = 0.01372;
  frame.tissue.residual = 3.2e-5;
  frame.times[Stage::motion] = 0.02;
  frame.times[Stage::contact] = 1.4;
  frame.times[Stage::tissue] = 5.8 + opening_mm / 20;
  frame.times[Stage::face] = 1.1;
  frame.times[Stage::measures] = 0.01;
  frame.state_hash = hash_start + static_cast<std::uint64_t>(opening_mm * 1e6);
  return frame;
}

PanelStage::PanelStage(int width, int height, float scale)
    : width_(width), height_(height), picture_(width, height, 1) {
  imgui_ = ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  ImGui_ImplOpenGL3_Init("#version 330 core");
  panels = std::make_unique<Panels>(scale);
  scene = {.parts = parts,
           .case_name = "Built-in patient",
           .motion_name = "opening",
           .duration_s = 4,
           .max_opening_mm = 52,
           .notes = {"Upper and lower teeth overlap by 0.12 mm at rest; contact deeper than that "
                     "counts as penetration."}};
  camera = standard_camera("three-quarter", {-80, -95, -90}, {80, 100, 130}, 1.3);
  rest();
}

PanelStage::~PanelStage() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui::DestroyContext(imgui_);
}

void PanelStage::step(double x, double y, bool down) {
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {static_cast<float>(width_), static_cast<float>(height_)};
  io.DeltaTime = 1.0f / 60;
  io.MousePos = {static_cast<float>(x), static_cast<float>(y)};
  io.MouseDown[0] = down;
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
  const PanelInput input{.scene = scene,
                         .frame = &frame,
                         .loop = {.steps_per_second = 60},
                         .pictures = drawing,
                         .camera = camera,
                         .box = {Eigen::Vector3d(-80, -95, -90), Eigen::Vector3d(80, 100, 130)},
                         .progress = progress,
                         .progress_fraction = 0.4,
                         .can_cancel = can_cancel,
                         .key = key,
                         .plots = plots,
                         .kept = kept,
                         .recording = !recording.empty(),
                         .recording_what = recording,
                         .recording_fraction = 0.3,
                         .unfinished = unfinished};
  const auto asked = panels->draw(input, view, width_, height_);
  commands.insert(commands.end(), asked.begin(), asked.end());
  ImGui::Render();
}

void PanelStage::set_light(bool light) {
  panels->set_light(light);
  ImGui_ImplOpenGL3_DestroyFontsTexture();
  ImGui_ImplOpenGL3_CreateFontsTexture();
}

Image PanelStage::image() {
  picture_.bind();
  glClearColor(0.06f, 0.07f, 0.08f, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  return picture_.read();
}

void PanelStage::rest(int pictures) {
  for (int i = 0; i < pictures; ++i) step(-1e4, -1e4, false);
}

void PanelStage::click(const std::string& name) {
  const ViewRect r = item(name).rect;
  const double x = r.x + r.width / 2, y = r.y + r.height / 2;
  step(x, y, false);
  step(x, y, true);
  step(x, y, false);
  rest(2);
}

void PanelStage::slide(const std::string& name, double from, double to) {
  const ViewRect r = item(name).rect;
  const double y = r.y + r.height / 2;
  const auto x = [&](double f) { return r.x + r.width * f; };
  step(x(from), y, false);
  for (int i = 0; i <= 8; ++i) step(x(from + (to - from) * i / 8), y, true);
  step(x(to), y, false);
  rest(2);
}

void PanelStage::hold(bool ctrl, bool shift) {
  ImGui::GetIO().KeyCtrl = ctrl;
  ImGui::GetIO().KeyShift = shift;
}

void PanelStage::enter(const std::string& name, const std::string& words, bool ctrl) {
  constexpr int enter_key = 1;
  ImGuiIO& io = ImGui::GetIO();
  io.KeyMap[ImGuiKey_Enter] = enter_key;
  io.KeyCtrl = ctrl;
  click(name);
  io.KeyCtrl = false;
  io.AddInputCharactersUTF8(words.c_str());
  rest(1);
  io.KeysDown[enter_key] = true;
  rest(1);
  io.KeysDown[enter_key] = false;
  rest(3);
}

bool PanelStage::has(const std::string& name) const {
  return std::any_of(panels->items().begin(), panels->items().end(),
                     [&](const DrawnItem& drawn) { return drawn.name == name; });
}

DrawnItem PanelStage::item(const std::string& name) const {
  for (const DrawnItem& drawn : panels->items())
    if (drawn.name == name) return drawn;
  ADD_FAILURE() << "no item '" << name << "' was drawn";
  return {};
}

}  // namespace condyle
