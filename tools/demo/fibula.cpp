#include <fmt/format.h>

#include "render/plan/picture_grid.h"
#include "sim/operated/graft_path.h"
#include "sim/operated/operated_scene.h"
#include "sim/operation/graft_steps.h"
#include "sim/phantom/phantom.h"
#include "tools/common.h"
#include "tools/demo/demo.h"
#include "tools/demo/operation_output.h"
#include "tools/demo/plan_steps.h"
#include "tools/demo/played_motion.h"

namespace condyle {
namespace {

Plan fibula_plan(const Case& patient) {
  Plan plan = begin_plan(patient, "fibula");
  CutStep cut{.osteotomy = "segmental_resection",
              .parameters = {{"from_tooth", 45}, {"to_tooth", 36}},
              .kerf_mm = 0.5,
              .pieces = {"tumour"},
              .below_margins = true};
  plan = with_step(std::move(plan), std::move(cut));
  plan = with_step(std::move(plan), ResectStep{"tumour"});
  GraftStep graft;
  graft.name = "fibula";
  graft.replaces = "tumour";
  graft.pieces = 3;
  return with_step(std::move(plan), graft);
}

PageTable faces_table(const Operated& operated, const GraftLayout& graft) {
  PageTable table{{"face", "in contact, %", "mean gap, mm", "largest gap, mm"}, {}};
  for (const GraftFaceReport& face : graft_faces(operated, graft))
    table.rows.push_back({face.piece + " to " + face.other, fmt::format("{:.0f}", 100 * face.share),
                          fmt::format("{:.2f}", face.contact.mean_gap_mm),
                          fmt::format("{:.2f}", face.contact.largest_gap_mm)});
  return table;
}

PageTable saw_table(const GraftLayout& graft) {
  PageTable table{{"piece", "length, mm", "cut at, mm", "degrees off square", "cut at, mm",
                   "degrees off square"},
                  {}};
  for (const GraftPiece& piece : graft.pieces)
    table.rows.push_back({piece.body, fmt::format("{:.1f}", piece.length_mm),
                          fmt::format("{:.1f}", piece.cuts[0].place_mm),
                          fmt::format("{:.1f}", piece.cuts[0].angle_deg),
                          fmt::format("{:.1f}", piece.cuts[1].place_mm),
                          fmt::format("{:.1f}", piece.cuts[1].angle_deg)});
  return table;
}

/// Pictures of a motion at its start, halfway and in its middle.
Image path_picture(const PlayedMotion& played, const std::string& title) {
  PictureGrid grid{title, {{}}};
  const std::size_t middle = played.pictures.size() / 2;
  for (const std::size_t frame : {std::size_t{0}, middle / 4, middle / 2, middle})
    grid.rows[0].push_back(
        {played.pictures[frame], fmt::format("{:.1f} s", played.frames[frame].time_s)});
  return draw_grid(grid);
}

}  // namespace

int run_fibula(const DemoOptions& options, const CommonOptions& common) {
  ProgressBar bar(common);
  const Case patient = builtin_patient({}, bar.callback());
  const Plan plan = fibula_plan(patient);
  const Operated operated = apply_plan(patient, plan);
  OperationOutput output(options.out, "Fibula graft",
                         "The lower jaw is resected from the right second premolar to the left "
                         "first molar. Three pieces of a "
                         "fibula with mitred faces take its place along the lower border.");
  output.add_operation(plan, operated, bar.callback());
  for (const GraftLayout& graft : operated.grafts) {
    output.add_table("Saw cuts on the fibula", saw_table(graft));
    output.add_table("Faces of the graft", faces_table(operated, graft),
                     "Bone united at a mean gap of 1.3 mm and did not at 2.6 mm (38 sites).");
  }
  SimulatorSettings settings;
  settings.threads = common.threads;
  settings.tissue = false;
  settings.step_s = 1.0 / 60;
  const Scene scene = make_operated_scene(patient, plan, settings, bar.callback());
  const Motion path = insertion_path_motion("path:fibula", scene, 0, common.threads);
  output.add_section("Insertion path", path.notes.front());
  output.draw([&] {
    PlaySettings play;
    play.frames = 25;
    play.skin_opacity = 0;
    const PlayedMotion played = play_motion(scene, path, settings, play, true, bar.callback());
    output.add_picture("insertion_path.png",
                       path_picture(played, "The graft leaves its seat along the insertion path"),
                       "The graft leaves its seat; insertion follows the same path in reverse.");
    const Motion opening = make_motion("open; close", scene.patient, scene.contacts);
    const PlayedMotion opened = play_motion(scene, opening, settings, play, true, bar.callback());
    const std::size_t widest = opened.widest();
    PictureGrid grid{"Opening after the operation", {{}}};
    for (const std::size_t frame : {std::size_t{0}, widest / 2, widest})
      grid.rows[0].push_back(
          {opened.pictures[frame],
           fmt::format("opening {:.1f} mm", opened.frames[frame].measures.opening_mm)});
    output.add_picture("opening.png", draw_grid(grid), "The mouth opens after the operation.");
    output.add_section(
        "Mouth opening",
        fmt::format("After the operation the mouth opens by {:.1f} mm, measured at the former "
                    "lower incisal point.",
                    opened.frames[widest].measures.opening_mm));
    output.json["opening"] = {{"widest_mm", opened.frames[widest].measures.opening_mm}};
  });
  bar.clear();
  if (common.json) fmt::print("{}\n", output.json.dump(2));
  output.finish(common.prints_summary());
  return 0;
}

}  // namespace condyle
