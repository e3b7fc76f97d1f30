#include "sim/motion/recording_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "sim/case/json_file.h"
#include "sim/case/source_frame.h"
#include "sim/motion/condylar_kinematics.h"

namespace condyle {
namespace {

constexpr std::size_t max_bytes = std::size_t{1} << 20;

std::vector<std::string> names(const JsonItem& list, std::initializer_list<std::size_t> sizes) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < list.size(); ++i) out.push_back(list.at(i).text());
  if (sizes.size() > 0 && std::find(sizes.begin(), sizes.end(), out.size()) == sizes.end())
    list.refuse(
        fmt::format("names {} columns; {} are required", out.size(), fmt::join(sizes, " or ")));
  return out;
}

BodyColumns body(const JsonItem& item) {
  using Rotation = BodyColumns::Rotation;
  item.only_keys({"translation", "quaternion", "euler", "order", "matrix", "markers"});
  BodyColumns out;
  if (const auto markers = item.find("markers")) {
    out.markers = names(*markers, {});
    if (out.markers.size() < 3) markers->refuse("needs three markers or more");
    return out;
  }
  if (const auto columns = item.find("translation")) out.translation = names(*columns, {3});
  for (const auto& [key, rotation] :
       {std::pair{"quaternion", Rotation::quaternion}, std::pair{"euler", Rotation::euler},
        std::pair{"matrix", Rotation::matrix}}) {
    const auto columns = item.find(key);
    if (!columns) continue;
    if (out.rotation != Rotation::none) columns->refuse("is a second rotation; give only one");
    out.rotation = rotation;
    out.turn = rotation == Rotation::quaternion ? names(*columns, {4})
               : rotation == Rotation::euler    ? names(*columns, {3})
                                                : names(*columns, {9, 16});
  }
  if (out.rotation == Rotation::none)
    item.refuse("has no rotation: give quaternion, euler, matrix, or markers");
  if (out.translation.empty() != (out.turn.size() == 16))
    item.refuse("needs either a translation with a rotation, or a matrix of 16");
  if (const auto order = item.find("order")) {
    out.order = order->text();
    std::string sorted = out.order;
    std::sort(sorted.begin(), sorted.end());
    const bool proper =
        out.order.size() == 3 && out.order[0] != out.order[1] && out.order[1] != out.order[2];
    const bool letters = out.order.find_first_not_of("XYZ") == std::string::npos ||
                         out.order.find_first_not_of("xyz") == std::string::npos;
    if (!proper || !letters)
      order->refuse("\"" + out.order.substr(0, 20) +
                    "\" is not an order of angles; use XYZ, ZYX, ... (intrinsic) or xyz, zyx, ... "
                    "(extrinsic)");
  }
  return out;
}

/// The value of one of several words. throws: InputError listing them.
template <std::size_t N>
double choice(const JsonItem& item, const std::array<std::pair<const char*, double>, N>& values) {
  std::string known;
  for (const auto& [name, value] : values) {
    if (item.text() == name) return value;
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  item.refuse("\"" + item.text().substr(0, 20) + "\" is unknown; valid values are " + known);
}

}  // namespace

RecordingMap read_sidecar(const std::filesystem::path& file, RecordingMap map) {
  const JsonFile json(file, read_file(file, max_bytes));
  const JsonItem root = json.root();
  root.only_keys({"time", "time_unit", "rate_hz", "length_unit", "angle_unit", "axes", "origin_mm",
                  "rest", "smooth_hz", "mandible", "cranium"});
  if (const auto item = root.find("time")) map.time = item->text();
  if (const auto item = root.find("time_unit"))
    map.time_unit_s = choice(*item, std::array{std::pair{"s", 1.0}, std::pair{"ms", 1e-3}});
  if (const auto item = root.find("rate_hz")) map.rate_hz = item->number(0.01, 1e6);
  if (const auto item = root.find("length_unit"))
    map.length_unit_mm = choice(*item, std::array{std::pair{"mm", 1.0}, std::pair{"cm", 10.0},
                                                  std::pair{"m", 1e3}, std::pair{"in", 25.4}});
  if (const auto item = root.find("angle_unit"))
    map.angle_unit_rad = choice(*item, std::array{std::pair{"deg", degree}, std::pair{"rad", 1.0}});
  if (const auto item = root.find("axes")) {
    try {
      map.source = source_frame("mm", item->text());
    } catch (const InputError&) {
      item->refuse("\"" + item->text().substr(0, 20) +
                   "\" does not name axes; give the directions of x, y and z, one letter each of L "
                   "or R, A or P, S or I: LPS, RAS, ASR ...");
    }
  }
  if (const auto item = root.find("origin_mm")) {
    if (item->size() != 3) item->refuse("needs three numbers");
    for (int k = 0; k < 3; ++k)
      map.origin_mm[k] = item->at(static_cast<std::size_t>(k)).number(-1e5, 1e5);
  }
  if (const auto item = root.find("rest"))
    map.first_is_rest =
        choice(*item, std::array{std::pair{"first", 1.0}, std::pair{"identity", 0.0}}) > 0;
  if (const auto item = root.find("smooth_hz")) map.smooth_hz = item->number(0.1, 1e4);
  if (const auto item = root.find("mandible")) map.mandible = body(*item);
  if (const auto item = root.find("cranium")) map.cranium = body(*item);
  return map;
}

}  // namespace condyle
