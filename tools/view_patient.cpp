#include "tools/view_patient.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <utility>

#include "engine/core/error.h"
#include "sim/muscles/usual_muscles.h"

namespace condyle {
namespace fs = std::filesystem;
namespace {

std::string lower_case(std::string words) {
  std::transform(words.begin(), words.end(), words.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return words;
}

/// The first line that is neither empty nor a comment.
std::string first_line(const fs::path& file) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);)
    if (!line.empty() && line.front() != '#' && line.front() != '\r') return lower_case(line);
  return {};
}

/// Of the others a patient may well have several.
bool is_had_once(const std::string& role) {
  return !role.empty() && role != "segment" && role != "transplant";
}

std::string role_guess(const fs::path& file) {
  if (const FileKind kind = kind_of(file); kind != FileKind::surface)
    return kind == FileKind::landmarks ? "landmarks" : kind == FileKind::muscles ? "muscles" : "";
  const std::string name = lower_case(file.stem().string());
  const auto has = [&](std::initializer_list<const char*> words) {
    return std::any_of(words.begin(), words.end(),
                       [&](const char* word) { return name.find(word) != std::string::npos; });
  };
  const bool teeth = has({"teeth", "tooth", "dent", "arch", "crown"}) &&
                     !has({"with_teeth", "with-teeth", "with teeth", "with_dent"});
  if (teeth && has({"lower", "mandib", "inferior"})) return "lower-teeth";
  if (teeth && has({"upper", "maxill", "superior"})) return "upper-teeth";
  if (has({"mandib", "lower"})) return "mandible";
  if (has({"maxill", "upper"})) return "maxilla";
  if (has({"jaw"})) return "mandible";
  if (has({"skull", "crani", "head_bone"})) return "skull";
  if (has({"face", "skin", "soft"})) return "face";
  if (has({"transplant", "graft", "fibula"})) return "transplant";
  if (has({"segment"})) return "segment";
  return {};
}

}  // namespace

std::shared_ptr<const ViewPatient> make_view_patient(Case patient, fs::path folder,
                                                     SimulatorSettings settings,
                                                     const Progress& progress) {
  std::string trouble;
  const auto build = [&]() -> Scene {
    try {
      return make_scene(patient, settings, progress);
    } catch (const InputError& error) {
      if (!settings.tissue) throw;
      trouble = std::string("The soft tissue is left out. ") + error.what();
      settings.tissue = false;
      return make_scene(patient, settings, progress);
    }
  };
  auto made = std::make_shared<ViewPatient>(
      ViewPatient{std::move(folder), build(), {}, {}, {}, std::move(trouble)});
  made->at_rest = rest_frame(made->scene);
  carry_face(made->scene, made->at_rest, settings.threads);
  for (const auto& [name, at] : made->scene.patient.landmarks.points)
    made->landmarks.push_back(landmark_at(name, at, made->scene.patient.parts));
  try {
    made->muscles = muscles_of(made->scene.patient);
  } catch (const InputError&) {
    // Nobody asked for them; a motion by muscles says what is missing.
  }
  return made;
}

Case with_landmarks(Case patient, const std::vector<Landmark>& landmarks) {
  patient.landmarks.points.clear();
  for (const auto& landmark : landmarks) patient.landmarks.points[landmark.name] = landmark.at_rest;
  return patient;
}

FileKind kind_of(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return FileKind::patient;
  if (path.filename() == "case.json") return FileKind::patient;
  const std::string ending = lower_case(path.extension().string());
  for (const char* surface : {".stl", ".ply", ".obj", ".glb", ".gltf"})
    if (ending == surface) return FileKind::surface;
  if (lower_case(path.string()).ends_with(".mrk.json")) return FileKind::landmarks;
  if (ending == ".csv") {
    const std::string header = first_line(path);
    if (header.find("max_force_n") != std::string::npos) return FileKind::muscles;
    if (header.starts_with("name") || header.find("x_mm") == 0) return FileKind::landmarks;
    const bool has_place = header.find('x') != std::string::npos;
    return header.starts_with("time_s") && !has_place ? FileKind::excitations : FileKind::motion;
  }
  for (const char* motion : {".motion", ".mot", ".sto", ".trc", ".raw", ".txt"})
    if (ending == motion) return FileKind::motion;
  return FileKind::unknown;
}

std::vector<FileRole> proposed_roles(const std::vector<fs::path>& files) {
  const auto stem = [](const FileRole& one) { return lower_case(one.file.stem().string()); };
  std::vector<FileRole> roles;
  for (const fs::path& file : files) roles.push_back({file, role_guess(file)});
  std::vector<FileRole*> plainest_first;
  for (FileRole& one : roles)
    if (kind_of(one.file) == FileKind::surface) plainest_first.push_back(&one);
  std::stable_sort(
      plainest_first.begin(), plainest_first.end(),
      [&](const FileRole* a, const FileRole* b) { return stem(*a).size() < stem(*b).size(); });
  for (auto one = plainest_first.begin(); one != plainest_first.end(); ++one) {
    const bool again = std::any_of(plainest_first.begin(), one, [&](const FileRole* plainer) {
      return plainer->role == (*one)->role && stem(**one).starts_with(stem(*plainer));
    });
    if (again && is_had_once((*one)->role)) (*one)->taken = std::exchange((*one)->role, {});
  }
  return roles;
}

Case import_files(const wish::Import& wanted) {
  ImportRequest request{
      .files = {}, .landmarks = {}, .units = wanted.units, .frame = wanted.frame, .name = {}};
  for (const FileRole& one : wanted.files) {
    if (one.role == "landmarks")
      request.landmarks = one.file;
    else if (one.role == "muscles")
      request.muscles = one.file;
    else if (const auto role = role_named(one.role))
      request.files.push_back({*role, one.file});
  }
  if (!request.files.empty())
    request.name = request.files.front().file.parent_path().filename().string();
  return import_meshes(request);
}

}  // namespace condyle
