#include "sim/plan/graft_step_file.h"

#include <fmt/format.h>

#include <limits>

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

double any_number(const JsonItem& item) {
  constexpr double most = std::numeric_limits<double>::max();
  return item.number(-most, most);
}

void read_number(const JsonItem& item, const char* key, double& value) {
  if (const auto found = item.find(key)) value = any_number(*found);
}

}  // namespace

Json graft_step_json(const ResectStep& step) { return {{"segment", step.segment}}; }

Json graft_step_json(const GraftStep& step) {
  Json json = {{"name", step.name}, {"donor", step.donor}};
  if (!step.donor_shape.empty()) json["donor_shape"] = step.donor_shape;
  json["replaces"] = step.replaces;
  json["pieces"] = step.pieces;
  for (const auto& p : step.curve) json["curve"].push_back({p.x(), p.y(), p.z()});
  if (step.height_mm) json["height_mm"] = *step.height_mm;
  json["roll_deg"] = step.roll_deg;
  json["kerf_mm"] = step.kerf_mm;
  json["spacing_mm"] = step.spacing_mm;
  json["clearance_mm"] = step.clearance_mm;
  if (!step.starts_mm.empty()) json["starts_mm"] = step.starts_mm;
  json["approach"] = step.approach;
  return json;
}

ResectStep resect_step_in(const JsonItem& item) {
  item.only_keys({"segment"});
  return {item.at("segment").text()};
}

GraftStep graft_step_in(const JsonItem& item) {
  item.only_keys({"name", "donor", "donor_shape", "replaces", "pieces", "curve", "height_mm",
                  "roll_deg", "kerf_mm", "spacing_mm", "clearance_mm", "starts_mm", "approach"});
  GraftStep step{.name = item.at("name").text(),
                 .donor = item.at("donor").text(),
                 .replaces = item.at("replaces").text(),
                 .pieces = item.at("pieces").integer(1, max_graft_pieces)};
  if (const auto shape = item.find("donor_shape")) step.donor_shape = shape->text();
  if (const auto curve = item.find("curve"))
    for (std::size_t i = 0; i < curve->size(); ++i) {
      const JsonItem point = curve->at(i);
      if (point.size() != 3) point.refuse(fmt::format("has {} numbers; expected 3", point.size()));
      step.curve.emplace_back(any_number(point.at(0)), any_number(point.at(1)),
                              any_number(point.at(2)));
    }
  if (const auto height = item.find("height_mm")) step.height_mm = any_number(*height);
  read_number(item, "roll_deg", step.roll_deg);
  read_number(item, "kerf_mm", step.kerf_mm);
  read_number(item, "spacing_mm", step.spacing_mm);
  read_number(item, "clearance_mm", step.clearance_mm);
  if (const auto starts = item.find("starts_mm"))
    for (std::size_t i = 0; i < starts->size(); ++i)
      step.starts_mm.push_back(any_number(starts->at(i)));
  if (const auto approach = item.find("approach")) step.approach = approach->text();
  return step;
}

}  // namespace condyle
