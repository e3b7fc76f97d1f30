#include "sim/plan/plan_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "sim/case/json_file.h"
#include "sim/plan/graft_step_file.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

constexpr std::size_t max_plan_bytes = std::size_t{16} << 20;
constexpr std::size_t line_width = 96;

Json point_json(const Vector3d& p) { return {p.x(), p.y(), p.z()}; }
Json rotation_json(const Eigen::Quaterniond& R) { return {R.w(), R.x(), R.y(), R.z()}; }

Json step_json(const PlanePatch& patch) {
  Json item = {
      {"kind", "plane"}, {"point", point_json(patch.point)}, {"normal", point_json(patch.normal)}};
  if (const auto* rectangle = std::get_if<PatchRectangle>(&patch.reach)) {
    item["axis"] = point_json(rectangle->axis);
    item["half_along_mm"] = rectangle->half_along_mm;
    item["half_across_mm"] = rectangle->half_across_mm;
  } else {
    item["radius_mm"] = std::get<double>(patch.reach);
  }
  return item;
}

Json step_json(const BentSheet& sheet) {
  Json item = {{"kind", "sheet"}, {"polyline", Json::array()}};
  for (const auto& point : sheet.polyline) item["polyline"].push_back(point_json(point));
  item["direction"] = point_json(sheet.direction);
  item["depth_mm"] = sheet.depth_mm;
  item["overhang_mm"] = sheet.overhang_mm;
  return item;
}

Json step_json(const CutStep& cut) {
  Json item = Json::object();
  if (!cut.osteotomy.empty()) item["osteotomy"] = cut.osteotomy;
  if (!cut.target.empty()) item["target"] = cut.target;
  if (!cut.bone.empty()) item["bone"] = cut.bone;
  if (!cut.parameters.empty()) item["parameters"] = cut.parameters;
  item["kerf_mm"] = cut.kerf_mm;
  for (const auto& surface : cut.surfaces)
    item["surfaces"].push_back(
        std::visit([](const auto& known) { return step_json(known); }, surface));
  item["pieces"] = cut.pieces;
  if (cut.below_margins) item["below_margins"] = true;
  return {{"cut", item}};
}

Json step_json(const MoveStep& step) {
  Json item = {{"segment", step.segment}};
  if (const auto* move = std::get_if<ClinicalMove>(&step.move)) {
    if (!move->about.empty()) item["about"] = move->about;
    item["left_mm"] = move->left_mm;
    item["forward_mm"] = move->forward_mm;
    item["up_mm"] = move->up_mm;
    item["roll_deg"] = move->roll_deg;
    item["pitch_deg"] = move->pitch_deg;
    item["yaw_deg"] = move->yaw_deg;
  } else {
    const Pose& X_CS = std::get<ExplicitMove>(step.move).X_CS;
    item["rotation"] = rotation_json(X_CS.R);
    item["translation_mm"] = point_json(X_CS.t);
  }
  return {{"move", item}};
}

Json step_json(const TrimStep& step) {
  Json item = {{"segment", step.segment}, {"of", step.of}};
  if (step.below_margins) item["below_margins"] = true;
  return {{"trim", item}};
}

Json step_json(const NoteStep& note) { return {{"note", note.text}}; }
Json step_json(const ResectStep& step) { return {{"resect", graft_step_json(step)}}; }
Json step_json(const GraftStep& step) { return {{"graft", graft_step_json(step)}}; }

/// Points and triangles are flat lists, so that each keeps to one line.
Json zone_json(const PlanZone& zone) {
  Json item = {{"name", zone.name}, {"kind", zone_kind_name(zone.kind)}};
  if (zone.radius_mm > 0) item["radius_mm"] = zone.radius_mm;
  if (zone.warn_mm) item["warn_mm"] = *zone.warn_mm;
  if (zone.stop_mm) item["stop_mm"] = *zone.stop_mm;
  item["points"] = Json::array();
  for (const Vector3d& p : zone.points)
    for (const double coordinate : p) item["points"].push_back(coordinate);
  for (const Eigen::Vector3i& t : zone.triangles)
    for (const int corner : t) item["triangles"].push_back(corner);
  return item;
}

