#include "tools/tissue_options.h"

#include <fmt/format.h>

#include "engine/core/error.h"
#include "tools/text_list.h"

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
  region.bone = fields[0] == "mandible" ? Body::mandible : Body::cranium;
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
