#include <fmt/format.h>

#include "render/image/raster_2d.h"
#include "render/plan/picture_grid.h"
#include "sim/frame/part_names.h"
#include "sim/operated/operated_scene.h"
#include "sim/report/operation_comparison.h"
#include "tools/common.h"
#include "tools/demo/class_iii_plan.h"
#include "tools/demo/demo.h"
#include "tools/demo/operation_output.h"
#include "tools/demo/played_motion.h"

namespace condyle {
namespace {

constexpr const char* border_movements =
    "open; close; protrude 8; close; left 8; close; right 8; close";
constexpr const char* shown_movement = "open 35; close";

void add_comparison(OperationOutput& output, const OperationComparison& comparison) {
  output.add_table("Range of motion", range_of_motion_table(comparison),
                   "Opening is the patient's largest; protrusion and laterotrusion of 8 mm were "
                   "prescribed, with the teeth gliding on each other.");
  output.add_table("Least distance during these movements", clearances_table(comparison),
                   "Overlap of the proximal and distal segments is bone that the surgeon trims.");
}

struct Side {
  Scene scene;
  Motion borders, shown;
  ClearanceCheck check;
  PlayedMotion played;
};

}  // namespace

int run_jaw_before_after(const DemoOptions& options, const CommonOptions& common) {
  ProgressBar bar(common);
  const ClassIiiPlan made = make_class_iii_plan(common.threads, bar.callback());
  SimulatorSettings settings;
  settings.threads = common.threads;
  settings.face = true;
  settings.step_s = 1.0 / 60;

  OperationOutput output(
      options.out, "Jaw movement before and after the operation of class III",
      "The patient opens, protrudes and moves the jaw to both sides, before the operation of both "
      "jaws and after it. The condyles stay with the proximal segments, the teeth with theirs.");
  output.add_operation(made.plan, apply_plan(made.patient, made.plan), bar.callback());

  const auto prepare = [&](const std::optional<Plan>& plan) {
    Scene scene = make_scene(made.patient, plan, settings, bar.callback());
    Motion borders = make_motion(border_movements, scene.patient, scene.contacts);
    Motion shown = make_motion(shown_movement, scene.patient, scene.contacts);
    ClearanceCheck check =
        check_clearance(scene, borders, {.sampling = {.fps = 15}}, settings, bar.callback());
    return Side{std::move(scene), std::move(borders), std::move(shown), std::move(check), {}};
  };
  Side before = prepare(std::nullopt), after = prepare(made.plan);
  const OperationComparison comparison = compare_operation(
      before.scene, before.borders, before.check, after.scene, after.borders, after.check);
  output.json["comparison"] = comparison.json();

  output.draw([&] {
    std::vector<Image> film;
    for (Side* side : {&before, &after})
      side->played = play_motion(side->scene, side->shown, settings, {}, true, bar.callback());
    for (std::size_t i = 0; i < before.played.pictures.size(); ++i)
      film.push_back(beside(std::vector{before.played.pictures[i], after.played.pictures[i]}));
    bar.show("writing the film", 0.95);
    write_film(options.out, film, before.played.frames_per_second, made.plan.name);
    PictureGrid grid{"Opening before and after the operation", {{}, {}}};
    for (const bool is_after : {false, true}) {
      const PlayedMotion& played = is_after ? after.played : before.played;
      const std::size_t widest = played.widest();
      for (const std::size_t frame : {std::size_t{0}, widest / 2, widest})
        grid.rows[is_after].push_back(
            {played.pictures[frame],
             fmt::format("{}, opening {:.1f} mm", is_after ? "after" : "before",
                         played.frames[frame].measures.opening_mm)});
    }
    output.add_picture("opening.png", draw_grid(grid),
                       "Opening before (above) and after the operation (below).");
    output.add_link("film.mp4", "Film: before on the left, after on the right");
    if (const int frames = before.played.unconverged + after.played.unconverged; frames > 0)
      output.add_note(fmt::format("the soft tissue did not converge in {} frames", frames));
  });
  add_comparison(output, comparison);
  bar.clear();
  if (common.json) fmt::print("{}\n", output.json.dump(2));
  output.finish(common.prints_summary());
  if (common.prints_summary()) fmt::print(stderr, "{}", comparison.text());
  return 0;
}

}  // namespace condyle
