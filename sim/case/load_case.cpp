#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/mesh_io/mesh_files.h"
#include "sim/case/canal_list.h"
#include "sim/case/case_format.h"
#include "sim/case/case_io.h"
#include "sim/case/face_muscle_table.h"
#include "sim/case/json_file.h"
#include "sim/case/landmark_files.h"
#include "sim/case/muscle_table.h"
#include "sim/case/pair_rules.h"
#include "sim/case/tissue_plan_file.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

/// Path of a file named in case.json, which must lie in the case's folder after following links.
fs::path inside(const fs::path& folder, const JsonItem& item) {
  const std::string name = item.text();
  const fs::path relative(name);
  const bool climbs = std::any_of(relative.begin(), relative.end(),
                                  [](const fs::path& step) { return step == ".."; });
  const std::string rule = "; a case refers only to files in its own folder";
  if (name.empty() || relative.is_absolute() || climbs || name.find('\0') != std::string::npos)
    item.refuse("\"" + name + "\" is not a file in the case's folder" + rule);
  const fs::path file = folder / relative;
  std::error_code error;
  if (!fs::exists(file, error)) item.refuse("the file \"" + name + "\" is missing from the folder");
  const fs::path home = fs::canonical(folder, error), target = fs::canonical(file, error);
  const auto [end, rest] = std::mismatch(home.begin(), home.end(), target.begin(), target.end());
  if (error || end != home.end())
    item.refuse("\"" + name + "\" is a link that leads out of the folder" + rule);
  return file;
}

std::vector<Tooth> load_teeth(const JsonItem& list, int triangles) {
  std::vector<Tooth> teeth;
  std::set<int> numbers;
  int free_from = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const JsonItem item = list.at(i);
    Tooth tooth;
    tooth.fdi = item.at("fdi").integer(11, 85);
    if (!is_fdi(tooth.fdi))
      item.at("fdi").refuse(fmt::format("{} is no FDI tooth number (11 to 48)", tooth.fdi));
    if (!numbers.insert(tooth.fdi).second)
      item.at("fdi").refuse(fmt::format("the tooth {} appears twice", tooth.fdi));
    tooth.first_triangle = item.at("first_triangle").integer(free_from, triangles);
    tooth.triangle_count = item.at("triangle_count").integer(1, triangles - tooth.first_triangle);
    free_from = tooth.first_triangle + tooth.triangle_count;
    teeth.push_back(tooth);
  }
  return teeth;
}

Part load_part(const fs::path& folder, const JsonItem& item) {
  Part part;
  part.name = item.at("name").text();
  if (!is_part_name(part.name))
    item.at("name").refuse("\"" + part.name + "\" is no part name; use letters, digits, - and _");
  const std::string role = item.at("role").text();
  if (const auto known = role_named(role))
    part.role = *known;
  else
    item.at("role").refuse("the role \"" + role + "\" is unknown; known are " + known_roles());
  part.mesh = read_mesh(inside(folder, item.at("file")));
  if (const auto teeth = item.find("teeth"))
    part.teeth = load_teeth(*teeth, static_cast<int>(part.mesh.triangles.size()));
  return part;
}

BodyId body_named(const BodyTree& bodies, const JsonItem& item) {
  const auto body = bodies.find(item.text());
  if (!body) item.refuse("the body \"" + item.text() + "\" does not exist");
  return *body;
}

/// In the file parents precede their children, the cranium first.
BodyTree load_bodies(const JsonItem& list) {
  BodyTree bodies;
  if (list.size() == 0 || list.at(std::size_t{0}).at("name").text() != bodies[cranium_body].name)
    list.refuse("the first body must be the cranium");
  for (std::size_t i = 1; i < list.size(); ++i) {
    const JsonItem item = list.at(i);
    Body body;
    body.name = item.at("name").text();
    if (body.name.empty() || bodies.find(body.name))
      item.at("name").refuse("is \"" + body.name + "\"; each body needs a unique name");
    body.parent = body_named(bodies, item.at("parent"));
    const std::string driver = item.at("driver").text();
    if (const auto known = driver_named(driver))
      body.driver = *known;
    else
      item.at("driver").refuse("is \"" + driver +
                               "\"; it must be fixed, motion, plan, hand or dynamics");
    bodies.add(std::move(body));
  }
  return bodies;
}

JawBodies load_jaw(const JsonItem& item, const BodyTree& bodies) {
  return {.upper_arch = body_named(bodies, item.at("upper_arch")),
          .lower_arch = body_named(bodies, item.at("lower_arch")),
          .left_condyle = body_named(bodies, item.at("left_condyle")),
          .right_condyle = body_named(bodies, item.at("right_condyle"))};
}

