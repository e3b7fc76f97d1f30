#include "render/session/view_overlays.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/error.h"
#include "render/recording/anatomy_drawing.h"
#include "render/recording/facial_bellies.h"
#include "render/recording/muscle_looks.h"
#include "render/recording/overlay_drawing.h"
#include "sim/frame/body_poses.h"
#include "sim/frame/part_names.h"
#include "sim/muscles/expression_names.h"
#include "sim/muscles/muscle_names.h"
#include "sim/plan/clinical_frame.h"
#include "sim/tissue/model.h"

namespace condyle {
namespace {

const Eigen::Vector3f mirror_color{0.93f, 0.62f, 0.83f};

std::string sided(const Muscle& muscle) {
  const char side = muscle.name.empty() ? ' ' : muscle.name.front();
  const std::string words = muscle.full_name.empty() ? muscle.name : muscle.full_name;
  return words + (side == 'l' ? ", left" : side == 'r' ? ", right" : "");
}

/// The mirror image of a part as it lies now.
GlassSheet mirror_sheet(const Part& part, const Pose& X_CP,
                        const Eigen::Hyperplane<double, 3>& plane) {
  GlassSheet sheet{.color = mirror_color, .opacity = 0.45f};
  sheet.positions.reserve(part.mesh.vertices.size());
  for (const Eigen::Vector3d& p : part.mesh.vertices) {
    const Eigen::Vector3d here = X_CP * p;
    sheet.positions.push_back(
        (here - 2 * plane.signedDistance(here) * plane.normal()).cast<float>());
  }
  sheet.triangles.reserve(part.mesh.triangles.size());
  for (const Eigen::Vector3i& t : part.mesh.triangles)  // a mirror turns them over
    sheet.triangles.emplace_back(t.x(), t.z(), t.y());
  return sheet;
}

void add_mirror_image(const SessionPatient& patient, const FrameState& frame,
                      const std::string& name, Overlays& shown) {
  const Case& now = patient.scene.patient;
  const auto part = std::find_if(now.parts.begin(), now.parts.end(),
                                 [&](const Part& one) { return one.name == name; });
  const auto plane = midsagittal_plane(patient);
  if (part == now.parts.end() || part->role == Role::face || !plane) return;
  shown.sheets["mirror image"] = mirror_sheet(*part, pose_of(*part, frame.poses), *plane);
  shown.key.push_back(
      {"Mirror image: " + display_name(name), {mirror_color}, KeyEntry::Mark::sheet});
}

}  // namespace

std::optional<Eigen::Hyperplane<double, 3>> midsagittal_plane(const SessionPatient& patient) {
  try {
    const ClinicalFrame frame = clinical_frame(patient.operated->patient.landmarks);
    return Eigen::Hyperplane<double, 3>(frame.left, frame.origin);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

bool shows_muscles(const ViewState& view) {
  return std::any_of(view.muscles.begin(), view.muscles.end(),
                     [](const PartView& muscle) { return muscle.shown; });
}

Overlays view_overlays(const SessionPatient& patient, const Motion& motion, const FrameState& frame,
                       const ViewState& view, const std::shared_ptr<const LineSet>& paths,
                       const MuscleBellies* bellies) {
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
  if (bellies) {
    std::vector<double> opacity;
    for (const PartView& muscle : view.muscles)
      opacity.push_back(muscle.shown ? muscle.opacity : 0);
    add_muscles(*bellies, motion, frame, opacity, look.muscle_labels, shown);
  }
  if (look.facial_muscles && model) {
    shown.bodies["facial muscles"] = facial_bellies(*model, frame.tissue);
    shown.key.push_back(facial_muscle_key());
  }
  if (model)
    for (int sheet = 0; sheet < model->mesh->sheets; ++sheet) {
      const auto i = static_cast<std::size_t>(sheet);
      if (i >= view.layers.size() || !view.layers[i].shown) continue;
      shown.sheets[layer_overlay_name(sheet)] =
          layer_sheet(*model, frame.tissue, sheet, view.layers[i].opacity);
      shown.key.push_back(layer_key(*model, sheet));
    }
  if (!look.mirrored.empty()) add_mirror_image(patient, frame, look.mirrored, shown);
  return shown;
}

std::vector<TreeItem> muscle_items(const SessionPatient& patient) {
  std::vector<TreeItem> items;
  for (const Muscle& muscle : patient.muscles)
    items.push_back({muscle.name, sided(muscle), short_name(muscle)});
  return items;
}

std::vector<TreeItem> expression_items(const SessionPatient& patient) {
  const TissueModel* model = patient.scene.tissue.get();
  if (!model || face_muscles_of(*model).empty()) return {};
  const auto label = [](const NamedExpression& each) {
    if (each.action_unit()) return each.name + ", " + each.action;
    return each.name.size() == 1 ? "Sound " + each.name : display_name(each.name);
  };
  std::vector<TreeItem> items;
  for (const NamedExpression& each : named_expressions()) items.push_back({each.name, label(each)});
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
