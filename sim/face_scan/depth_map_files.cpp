#include "sim/face_scan/depth_map_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/mesh_io/picture_files.h"
#include "sim/case/json_file.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

constexpr double largest_depth_mm = 2000;

/// A file beside the description.
fs::path file_beside(const fs::path& description, const JsonItem& name) {
  const fs::path file = name.text();
  if (file.empty() || file.has_parent_path() || file.is_absolute())
    name.refuse("is no name of a file beside the description");
  return description.parent_path() / file;
}

void read_colours(const fs::path& file, FaceDepthMap& map) {
  ColourPicture picture = read_colour_picture(file);
  const double across = static_cast<double>(picture.width) / map.width;
  const double down = static_cast<double>(picture.height) / map.height;
  if (std::abs(across / down - 1) > 0.01)
    throw InputError(file, "",
                     fmt::format("has {} x {} pixels, the depth map {} x {}: the colours are not "
                                 "those of the depths",
                                 picture.width, picture.height, map.width, map.height));
  map.colour_width = picture.width;
  map.colour_height = picture.height;
  map.rgb = std::move(picture.rgb);
}

void read_shape(const JsonItem& root, FaceDepthMap& map) {
  const std::string kind = root.at("kind").text();
  const auto number = [&](const char* name, double low, double high, double missing) {
    const auto item = root.find(name);
    return item ? item->number(low, high) : missing;
  };
  if (kind == "plane") {
    root.only_keys({"kind", "depth", "colour", "unit_mm", "offset_mm", "invalid", "pixel_mm"});
    map.kind = FaceDepthMap::Kind::plane;
    map.pixel_mm = root.at("pixel_mm").number(0.01, 10);
    return;
  }
  if (kind != "cylinder") root.at("kind").refuse("is no kind of depth map: cylinder or plane");
  root.only_keys({"kind", "depth", "colour", "unit_mm", "offset_mm", "invalid", "angle_from_deg",
                  "angle_to_deg", "height_mm"});
  map.kind = FaceDepthMap::Kind::cylinder;
  map.angle_from_deg = number("angle_from_deg", -720, 720, -180);
  map.angle_to_deg = number("angle_to_deg", -720, 720, 180);
  map.height_mm = root.at("height_mm").number(1, 2000);
  const double turn = std::abs(map.angle_to_deg - map.angle_from_deg);
  if (turn < 1 || turn > 360.001)
    root.at("angle_to_deg").refuse(fmt::format("makes {:.6g} degrees; 1 to 360 are needed", turn));
}

}  // namespace

FaceDepthMap read_depth_map(const fs::path& description) {
  constexpr std::size_t longest_text = 1 << 20;
  const JsonFile json(description, read_file(description, longest_text));
  const JsonItem root = json.root();
  FaceDepthMap map;
  read_shape(root, map);
  const double unit_mm = root.at("unit_mm").number(1e-6, 1000);
  const auto offset = root.find("offset_mm"), invalid = root.find("invalid");
  const double offset_mm = offset ? offset->number(-largest_depth_mm, largest_depth_mm) : 0;
  const int nothing = invalid ? invalid->integer(0, 65535) : 0;
  const fs::path file = file_beside(description, root.at("depth"));
  const GreyPicture depths = read_grey_picture(file);
  if (depths.width < 3 || depths.height < 3)
    throw InputError(file, "",
                     fmt::format("has {} x {} pixels; a depth map has at least 3 x 3", depths.width,
                                 depths.height));
  map.width = depths.width;
  map.height = depths.height;
  map.depth_mm.reserve(depths.values.size());
  for (const std::uint16_t value : depths.values) {
    const double depth = unit_mm * value + offset_mm;
    if (value != nothing && std::abs(depth) > largest_depth_mm)
      root.at("unit_mm").refuse(
          fmt::format("makes a depth of {:.6g} mm of the number {}; at most "
                      "{} mm",
                      depth, value, largest_depth_mm));
    const bool none = value == nothing || (map.kind == FaceDepthMap::Kind::cylinder && depth <= 0);
    map.depth_mm.push_back(none ? std::nanf("") : static_cast<float>(depth));
  }
  if (const auto colour = root.find("colour")) read_colours(file_beside(description, *colour), map);
  return map;
}

void write_depth_map(const FaceDepthMap& map, const fs::path& description) {
  constexpr double unit_mm = 0.01;
  const std::string name = description.stem().string();
  double least = 0;
  for (const float depth : map.depth_mm)
    if (!std::isnan(depth)) least = std::min<double>(least, depth);
  const double offset_mm = least < 0 ? std::floor(least) - 1 : 0;
  GreyPicture depths{map.width, map.height, {}};
  for (const float depth : map.depth_mm) {
    const double number = std::isnan(depth) ? 0 : std::round((depth - offset_mm) / unit_mm);
    if (number > 65535)
      throw InputError(description, "depth",
                       fmt::format("of {:.6g} mm does not fit into the map", depth));
    depths.values.push_back(static_cast<std::uint16_t>(number));
  }
  const bool cylinder = map.kind == FaceDepthMap::Kind::cylinder;
  nlohmann::ordered_json json = {{"kind", cylinder ? "cylinder" : "plane"},
                                 {"depth", name + "-depth.png"},
                                 {"unit_mm", unit_mm},
                                 {"offset_mm", offset_mm},
                                 {"invalid", 0}};
  if (cylinder) {
    json["angle_from_deg"] = map.angle_from_deg;
    json["angle_to_deg"] = map.angle_to_deg;
    json["height_mm"] = map.height_mm;
  } else {
    json["pixel_mm"] = map.pixel_mm;
  }
  const fs::path folder = description.parent_path();
  write_picture(depths, folder / (name + "-depth.png"));
  if (!map.rgb.empty()) {
    json["colour"] = name + "-colour.png";
    write_picture(ColourPicture{map.colour_width, map.colour_height, map.rgb},
                  folder / (name + "-colour.png"));
  }
  write_file(description, json.dump(2) + "\n");
}

}  // namespace condyle
