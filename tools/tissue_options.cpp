#include "tools/tissue_options.h"

#include <CLI/CLI.hpp>

#include "engine/core/error.h"
#include "engine/core/text_list.h"
#include "tools/command.h"

namespace condyle {
namespace {

/// "cranium|mandible,LANDMARK,RADIUS" or "cranium|mandible,X,Y,Z,RADIUS".
AttachmentRegion parse_region(const std::string& name, const std::string& text, bool attached) {
  const std::string option = name + " " + text;
  const auto fields = split_list(text);
  if ((fields.size() != 3 && fields.size() != 5) ||
      (fields[0] != "cranium" && fields[0] != "mandible"))
    throw InputError(option +
                     ": must be BONE,LANDMARK,RADIUS or BONE,X,Y,Z,RADIUS with the bone "
                     "cranium or mandible, e.g. mandible,pogonion,15");
  AttachmentRegion region;
  region.bone = fields[0] == "mandible" ? mandible_body : cranium_body;
  region.attached = attached;
  if (fields.size() == 3)
    region.landmark = fields[1];
  else
    region.centre = {parse_number(fields[1], option), parse_number(fields[2], option),
                     parse_number(fields[3], option)};
  region.radius_mm = parse_number(fields.back(), option);
  return region;
}

}  // namespace

void add_tissue(CLI::App& command, TissueOptions& tissue) {
  begin_group(command, "Tissue");
  command.add_flag_callback(
      "--no-tissue", [&tissue] { tissue.simulated = false; }, "Leave the soft tissue at rest");
  in_range(command.add_option(
               "--surface-nodes", tissue.surface_nodes,
               "Nodes of one layer, about; default 520. With 1500 a frame takes some 40 ms; with "
               "3000 and more seconds, and wide openings may not converge"),
           100, 20000);
  command.add_option("--layers", tissue.layers, "Layers of tissue; default 3")
      ->type_name("1|2|3|5");
  command
      .add_option("--turgor", tissue.turgor,
                  "Tension of the skin: its rest length over its length, above 0; default 1, none")
      ->type_name("0..1");
  command.add_option("--lambda", tissue.lambda, "Weight of springs against volumes; default 0.5")
      ->type_name("0.001..0.999");
  command
      .add_option("--gravity", tissue.gravity,
                  "Direction of gravity, which gives the tissue weight: 0,0,-1 upright, 0,1,0 on "
                  "the back")
      ->type_name("X,Y,Z");
  command.add_flag("--glued", tissue.glued,
                   "Glue the tissue to bone and teeth instead of letting it slide");
  command
      .add_option("--attach", tissue.attach,
                  "Attach the tissue that lies on a bone near a landmark or point, e.g. "
                  "mandible,pogonion,15; may be given several times")
      ->type_name("BONE,PLACE,RADIUS");
  command.add_option("--detach", tissue.detach, "Let it slide there instead")
      ->type_name("BONE,PLACE,RADIUS");
}

TissuePlan parse_tissue(const TissueOptions& options) {
  TissuePlan plan;
  plan.layer_count = options.layers;
  plan.turgor = options.turgor;
  plan.lambda = options.lambda;
  if (options.glued) plan.bond = TissueBond::glued;
  if (!options.gravity.empty()) {
    const auto fields = split_list(options.gravity);
    const std::string option = "--gravity " + options.gravity;
    if (fields.size() != 3) throw InputError(option + ": must be X,Y,Z, e.g. 0,0,-1 upright");
    plan.down = {parse_number(fields[0], option), parse_number(fields[1], option),
                 parse_number(fields[2], option)};
  }
  for (const auto& text : options.attach)
    plan.attachments.push_back(parse_region("--attach", text, true));
  for (const auto& text : options.detach)
    plan.attachments.push_back(parse_region("--detach", text, false));
  check_plan(plan, "soft tissue: ");
  return plan;
}

}  // namespace condyle
