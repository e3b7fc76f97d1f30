#include <fmt/format.h>

#include "engine/collide/distance_field.h"
#include "engine/core/user_cache.h"
#include "sim/phantom/phantom.h"
#include "sim/prediction/predicted_landmarks.h"
#include "tools/bite_picture.h"
#include "tools/common.h"
#include "tools/demo/class_iii_plan.h"
#include "tools/demo/demo.h"
#include "tools/demo/operation_output.h"
#include "tools/demo/plan_steps.h"

namespace condyle {
namespace {

constexpr double published_setback_mm = 5;

}  // namespace

ClassIiiPlan make_class_iii_plan(int threads, const Progress& progress) {
  ClassIiiPlan made;
  HeadChoice choice;
  choice.variant = HeadChoice::Variant::class_iii;
  made.patient = builtin_patient(choice, progress);
  Plan plan = begin_plan(made.patient, "class III");
  plan = with_cut(made.patient, std::move(plan), {.osteotomy = "le_fort_1"});
  plan = with_move(std::move(plan), "maxilla", {"forward", "4", "up", "2", "pns", "up", "4"});
  plan = with_cut(made.patient, std::move(plan), {.osteotomy = "sagittal_split"});
  OcclusionSettings settings;
  settings.threads = threads;
  settings.cache = user_cache_folder();
  made.bite = find_segment_bite(made.patient, plan, "distal", settings, progress);
  made.plan = with_segment_bite(std::move(plan), "distal", made.bite);
  const Eigen::Vector3d edge = made.patient.landmarks.points.at("lower_incisal_point");
  const ClinicalFrame frame = clinical_frame(made.patient.landmarks, made.plan.reference);
  made.setback_mm = frame.back.dot(made.bite.X_CS * edge - edge);
  return made;
}

int run_class_iii(const DemoOptions& options, const CommonOptions& common) {
  ProgressBar bar(common);
  const ClassIiiPlan made = make_class_iii_plan(common.threads, bar.callback());
  PredictionSettings settings;
  settings.threads = common.threads;
  const Prediction prediction = predict(made.patient, made.plan, settings, bar.callback());

  OperationOutput output(
      options.out, "Class III: both jaws",
      "The upper jaw is moved 4 mm forward, 2 mm up in front and 4 mm up behind after a Le Fort I "
      "osteotomy. After a sagittal split the lower arch is closed on the moved upper one, so that "
      "its setback is a result.");
  output.add_operation(made.plan, prediction.operated, bar.callback(),
                       predicted_landmarks(prediction));
  const Bite& bite = made.bite.bite;
  output.json["bite"] = {{"stable", bite.stable},
                         {"contacts", bite.contacts.size()},
                         {"overjet_mm", bite.after.overjet_mm},
                         {"overbite_mm", bite.after.overbite_mm},
                         {"lower_arch_setback_mm", made.setback_mm},
                         {"published_setback_mm", published_setback_mm}};
  output.add_table(
      "The bite",
      {{"", "Result", "Published plan"},
       {{"Setback of the lower incisal edge", fmt::format("{:.1f} mm", made.setback_mm),
         fmt::format("{:g} mm", published_setback_mm)},
        {"Overjet", fmt::format("{:.1f} mm", bite.after.overjet_mm), ""},
        {"Overbite", fmt::format("{:.1f} mm", bite.after.overbite_mm), ""},
        {"Contacts on 0.1 mm film",
         fmt::format("{}, {:.0f} % of the load left", bite.contacts.size(),
                     100 * bite.left_fraction),
         ""}}},
      bite.stable ? "The bite is stable." : "The bite is not stable: " + bite.unstable_because);
  output.draw([&] {
    output.add_picture("arches.png",
                       bite_picture(made.bite.patient, bite, made.bite.at,
                                    OcclusionSettings{}.film_mm, common.threads),
                       "Contacts of the planned bite on the arches, opened like a book.");
  });
  output.add_prediction(made.plan, prediction, bar.callback());
  bar.clear();
  if (common.json) fmt::print("{}\n", output.json.dump(2));
  output.finish(common.prints_summary());
  if (common.prints_summary())
    fmt::print(stderr, "setback of the lower arch: {:.1f} mm (published plan: {:g} mm)\n",
               made.setback_mm, published_setback_mm);
  return 0;
}

}  // namespace condyle
