#include "tools/view_overlays.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "engine/tissue/layered_net.h"
#include "sim/tissue/model.h"

namespace condyle {
namespace {

using Eigen::Vector3f;

LineSet tissue_springs(const TissueModel& model, const TissueState& now) {
  LineSet lines;
  const SpringPrismNet& net = model.net;
  lines.color = {0.18f, 0.75f, 0.58f};
  lines.width_px = 0.6f;
  lines.through = 0.25f;
  lines.ends.reserve(2 * net.spring_a.size());
  for (std::size_t s = 0; s < net.spring_a.size(); ++s)
    for (const int node : {net.spring_a[s], net.spring_b[s]})
      lines.ends.push_back(now.nodes[static_cast<std::size_t>(node)].cast<float>());
  return lines;
}

// By place, from the skin to the bone; lightness tells them apart, too.
const std::array<Vector3f, 4> layer_colors = {
    {{0.88f, 0.67f, 0.56f}, {0.94f, 0.83f, 0.45f}, {0.72f, 0.24f, 0.20f}, {0.62f, 0.68f, 0.74f}}};

/// The sheet below so many layers, where its nodes are now.
GlassSheet layer_sheet(const TissueModel& model, const TissueState& now, int sheet,
                       double opacity) {
  GlassSheet made{.positions = {},
                  .triangles = model.triangles,
                  .color = layer_colors[3],
                  .opacity = static_cast<float>(opacity)};
  const int layers = model.sheets - 1;
  if (sheet < layers)
    made.color = layer_colors[static_cast<std::size_t>(layers == 1 ? 0 : 2 * sheet / (layers - 1))];
  made.positions.reserve(static_cast<std::size_t>(model.columns));
  for (int column = 0; column < model.columns; ++column)
    made.positions.push_back(
        now.nodes[static_cast<std::size_t>(node_of(column, sheet, model.sheets))].cast<float>());
  return made;
}

/// Dark red at rest, bright yellow when fully excited: lightness alone tells it.
Vector3f excited_color(double excitation) {
  const Vector3f rest(0.50f, 0.12f, 0.11f), full(1.0f, 0.88f, 0.25f);
  return rest + static_cast<float>(std::clamp(excitation, 0.0, 1.0)) * (full - rest);
}

LineSet muscle_line(const Muscle& muscle, const Pose& X_CM, double excitation, double opacity) {
  const auto now = [&](MuscleBody body, const Eigen::Vector3d& rest) -> Vector3f {
    return (body == MuscleBody::mandible ? X_CM * rest : rest).cast<float>();
  };
  const Vector3f origin = now(muscle.origin_body, muscle.origin),
                 insertion = now(muscle.insertion_body, muscle.insertion);
  return {.ends = {origin, insertion},
          .colors = {},
          .dots = {origin, insertion},
          .color = excited_color(excitation),
          .width_px = 6,
          .dot_mm = 1.2f,
          .through = 0.45f,
          .opacity = static_cast<float>(opacity)};
}

std::string sided(const Muscle& muscle) {
  const char side = muscle.name.empty() ? ' ' : muscle.name.front();
  const std::string words = muscle.full_name.empty() ? muscle.name : muscle.full_name;
  return words + (side == 'l' ? ", left" : side == 'r' ? ", right" : "");
}

}  // namespace

Overlays view_overlays(const ViewPatient& patient, const Motion& motion, const FrameState& frame,
                       const ViewState& view, const std::shared_ptr<const LineSet>& paths) {
  Overlays shown;
  if (view.look.paths && paths) shown.lines["paths"] = *paths;
  const TissueModel* model = patient.scene.tissue.get();
  if (model && !frame.tissue.nodes.empty()) {
    if (view.look.springs) shown.lines["springs"] = tissue_springs(*model, frame.tissue);
    for (int sheet = 0; sheet < model->sheets; ++sheet) {
      const auto i = static_cast<std::size_t>(sheet);
      if (i < view.layers.size() && view.layers[i].shown)
        // Inner ones first: outer ones lie over them.
        shown.sheets[fmt::format("layer {:03}", 999 - sheet)] =
            layer_sheet(*model, frame.tissue, sheet, view.layers[i].opacity);
    }
  }
  for (std::size_t m = 0; m < patient.muscles.size() && m < view.muscles.size(); ++m) {
    if (!view.muscles[m].shown) continue;
    const Muscle& muscle = patient.muscles[m];
    double excitation = 0;
    for (std::size_t k = 0; k < std::min(frame.muscles.size(), motion.muscle_names.size()); ++k)
      if (motion.muscle_names[k] == muscle.name) excitation = frame.muscles[k].excitation;
    shown.lines["muscle " + muscle.name] =
        muscle_line(muscle, frame.X_CM, excitation, view.muscles[m].opacity);
  }
  return shown;
}

std::vector<TreeItem> muscle_items(const ViewPatient& patient) {
  std::vector<TreeItem> items;
  for (const Muscle& muscle : patient.muscles) items.push_back({muscle.name, sided(muscle)});
  return items;
}

std::vector<TreeItem> layer_items(const ViewPatient& patient) {
  const TissueModel* model = patient.scene.tissue.get();
  if (!model) return {};
  std::vector<TreeItem> items;
  const int layers = model->sheets - 1;
  constexpr std::array usual = {"Skin", "Fat", "Muscle layer"};
  for (int sheet = 0; sheet < model->sheets; ++sheet) {
    std::string label = fmt::format("Layer {}", sheet + 1);
    if (layers == static_cast<int>(usual.size()) && sheet < layers)
      label = usual[static_cast<std::size_t>(sheet)];
    items.push_back({fmt::format("{}", sheet + 1), sheet == layers ? "Inner side" : label});
  }
  return items;
}

}  // namespace condyle
