#include "render/session/saved/session_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace condyle::session_fields {

namespace fs = std::filesystem;

namespace {

constexpr double most_mm = 1e6;
constexpr double unit_tolerance = 1e-6;
constexpr std::size_t most_items = 100000;

void limit_items(const JsonItem& list) {
  if (list.size() > most_items)
    list.refuse(fmt::format("has {} items; at most {} are read", list.size(), most_items));
}

std::map<std::string, double> numbers_in(const JsonItem& item) {
  std::map<std::string, double> numbers;
  if (!item.value().is_object()) item.refuse("must be an object {...}");
  for (const auto& [name, value] : item.value().items())
    numbers[name] = item.at(name).number(-most_mm, most_mm);
  return numbers;
}

}  // namespace

Eigen::Vector3d point_in(const JsonItem& item) {
  if (item.size() != 3) item.refuse(fmt::format("has {} numbers; expected 3", item.size()));
  Eigen::Vector3d p;
  for (std::size_t i = 0; i < 3; ++i) p[static_cast<int>(i)] = item.at(i).number(-most_mm, most_mm);
  return p;
}

Pose pose_in(const JsonItem& item) {
  item.only_keys({"rotation", "translation_mm"});
  const JsonItem rotation = item.at("rotation");
  if (rotation.size() != 4)
    rotation.refuse(fmt::format("has {} numbers; expected 4: w, x, y, z", rotation.size()));
  double q[4];
  for (std::size_t i = 0; i < 4; ++i) q[i] = rotation.at(i).number(-1, 1);
  const Eigen::Quaterniond R{q[0], q[1], q[2], q[3]};
  if (std::abs(R.norm() - 1) > unit_tolerance)
    rotation.refuse(fmt::format("has length {:.6g}; a rotation has length 1", R.norm()));
  return {R, point_in(item.at("translation_mm"))};
}

bool flag_in(const JsonItem& item) {
  if (!item.value().is_boolean())
    item.refuse("is " + item.value().dump().substr(0, 40) + "; it must be true or false");
  return item.value().get<bool>();
}

fs::path path_in(const JsonItem& item, const fs::path& file) {
  const std::string text = item.text();
  if (text.empty() || text.find('\0') != std::string::npos) item.refuse("is no path");
  std::error_code ignored;
  return (fs::absolute(file, ignored).parent_path() / text).lexically_normal();
}

std::size_t number_of(const std::vector<std::string>& names, const JsonItem& item) {
  const std::string name = item.text();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    item.refuse(fmt::format("is \"{}\"; it must be one of: {}", name.substr(0, 60),
                            fmt::join(names, ", ")));
  return static_cast<std::size_t>(found - names.begin());
}

std::optional<JsonItem> Reader::find(const char* name) {
  known_.emplace_back(name);
  return object_.find(name);
}

void Reader::end() const {
  for (const auto& [key, value] : object_.value().items())
    if (std::find(known_.begin(), known_.end(), key) == known_.end())
      object_.refuse(fmt::format("unknown key \"{}\"; valid keys are {}", key.substr(0, 40),
                                 fmt::join(known_, ", ")));
}

void Reader::letter(const char* name, char& value, const std::string& known) {
  const auto item = find(name);
  if (!item) return;
  const std::string text = item->text();
  if (text.size() != 1 || known.find(text) == std::string::npos)
    item->refuse("is \"" + text.substr(0, 40) + "\"; it must be one letter of " + known);
  value = text.front();
}

void Reader::names(const char* name, std::vector<std::string> ViewNames::*which) {
  const auto list = find(name);
  if (!list) return;
  limit_items(*list);
  auto& names = session_.names.*which;
  names.clear();
  for (std::size_t i = 0; i < list->size(); ++i) names.push_back(list->at(i).text());
}

void Reader::parts(const char* name, std::vector<PartView>& views,
                   std::vector<std::string> ViewNames::*which) {
  const auto list = find(name);
  if (!list) return;
  limit_items(*list);
  views.clear();
  auto& names = session_.names.*which;
  names.clear();
  for (std::size_t i = 0; i < list->size(); ++i) {
    const JsonItem item = list->at(i);
    item.only_keys({"name", "shown", "opacity"});
    names.push_back(item.at("name").text());
    views.push_back({flag_in(item.at("shown")), item.at("opacity").number(0, 1)});
  }
}

std::size_t Reader::part_in(const JsonItem& item) const {
  return number_of(session_.names.parts, item);
}

