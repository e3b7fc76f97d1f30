#include "sim/case/canal_list.h"

#include <fmt/format.h>

#include <set>
#include <string>

#include "engine/core/error.h"
#include "sim/case/case_format.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

constexpr double max_canal_diameter_mm = 30, max_canal_coordinate_mm = 1e6;

Eigen::Vector3d load_canal_point(const JsonItem& item) {
  if (item.size() != 3)
    item.refuse(fmt::format("has {} numbers; a point has three: x, y, z", item.size()));
  Eigen::Vector3d point;
  for (std::size_t i = 0; i < 3; ++i)
    point[static_cast<int>(i)] =
        item.at(i).number(-max_canal_coordinate_mm, max_canal_coordinate_mm);
  return point;
}

Canal load_canal(const JsonItem& item, const BodyTree& bodies) {
  item.only_keys({"name", "body", "diameter_mm", "points"});
  Canal canal;
  canal.name = item.at("name").text();
  if (!is_part_name(canal.name))
    item.at("name").refuse("\"" + canal.name +
                           "\" is no name of a canal; use letters, digits, - and _");
  const JsonItem body = item.at("body");
  if (const auto known = bodies.find(body.text()))
    canal.body = *known;
  else
    body.refuse("the body \"" + body.text() + "\" does not exist");
  const JsonItem diameter = item.at("diameter_mm");
  canal.diameter_mm = diameter.number(0, max_canal_diameter_mm);
  if (!(canal.diameter_mm > 0)) diameter.refuse("is 0; a canal has a diameter");
  const JsonItem points = item.at("points");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d point = load_canal_point(points.at(i));
    if (i > 0 && point == canal.points.back()) points.at(i).refuse("repeats the point before it");
    canal.points.push_back(point);
  }
  if (canal.points.size() < 2)
    points.refuse(
        fmt::format("has {} of the two or more points that a canal needs", canal.points.size()));
  return canal;
}

}  // namespace

std::vector<Canal> load_canals(const JsonItem& list, const BodyTree& bodies) {
  std::vector<Canal> canals;
  std::set<std::string> names;
  for (std::size_t i = 0; i < list.size(); ++i) {
    canals.push_back(load_canal(list.at(i), bodies));
    if (!names.insert(canals.back().name).second)
      list.at(i).at("name").refuse("the canal \"" + canals.back().name + "\" occurs twice");
  }
  return canals;
}

Json canals_json(const std::vector<Canal>& canals, const BodyTree& bodies) {
  Json list = Json::array();
  for (const Canal& canal : canals) {
    Json points = Json::array();
    for (const auto& p : canal.points) points.push_back({p.x(), p.y(), p.z()});
    list.push_back({{"name", canal.name},
                    {"body", bodies[canal.body].name},
                    {"diameter_mm", canal.diameter_mm},
                    {"points", std::move(points)}});
  }
  return list;
}

void check_canals(const std::vector<Canal>& canals, const BodyTree& bodies,
                  const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const Canal& canal : canals) {
    const auto refuse = [&](const std::string& problem) {
      throw InputError(folder, "canal \"" + canal.name + "\"", problem);
    };
    if (!is_part_name(canal.name) || !names.insert(canal.name).second)
      refuse("the name must be unique and of letters, digits, - and _");
    if (index_of(canal.body) >= static_cast<std::size_t>(bodies.size()))
      refuse("its body does not exist");
    if (!(canal.diameter_mm > 0 && canal.diameter_mm <= max_canal_diameter_mm))
      refuse(fmt::format("its diameter must be above 0 and at most {} mm", max_canal_diameter_mm));
    if (canal.points.size() < 2) refuse("needs two points or more");
    for (std::size_t i = 0; i < canal.points.size(); ++i) {
      const auto& p = canal.points[i];
      if (!p.allFinite() || p.cwiseAbs().maxCoeff() > max_canal_coordinate_mm)
        refuse(fmt::format("the position of its point {} is not valid", i));
      if (i > 0 && p == canal.points[i - 1])
        refuse(fmt::format("its point {} repeats the one before it", i));
    }
  }
}

}  // namespace condyle