/// Format 1: a segment or transplant is its own body, child of its "carrier".
void give_native_body(Case& patient, Part& part, const JsonItem& item) {
  part.body = default_body(part.role);
  const auto carrier = item.find("carrier");
  if (carrier && !is_piece(part.role))
    carrier->refuse("only a segment or transplant has a carrier; this part is " +
                    role_name(part.role));
  if (!is_piece(part.role)) return;
  BodyId parent = cranium_body;
  if (carrier && carrier->text() == "mandible")
    parent = mandible_body;
  else if (carrier && carrier->text() != "cranium")
    carrier->refuse("is \"" + carrier->text() + "\"; it must be cranium or mandible");
  const bool taken = patient.bodies.find(part.name).has_value();
  part.body = patient.bodies.add({.name = taken ? part.name + "-body" : part.name,
                                  .parent = parent,
                                  .driver = BodyDriver::hand});
}

PairRule load_rule(const Case& patient, const JsonItem& item) {
  constexpr double max_mm = 1000;
  PairRule rule;
  rule.a = item.at("a").text();
  rule.b = item.at("b").text();
  for (const char* side : {"a", "b"})
    if (const std::string name = item.at(side).text(); !is_rule_part(patient, name))
      item.at(side).refuse("no bone or teeth are called \"" + name + "\"; there are " +
                           rule_part_names(patient) + ", and * for any");
  const std::string policy = item.at("policy").text();
  if (const auto known = policy_named(policy))
    rule.policy = *known;
  else
    item.at("policy").refuse("the policy \"" + policy + "\" is unknown; known are " +
                             known_policies());
  if (const auto margin = item.find("margin_mm")) rule.margin_mm = margin->number(0, max_mm);
  if (const auto gap = item.find("gap_mm")) rule.gap_mm = gap->number(0, max_mm);
  return rule;
}

CondylarPath load_path(const JsonItem& item) {
  CondylarPath path;
  const JsonItem forward = item.at("forward_mm"), drop = item.at("drop_mm");
  for (std::size_t i = 0; i < forward.size(); ++i) {
    path.forward_mm.push_back(forward.at(i).number(-100, 100));
    if (i > 0 && !(path.forward_mm[i] > path.forward_mm[i - 1]))
      forward.at(i).refuse("the values must increase");
  }
  for (std::size_t i = 0; i < drop.size(); ++i)
    path.inferior_mm.push_back(drop.at(i).number(-100, 100));
  if (path.forward_mm.size() != path.inferior_mm.size() || path.forward_mm.size() < 2)
    item.refuse(
        fmt::format("forward_mm has {} values and drop_mm {}; both need the same number, 2 or more",
                    path.forward_mm.size(), path.inferior_mm.size()));
  if (path.forward_mm.front() > 0) forward.at(0).refuse("the path must start at or below 0");
  return path;
}

/// The stored quaternion must be of unit length; its bits are kept.
Pose load_bite(const JsonItem& item) {
  constexpr double far_mm = 1000, unit_error = 1e-6;
  const JsonItem rotation = item.at("rotation"), translation = item.at("translation_mm");
  for (const auto& [list, size] : {std::pair(&rotation, 4u), std::pair(&translation, 3u)})
    if (list->size() != size)
      list->refuse(fmt::format("has {} numbers; it must have {}", list->size(), size));
  const auto q = [&](std::size_t i) { return rotation.at(i).number(-1.001, 1.001); };
  const auto t = [&](std::size_t i) { return translation.at(i).number(-far_mm, far_mm); };
  Pose X_CM;
  X_CM.R = Eigen::Quaterniond(q(0), q(1), q(2), q(3));
  X_CM.t = {t(0), t(1), t(2)};
  if (std::abs(X_CM.R.norm() - 1) > unit_error)
    rotation.refuse(fmt::format("is no rotation: its length is {:.6g}", X_CM.R.norm()));
  return X_CM;
}

MotionParameters load_motion(const JsonItem& item) {
  MotionParameters parameters;
  if (!item.value().is_object()) item.refuse("must be an object of motion parameters");
  for (const auto& [key, value] : item.value().items()) {
    const auto* entry = motion_parameter(key);
    if (!entry || entry->key() != key) {
      std::string known;
      for (const auto& name : motion_parameter_names())
        known += (known.empty() ? "" : ", ") + name.key();
      item.at(key).refuse("is not known; known are " + known);
    }
    const double number = item.at(key).number(entry->low, entry->high);
    for (const auto member : entry->values) parameters.*member = number;
  }
  return parameters;
}

bool calls_itself_a_case(const nlohmann::json& root) {
  return root.is_object() && root.contains("format") && root["format"] == case_format;
}

