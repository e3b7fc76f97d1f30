#include "tools/appliance/appliance_output.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <sstream>

#include "engine/core/error.h"
#include "engine/mesh_io/mesh_files.h"
#include "render/gl/gl_context.h"
#include "render/plan/appliance_pictures.h"
#include "tools/plan/plan_command.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

std::string extension_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// The teeth of one jaw, where it has none its bone.
std::vector<Part> arch_parts(const Case& patient, bool upper, const Pose& X) {
  std::vector<Part> parts;
  const BodyId body = upper ? patient.jaw.upper_arch : patient.jaw.lower_arch;
  const bool has_teeth = patient.teeth_of(body) != nullptr;
  for (const Part& part : patient.parts) {
    const bool is_arch = upper ? part.role == Role::upper_teeth : part.role == Role::lower_teeth;
    if (has_teeth ? !is_arch : !(collides(part.role) && part.body == body)) continue;
    parts.push_back(part);
    for (Vector3d& p : parts.back().mesh.vertices) p = X * p;
  }
  return parts;
}

void draw_sheet(const TriMesh& mesh, const AppliancePicture& picture,
                const std::filesystem::path& file) {
  const OffscreenContext context;
  write_png(file, appliance_sheet(mesh, picture));
}

}  // namespace

void add_appliance_files(CLI::App& command, ApplianceFiles& files) {
  command.add_option("--out", files.out, "File of the surface, STL or PLY")
      ->type_name("FILE")
      ->required();
  command.add_option("--picture", files.picture, "Also draw it, as PNG")->type_name("FILE");
}

void check_files(const ApplianceFiles& files) {
  if (const auto extension = extension_of(files.out); extension != ".stl" && extension != ".ply")
    throw InputError(files.out, "", "surfaces are written as .stl or .ply");
  if (!files.picture.empty() && extension_of(files.picture) != ".png")
    throw InputError(files.picture, "", "pictures are written as .png");
}

void add_length(CLI::App& command, const std::string& name, double& value_mm, const char* what,
                double low, double high) {
  in_range(
      command.add_option("--" + name, value_mm, fmt::format("{}; default {} mm", what, value_mm)),
      low, high);
}

void finish_appliance(const TriMesh& mesh, const ApplianceReport& report,
                      const ApplianceFiles& files, const CommonOptions& common) {
  if (extension_of(files.out) == ".ply")
    write_ply(mesh, files.out);
  else
    write_stl(mesh, files.out);
  print_plan_notes(common, report.notes);
  if (!files.picture.empty())
    report.draw({report.title + " of " + report.plan, report.text}, files.picture);
  if (common.json)
    fmt::print("{}\n",
               report.json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  if (common.prints_summary())
    fmt::print(stderr, "{}: {}\n{}", files.out.string(), report.title, report.text);
}

void write_splint_picture(const Splint& splint, const Case& patient, const PictureText& text,
                          const std::filesystem::path& file) {
  const std::vector<Part> upper = arch_parts(patient, true, {}),
                          lower = arch_parts(patient, false, splint.X_lower);
  std::vector<Part> both = upper;
  both.insert(both.end(), lower.begin(), lower.end());
  const Vector3d up = splint.measure.prints.at(0).seat, front = -Vector3d::UnitY();
  const Vector3d beside = (front + 0.8 * Vector3d::UnitX() + 0.25 * Vector3d::UnitZ()).normalized();
  draw_sheet(splint.mesh,
             {text.title,
              {{"in the bite, from the front", both, front, Vector3d::UnitZ(), 1.25},
               {"in the bite, from the left", both, beside, Vector3d::UnitZ(), 1.25},
               {"upper prints, from above", {}, up, front},
               {"lower prints, from below", {}, -up, front}},
              lines_of(text.lines)},
             file);
}

void write_guide_picture(const Guide& guide, const Case& patient, const PictureText& text,
                         const std::filesystem::path& file) {
  std::vector<Part> bones;
  BodyId body = cranium_body;
  for (const Part& part : patient.parts)
    if (part.name == guide.on) body = part.body;
  for (const Part& part : patient.parts)
    if (collides(part.role) && part.body == body) bones.push_back(part);
  const Vector3d out = -guide.measure.prints.at(0).seat;
  const Vector3d up =
      std::abs(out.z()) < 0.8 ? Vector3d(Vector3d::UnitZ()) : Vector3d(-Vector3d::UnitY());
  const Vector3d right = up.cross(out).normalized();
  const Vector3d beside = (out + 0.9 * right + 0.4 * up).normalized();
  draw_sheet(guide.mesh,
             {text.title,
              {{"on the bone, as it is seated", bones, out, up, 1.35},
               {"on the bone, from beside", bones, beside, up, 1.35},
               {"outer side", {}, out, up},
               {"side of the bone", {}, -out, up}},
              lines_of(text.lines)},
             file);
}

}  // namespace condyle
