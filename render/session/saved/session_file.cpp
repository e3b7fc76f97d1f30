#include "render/session/saved/session_file.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <set>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "render/session/saved/session_fields.h"
#include "render/session/saved/session_reader.h"
#include "render/session/saved/session_writer.h"
#include "sim/phantom/head_shape.h"
#include "sim/plan/plan_file.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;
namespace fields = session_fields;
using fields::OrderedJson;

constexpr std::size_t max_session_bytes = std::size_t{64} << 20;

template <class Visit, class AnyView>
void view_fields(Visit& visit, AnyView& view) {
  using AnyEdits = std::conditional_t<std::is_const_v<AnyView>, const Edits, Edits>;
  visit.names("bodies", &ViewNames::bodies);
  fields::edit_fields(visit, static_cast<AnyEdits&>(view));
  fields::control_fields(visit, view);
}

OrderedJson source_json(const PatientSource& source, const fs::path& file) {
  if (const auto* built_in = std::get_if<BuiltInSource>(&source))
    return {{"built_in", built_in->name}};
  if (const auto* stored = std::get_if<FolderSource>(&source))
    return {{"folder", fields::stored_path(stored->folder, file)}};
  const auto& imported = std::get<SurfaceSource>(source);
  OrderedJson item = {
      {"surfaces", OrderedJson::array()}, {"units", imported.units}, {"frame", imported.frame}};
  for (const auto& surface : imported.surfaces)
    item["surfaces"].push_back(
        {{"file", fields::stored_path(surface.file, file)}, {"role", surface.role}});
  return item;
}

PatientSource source_in(const JsonItem& item, const fs::path& file) {
  if (const auto built_in = item.find("built_in")) {
    item.only_keys({"built_in"});
    if (!is_head_name(built_in->text()))
      built_in->refuse("is \"" + built_in->text().substr(0, 60) + "\"; no built-in patient");
    try {
      parse_head_name(built_in->text());
    } catch (const InputError& error) {
      built_in->refuse(error.what());
    }
    return BuiltInSource{built_in->text()};
  }
  if (const auto folder = item.find("folder")) {
    item.only_keys({"folder"});
    return FolderSource{fields::path_in(*folder, file)};
  }
  item.only_keys({"surfaces", "units", "frame"});
  const JsonItem list = item.at("surfaces");
  SurfaceSource imported{.units = item.at("units").text(), .frame = item.at("frame").text()};
  for (std::size_t i = 0; i < list.size(); ++i) {
    const JsonItem one = list.at(i);
    one.only_keys({"file", "role"});
    imported.surfaces.push_back({fields::path_in(one.at("file"), file), one.at("role").text()});
  }
  return imported;
}

OrderedJson camera_json(const Camera& camera) {
  const auto& [target, direction, up, distance_mm, field_of_view_deg, near_mm] = camera;
  return {{"target_mm", fields::point_json(target)},
          {"direction", fields::point_json(direction)},
          {"up", fields::point_json(up)},
          {"distance_mm", distance_mm},
          {"field_of_view_deg", field_of_view_deg},
          {"near_mm", near_mm}};
}

Camera camera_in(const JsonItem& item) {
  item.only_keys({"target_mm", "direction", "up", "distance_mm", "field_of_view_deg", "near_mm"});
  constexpr double unit_tolerance = 1e-6;
  const auto direction_in = [&](const char* name) {
    const JsonItem direction = item.at(name);
    const Eigen::Vector3d d = fields::point_in(direction);
    if (std::abs(d.norm() - 1) > unit_tolerance)
      direction.refuse(fmt::format("has length {:.6g}; a direction has length 1", d.norm()));
    return d;
  };
  Camera camera{.target = fields::point_in(item.at("target_mm")),
                .direction = direction_in("direction"),
                .up = direction_in("up"),
                .distance_mm = item.at("distance_mm").number(1e-3, 1e6),
                .field_of_view_deg = item.at("field_of_view_deg").number(1, 170),
                .near_mm = item.at("near_mm").number(0, 1e6)};
  if (camera.direction.cross(camera.up).norm() < unit_tolerance)
    item.at("up").refuse("is parallel to the direction");
  return camera;
}

/// A plan's JSON, of which a session has the case and the rest in two places.
OrderedJson plan_document(const Plan& plan) { return OrderedJson::parse(plan_json(plan)); }

Plan geometry_plan(const CaseGeometry& geometry) {
  Plan plan;
  plan.name = "plan";
  plan.geometry = geometry;
  return plan;
}

