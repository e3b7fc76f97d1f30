#include <fmt/format.h>

#include "render/plan/picture_grid.h"
#include "sim/operated/operated_scene.h"
#include "sim/phantom/phantom.h"
#include "sim/prediction/predicted_landmarks.h"
#include "tools/common.h"
#include "tools/demo/demo.h"
#include "tools/demo/operation_output.h"
#include "tools/demo/plan_steps.h"
#include "tools/demo/played_motion.h"

namespace condyle {

int run_genioplasty(const DemoOptions& options, const CommonOptions& common) {
  ProgressBar bar(common);
  const Case patient = builtin_patient({}, bar.callback());
  Plan plan = begin_plan(patient, "genioplasty");
  plan = with_cut(patient, std::move(plan), {.osteotomy = "genioplasty", .kerf_mm = 0.5});
  plan = with_move(std::move(plan), "chin", {"forward", "6", "up", "1"});
  PredictionSettings predicted;
  predicted.threads = common.threads;
  const Prediction prediction = predict(patient, plan, predicted, bar.callback());

  OperationOutput output(
      options.out, "Genioplasty",
      "The chin is cut below the roots and the nerve canals and moved 6 mm "
      "forward and 1 mm up. The mouth then opens with the chin in its new place.");
  output.add_operation(plan, prediction.operated, bar.callback(), predicted_landmarks(prediction));
  output.add_prediction(plan, prediction, bar.callback());
  SimulatorSettings settings;
  settings.threads = common.threads;
  settings.face = true;
  settings.step_s = 1.0 / 60;
  output.draw([&] {
    const Scene scene = make_operated_scene(patient, plan, settings, bar.callback());
    const Motion motion = make_motion("open; close", scene.patient, scene.contacts);
    const PlayedMotion played = play_motion(scene, motion, settings, {}, true, bar.callback());
    bar.show("writing the film", 0.95);
    write_film(options.out, played.pictures, played.frames_per_second, plan.name);
    PictureGrid grid{"Opening after the operation", {{}}};
    const std::size_t widest = played.widest();
    for (const std::size_t frame : {std::size_t{0}, widest / 2, widest})
      grid.rows[0].push_back(
          {played.pictures[frame],
           fmt::format("opening {:.1f} mm", played.frames[frame].measures.opening_mm)});
    output.add_picture("opening.png", draw_grid(grid), "The mouth opens after the operation.");
    output.add_link("film.mp4", "Film of the opening");
    output.json["opening"] = {{"frames", played.frames.size()},
                              {"widest_mm", played.frames[widest].measures.opening_mm},
                              {"frames_unconverged", played.unconverged},
                              {"frames_with_inverted_prisms", played.inverted}};
  });
  bar.clear();
  if (common.json) fmt::print("{}\n", output.json.dump(2));
  output.finish(common.prints_summary());
  return 0;
}

}  // namespace condyle
