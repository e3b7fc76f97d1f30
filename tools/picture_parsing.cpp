#include <fmt/format.h>

#include <algorithm>

#include "engine/core/error.h"
#include "engine/core/text_list.h"
#include "engine/mesh/measure.h"
#include "render/recording/caption.h"
#include "render/recording/recording_camera.h"
#include "tools/common.h"
#include "tools/picture_options.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

// Gap marked as contact: the thickness of articulating film.
constexpr float patch_mm = 0.1f;

/// Names of the parts in a list of groups and parts.
std::vector<std::string> parts_of(const std::vector<std::string>& items, const Case& patient,
                                  const std::string& option) {
  std::vector<std::string> names;
  for (const auto& item : items) {
    const auto group = part_groups().find(item);
    bool known = group != part_groups().end() || item == "all";
    for (const auto& part : patient.parts) {
      const bool meant = item == "all" || item == part.name ||
                         (group != part_groups().end() && group->second.contains(part.role));
      known |= meant;
      if (meant) names.push_back(part.name);
    }
    if (!known) {
      std::string all = "all";
      for (const auto& [name, roles] : part_groups()) all += ", " + name;
      for (const auto& part : patient.parts) all += ", " + part.name;
      throw InputError(option + ": " + item + " is unknown; known are " + all);
    }
  }
  // A group without parts in this patient cuts nothing; an empty list would cut everything.
  if (names.empty() && !items.empty()) names.emplace_back();
  return names;
}

Vector3d middle_of_joints(const Case& patient) {
  const auto left = patient.landmarks.find("left_condyle"),
             right = patient.landmarks.find("right_condyle");
  if (left && right) return 0.5 * (*left + *right);
  Box box;
  for (const auto& part : patient.parts)
    for (const auto& v : part.mesh.vertices) box.add(v);
  return box.empty() ? Vector3d(0, 0, 0) : Vector3d(0.5 * (box.low + box.high));
}

ClippingPlane parse_clip(const std::string& text, const Case* patient) {
  const std::string option = "--clip " + text;
  ClippingPlane plane;
  const auto numbers = split_list(text);
  if (numbers.size() == 6) {
    for (int k = 0; k < 3; ++k) {
      plane.point[k] = parse_number(numbers[static_cast<std::size_t>(k)], option);
      plane.normal[k] = parse_number(numbers[static_cast<std::size_t>(3 + k)], option);
    }
    if (plane.normal.norm() < 1e-9)
      throw InputError(option + ": the outward normal must not be zero");
    return plane;
  }
  const auto colon = text.find(':');
  const std::string side = text.substr(0, colon);
  const std::map<std::string, Vector3d> sides = {
      {"left", Vector3d::UnitX()},   {"right", -Vector3d::UnitX()}, {"back", Vector3d::UnitY()},
      {"front", -Vector3d::UnitY()}, {"above", Vector3d::UnitZ()},  {"below", -Vector3d::UnitZ()}};
  const auto found = sides.find(side);
  if (found == sides.end())
    throw InputError(
        option +
        ": must be left, right, front, back, above or below optionally with a distance in mm "
        "(left:10), or X,Y,Z,NX,NY,NZ");
  plane.normal = found->second;
  const double offset_mm =
      colon == std::string::npos ? 0 : parse_number(text.substr(colon + 1), option);
  if (patient) plane.point = middle_of_joints(*patient) + offset_mm * plane.normal;
  return plane;
}

CutAway parse_cut_away(const std::string& text, const Case* patient) {
  const std::string option = "--cut-away " + text;
  const auto items = split_list(text);
  CutAway hole;
  if (items.size() == 4) {
    for (int k = 0; k < 3; ++k)
      hole.center[k] = parse_number(items[static_cast<std::size_t>(k)], option);
  } else if (items.size() != 2) {
    throw InputError(option + ": must be LANDMARK,RADIUS or X,Y,Z,RADIUS, e.g. left_condyle,35");
  } else if (patient) {
    const auto place = patient->landmarks.find(items[0]);
    if (!place) throw InputError(option + ": the patient has no landmark " + items[0]);
    hole.center = *place;
  }
  hole.radius_mm = parse_number(items.back(), option);
  if (!(hole.radius_mm > 0 && hole.radius_mm <= 500))
    throw InputError(option + ": the radius must be above 0 and at most 500 mm");
  return hole;
}