std::string line_of(const Json& value) {
  std::string text;
  if (value.is_structured()) {
    for (const auto& [key, item] : value.items()) {
      if (!text.empty()) text += ", ";
      if (value.is_object()) text += line_of(key) + ": ";
      text += line_of(item);
    }
    return value.is_object() ? "{" + text + "}" : "[" + text + "]";
  }
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Indented text in which points and short lists keep to one line.
void put_indented(std::string& text, const Json& value, std::size_t indent) {
  const auto is_flat = [](const Json& list) {
    return std::none_of(list.begin(), list.end(), [](const Json& v) { return v.is_structured(); });
  };
  if (!value.is_structured() || value.empty() || is_flat(value)) {
    const std::string line = line_of(value);
    if (value.is_array() || !value.is_structured() || indent + line.size() < line_width) {
      text += line;
      return;
    }
  }
  text += value.is_object() ? "{" : "[";
  bool is_first = true;
  for (const auto& [key, item] : value.items()) {
    text += (is_first ? "\n" : ",\n") + std::string(indent + 1, ' ');
    is_first = false;
    if (value.is_object()) text += line_of(key) + ": ";
    put_indented(text, item, indent + 1);
  }
  text += "\n" + std::string(indent, ' ') + (value.is_object() ? "}" : "]");
}

double number_in(const JsonItem& item) {
  constexpr double most = std::numeric_limits<double>::max();
  return item.number(-most, most);
}

double number_in(const JsonItem& item, const char* key, double absent) {
  const auto found = item.find(key);
  return found ? number_in(*found) : absent;
}

std::string text_in(const JsonItem& item, const char* key) {
  const auto found = item.find(key);
  return found ? found->text() : "";
}

Vector3d point_in(const JsonItem& item) {
  if (item.size() != 3) item.refuse(fmt::format("has {} numbers; expected 3", item.size()));
  Vector3d p;
  for (std::size_t i = 0; i < 3; ++i) p[static_cast<int>(i)] = number_in(item.at(i));
  return p;
}

Eigen::Quaterniond rotation_in(const JsonItem& item) {
  if (item.size() != 4)
    item.refuse(fmt::format("has {} numbers; expected 4: w, x, y, z", item.size()));
  double q[4];
  for (std::size_t i = 0; i < 4; ++i) q[i] = number_in(item.at(i));
  return {q[0], q[1], q[2], q[3]};
}

std::uint64_t hash_in(const JsonItem& item) {
  const std::string text = item.text();
  std::uint64_t hash = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), hash, 16);
  if (text.size() != 16 || error != std::errc() || end != text.data() + text.size())
    item.refuse("is \"" + text.substr(0, 40) + "\"; expected 16 hexadecimal digits");
  return hash;
}

std::vector<std::string> texts_in(const JsonItem& list) {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < list.size(); ++i) texts.push_back(list.at(i).text());
  return texts;
}

bool below_margins_in(const JsonItem& item) {
  const auto below = item.find("below_margins");
  if (!below) return false;
  if (!below->value().is_boolean()) below->refuse("must be true or false");
  return below->value().get<bool>();
}

