#include <fcntl.h>
#include <fmt/format.h>
#include <stdio.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/mesh_io/mesh_files.h"
#include "sim/case/canal_list.h"
#include "sim/case/case_format.h"
#include "sim/case/case_io.h"
#include "sim/case/face_muscle_table.h"
#include "sim/case/landmark_files.h"
#include "sim/case/muscle_table.h"
#include "sim/case/pair_rules.h"
#include "sim/case/tissue_plan_file.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json to_json(const Part& part, const BodyTree& bodies) {
  Json item = {{"name", part.name}, {"role", role_name(part.role)}, {"file", part.name + ".ply"}};
  for (const auto& tooth : part.teeth)
    item["teeth"].push_back({{"fdi", tooth.fdi},
                             {"first_triangle", tooth.first_triangle},
                             {"triangle_count", tooth.triangle_count}});
  item["body"] = bodies[part.body].name;
  return item;
}

Json to_json(const BodyTree& bodies) {
  Json list = Json::array();
  for (const Body& body : bodies.bodies()) {
    Json item = {{"name", body.name}};
    if (!list.empty()) {
      item["parent"] = bodies[body.parent].name;
      item["driver"] = driver_name(body.driver);
    }
    list.push_back(std::move(item));
  }
  return list;
}

Json to_json(const JawBodies& jaw, const BodyTree& bodies) {
  return {{"upper_arch", bodies[jaw.upper_arch].name},
          {"lower_arch", bodies[jaw.lower_arch].name},
          {"left_condyle", bodies[jaw.left_condyle].name},
          {"right_condyle", bodies[jaw.right_condyle].name}};
}

Json to_json(const PairRule& rule) {
  Json item = {{"a", rule.a}, {"b", rule.b}, {"policy", policy_name(rule.policy)}};
  if (rule.margin_mm) item["margin_mm"] = *rule.margin_mm;
  if (rule.gap_mm > 0) item["gap_mm"] = rule.gap_mm;
  return item;
}

Json bite_json(const Pose& X_CM) {
  const Eigen::Quaterniond& R = X_CM.R;
  return {{"rotation", {R.w(), R.x(), R.y(), R.z()}},
          {"translation_mm", {X_CM.t.x(), X_CM.t.y(), X_CM.t.z()}}};
}

Json to_json(const Case& patient) {
  Json root = {{"format", case_format},
               {"version", case_version},
               {"name", patient.name},
               {"source_units", patient.source.units},
               {"source_frame", patient.source.axes},
               {"bodies", to_json(patient.bodies)},
               {"jaw", to_json(patient.jaw, patient.bodies)},
               {"parts", Json::array()}};
  for (const auto& part : patient.parts) root["parts"].push_back(to_json(part, patient.bodies));
  if (!patient.landmarks.points.empty()) root["landmarks"] = "landmarks.csv";
  if (!patient.canals.empty()) root["canals"] = canals_json(patient.canals, patient.bodies);
  if (patient.condylar_path)
    root["condylar_path"] = {{"forward_mm", patient.condylar_path->forward_mm},
                             {"drop_mm", patient.condylar_path->inferior_mm}};
  if (patient.scan_opening_mm) root["scan_opening_mm"] = *patient.scan_opening_mm;
  if (const auto& bite = patient.X_CM_bite) root["bite"] = bite_json(*bite);
  if (!patient.muscles.empty()) root["muscles"] = muscles_file;
  if (!patient.face_muscles.empty()) root["face_muscles"] = face_muscles_file;
  if (patient.mechanics) root["mechanics"] = mechanics_file;
  for (const auto& rule : patient.pair_rules) root["contact_pairs"].push_back(to_json(rule));
  for (const auto& entry : motion_parameter_names())
    if (const auto value = entry.values.front(); entry.values.size() == 1 && patient.motion.*value)
      root["motion"][entry.key()] = *(patient.motion.*value);
  if (const auto tissue = tissue_plan_json(patient.tissue); !tissue.empty())
    root["tissue"] = tissue;
  root["notes"] = patient.notes;
  return root;
}

/// A case that could not be loaded again must not be written.
void check(const Case& patient, const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& part : patient.parts) {
    if (!is_part_name(part.name) || !names.insert(part.name).second)
      throw InputError(folder, "part \"" + part.name + "\"",
                       "the name must be unique and of letters, digits, - and _");
    if (part.mesh.empty())
      throw InputError(folder, "part \"" + part.name + "\"", "has no triangles");
  }
  if (patient.parts.empty()) throw InputError(folder, "", "a case without parts cannot be saved");
  check_rules(patient, patient.pair_rules, folder.string() + ": the rule for");
  for (const auto& [name, point] : patient.landmarks.points)
    if (!is_part_name(name))
      throw InputError(folder, "landmark \"" + name + "\"",
                       "the name must be of letters, digits, - and _");
    else if (!point.allFinite())
      throw InputError(folder, "landmark " + name, "its position is not finite");
  check_canals(patient.canals, patient.bodies, folder);
}

