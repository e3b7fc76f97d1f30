#include "sim/export/slicer_files.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/core/units.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* schema =
    "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/"
    "Schema/markups-schema-v1.0.0.json#";

const char* type_of(SlicerMarkup::Kind kind) {
  switch (kind) {
    case SlicerMarkup::Kind::line:
      return "Line";
    case SlicerMarkup::Kind::angle:
      return "Angle";
    default:
      return "Fiducial";
  }
}

Json markup_json(const SlicerMarkup& markup) {
  Json json = {{"type", type_of(markup.kind)}, {"name", markup.name}, {"coordinateSystem", "LPS"},
               {"coordinateUnits", "mm"},      {"locked", true},      {"labelFormat", "%N-%d"}};
  json["controlPoints"] = Json::array();
  int id = 0;
  for (const auto& point : markup.points)
    json["controlPoints"].push_back(
        {{"id", std::to_string(++id)},
         {"label", point.label},
         {"position", {point.place.x(), point.place.y(), point.place.z()}},
         {"orientation", {-1, 0, 0, 0, -1, 0, 0, 0, 1}},
         {"selected", true},
         {"locked", true},
         {"visibility", true},
         {"positionStatus", "defined"}});
  if (markup.kind != SlicerMarkup::Kind::points)
    json["measurements"] = {{{"name", markup.kind == SlicerMarkup::Kind::line ? "length" : "angle"},
                             {"enabled", true},
                             {"value", measured(markup)},
                             {"units", markup.kind == SlicerMarkup::Kind::line ? "mm" : "deg"}}};
  return json;
}

}  // namespace

std::string itk_transform(const Pose& X) {
  const Pose inverse = X.inverse();
  const Eigen::Matrix3d R = inverse.R.toRotationMatrix();
  std::string text =
      "#Insight Transform File V1.0\n#Transform 0\nTransform: AffineTransform_double_3_3\n"
      "Parameters:";
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) text += fmt::format(" {}", R(i, j) + 0.0);
  for (int i = 0; i < 3; ++i) text += fmt::format(" {}", inverse.t[i] + 0.0);
  return text + "\nFixedParameters: 0 0 0\n";
}

double measured(const SlicerMarkup& markup) {
  const auto& p = markup.points;
  if (markup.kind == SlicerMarkup::Kind::line) return (p[1].place - p[0].place).norm();
  if (markup.kind != SlicerMarkup::Kind::angle) return 0;
  const Eigen::Vector3d a = p[0].place - p[1].place, b = p[2].place - p[1].place;
  return std::atan2(a.cross(b).norm(), a.dot(b)) * degrees_per_radian;
}

std::string slicer_markups(const std::vector<SlicerMarkup>& markups) {
  Json json = {{"@schema", schema}, {"markups", Json::array()}};
  for (const SlicerMarkup& markup : markups) json["markups"].push_back(markup_json(markup));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

SlicerMarkup landmark_markup(const Landmarks& landmarks, const std::string& name) {
  SlicerMarkup markup{SlicerMarkup::Kind::points, name, {}};
  for (const auto& [label, place] : landmarks.points) markup.points.push_back({label, place});
  return markup;
}

}  // namespace condyle
