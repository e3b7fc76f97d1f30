#include "tools/shared_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <map>

#include "sim/case/pair_rules.h"
#include "tools/pair_options.h"

namespace condyle {

CLI::Validator within(double least, double most) {
  return CLI::Validator(
      [=](std::string& text) {
        char* end = nullptr;
        const double value = std::strtod(text.c_str(), &end);
        if (end != text.c_str() && *end == '\0' && value >= least && value <= most)
          return std::string();
        return "\"" + text + "\" is not a number from " + CLI::detail::to_string(least) + " to " +
               CLI::detail::to_string(most);
      },
      "NUMBER");
}

void add_muscles(CLI::App* command, MuscleMotionSettings& muscles) {
  command
      ->add_option("--muscle-law", muscles.law.law,
                   "Of muscle-driven motion: hill (force falls with speed, activation lags; the "
                   "default) or peck (neither)")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, MuscleLaw>{{"peck", MuscleLaw::peck}, {"hill", MuscleLaw::hill}}));
  command
      ->add_option("--hyoid", muscles.hyoid,
                   "Of muscle-driven motion: fixed (the default), free, or a CSV of its way from "
                   "rest (time_s,x_mm,y_mm,z_mm)")
      ->type_name("fixed|free|FILE");
  command
      ->add_option("--bolus", muscles.bolus.side,
                   "Food between the back teeth of muscle-driven motion: left, right or none")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, BolusSettings::Side>{{"none", BolusSettings::Side::none},
                                                     {"left", BolusSettings::Side::left},
                                                     {"right", BolusSettings::Side::right}}));
  command->add_option("--bolus-size", muscles.bolus.size_mm, "Its thickness, mm (10)")
      ->check(within(1.0, 40.0));
  command
      ->add_option("--bolus-resistance", muscles.bolus.resistance_N,
                   "Its force when bitten through, N (35)")
      ->check(within(0.0, 300.0));
}

void add_motion(CLI::App* command, MotionOptions& motion, bool motion_required) {
  command->add_option("CASE", motion.patient,
                      "Folder with case.json (default: the built-in patient)");
  auto* option = command->add_option(
      "--motion", motion.motion,
      "Built-in motion (" + CLI::detail::join(builtin_motions(), ", ") +
          "), movements in words (\"open 40; close; protrude 6\"), a file of them (*.motion), or a "
          "recording (CSV: time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz; others as README.md tells), "
          "muscles:FILE (excitations: time_s,MUSCLE,...), or inverse:MOTION (muscles that follow a "
          "motion)");
  if (motion_required) option->required();
  command
      ->add_option("--duration", motion.settings.duration_s,
                   "Time of the whole motion, s (its own; opening and closing 3)")
      ->check(within(0.2, 3600.0));
  for (const auto& entry : motion_parameter_names()) {
    std::string name = "--" + entry.name;
    std::replace(name.begin(), name.end(), '_', '-');
    const std::string unit = entry.unit.empty() || entry.unit == "mm_s" ? "" : ", " + entry.unit;
    command
        ->add_option_function<double>(
            name,
            [&motion, &entry](const double& value) {
              for (const auto member : entry.values) motion.settings.parameters.*member = value;
            },
            entry.help + unit)
        ->check(within(entry.low, entry.high))
        ->group("How the jaw moves");
  }
  add_muscles(command, motion.muscles);
}

void add_contact(CLI::App* command, MotionOptions& motion) {
  command
      ->add_option("--pair", motion.pairs,
                   "What two parts may do to each other (" + known_policies() +
                       "; * is any part), e.g. skull,mandible,guided,gap=1.5 or "
                       "segment,*,forbidden,margin=2; may be given several times")
      ->type_name("A,B,POLICY[,gap=MM][,margin=MM]");
}

void add_respect_contact(CLI::App* command, MotionOptions& motion) {
  command->add_flag("--respect-contact", motion.respect_contact,
                    "Keep a recorded motion, too, from passing bone through bone: it slides along "
                    "(built-in motions always do)");
  command
      ->add_option("--friction", motion.friction,
                   "Coulomb coefficient of sliding bone and teeth (0)")
      ->check(within(0.0, 2.0));
}

