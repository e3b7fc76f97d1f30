#include "sim/session/patient_files.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <utility>

#include "sim/case/case_io.h"
#include "sim/motion/closed_position.h"

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

/// Whether a table of muscles is one of the face: a row for each point.
bool is_of_the_face(const fs::path& file) { return first_line(file).starts_with("muscle,side"); }

/// The kind of a JSON file by the format that its beginning states.
FileKind json_kind(const fs::path& file) {
  std::ifstream stream(file);
  std::string start(200, ' ');
  stream.read(start.data(), static_cast<std::streamsize>(start.size()));
  if (start.find("\"condyle plan\"") != std::string::npos) return FileKind::plan;
  if (start.find("\"condyle session\"") != std::string::npos) return FileKind::session;
  return FileKind::unknown;
}

/// Whether a patient has at most one part of this role.
bool occurs_once(const std::string& role) {
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

FileKind kind_of(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return FileKind::patient;
  if (path.filename() == "case.json") return FileKind::patient;
  const std::string ending = lower_case(path.extension().string());
  for (const char* surface : {".stl", ".ply", ".obj", ".glb", ".gltf"})
    if (ending == surface) return FileKind::surface;
  if (lower_case(path.string()).ends_with(".mrk.json")) return FileKind::landmarks;
  if (ending == ".condyle-session") return FileKind::session;
  if (ending == ".json")
    if (const FileKind kind = json_kind(path); kind != FileKind::unknown) return kind;
  if (ending == ".csv") {
    const std::string header = first_line(path);
    if (is_of_the_face(path)) return FileKind::muscles;
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
    if (again && occurs_once((*one)->role)) (*one)->taken = std::exchange((*one)->role, {});
  }
  return roles;
}

std::vector<fs::path> with_loose_surfaces(const std::vector<fs::path>& files) {
  std::vector<fs::path> all;
  for (const fs::path& file : files) {
    std::error_code ignored;
    std::vector<fs::path> inside;
    if (fs::is_directory(file, ignored) &&
        (!fs::exists(file / "case.json", ignored) || has_foreign_case_file(file)))
      for (fs::directory_iterator one(file, ignored), end; !ignored && one != end;
           one.increment(ignored))
        if (makes_patient(kind_of(one->path()))) inside.push_back(one->path());
    std::sort(inside.begin(), inside.end());
    if (inside.empty()) inside = {file};
    all.insert(all.end(), inside.begin(), inside.end());
  }
  return all;
}

Case import_files(const std::vector<FileRole>& files, const std::string& units,
                  const std::string& frame) {
  ImportRequest request{
      .files = {}, .landmarks = {}, .source = source_frame(units, frame), .name = {}};
  for (const FileRole& one : files) {
    if (one.role == "landmarks")
      request.landmarks = one.file;
    else if (one.role == "muscles")
      (is_of_the_face(one.file) ? request.face_muscles : request.muscles) = one.file;
    else if (const auto role = role_named(one.role))
      request.files.push_back({*role, one.file});
  }
  if (!request.files.empty())
    request.name = request.files.front().file.parent_path().filename().string();
  Case patient = import_meshes(request);
  report_scan_opening(patient);
  return patient;
}

}  // namespace condyle
