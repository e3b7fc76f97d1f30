#include "tools/tissue_options.h"

#include <fmt/format.h>

#include <cstdlib>

#include "engine/core/error.h"

namespace condyle {
namespace {

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> fields(1);
  for (const char c : text)
    if (c == ',')
      fields.emplace_back();
    else
      fields.back() += c;
  return fields;
}

double number(const std::string& text, const std::string& option) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0') throw InputError(option + ": \"" + text + "\" is no number");
  return value;
}

/// "cranium|mandible,LANDMARK,RADIUS" or "cranium|mandible,X,Y,Z,RADIUS".
AttachmentRegion parse_region(const std::string& name, const std::string& text, bool attached) {
  const std::string option = name + " " + text;
  const auto fields = split(text);
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
    region.centre = {number(fields[1], option), number(fields[2], option),
                     number(fields[3], option)};
  region.radius_mm = number(fields.back(), option);
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
    const auto fields = split(options.gravity);
    const std::string option = "--gravity " + options.gravity;
    if (fields.size() != 3) throw InputError(option + ": must be X,Y,Z, e.g. 0,0,-1 upright");
    plan.down = {number(fields[0], option), number(fields[1], option), number(fields[2], option)};
  }
  for (const auto& text : options.attach)
    plan.attachments.push_back(parse_region("--attach", text, true));
  for (const auto& text : options.detach)
    plan.attachments.push_back(parse_region("--detach", text, false));
  check_plan(plan, "soft tissue: ");
  return plan;
}

}  // namespace condyle