void add_tissue(CLI::App* command, MotionOptions& motion) {
  command->add_flag("!--no-tissue", motion.tissue, "Leave the soft tissue where it is");
  command
      ->add_option("--surface-nodes", motion.surface_nodes,
                   "Soft-tissue nodes of one layer, about (520). With 1500 a frame takes some "
                   "40 ms; with 3000 and more, where layers are cut too, seconds, and wide "
                   "openings may not settle")
      ->check(CLI::Range(100, 20000));
  TissueOptions& model = motion.tissue_model;
  command->add_option("--layers", model.layers, "Layers of soft tissue: 1, 2, 3 or 5 (3)");
  command->add_option(
      "--turgor", model.turgor,
      "Tension of the skin: its rest length over its length, above 0 to 1 (1: none)");
  command->add_option("--lambda", model.lambda,
                      "Weight of springs against volumes, 0.001 to 0.999 (0.5)");
  command
      ->add_option("--gravity", model.gravity,
                   "Give the tissue weight, down along X,Y,Z: 0,0,-1 upright, 0,1,0 on the back")
      ->type_name("X,Y,Z");
  command->add_flag("--glued", model.glued,
                    "Glue soft tissue to bone and teeth instead of letting it slide");
  command
      ->add_option("--attach", model.attach,
                   "Attach the tissue that lies on a bone near a landmark or point, e.g. "
                   "mandible,pogonion,15; may be given several times")
      ->type_name("BONE,LANDMARK|X,Y,Z,RADIUS");
  command->add_option("--detach", model.detach, "Let it slide there instead")
      ->type_name("BONE,LANDMARK|X,Y,Z,RADIUS");
}

void add_recording(CLI::App* command, RecordOptions& record) {
  add_motion(command, record.motion, true);
  add_contact(command, record.motion);
  add_respect_contact(command, record.motion);
  add_tissue(command, record.motion);
  command->add_option("--out", record.out, "Folder for the results")->required();
  command
      ->add_option("--frames", record.frames,
                   "The whole motion in this many frames, both ends included")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--fps", record.fps, "Frames a second of the motion's own time (30)")
      ->check(within(0.1, 1000.0));
  command->add_flag("--plots", record.plots, "Also draw plots (SVG)");
}

void add_pictures(CLI::App* command, PictureOptions& picture) {
  command->add_option("--size", picture.size,
                      "Picture size, WIDTHxHEIGHT up to 8192 a side (1280x720; 4K: 3840x2160)");
  command->add_option(
      "--camera", picture.camera,
      "front back left right three-quarter above below spin upper-arch lower-arch, or a JSON file "
      "with a view or a path of views; several at once by commas (three-quarter)");
  command->add_option(
      "--show", picture.show,
      "What to draw: all bones teeth segments transplants skin mouth contacts or part names, each "
      "with an opacity if wanted, e.g. bones,teeth,skin:0.4 (all); distance: colour bones and "
      "teeth by their distance from what they may meet; displacement: colour the skin by its way "
      "from rest");
  command
      ->add_option("--distance-near", picture.distance_near_mm,
                   "Distances up to here are coloured, mm (2)")
      ->check(within(0.5, 10.0));
  command
      ->add_option("--clip", picture.clip,
                   "Leave out what lies beyond a plane, and close what it cuts: left right front "
                   "back above or below, with a place in mm from the middle between the condyles "
                   "if wanted (left:10), or X,Y,Z,NX,NY,NZ: a point and the way out")
      ->type_name("SIDE[:MM]");
  command->add_option("--clip-parts", picture.clip_parts,
                      "Which parts the plane cuts, as in --show (all)");
  command->add_flag("--clip-open", picture.clip_open,
                    "Show the inner sides, drawn flat, instead of closing what is cut");
  command
      ->add_option("--cut-away", picture.cut_away,
                   "Open a round window in the skin about a landmark or point, e.g. "
                   "left_condyle,35")
      ->type_name("LANDMARK|X,Y,Z,RADIUS");
  command->add_option(
      "--overlay", picture.overlay,
      "Also draw, by commas: springs prisms bone-springs layers (of the tissue) muscles (their "
      "lines "
      "of action) axes paths (of condyles and incisal point) ghost (where all was at rest) "
      "wireframe[:PARTS] patches (of contact) scale letters (L R A P S I)");
  command
      ->add_option("--wipe", picture.wipe,
                   "Left of this share of the width the patient at rest, right of it as he is now")
      ->check(within(0.0, 1.0));
  command->add_flag("--before-after", picture.before_after,
                    "Three pictures of that size beside one another: at rest, as he is now, and "
                    "now with the skin coloured by its way from rest");
  command->add_option(
      "--caption", picture.caption,
      "Words at the foot of the picture; {time}, {opening} (drop of the lower incisal point), "
      "{interincisal} (between the incisal edges), {rotation}, {frame} and {motion} "
      "are filled in, | breaks the line");
  command->add_flag("--light", picture.light, "A light background in place of the dark one");
  command->add_flag("--transparent", picture.transparent, "No background: PNG with alpha");
  command
      ->add_option(
          "--edges", picture.edges,
          "How edges are made smooth: msaa4 (a driver that gives fewer samples is told of), "
          "fxaa (twice as fast) or none (msaa4)")
      ->check(CLI::IsMember({"msaa4", "fxaa", "none"}));
  command
      ->add_option("--supersample", picture.supersample,
                   "Draw so many times as wide and high, then average: 1 to 4 (1)")
      ->check(CLI::Range(1, 4));
  command->add_flag("!--no-shadows", picture.shadows, "Leave shadows out");
}

}  // namespace condyle
