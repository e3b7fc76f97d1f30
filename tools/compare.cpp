#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/mesh_io/mesh_files.h"
#include "render/gl/gl_context.h"
#include "render/image/image.h"
#include "render/overlay/legend.h"
#include "render/scene/scene_renderer.h"
#include "sim/case/case_io.h"
#include "sim/case/landmark_files.h"
#include "sim/case/source_frame.h"
#include "sim/comparison/face_comparison_text.h"
#include "sim/frame/body_poses.h"
#include "tools/commands.h"
#include "tools/common.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

struct CompareOptions {
  fs::path predicted, after;
  fs::path landmarks, after_landmarks;
  fs::path patient;  // case folder or a head's name; empty: none
  std::string units = "mm", frame = "LPS";
  FaceAlignment alignment = FaceAlignment::surface;
  double range_mm = 0;  // of the map; 0: by the distances
  fs::path out;
};

const Choices<FaceAlignment> alignments = {{"landmarks", FaceAlignment::landmarks},
                                           {"surface", FaceAlignment::surface},
                                           {"none", FaceAlignment::none}};

/// The predicted face: a mesh, or what `condyle predict` wrote into a folder.
MarkedFace read_predicted(const CompareOptions& options, const CommonOptions& common,
                          ProgressBar& bar) {
  const bool is_folder = fs::is_directory(options.predicted);
  const fs::path file = is_folder ? options.predicted / "face_after.ply" : options.predicted;
  if (is_folder && !fs::exists(file))
    throw InputError(options.predicted, "face_after.ply",
                     "is missing: expected a mesh or a folder of condyle predict");
  MarkedFace face{read_mesh(file), {}};
  const fs::path own_landmarks = options.predicted / "landmarks_after.csv";
  if (!options.landmarks.empty())
    face.landmarks = read_landmarks(options.landmarks);
  else if (!options.patient.empty())
    face.landmarks = open_patient(options.patient, common, bar).landmarks;
  else if (is_folder && fs::exists(own_landmarks))
    face.landmarks = read_landmarks(own_landmarks);
  return face;
}

/// The face after the operation, in LPS and mm.
MarkedFace read_after(const CompareOptions& options) {
  const SourceFrame source = source_frame(options.units, options.frame);
  MarkedFace face{read_mesh(options.after), {}};
  const Eigen::Matrix3d to_lps = source.to_lps_mm();
  for (Eigen::Vector3d& p : face.mesh.vertices) p = to_lps * p;
  if (source.mirrored()) flip(face.mesh);
  if (!options.after_landmarks.empty()) {
    const LandmarkTable table = read_landmark_table(options.after_landmarks);
    face.landmarks = name_landmarks(options.after_landmarks, table);
    if (!table.own_frame)
      for (auto& [name, p] : face.landmarks.points) p = to_lps * p;
  }
  return face;
}

/// The end of the map: 2, 5, 10 or 20 mm, beyond nearly all distances.
double range_of(const FaceComparison& comparison) {
  for (const double mm : {2.0, 5.0, 10.0})
    if (comparison.rows.back().p95_mm <= mm) return std::max(mm, 4.0);
  return 20;
}

/// The triangles whose corners all have this value, as a part that is only drawn.
Part drawn_part(const TriMesh& mesh, const std::vector<bool>& of_vertex, bool value,
                const std::string& name) {
  Part part;
  part.name = name;
  part.mesh.vertices = mesh.vertices;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    bool all = true;
    for (const int corner : t) all = all && of_vertex[static_cast<std::size_t>(corner)];
    if (all == value) part.mesh.triangles.push_back(t);
  }
  return part;
}