void Reader::points(const char* name, std::vector<PinnedPoint>& points) {
  const auto list = find(name);
  if (!list) return;
  limit_items(*list);
  points.clear();
  session_.measured_at_rest.clear();
  for (std::size_t i = 0; i < list->size(); ++i) {
    const JsonItem item = list->at(i);
    item.only_keys({"part", "triangle", "barycentric", "at_rest_mm"});
    PinnedPoint point{.part = part_in(item.at("part"))};
    const JsonItem corners = item.at("triangle");
    if (corners.size() != 3) corners.refuse("must have 3 numbers of vertices");
    for (std::size_t k = 0; k < 3; ++k)
      point.triangle[static_cast<int>(k)] =
          corners.at(k).integer(0, std::numeric_limits<int>::max());
    point.barycentric = point_in(item.at("barycentric"));
    points.push_back(point);
    session_.measured_at_rest.push_back(point_in(item.at("at_rest_mm")));
  }
}

void Reader::hands(const char* name, Hands& hands) {
  const auto item = find(name);
  if (!item) return;
  item->only_keys({"targets", "jaw", "jaw_in_room"});
  const auto& bodies = session_.names.bodies;
  const auto body_in = [&](const JsonItem& body) {
    return BodyId{static_cast<int>(number_of(bodies, body))};
  };
  hands = {};
  if (const auto targets = item->find("targets")) {
    limit_items(*targets);
    for (std::size_t i = 0; i < targets->size(); ++i) {
      const JsonItem target = targets->at(i);
      target.only_keys({"body", "pose"});
      hands.set(body_in(target.at("body")), pose_in(target.at("pose")));
    }
  }
  if (const auto jaw = item->find("jaw")) hands.jaw = body_in(*jaw);
  if (const auto held = item->find("jaw_in_room")) hands.X_RM = pose_in(*held);
}

void Reader::landmarks(const char* name, std::vector<Landmark>& landmarks) {
  const auto list = find(name);
  if (!list) return;
  limit_items(*list);
  landmarks.clear();
  for (std::size_t i = 0; i < list->size(); ++i) {
    const JsonItem item = list->at(i);
    item.only_keys({"name", "at_rest_mm", "part", "vertex"});
    landmarks.push_back({.name = item.at("name").text(),
                         .at_rest = point_in(item.at("at_rest_mm")),
                         .part = part_in(item.at("part")),
                         .vertex = item.at("vertex").integer(0, std::numeric_limits<int>::max())});
  }
}

void Reader::cut(const char* name, DrawnCut& cut) {
  const auto item = find(name);
  if (!item) return;
  item->only_keys({"part", "points_mm", "direction", "depth_mm", "kerf_mm"});
  cut = {};
  if (const auto part = item->find("part")) cut.part = part_in(*part);
  const JsonItem points = item->at("points_mm");
  limit_items(points);
  for (std::size_t i = 0; i < points.size(); ++i) cut.points.push_back(point_in(points.at(i)));
  if (!cut.points.empty() && !cut.part) item->refuse("has points, but no part");
  cut.direction = point_in(item->at("direction"));
  if (std::abs(cut.direction.norm() - 1) > unit_tolerance)
    item->at("direction").refuse("must have length 1");
  cut.depth_mm = item->at("depth_mm").number(0, most_mm);
  cut.kerf_mm = item->at("kerf_mm").number(0, most_mm);
}

void Reader::motion(const char* name, MotionChoice& motion) {
  const auto item = find(name);
  if (!item) return;
  item->only_keys({"spec", "kind", "file", "parameters", "excitations"});
  if (const auto file = item->find("file")) {
    std::string kind;
    if (const auto known = item->find("kind")) {
      number_of({"muscles", "inverse"}, *known);
      kind = known->text() + ":";
    }
    motion.spec = kind + path_in(*file, file_).string();
  } else {
    motion.spec = item->at("spec").text();
  }
  if (const auto parameters = item->find("parameters")) motion.parameters = numbers_in(*parameters);
  if (const auto excitations = item->find("excitations"))
    motion.excitations = numbers_in(*excitations);
}

void Reader::expression(const char* name, std::vector<ExpressionLevel>& levels) {
  const auto list = find(name);
  if (!list) return;
  limit_items(*list);
  levels.clear();
  for (std::size_t i = 0; i < list->size(); ++i) {
    const JsonItem item = list->at(i);
    item.only_keys({"name", "left", "right"});
    levels.push_back({.name = item.at("name").text(),
                      .left = item.at("left").number(0, 1),
                      .right = item.at("right").number(0, 1)});
  }
}

}  // namespace condyle::session_fields