void add_overlay(const std::string& item, const Case* patient, PicturePlan& plan) {
  const std::map<std::string, bool*> switches = {{"springs", &plan.overlays.springs},
                                                 {"prisms", &plan.overlays.prisms},
                                                 {"bone-springs", &plan.overlays.bone_springs},
                                                 {"axes", &plan.overlays.axes},
                                                 {"paths", &plan.overlays.paths},
                                                 {"muscles", &plan.overlays.muscles},
                                                 {"muscle-labels", &plan.overlays.muscle_labels},
                                                 {"facial-muscles", &plan.overlays.facial_muscles},
                                                 {"layers", &plan.overlays.layers},
                                                 {"patches", &plan.patches},
                                                 {"scale", &plan.annotations.scale_bar},
                                                 {"letters", &plan.annotations.letters}};
  const auto colon = item.find(':');
  const std::string name = item.substr(0, colon);
  if (const auto found = switches.find(item); found != switches.end()) {
    *found->second = true;
  } else if (item == "ghost") {
    plan.settings.ghost.emplace();
  } else if (name == "wireframe") {
    if (colon == std::string::npos)
      plan.settings.wireframe = {"*"};
    else if (patient)
      for (auto& part : parts_of({item.substr(colon + 1)}, *patient, "--overlay " + item))
        plan.settings.wireframe.push_back(std::move(part));
  } else {
    std::string known = "ghost, wireframe[:PARTS]";
    for (const auto& [other, value] : switches) known += ", " + other;
    throw InputError("--overlay " + item + ": unknown; known are " + known);
  }
}

/// Without a patient, checks only what needs none.
PicturePlan parse(const PictureOptions& options, const Case* patient) {
  PicturePlan plan;
  auto& settings = plan.settings;
  std::tie(settings.width, settings.height) = parse_size(options.size);
  if (patient) plan.map = apply_show_list(options.show, patient->parts, settings, options.shown_by);
  if (!options.clip.empty()) {
    settings.clip = parse_clip(options.clip, patient);
    settings.clip->capped = !options.clip_open;
    if (patient && !options.clip_parts.empty())
      settings.clip->parts =
          parts_of(split_list(options.clip_parts), *patient, "--clip-parts " + options.clip_parts);
  } else if (!options.clip_parts.empty() || options.clip_open) {
    throw InputError("--clip-parts and --clip-open need --clip");
  }
  if (!options.cut_away.empty()) settings.cut_away = parse_cut_away(options.cut_away, patient);
  if (!options.overlay.empty())
    for (const auto& item : split_list(options.overlay)) add_overlay(item, patient, plan);
  if (plan.patches) {
    if (plan.map == SurfaceMap::distance)
      throw InputError("--overlay patches: shows less than --show distance does; leave one out");
    settings.mapped_up_to = patch_mm;
  }
  if (options.light) settings.backdrop = Backdrop::light;
  plan.annotations.backdrop = settings.backdrop;
  settings.transparent = options.transparent;
  settings.samples = options.edges == "msaa4" ? 4 : 1;
  settings.smooth_edges = options.edges == "fxaa";
  settings.supersampling = options.supersample;
  settings.shadows = options.shadows;
  settings.folds = options.folds;
  plan.wipe = options.wipe;
  plan.near_mm = options.distance_near_mm;
  plan.caption = options.caption;
  plan.cameras = split_cameras(options.camera);
  if (options.before_after) {
    if (plan.map == SurfaceMap::distance || plan.patches || plan.wipe)
      throw InputError(
          "--before-after: shows rest, now and the displacement of the skin; leave --wipe, "
          "--show distance and --overlay patches out");
    plan.before_after = true;
    plan.map = SurfaceMap::displacement;
  }
  if (options.life) {
    if (plan.map != SurfaceMap::none || plan.patches || plan.wipe)
      throw InputError(
          "--life: is for looks alone; leave --wipe, --before-after, --overlay patches, "
          "--show distance and --show displacement out");
    settings.life =
        patient ? life_about(middle_of_joints(*patient), patient->landmarks.find("pronasale"))
                : life_about(Vector3d(0, 0, 0));
  }
  plan.words = {{"show", options.show},
                {"distances", plan.map == SurfaceMap::distance
                                  ? fmt::format("up to {} mm", options.distance_near_mm)
                                  : std::string("none")},
                {"picture", describe(options)}};
  return plan;
}

}  // namespace

PicturePlan parse_pictures(const PictureOptions& options, const Case& patient) {
  return parse(options, &patient);
}

void check_pictures(const PictureOptions& options) {
  parse(options, nullptr);
  caption_lines(options.caption, 0, {}, "");
}

std::string describe(const PictureOptions& o) {
  std::string text = fmt::format("edges {}, {} times, {}", o.edges, o.supersample,
                                 o.shadows ? "shadows" : "no shadows");
  if (!o.clip.empty())
    text += fmt::format("; clip {} of {}{}", o.clip, o.clip_parts.empty() ? "all" : o.clip_parts,
                        o.clip_open ? ", open" : "");
  if (!o.cut_away.empty()) text += "; cut away " + o.cut_away;
  if (!o.overlay.empty()) text += "; overlay " + o.overlay;
  if (o.before_after) text += "; before and after";
  if (o.wipe) text += fmt::format("; wipe {}", *o.wipe);
  if (!o.caption.empty()) text += "; caption " + o.caption;
  if (o.light) text += "; light";
  if (o.transparent) text += "; transparent";
  if (!o.folds) text += "; no folds";
  if (o.life) text += "; life";
  return text;
}

}  // namespace condyle
