#include "render/session/view_overlays.h"

#include <fmt/format.h>

#include <algorithm>

#include "render/recording/anatomy_drawing.h"
#include "render/recording/overlay_drawing.h"
#include "sim/muscles/muscle_names.h"
#include "sim/tissue/model.h"

namespace condyle {
namespace {

std::string sided(const Muscle& muscle) {
  const char side = muscle.name.empty() ? ' ' : muscle.name.front();
  const std::string words = muscle.full_name.empty() ? muscle.name : muscle.full_name;
  return words + (side == 'l' ? ", left" : side == 'r' ? ", right" : "");
}

}  // namespace

Overlays view_overlays(const SessionPatient& patient, const Motion& motion, const FrameState& frame,
                       const ViewState& view, const std::shared_ptr<const LineSet>& paths) {
  Overlays shown;
  const Look& look = view.look;
  const OverlayChoice choice = {.springs = look.springs,
                                .prisms = look.prisms,
                                .bone_springs = look.bone_springs,
                                .axes = look.axes,
                                .paths = look.paths && paths};
  shown.lines = overlay_lines(patient.scene, frame, choice);
  if (look.paths && paths) shown.lines["paths"] = *paths;
  const TissueModel* model = frame.tissue.nodes.empty() ? nullptr : patient.scene.tissue.get();
  shown.key = overlay_key(choice, model != nullptr);
  if (std::any_of(view.muscles.begin(), view.muscles.end(),
                  [](const PartView& muscle) { return muscle.shown; }))
    shown.key.push_back(muscle_key());
  if (model)
    for (int sheet = 0; sheet < model->mesh->sheets; ++sheet) {
      const auto i = static_cast<std::size_t>(sheet);
      if (i >= view.layers.size() || !view.layers[i].shown) continue;
      shown.sheets[layer_overlay_name(sheet)] =
          layer_sheet(*model, frame.tissue, sheet, view.layers[i].opacity);
      shown.key.push_back(layer_key(*model, sheet));
    }
  for (std::size_t m = 0; m < patient.muscles.size() && m < view.muscles.size(); ++m)
    if (view.muscles[m].shown)
      shown.lines["muscle " + patient.muscles[m].name] =
          muscle_line(patient.muscles[m], motion, frame, view.muscles[m].opacity);
  return shown;
}

std::vector<TreeItem> muscle_items(const SessionPatient& patient) {
  std::vector<TreeItem> items;
  for (const Muscle& muscle : patient.muscles)
    items.push_back({muscle.name, sided(muscle), short_name(muscle)});
  return items;
}

std::vector<TreeItem> layer_items(const SessionPatient& patient) {
  const TissueModel* model = patient.scene.tissue.get();
  if (!model) return {};
  std::vector<TreeItem> items;
  for (int sheet = 0; sheet < model->mesh->sheets; ++sheet)
    items.push_back({fmt::format("{}", sheet + 1), layer_label(*model, sheet),
                     layer_short_label(*model, sheet)});
  return items;
}

}  // namespace condyle