CutSurface surface_in(const JsonItem& item) {
  const std::string kind = item.at("kind").text();
  if (kind == "plane") {
    item.only_keys(
        {"kind", "point", "normal", "radius_mm", "axis", "half_along_mm", "half_across_mm"});
    PlanePatch patch{.point = point_in(item.at("point")), .normal = point_in(item.at("normal"))};
    const auto radius = item.find("radius_mm");
    if (radius && item.find("axis")) radius->refuse("stands beside an axis; one reach is expected");
    if (radius)
      patch.reach = number_in(*radius);
    else
      patch.reach = PatchRectangle{.axis = point_in(item.at("axis")),
                                   .half_along_mm = number_in(item.at("half_along_mm")),
                                   .half_across_mm = number_in(item.at("half_across_mm"))};
    return patch;
  }
  if (kind != "sheet") item.at("kind").refuse("is \"" + kind + "\"; it must be plane or sheet");
  item.only_keys({"kind", "polyline", "direction", "depth_mm", "overhang_mm"});
  BentSheet sheet;
  const JsonItem line = item.at("polyline");
  for (std::size_t i = 0; i < line.size(); ++i) sheet.polyline.push_back(point_in(line.at(i)));
  sheet.direction = point_in(item.at("direction"));
  sheet.depth_mm = number_in(item.at("depth_mm"));
  sheet.overhang_mm = number_in(item, "overhang_mm", sheet.overhang_mm);
  return sheet;
}

CutStep cut_in(const JsonItem& item) {
  item.only_keys({"osteotomy", "target", "bone", "parameters", "kerf_mm", "surfaces", "pieces",
                  "below_margins"});
  CutStep cut{.osteotomy = text_in(item, "osteotomy"),
              .target = text_in(item, "target"),
              .bone = text_in(item, "bone")};
  if (const auto parameters = item.find("parameters")) {
    if (!parameters->value().is_object()) parameters->refuse("must be an object {...}");
    for (const auto& [name, value] : parameters->value().items())
      cut.parameters[name] = number_in(parameters->at(name));
  }
  cut.kerf_mm = number_in(item.at("kerf_mm"));
  if (const auto surfaces = item.find("surfaces"))
    for (std::size_t i = 0; i < surfaces->size(); ++i)
      cut.surfaces.push_back(surface_in(surfaces->at(i)));
  cut.pieces = texts_in(item.at("pieces"));
  cut.below_margins = below_margins_in(item);
  return cut;
}

TrimStep trim_in(const JsonItem& item) {
  item.only_keys({"segment", "of", "below_margins"});
  return {.segment = item.at("segment").text(),
          .of = texts_in(item.at("of")),
          .below_margins = below_margins_in(item)};
}

PlanZone zone_in(const fs::path& file, const JsonItem& item) {
  item.only_keys({"name", "kind", "radius_mm", "warn_mm", "stop_mm", "points", "triangles"});
  PlanZone zone{.name = item.at("name").text()};
  const std::string kind = item.at("kind").text();
  const auto known = zone_kind_named(kind);
  if (!known)
    item.at("kind").refuse("is \"" + kind + "\"; it must be tooth, canal, foramen or other");
  zone.kind = *known;
  zone.radius_mm = number_in(item, "radius_mm", 0);
  if (const auto warn = item.find("warn_mm")) zone.warn_mm = number_in(*warn);
  if (const auto stop = item.find("stop_mm")) zone.stop_mm = number_in(*stop);
  const auto refuse_length = [](const JsonItem& list, std::size_t most) {
    if (list.size() % 3 != 0 || list.size() > 3 * most)
      list.refuse(
          fmt::format("has {} numbers; expected three each for at most {}", list.size(), most));
  };
  const JsonItem points = item.at("points");
  refuse_length(points, max_zone_points);
  for (std::size_t i = 0; i < points.size(); i += 3)
    zone.points.emplace_back(number_in(points.at(i)), number_in(points.at(i + 1)),
                             number_in(points.at(i + 2)));
  if (const auto triangles = item.find("triangles")) {
    refuse_length(*triangles, max_zone_triangles);
    const auto corner = [&](std::size_t i) {
      return triangles->at(i).integer(0, static_cast<int>(max_zone_points));
    };
    for (std::size_t i = 0; i < triangles->size(); i += 3)
      zone.triangles.emplace_back(corner(i), corner(i + 1), corner(i + 2));
  }
  if (const auto found = problem_of(zone))
    throw InputError(file, item.name() + "." + found->item, found->problem);
  return zone;
}