/// Whether everything in the folder was written by an earlier save, so that it may be replaced.
void check_replaceable(const fs::path& folder) {
  std::set<std::string> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    files.insert(entry->path().filename().string());
  if (error) throw MachineError(folder.string() + ": cannot be read: " + error.message());
  if (files.empty()) return;
  const auto refuse = [&](const std::string& problem) {
    throw InputError(folder, "", problem + "; choose a new or empty folder for the case");
  };
  const auto saved = [&] {
    try {
      return Json::parse(read_file(folder / "case.json", max_case_json_bytes));
    } catch (const std::exception&) {
      return Json();
    }
  }();
  if (!saved.is_object() || !saved.contains("format") || saved["format"] != case_format)
    refuse("contains " + *files.begin() + " and is not a case");
  files.erase("case.json");
  files.erase("landmarks.csv");
  files.erase(muscles_file);
  files.erase(face_muscles_file);
  files.erase(mechanics_file);
  if (saved.contains("parts") && saved["parts"].is_array())
    for (const auto& part : saved["parts"])
      if (part.is_object() && part.contains("file") && part["file"].is_string())
        files.erase(part["file"].get<std::string>());
  if (!files.empty())
    refuse("contains " + *files.begin() + ", which is not part of the case there");
}

void put_in_place(const fs::path& made, const fs::path& folder) {
  std::error_code ignored;
  if (!fs::exists(folder, ignored)) {
    if (::rename(made.c_str(), folder.c_str()) == 0) return;
  } else if (::renameat2(AT_FDCWD, made.c_str(), AT_FDCWD, folder.c_str(), RENAME_EXCHANGE) == 0) {
    fs::remove_all(made, ignored);  // now the earlier case
    return;
  } else if (errno == EINVAL || errno == ENOSYS) {
    // No atomic exchange on this file system: two steps, the first undone if the second fails.
    const fs::path earlier = made.string() + ".earlier";
    if (::rename(folder.c_str(), earlier.c_str()) == 0) {
      if (::rename(made.c_str(), folder.c_str()) == 0) {
        fs::remove_all(earlier, ignored);
        return;
      }
      const int reason = errno;
      if (::rename(earlier.c_str(), folder.c_str()) != 0)
        throw MachineError(folder.string() +
                           ": could not be replaced; the earlier case is now at " +
                           earlier.string());
      errno = reason;
    }
  }
  throw MachineError(folder.string() +
                     ": the case cannot be moved into place: " + std::strerror(errno));
}

}  // namespace

bool is_part_name(const std::string& name) {
  return !name.empty() && name.size() <= 100 &&
         std::all_of(name.begin(), name.end(),
                     [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_'; });
}

bool is_fdi(int number) {
  const int quadrant = number / 10, place = number % 10;
  return quadrant >= 1 && quadrant <= 8 && place >= 1 && place <= (quadrant <= 4 ? 8 : 5);
}

void save_case(const Case& patient, const fs::path& given) {
  check(patient, given);
  std::error_code error;
  // Follows links and removes a trailing slash: the folder itself is replaced.
  fs::path folder = fs::weakly_canonical(given, error);
  if (error || folder.empty()) folder = fs::absolute(given);
  if (!folder.has_filename()) folder = folder.parent_path();
  if (fs::exists(folder, error)) {
    if (!fs::is_directory(folder, error))
      throw InputError(given, "", "is a file; give a folder for the case");
    check_replaceable(folder);
  }
  if (folder.has_parent_path()) make_folder(folder.parent_path());
  const fs::path made =
      folder.parent_path() / fmt::format(".{}.{}.part", folder.filename().string(), ::getpid());
  try {
    make_folder(made);
    for (const auto& part : patient.parts) write_ply(part.mesh, made / (part.name + ".ply"));
    if (!patient.landmarks.points.empty())
      write_file(made / "landmarks.csv", landmarks_csv(patient.landmarks));
    if (!patient.muscles.empty()) write_file(made / muscles_file, muscles_csv(patient.muscles));
    if (!patient.face_muscles.empty())
      write_file(made / face_muscles_file, face_muscles_csv(patient.face_muscles));
    if (patient.mechanics) write_file(made / mechanics_file, mechanics_json(*patient.mechanics));
    write_file(made / "case.json",
               to_json(patient).dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
    put_in_place(made, folder);
  } catch (...) {
    fs::remove_all(made, error);
    throw;
  }
}

}  // namespace condyle
