#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

#include "engine/core/error.h"
#include "engine/mesh/holes.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/refine.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/topology.h"
#include "engine/mesh_io/mesh_files.h"
#include "engine/mesh_io/texture.h"
#include "sim/case/case_format.h"
#include "sim/case/case_io.h"
#include "sim/case/import_checks.h"
#include "sim/case/import_face_muscles.h"
#include "sim/case/import_muscles.h"
#include "sim/case/jaw_order.h"
#include "sim/case/landmark_files.h"
#include "sim/case/soft_landmarks.h"
#include "sim/case/source_frame.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

/// A file after reading, conversion and cleaning.
struct Surface {
  ImportFile source;
  TriMesh mesh;
};

/// Result of cleaning the files of one part.
struct Cleaning {
  int welded = 0, flat = 0, twice = 0, turned = 0, holes = 0, unused = 0;
};

bool is_bone(Role role) {
  return role == Role::skull || role == Role::maxilla || role == Role::mandible;
}

std::string at(const Vector3d& p) {
  // Rounded first, to avoid "-0".
  return fmt::format("({:.0f}, {:.0f}, {:.0f})", std::round(p.x()) + 0.0, std::round(p.y()) + 0.0,
                     std::round(p.z()) + 0.0);
}

std::string counted(long count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

/// Merges coincident corners, then those nearer than single precision resolves on a head, where
/// that closes more edges than it makes non-manifold: some surfaces touch themselves at a point
/// intentionally.
int weld_file(TriMesh& mesh) {
  int welded = 0;
  for (const double tolerance_mm : {0.0, 1e-4}) {
    const Topology before = inspect(mesh);
    if (before.boundary_edges == 0) break;
    TriMesh joined = mesh;
    const int count = weld(joined, tolerance_mm);
    if (count == 0) continue;
    const Topology after = inspect(joined);
    if (before.boundary_edges - after.boundary_edges <=
        after.nonmanifold_edges - before.nonmanifold_edges)
      continue;
    mesh = std::move(joined);
    welded += count;
  }
  return welded;
}

void clean(Surface& surface, Cleaning& done) {
  done.welded += weld_file(surface.mesh);
  done.flat += drop_degenerate(surface.mesh);
  done.twice += drop_duplicates(surface.mesh);
  done.turned += orient_outward(surface.mesh).turned;
  if (surface.source.role != Role::face) {
    const int holes = close_small_holes(surface.mesh).holes;
    if (holes > 0) done.turned += orient_outward(surface.mesh).turned;
    done.holes += holes;
  }
  done.unused += drop_unreferenced(surface.mesh);
  if (surface.mesh.triangles.empty())
    throw InputError(surface.source.file, "",
                     "has no triangle with an area; export the surface again");
}

/// The part and its flaws, in readable form.
std::string description(const Part& part, const std::string& files) {
  const Topology found = inspect(part.mesh);
  std::string note =
      fmt::format("{} ({}): {} in {}", part.name, files,
                  counted(static_cast<long>(part.mesh.triangles.size()), "triangle", "triangles"),
                  counted(found.components, "piece", "pieces"));
  if (found.closed()) return note + fmt::format(", closed, {:.1f} cm3", found.volume_mm3 / 1000);
  if (found.boundary_edges > 0) {
    const auto& longest = found.boundary.front();
    note += fmt::format("; open: {} in {}, the longest ({:.0f} mm) around {}",
                        counted(found.boundary_edges, "boundary edge", "boundary edges"),
                        counted(static_cast<long>(found.boundary.size()), "rim", "rims"),
                        longest.length_mm, at(longest.box.center()));
  }
  if (found.nonmanifold_edges > 0)
    note += fmt::format("; {} of three or more triangles around {}",
                        counted(found.nonmanifold_edges, "edge", "edges"),
                        at(found.nonmanifold_box.center()));
  if (found.misoriented_edges > 0)
    note += fmt::format("; neighbours disagree about outside at {}",
                        counted(found.misoriented_edges, "edge", "edges"));
  return note + "; inside and outside are uncertain";
}

/// Empty when nothing was changed.
std::string description(const Cleaning& done) {
  std::string text;
  const auto add = [&](long count, const char* one, const char* many) {
    if (count > 0) text += (text.empty() ? "" : ", ") + counted(count, one, many);
  };
  add(done.welded, "vertex welded", "vertices welded");
  add(done.flat, "triangle without area dropped", "triangles without area dropped");
  add(done.twice, "repeated triangle dropped", "repeated triangles dropped");
  add(done.turned, "triangle turned outward or to agree with its neighbours",
      "triangles turned outward or to agree with their neighbours");
  add(done.holes, "small hole closed", "small holes closed");
  add(done.unused, "unused vertex dropped", "unused vertices dropped");
  return text;
}

/// The FDI number in a file name ("tooth_36.ply", "36.stl", "FDI36"); 0 without one.
int fdi_of(const fs::path& file) {
  const std::string name = file.stem().string();
  int found = 0;
  for (std::size_t i = 0; i < name.size();) {
    std::size_t end = i;
    while (end < name.size() && std::isdigit(static_cast<unsigned char>(name[end]))) ++end;
    if (end == i) {
      ++i;
      continue;
    }
    if (end - i == 2) {
      const int number = (name[i] - '0') * 10 + (name[i + 1] - '0');
      if (is_fdi(number)) found = number;
    }
    i = end;
  }
  return found;
}

/// 1 and 2 (5 and 6) are upper quadrants, 3 and 4 (7 and 8) lower ones.
bool is_upper(int fdi) { return (fdi / 10 - 1) % 4 < 2; }

void append(TriMesh& whole, const TriMesh& piece) {
  const int offset = static_cast<int>(whole.vertices.size());
  const bool colored =
      piece.colors.size() == piece.vertices.size() && whole.colors.size() == whole.vertices.size();
  whole.vertices.insert(whole.vertices.end(), piece.vertices.begin(), piece.vertices.end());
  for (const auto& t : piece.triangles)
    whole.triangles.push_back(t + Eigen::Vector3i::Constant(offset));
  if (colored)
    whole.colors.insert(whole.colors.end(), piece.colors.begin(), piece.colors.end());
  else
    whole.colors.clear();
}

/// One part of all files of an arch, with a range of triangles for each file named by a tooth.
Part join_teeth(Role role, const std::vector<Surface>& surfaces, std::vector<std::string>& notes) {
  Part part{role_name(role), role, {}, {}};
  std::set<int> numbers;
  int unnamed = 0;
  const auto count = std::count_if(surfaces.begin(), surfaces.end(),
                                   [&](const Surface& s) { return s.source.role == role; });
  for (const auto& surface : surfaces) {
    if (surface.source.role != role) continue;
    const int first = static_cast<int>(part.mesh.triangles.size());
    append(part.mesh, surface.mesh);
    const int fdi = fdi_of(surface.source.file);
    if (fdi == 0) {
      ++unnamed;
      continue;
    }
    if (is_upper(fdi) != (role == Role::upper_teeth))
      throw InputError(
          surface.source.file, "",
          fmt::format("is tooth {}, which is no {} tooth; use --{}-teeth", fdi,
                      is_upper(fdi) ? "lower" : "upper", is_upper(fdi) ? "upper" : "lower"));
    if (!numbers.insert(fdi).second)
      throw InputError(surface.source.file, "",
                       fmt::format("is tooth {}, which another file also claims", fdi));
    part.teeth.push_back({fdi, first, static_cast<int>(surface.mesh.triangles.size())});
  }
  if (unnamed > 0 && count > 1)
    notes.push_back(fmt::format(
        "{}: {} no FDI number in the name (as in tooth_36.ply), so its teeth are not separated",
        part.name, unnamed == 1 ? "1 file has" : fmt::format("{} files have", unnamed)));
  return part;
}

/// Colours the face by its file's own texture, if it has one, with triangles small enough to
/// preserve the detail.
void lay_texture(const fs::path& file, const SourceFrame& frame, Case& patient) {
  constexpr int max_triangles = 150000;
  const auto part = std::find_if(patient.parts.begin(), patient.parts.end(),
                                 [](const Part& p) { return p.role == Role::face; });
  if (part == patient.parts.end() || !part->mesh.colors.empty()) return;
  const auto texture = read_texture(file);
  if (!texture) return;
  // Estimated number of uniform triangles; only longer edges are halved.
  const double edge_mm =
      1.3 * std::sqrt(4 / std::sqrt(3.0) * surface_area(part->mesh) / max_triangles);
  const std::vector<double> edges(part->mesh.vertices.size(), edge_mm);
  part->mesh = refine(std::move(part->mesh), edges, max_triangles);
  paint(part->mesh, *texture, Eigen::Affine3d(frame.to_lps_mm()));
  patient.notes.push_back(fmt::format(
      "{}: coloured by the texture of {} ({}x{}), in {} triangles to keep it sharp", part->name,
      file.filename().string(), texture->width, texture->height, part->mesh.triangles.size()));
}

std::vector<Part> make_parts(std::vector<Surface>& surfaces, std::vector<std::string>& notes) {
  std::vector<Part> parts;
  std::set<std::string> names;
  for (auto& surface : surfaces) {
    const Role role = surface.source.role;
    std::string name = role_name(role), files = surface.source.file.filename().string();
    Cleaning done;
    if (!is_teeth(role)) {
      for (int n = 2; !names.insert(name).second; ++n)
        name = fmt::format("{}-{}", role_name(role), n);
      clean(surface, done);
      parts.push_back({name, role, std::move(surface.mesh), {}});
    } else {
      if (!names.insert(name).second) continue;
      int count = 0;
      for (auto& other : surfaces)
        if (other.source.role == role) clean(other, done), ++count;
      if (count > 1) files = fmt::format("{} files", count);
      parts.push_back(join_teeth(role, surfaces, notes));
    }
    notes.push_back(description(parts.back(), files));
    if (const auto text = description(done); !text.empty()) notes.push_back(name + ": " + text);
  }
  return parts;
}

Landmarks import_landmarks(const ImportRequest& request, const Box& box,
                           std::vector<std::string>& notes) {
  if (request.landmarks.empty()) return {};
  LandmarkTable table = read_landmark_table(request.landmarks);
  constexpr double margin_mm = 100;
  const auto strays = [&](const Eigen::Matrix3d& turn) {
    return std::find_if(table.rows.begin(), table.rows.end(), [&](const LandmarkRow& row) {
      return !box.contains(turn * row.point, margin_mm);
    });
  };
  // A file that defines its own frame is in LPS mm. Others have the frame of the meshes, unless
  // that places them off the patient and the millimetres of their column names do not.
  const SourceFrame& frame = request.source;
  Eigen::Matrix3d turn = frame.to_lps_mm();
  if (table.own_frame) {
    turn.setIdentity();
  } else if (frame.units != "mm" && strays(turn) != table.rows.end()) {
    if (strays(frame.axes_to_lps) == table.rows.end()) {
      turn = frame.axes_to_lps;
      notes.push_back("landmarks: taken in mm, as their columns say; in " + frame.units +
                      " they would lie off the patient");
    }
  }
  if (const auto stray = strays(turn); stray != table.rows.end()) {
    const Vector3d p = turn * stray->point;
    throw InputError(
        request.landmarks, stray->where,
        fmt::format(
            "\"{}\" at {} mm is more than {} mm away from the surfaces, which reach from {} to "
            "{}: check its units, frame and patient",
            stray->name.substr(0, 40), at(p), margin_mm, at(box.low), at(box.high)));
  }
  for (auto& row : table.rows) row.point = turn * row.point;
  return name_landmarks(request.landmarks, table);
}

}  // namespace