MoveStep move_in(const JsonItem& item) {
  MoveStep step{.segment = item.at("segment").text()};
  if (item.find("rotation") || item.find("translation_mm")) {
    item.only_keys({"segment", "rotation", "translation_mm"});
    step.move =
        ExplicitMove{{rotation_in(item.at("rotation")), point_in(item.at("translation_mm"))}};
    return step;
  }
  item.only_keys(
      {"segment", "about", "left_mm", "forward_mm", "up_mm", "roll_deg", "pitch_deg", "yaw_deg"});
  step.move = ClinicalMove{.about = text_in(item, "about"),
                           .left_mm = number_in(item, "left_mm", 0),
                           .forward_mm = number_in(item, "forward_mm", 0),
                           .up_mm = number_in(item, "up_mm", 0),
                           .roll_deg = number_in(item, "roll_deg", 0),
                           .pitch_deg = number_in(item, "pitch_deg", 0),
                           .yaw_deg = number_in(item, "yaw_deg", 0)};
  return step;
}

PlanStep step_in(const fs::path& file, const JsonItem& item) {
  item.only_keys({"id", "cut", "move", "trim", "note", "resect", "graft"});
  if (item.value().size() != 2)
    item.refuse("must have an id and one of cut, move, trim, note, resect and graft");
  PlanStep step{.id = item.at("id").integer(1, 1000000)};
  std::string kind;
  if (const auto cut = item.find("cut")) {
    step.action = cut_in(*cut);
    kind = "cut";
  } else if (const auto move = item.find("move")) {
    step.action = move_in(*move);
    kind = "move";
  } else if (const auto trim = item.find("trim")) {
    step.action = trim_in(*trim);
    kind = "trim";
  } else if (const auto resection = item.find("resect")) {
    step.action = resect_step_in(*resection);
    kind = "resect";
  } else if (const auto graft = item.find("graft")) {
    step.action = graft_step_in(*graft);
    kind = "graft";
  } else {
    step.action = NoteStep{item.at("note").text()};
    kind = "note";
  }
  if (const auto found = problem_of(step.action)) {
    const bool has_item = !found->item.empty() && kind != "note";
    throw InputError(file, item.name() + "." + kind + (has_item ? "." + found->item : ""),
                     found->problem);
  }
  return step;
}

CaseGeometry geometry_in(const JsonItem& item) {
  item.only_keys({"name", "parts", "landmarks"});
  CaseGeometry geometry{.name = item.at("name").text(), .parts = {}, .landmarks = {}};
  const JsonItem parts = item.at("parts");
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const JsonItem part = parts.at(i);
    part.only_keys({"name", "shape"});
    geometry.parts.push_back({part.at("name").text(), hash_in(part.at("shape"))});
  }
  const JsonItem landmarks = item.at("landmarks");
  if (!landmarks.value().is_object()) landmarks.refuse("must be an object {...}");
  for (const auto& [name, value] : landmarks.value().items())
    geometry.landmarks.points[name] = point_in(landmarks.at(name));
  return geometry;
}

HeadReference reference_in(const JsonItem& item) {
  item.only_keys({"horizontal", "rotation"});
  HeadReference reference;
  const std::string name = item.at("horizontal").text();
  if (name == horizontal_name(Horizontal::natural_head_position))
    reference.horizontal = Horizontal::natural_head_position;
  else if (name != horizontal_name(Horizontal::frankfort))
    item.at("horizontal")
        .refuse("is \"" + name + "\"; it must be " + horizontal_name(Horizontal::frankfort) +
                " or " + horizontal_name(Horizontal::natural_head_position));
  if (const auto rotation = item.find("rotation")) reference.R_NC = rotation_in(*rotation);
  return reference;
}

/// Of a key that an object has twice, the parser would silently take the last.
void check_keys(const fs::path& file, std::string_view text) {
  std::vector<std::set<std::string>> keys;
  const auto visit = [&](int, Json::parse_event_t event, Json& value) {
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second)
      throw InputError(file, value.get<std::string>().substr(0, 40), "appears twice in an object");
    return true;
  };
  [[maybe_unused]] const Json parsed = Json::parse(text.begin(), text.end(), visit);
}