int check_format(const fs::path& file, const JsonItem& root) {
  const std::string how =
      "; make a case from surfaces with: condyle import meshes --mandible FILE --maxilla FILE ... "
      "--out FOLDER";
  if (!calls_itself_a_case(root.value()))
    throw InputError(
        file, "",
        std::string("is not a Condyle case (no \"format\": \"") + case_format + "\")" + how);
  const int version = root.at("version").integer(1, 1'000'000);
  if (version > case_version)
    root.at("version").refuse(
        fmt::format("is {}; this program reads cases up to version {}: use a newer version",
                    version, case_version));
  return version;
}

SourceFrame load_source_frame(const JsonItem& root) {
  const JsonItem units = root.at("source_units"), axes = root.at("source_frame");
  try {
    return source_frame(units.text(), axes.text());
  } catch (const InputError&) {
    axes.refuse("\"" + units.text().substr(0, 20) + "\" and \"" + axes.text().substr(0, 20) +
                "\" are not valid units and axes of a case");
  }
}

}  // namespace

bool has_foreign_case_file(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_regular_file(folder / "case.json", ignored)) return false;
  try {
    const std::string text = read_file(folder / "case.json", max_case_json_bytes);
    const auto root = nlohmann::json::parse(text, nullptr, false);
    return !root.is_discarded() && !calls_itself_a_case(root);
  } catch (const InputError&) {
    return false;
  }
}

Case load_case(const fs::path& given) {
  const fs::path folder = given.filename() == "case.json" ? given.parent_path() / "." : given;
  std::error_code error;
  if (!fs::exists(folder, error)) throw InputError(given, "", "no such folder");
  if (!fs::is_directory(folder, error))
    throw InputError(given, "", "is a file; a case is a folder with a case.json");
  const fs::path file = folder / "case.json";
  if (!fs::exists(file, error))
    throw InputError(given, "",
                     "has no case.json, so it is not a case; make one from surfaces with: condyle "
                     "import meshes --mandible FILE --maxilla FILE ... --out FOLDER");
  const JsonFile json(file, read_file(file, max_case_json_bytes));
  const JsonItem root = json.root();
  const int version = check_format(file, root);

  Case patient;
  patient.name = root.at("name").text();
  patient.source = load_source_frame(root);
  if (version > 1) {
    patient.bodies = load_bodies(root.at("bodies"));
    patient.jaw = load_jaw(root.at("jaw"), patient.bodies);
  }
  const JsonItem parts = root.at("parts");
  if (parts.size() == 0) parts.refuse("is empty; a case needs one part or more");
  std::set<std::string> names;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    patient.parts.push_back(load_part(folder, parts.at(i)));
    Part& part = patient.parts.back();
    if (version == 1)
      give_native_body(patient, part, parts.at(i));
    else
      part.body = body_named(patient.bodies, parts.at(i).at("body"));
    if (!names.insert(patient.parts.back().name).second)
      parts.at(i).at("name").refuse("the part \"" + patient.parts.back().name + "\" occurs twice");
  }
  if (const auto landmarks = root.find("landmarks")) {
    // The names are canonical already.
    const fs::path points = inside(folder, *landmarks);
    for (const auto& row : read_landmark_table(points).rows)
      if (!patient.landmarks.points.try_emplace(row.name, row.point).second)
        throw InputError(points, row.where, "the landmark \"" + row.name + "\" occurs twice");
  }
  if (const auto canals = root.find("canals"))
    patient.canals = load_canals(*canals, patient.bodies);
  if (const auto path = root.find("condylar_path")) patient.condylar_path = load_path(*path);
  if (const auto opening = root.find("scan_opening_mm"))
    patient.scan_opening_mm = opening->number(0, max_scan_opening_mm);
  if (const auto bite = root.find("bite")) patient.X_CM_bite = load_bite(*bite);
  if (const auto muscles = root.find("muscles"))
    patient.muscles = read_muscles(inside(folder, *muscles), patient.notes);
  if (const auto muscles = root.find("face_muscles"))
    patient.face_muscles =
        read_face_muscles(inside(folder, *muscles), ZeroStrength::of_the_kind).muscles;
  if (const auto mechanics = root.find("mechanics"))
    patient.mechanics = read_mechanics(inside(folder, *mechanics));
  if (const auto rules = root.find("contact_pairs"))
    for (std::size_t i = 0; i < rules->size(); ++i)
      patient.pair_rules.push_back(load_rule(patient, rules->at(i)));
  if (const auto motion = root.find("motion")) patient.motion = load_motion(*motion);
  if (const auto tissue = root.find("tissue")) patient.tissue = load_tissue_plan(*tissue);
  if (const auto notes = root.find("notes"))
    for (std::size_t i = 0; i < notes->size(); ++i) patient.notes.push_back(notes->at(i).text());
  return patient;
}

}  // namespace condyle