Case import_meshes(const ImportRequest& request) {
  if (std::none_of(request.files.begin(), request.files.end(),
                   [](const ImportFile& file) { return is_bone(file.role); }))
    throw InputError(
        "no bone is given; name one with --skull, --maxilla or --mandible, or import dental scans "
        "alone with condyle import teeth");
  const SourceFrame& frame = request.source;

  std::vector<Surface> surfaces;
  Box box;
  const ImportFile* face = nullptr;
  for (const auto& file : request.files) {
    if (file.role == Role::face) {
      if (face) throw InputError(file.file, "", "is a second face; give only one");
      face = &file;
    }
    Surface surface{file, read_mesh(file.file)};
    for (auto& v : surface.mesh.vertices) v = frame.to_lps_mm() * v;
    if (frame.mirrored()) flip(surface.mesh);
    drop_unreferenced(surface.mesh);
    box.add(bounding_box(surface.mesh));
    surfaces.push_back(std::move(surface));
  }
  check_size(box, request);

  Case patient;
  patient.name = request.name;
  patient.source = frame;
  patient.scan_opening_mm = request.scan_opening_mm;
  patient.landmarks = import_landmarks(request, box, patient.notes);
  patient.parts = make_parts(surfaces, patient.notes);
  if (face) lay_texture(face->file, frame, patient);
  make_piece_bodies(patient, request.parents);
  check_frame(patient, request);
  check_jaw_order(patient, request);
  check_landmarks(patient, request);
  estimate_landmarks(patient);
  estimate_profile_landmarks(patient);
  import_muscles(request, box, patient);
  if (!request.face_muscles.empty())
    import_face_muscles(request.face_muscles, request.source.axes_to_lps, patient);
  return patient;
}

}  // namespace condyle
