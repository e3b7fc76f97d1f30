#include "tools/demo/operation_output.h"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/html_text.h"
#include "engine/mesh_io/mesh_files.h"
#include "render/gl/gl_context.h"
#include "render/plan/face_pictures.h"
#include "render/plan/segment_pictures.h"
#include "sim/case/case_io.h"
#include "sim/case/landmark_files.h"
#include "sim/frame/part_names.h"
#include "sim/operation/cut_text.h"
#include "sim/operation/graft_steps.h"
#include "sim/operation/segment_overlaps.h"
#include "sim/operation/trim_segments.h"
#include "sim/plan/cephalometry.h"
#include "sim/plan/plan_file.h"
#include "sim/prediction/predicted_landmarks.h"
#include "sim/prediction/soft_ratios.h"
#include "sim/report/page_parts.h"
#include "sim/report/plots.h"
#include "tools/plan/plan_report.h"

namespace condyle {
namespace {

TriMesh with_vertices(TriMesh mesh, const std::vector<Eigen::Vector3f>& vertices) {
  for (std::size_t i = 0; i < vertices.size(); ++i) mesh.vertices[i] = vertices[i].cast<double>();
  return mesh;
}

}  // namespace

OperationOutput::OperationOutput(std::filesystem::path folder, std::string title,
                                 std::string introduction)
    : folder_(std::move(folder)), title_(std::move(title)), introduction_(std::move(introduction)) {
  make_folder(folder_);
}

void OperationOutput::add_operation(const Plan& plan, const Operated& operated,
                                    const Progress& progress, const std::optional<Landmarks>& soft,
                                    std::vector<std::string> views) {
  if (!operated.problems.empty())
    throw InputError(fmt::format("{}", fmt::join(operated.problems, "; ")));
  json = plan_report_json(plan, operated);
  save_plan(plan, folder_ / "plan.json");
  const Case after = operated_case(operated);
  save_case(after, folder_ / "case");
  make_folder(folder_ / "segments");
  for (const Part& part : after.parts)
    if (is_piece(part.role) && operated.origin.contains(part.name))
      write_ply(part.mesh, folder_ / "segments" / (part.name + ".ply"));
  report(progress, "drawing", 0.9);
  draw([&] {
    add_picture("segments.png",
                segment_sheet(operated, {.title = title_, .views = std::move(views)}),
                "The bones before and after the operation, with the segments in colours.");
  });
  add_table(
      "Segments", bones_table(operated),
      fmt::format("The volumes of the pieces, the saw cuts and the trimmed bone add up to the bone "
                  "within {:.1g} %.",
                  json["volume_error_percent"].get<double>()));
  body_ += "<h2>Cuts</h2>\n";
  for (const CutReport& cut : operated.cuts)
    add_list(cut.title + ", " + cut.bone, cut_sentences(cut, operated.patient.landmarks));
  for (const TrimReport& trim : operated.trims)
    add_list(trim.title + ", " + trim.part, trim_sentences(trim));
  if (!operated.resections.empty()) body_ += "<h2>Resections and grafts</h2>\n";
  for (const Resection& resection : operated.resections)
    body_ += "<p>" + escaped(display_name(resection_sentence(resection))) + "</p>\n";
  for (const GraftLayout& graft : operated.grafts)
    add_list("graft " + graft.step.name, graft_sentences(operated, graft));
  add_table("Overlap at the planned positions", overlaps_table(segment_overlaps(operated)));
  for (const std::string& note : operated.notes) add_note(note);
  try {
    const ClinicalFrame frame = clinical_frame(operated.patient.landmarks, plan.reference);
    const Landmarks& before = operated.patient.landmarks;
    add_table("Movements of the bone", movements_table(planned_movements(operated, frame)));
    const Landmarks planned = soft ? *soft : planned_landmarks(operated);
    add_table("Cephalometry", cephalometry_table(cephalometry(frame, before, planned), !!soft),
              cephalometry_legend(operated));
  } catch (const InputError& error) {
    add_note(fmt::format("tables of movements and cephalometry are left out: {}", error.what()));
  }
}

void OperationOutput::add_prediction(const Plan& plan, const Prediction& prediction,
                                     const Progress& progress) {
  const ClinicalFrame frame = clinical_frame(prediction.operated.patient.landmarks, plan.reference);
  json["prediction"] = prediction_json(prediction, frame);
  write_ply(with_vertices(prediction.face, prediction.before), folder_ / "face_before.ply");
  write_ply(with_vertices(prediction.face, prediction.after), folder_ / "face_after.ply");
  write_file(folder_ / "landmarks_after.csv", landmarks_csv(predicted_landmarks(prediction)));
  report(progress, "drawing the face", 0.95);
  draw([&] {
    add_picture("face.png", face_sheet(face_pictures(prediction), "The face"),
                "The face before and after the operation, and the map of its displacement.");
  });
  add_table("Soft tissue", ratio_table(soft_ratios(prediction, frame)),
            "Sagittal movement of points of the face with the bone below them. Published ranges "
            "are averages over patients.");
}

void OperationOutput::add_picture(const std::string& file, const Image& image,
                                  const std::string& caption) {
  write_png(folder_ / file, image);
  body_ +=
      fmt::format("<figure><img src=\"{0}\" alt=\"{1}\"><figcaption>{1}</figcaption></figure>\n",
                  file, escaped(caption));
}

void OperationOutput::add_list(const std::string& title,
                               const std::vector<std::string>& sentences) {
  body_ += "<p><strong>" + escaped(title) + "</strong></p>\n<ul>\n";
  for (const std::string& sentence : sentences) body_ += "<li>" + escaped(sentence) + "</li>\n";
  body_ += "</ul>\n";
}

void OperationOutput::add_section(const std::string& heading, const std::string& text) {
  body_ += "<h2>" + escaped(heading) + "</h2>\n<p>" + escaped(text) + "</p>\n";
}

void OperationOutput::add_table(const std::string& heading, const PageTable& table,
                                const std::string& below) {
  if (table.rows.empty()) return;
  body_ += "<h2>" + escaped(heading) + "</h2>\n" + table_html(table);
  if (!below.empty()) body_ += "<p class=\"small\">" + escaped(below) + "</p>\n";
}

void OperationOutput::add_link(const std::string& file, const std::string& text) {
  body_ += fmt::format("<p><a href=\"{}\">{}</a></p>\n", file, escaped(text));
}

void OperationOutput::add_note(const std::string& note) { notes_.push_back(note); }

void OperationOutput::draw(const std::function<void()>& drawing) {
  try {
    const OffscreenContext context;
    drawing();
  } catch (const MachineError& error) {
    add_note(fmt::format("pictures are left out: {}", error.what()));
  }
}

void OperationOutput::finish(bool print_summary) {
  PageWriter page(title_);
  page.add("<h1>{}</h1>\n<p>{}</p>\n", escaped(title_), escaped(introduction_));
  page += body_;
  if (!notes_.empty()) {
    page += "<h2>Notes</h2>\n<ul>\n";
    page.add_notes(notes_);
    page += "</ul>\n";
  }
  write_file(folder_ / "report.html", page.finish());
  write_file(folder_ / "report.json",
             json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
  if (!print_summary) return;
  for (const std::string& note : notes_) fmt::print(stderr, "note: {}\n", note);
  fmt::print(stderr, "results are in {}; the page to read is {}\n", folder_.string(),
             (folder_ / "report.html").string());
}

}  // namespace condyle
