#include "render/recording/anatomy_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "engine/tissue/layered_mesh.h"
#include "sim/tissue/model.h"

namespace condyle {
namespace {

using Eigen::Vector3f;

// By position, from the skin to the bone; distinguishable by lightness too.
const std::array<Vector3f, 4> layer_colors = {
    {{0.88f, 0.67f, 0.56f}, {0.94f, 0.83f, 0.45f}, {0.72f, 0.24f, 0.20f}, {0.62f, 0.68f, 0.74f}}};

/// The layer below a sheet: as requested, or a division of it.
struct LayerPiece {
  int layer = 0, layers = 1, piece = 0, pieces = 1;
};
LayerPiece below(const TissueModel& model, int sheet) {
  if (model.mesh->cut_from.empty()) return {.layer = sheet, .layers = model.mesh->sheets - 1};
  LayerPiece here{.layer = model.mesh->cut_from[static_cast<std::size_t>(sheet)],
                  .layers = model.mesh->cut_from.back() + 1,
                  .pieces = 0};
  for (int other = 0; other + 1 < model.mesh->sheets; ++other) {
    if (model.mesh->cut_from[static_cast<std::size_t>(other)] != here.layer) continue;
    ++here.pieces;
    here.piece += other < sheet;
  }
  return here;
}

Vector3f layer_color(const TissueModel& model, int sheet) {
  if (sheet + 1 >= model.mesh->sheets) return layer_colors[3];
  const LayerPiece here = below(model, sheet);
  return layer_colors[static_cast<std::size_t>(
      here.layers == 1 ? 0 : 2 * here.layer / (here.layers - 1))];
}

std::string label_of(const TissueModel& model, int sheet,
                     const std::array<const char*, 3>& standard) {
  if (sheet + 1 == model.mesh->sheets) return "Inner side";
  const LayerPiece here = below(model, sheet);
  const std::string name = here.layers == static_cast<int>(standard.size())
                               ? standard[static_cast<std::size_t>(here.layer)]
                               : fmt::format("Layer {}", here.layer + 1);
  return here.pieces == 1 ? name : fmt::format("{}, {} of {}", name, here.piece + 1, here.pieces);
}

}  // namespace

GlassSheet layer_sheet(const TissueModel& model, const TissueState& now, int sheet,
                       double opacity) {
  GlassSheet made{.positions = {},
                  .triangles = model.mesh->triangles,
                  .color = layer_color(model, sheet),
                  .opacity = static_cast<float>(opacity)};
  made.positions.reserve(static_cast<std::size_t>(model.mesh->columns));
  for (int column = 0; column < model.mesh->columns; ++column)
    made.positions.push_back(
        now.nodes[static_cast<std::size_t>(node_of(column, sheet, model.mesh->sheets))]
            .cast<float>());
  return made;
}

std::string layer_label(const TissueModel& model, int sheet) {
  return label_of(model, sheet, {"Skin", "Fat", "Muscle layer"});
}
std::string layer_short_label(const TissueModel& model, int sheet) {
  return label_of(model, sheet, {"Skin", "Fat", "Muscle"});
}

KeyEntry layer_key(const TissueModel& model, int sheet) {
  return {layer_label(model, sheet), {layer_color(model, sheet)}, KeyEntry::Mark::sheet};
}

std::string layer_overlay_name(int sheet) { return fmt::format("layer {:03}", 999 - sheet); }

}  // namespace condyle