/// A plan of its document, which has the case of the session unless it states one.
Plan plan_in(const fs::path& file, const nlohmann::json& geometry, nlohmann::json document) {
  if (!document.contains("case")) document["case"] = geometry;
  return parse_plan(file, document.dump());
}

void read_plan(const JsonItem& item, SavedSession& session, const JsonItem& root,
               const fs::path& file) {
  item.only_keys({"file", "draft"});
  if (const auto path = item.find("file")) {
    if (item.find("draft")) path->refuse("stands beside a draft; one plan is expected");
    session.plan = fields::path_in(*path, file);
    return;
  }
  const JsonItem draft = item.at("draft");
  if (!draft.value().is_object()) draft.refuse("must be an object {...}");
  session.draft = plan_in(file, root.at("case").value(), draft.value());
}

void check_root(const JsonItem& root) {
  if (root.at("format").text() != session_format)
    root.at("format").refuse("is \"" + root.at("format").text().substr(0, 40) +
                             "\"; the file is no session");
  const int version = root.at("version").integer(1, std::numeric_limits<int>::max());
  if (version > session_version)
    root.at("version").refuse(
        fmt::format("is {}; this program reads sessions up to version {}: use a newer one", version,
                    session_version));
  root.only_keys({"format", "version", "patient", "case", "landmarks_replaced", "plan", "camera",
                  "panels", "view", "saved_as"});
}

}  // namespace

std::string session_json(const SavedSession& session, const fs::path& file) {
  OrderedJson root = {{"format", session_format}, {"version", session_version}};
  root["patient"] = source_json(session.source, file);
  if (session.landmarks_replaced) root["landmarks_replaced"] = true;
  if (!session.plan.empty()) root["plan"] = {{"file", fields::stored_path(session.plan, file)}};
  if (session.draft && session.plan.empty()) {
    OrderedJson draft = plan_document(*session.draft);
    if (session.draft->geometry == session.geometry) draft.erase("case");
    root["plan"] = {{"draft", std::move(draft)}};
  }
  if (!session.saved_as.empty()) root["saved_as"] = fields::stored_path(session.saved_as, file);
  root["camera"] = camera_json(session.camera);
  root["panels"] = OrderedJson::object();
  fields::Writer panels(root["panels"], session, file);
  fields::panel_fields(panels, static_cast<const PanelChoice&>(session.view));
  root["view"] = OrderedJson::object();
  fields::Writer view(root["view"], session, file);
  view_fields(view, session.view);
  root["case"] = plan_document(geometry_plan(session.geometry))["case"];
  return root.dump(1, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

SavedSession parse_session(const fs::path& file, std::string_view text) {
  const JsonFile json(file, text);
  const JsonItem root = json.root();
  check_root(root);
  SavedSession session;
  session.source = source_in(root.at("patient"), file);
  nlohmann::json empty = nlohmann::json::parse(plan_json(geometry_plan({})));
  empty.erase("case");
  session.geometry = plan_in(file, root.at("case").value(), empty).geometry;
  if (const auto replaced = root.find("landmarks_replaced"))
    session.landmarks_replaced = fields::flag_in(*replaced);
  if (const auto saved_as = root.find("saved_as"))
    session.saved_as = fields::path_in(*saved_as, file);
  if (const auto plan = root.find("plan")) read_plan(*plan, session, root, file);
  session.camera = camera_in(root.at("camera"));
  fields::Reader panels(root.at("panels"), session, file);
  fields::panel_fields(panels, static_cast<PanelChoice&>(session.view));
  panels.end();
  fields::Reader view(root.at("view"), session, file);
  view_fields(view, session.view);
  view.end();
  return session;
}

SavedSession load_session(const fs::path& file) {
  return parse_session(file, read_file(file, max_session_bytes));
}

void check_session_files(const SavedSession& session, const fs::path& file) {
  const auto check = [&](const std::string& item, const fs::path& path, const char* what) {
    std::error_code ignored;
    if (!fs::exists(path, ignored))
      throw InputError(file, item, "is " + path.string() + "; there is no such " + what);
  };
  if (const auto* stored = std::get_if<FolderSource>(&session.source))
    check("patient.folder", stored->folder, "folder");
  if (const auto* imported = std::get_if<SurfaceSource>(&session.source))
    for (std::size_t i = 0; i < imported->surfaces.size(); ++i)
      check(fmt::format("patient.surfaces[{}].file", i), imported->surfaces[i].file, "file");
  if (!session.plan.empty()) check("plan.file", session.plan, "file");
}

}  // namespace condyle