void draw_map(const FaceComparison& comparison, const TriMesh& predicted, double range_mm,
              const fs::path& folder) {
  const OffscreenContext context;
  std::vector<bool> measured;
  std::vector<float> values;
  Box box;
  for (std::size_t i = 0; i < comparison.distance_mm.size(); ++i) {
    const double distance = comparison.distance_mm[i];
    measured.push_back(std::isfinite(distance) &&
                       (comparison.regions.empty() || comparison.regions[i] != FaceRegion::none));
    // Values at the end of the map and beyond it would have the colour of "not measured".
    values.push_back(static_cast<float>(std::min(distance, range_mm * (1 - 1e-6))));
    if (measured.back()) box.add(predicted.vertices[i]);
  }
  const std::array parts{drawn_part(predicted, measured, true, "measured"),
                         drawn_part(predicted, measured, false, "not measured")};
  const ColourMap map = deviation_colours(range_mm, 2);
  SceneRenderer renderer(parts);
  FrameState frame;
  frame.poses = completed(native_bodies(), {});
  renderer.update(frame);
  renderer.set_colour_map(map);
  renderer.color_part(parts[0].name, values);
  renderer.color_part(parts[1].name,
                      std::vector<float>(values.size(), std::numeric_limits<float>::infinity()));
  PictureSettings settings;
  settings.width = 900;
  settings.height = 1000;
  settings.backdrop = Backdrop::light;
  const Glyphs words;
  for (const char* view : {"front", "left", "right", "three-quarter"}) {
    Image image = renderer.picture(standard_camera(view, box.low, box.high, 0.9), settings);
    add_legend(image, words, map, {"prediction against the face", "after the operation"},
               settings.backdrop);
    write_png(folder / fmt::format("deviation_{}.png", view), image);
  }
}

int run_compare(const CompareOptions& options, const CommonOptions& common) {
  ProgressBar bar(common);
  const MarkedFace predicted = read_predicted(options, common, bar);
  const MarkedFace after = read_after(options);
  bar.show("comparing", 0.2);
  FaceComparison comparison =
      compare_faces(predicted, after, {.alignment = options.alignment, .threads = common.threads});
  if (!options.out.empty()) {
    make_folder(options.out);
    write_ply(comparison.after, options.out / "after_registered.ply");
    write_file(options.out / "distances.csv", face_comparison_csv(comparison, predicted.mesh));
    bar.show("drawing", 0.7);
    try {
      draw_map(comparison, predicted.mesh,
               options.range_mm > 0 ? options.range_mm : range_of(comparison), options.out);
    } catch (const MachineError& error) {
      comparison.notes.push_back(fmt::format("pictures are left out: {}", error.what()));
    }
    write_file(options.out / "report.json", face_comparison_json(comparison).dump(2) + "\n");
  }
  bar.clear();
  if (common.json) fmt::print("{}\n", face_comparison_json(comparison).dump(2));
  if (common.prints_summary()) {
    for (const auto& note : comparison.notes) fmt::print(stderr, "note: {}\n", note);
    fmt::print(stderr, "{}", face_comparison_text(comparison));
  }
  return 0;
}

}  // namespace

void add_compare(Commands& commands) {
  const auto options = std::make_shared<CompareOptions>();
  CLI::App& command = commands.add(
      "compare", "Measure a predicted face against the face after the operation",
      "condyle compare predicted after.ply --out out",
      [options](const CommonOptions& common) { return run_compare(*options, common); });
  command
      .add_option("PREDICTED", options->predicted,
                  "Folder of condyle predict, or a mesh in LPS, mm")
      ->required();
  command.add_option("AFTER", options->after, "Surface of the face after the operation")
      ->required();
  command
      .add_option_function<std::string>(
          "--align",
          [options](const std::string& word) {
            options->alignment = chosen(alignments, "--align", word);
          },
          "Register on landmarks or the surface of the upper face, or take both as they are; "
          "default surface")
      ->type_name(words_of(alignments));
  command
      .add_option("--landmarks", options->landmarks,
                  "Landmarks of the predicted face, by which it is divided into regions; default "
                  "those of the folder or the case")
      ->type_name("FILE");
  command
      .add_option("--case", options->patient,
                  "Case whose landmarks the predicted face has; default: none")
      ->type_name("FOLDER|built-in");
  command
      .add_option("--after-landmarks", options->after_landmarks,
                  "Landmarks of the face after the operation, in its own frame")
      ->type_name("FILE");
  command.add_option("--units", options->units, "Unit of AFTER; default mm")
      ->type_name("mm|cm|m|in");
  command.add_option("--frame", options->frame, "Axes of AFTER: LPS (the default), RAS, ...")
      ->type_name("AXES");
  in_range(command.add_option("--range", options->range_mm,
                              "End of the map's colours, mm; default by the distances"),
           2.1, 100);
  command
      .add_option("--out", options->out,
                  "Folder for maps of the signed distance, distances.csv, after_registered.ply and "
                  "report.json")
      ->type_name("FOLDER");
}

}  // namespace condyle