void check_format(const JsonItem& root) {
  if (root.at("format").text() != plan_format)
    root.at("format").refuse("is \"" + root.at("format").text().substr(0, 40) +
                             "\"; the file is no plan of an operation");
  const int version = root.at("version").integer(1, std::numeric_limits<int>::max());
  if (version > plan_version)
    root.at("version").refuse(
        fmt::format("is {}; this program reads plans up to version {}: use a newer one", version,
                    plan_version));
}

}  // namespace

int version_of(const Plan& plan) {
  const bool recent = std::any_of(plan.steps.begin(), plan.steps.end(), [](const PlanStep& step) {
    return std::holds_alternative<TrimStep>(step.action) ||
           std::holds_alternative<ResectStep>(step.action) ||
           std::holds_alternative<GraftStep>(step.action);
  });
  return recent || !plan.zones.empty() ? 2 : 1;
}

std::string plan_json(const Plan& plan) {
  Json root = {{"format", plan_format}, {"version", version_of(plan)}, {"name", plan.name}};
  Json& geometry = root["case"] = {{"name", plan.geometry.name}, {"parts", Json::array()}};
  for (const auto& part : plan.geometry.parts)
    geometry["parts"].push_back(
        {{"name", part.name}, {"shape", fmt::format("{:016x}", part.hash)}});
  geometry["landmarks"] = Json::object();
  for (const auto& [name, point] : plan.geometry.landmarks.points)
    geometry["landmarks"][name] = point_json(point);
  root["reference"] = {{"horizontal", horizontal_name(plan.reference.horizontal)},
                       {"rotation", rotation_json(plan.reference.R_NC)}};
  root["steps"] = Json::array();
  for (const auto& step : plan.steps) {
    Json item = {{"id", step.id}};
    item.update(std::visit([](const auto& action) { return step_json(action); }, step.action));
    root["steps"].push_back(item);
  }
  for (const PlanZone& zone : plan.zones) root["zones"].push_back(zone_json(zone));
  std::string text;
  put_indented(text, root, 0);
  return text + "\n";
}

std::string plan_hash(const Plan& plan) {
  const std::string text = plan_json(plan);
  return fmt::format("{:016x}", hash_bytes(text.data(), text.size()));
}

Plan parse_plan(const fs::path& file, std::string_view text) {
  const JsonFile json(file, text);
  const JsonItem root = json.root();
  check_format(root);
  check_keys(file, text);
  root.only_keys({"format", "version", "name", "case", "reference", "steps", "zones"});
  Plan plan{.name = root.at("name").text(),
            .geometry = geometry_in(root.at("case")),
            .reference = reference_in(root.at("reference")),
            .steps = {}};
  const JsonItem steps = root.at("steps");
  for (std::size_t i = 0; i < steps.size(); ++i) plan.steps.push_back(step_in(file, steps.at(i)));
  if (const auto zones = root.find("zones"))
    for (std::size_t i = 0; i < zones->size(); ++i)
      plan.zones.push_back(zone_in(file, zones->at(i)));
  try {
    check_plan(plan);
  } catch (const InputError& error) {
    throw InputError(file, "", error.what());
  }
  return plan;
}

Plan load_plan(const fs::path& file) { return parse_plan(file, read_file(file, max_plan_bytes)); }

std::string checked_plan_json(const Plan& plan, const fs::path& file) {
  check_plan(plan);
  std::string text = plan_json(plan);
  if (text.size() > max_plan_bytes || parse_plan(file, text) != plan)
    throw InputError(file, "", "the plan has names or texts that could not be read back");
  return text;
}

void save_plan(const Plan& plan, const fs::path& file) {
  write_file(file, checked_plan_json(plan, file));
}

}  // namespace condyle
