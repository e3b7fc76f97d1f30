#include "sim/case/tissue_plan_file.h"

#include <algorithm>
#include <string_view>

#include "engine/core/error.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

void only(const JsonItem& item, std::initializer_list<std::string_view> known) {
  if (!item.value().is_object()) item.refuse("must be an object {...}");
  for (const auto& [key, value] : item.value().items())
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      std::string names;
      for (const auto name : known) names += (names.empty() ? "" : ", ") + std::string(name);
      item.refuse("\"" + key + "\" is not known; known are " + names);
    }
}

Eigen::Vector3d vector_of(const JsonItem& item) {
  if (item.size() != 3) item.refuse("must have three numbers");
  constexpr double far = 1e6;
  return {item.at(std::size_t{0}).number(-far, far), item.at(std::size_t{1}).number(-far, far),
          item.at(std::size_t{2}).number(-far, far)};
}

Json vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

AttachmentRegion load_region(const JsonItem& item) {
  only(item, {"bone", "attached", "landmark", "centre", "radius_mm"});
  AttachmentRegion region;
  const std::string bone = item.at("bone").text();
  if (bone == "mandible")
    region.bone = mandible_body;
  else if (bone != "cranium")
    item.at("bone").refuse("is \"" + bone + "\"; it must be cranium or mandible");
  if (const auto attached = item.find("attached")) {
    if (!attached->value().is_boolean()) attached->refuse("must be true or false");
    region.attached = attached->value().get<bool>();
  }
  if (const auto landmark = item.find("landmark"))
    region.landmark = landmark->text();
  else
    region.centre = vector_of(item.at("centre"));
  if (const auto radius = item.find("radius_mm")) region.radius_mm = radius->number(0, 200);
  return region;
}

}  // namespace

TissuePlan load_tissue_plan(const JsonItem& item) {
  only(item, {"layers", "turgor", "lambda", "gravity", "bond", "attachments"});
  TissuePlan plan;
  if (const auto layers = item.find("layers")) {
    if (layers->value().is_number()) {
      plan.layer_count = layers->integer(1, 5);
    } else {
      for (std::size_t i = 0; i < layers->size(); ++i) {
        const JsonItem from = layers->at(i);
        only(from, {"share", "modulus_MPa", "poisson", "mass_kg"});
        TissueLayer layer{.fraction = from.at("share").number(0, 1)};
        if (const auto value = from.find("modulus_MPa")) layer.modulus_MPa = value->number(0, 100);
        if (const auto value = from.find("poisson")) layer.poisson = value->number(0, 1);
        if (const auto value = from.find("mass_kg")) layer.mass_kg = value->number(0, 10);
        plan.layers.push_back(layer);
      }
      if (plan.layers.empty()) layers->refuse("is empty; name one layer or more");
    }
  }
  if (const auto value = item.find("turgor")) plan.turgor = value->number(0, 1);
  if (const auto value = item.find("lambda")) plan.lambda = value->number(0.001, 0.999);
  if (const auto value = item.find("gravity")) plan.down = vector_of(*value);
  if (const auto bond = item.find("bond")) {
    const std::string name = bond->text();
    if (name != "sliding" && name != "glued")
      bond->refuse("is \"" + name + "\"; it must be sliding or glued");
    plan.bond = name == "glued" ? TissueBond::glued : TissueBond::sliding;
  }
  if (const auto regions = item.find("attachments"))
    for (std::size_t i = 0; i < regions->size(); ++i)
      plan.attachments.push_back(load_region(regions->at(i)));
  try {
    check_plan(plan, "");
  } catch (const InputError& error) {
    item.refuse(error.what());
  }
  return plan;
}

Json tissue_plan_json(const TissuePlan& plan) {
  Json json = Json::object();
  if (plan.layer_count) json["layers"] = *plan.layer_count;
  for (const auto& layer : plan.layers) {
    Json item = {{"share", layer.fraction}};
    if (layer.modulus_MPa) item["modulus_MPa"] = *layer.modulus_MPa;
    if (layer.poisson) item["poisson"] = *layer.poisson;
    if (layer.mass_kg) item["mass_kg"] = *layer.mass_kg;
    json["layers"].push_back(item);
  }
  if (plan.turgor) json["turgor"] = *plan.turgor;
  if (plan.lambda) json["lambda"] = *plan.lambda;
  if (plan.down) json["gravity"] = vector_json(*plan.down);
  if (plan.bond) json["bond"] = *plan.bond == TissueBond::glued ? "glued" : "sliding";
  for (const auto& region : plan.attachments) {
    Json item = {{"bone", region.bone == mandible_body ? "mandible" : "cranium"},
                 {"attached", region.attached}};
    if (region.landmark.empty())
      item["centre"] = vector_json(region.centre);
    else
      item["landmark"] = region.landmark;
    item["radius_mm"] = region.radius_mm;
    json["attachments"].push_back(item);
  }
  return json;
}

}  // namespace condyle
