#include "sim/case/jaw_mechanics.h"

#include <Eigen/Eigenvalues>
#include <nlohmann/json.hpp>

#include "engine/core/files.h"
#include "sim/case/case_format.h"
#include "sim/case/json_file.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr const char* polyline_key = "polyline_posterior_superior_offsets_mm_from_tmj_marker";
constexpr double heaviest_kg = 10, max_inertia = 1e5, farthest_center_mm = 1000, max_drag = 1e7;

JsonItem list(const JsonItem& item, std::size_t size) {
  if (item.size() != size)
    item.refuse("has " + std::to_string(item.size()) + " values; it needs " + std::to_string(size));
  return item;
}

Vector3d vector(const JsonItem& item, double most) {
  list(item, 3);
  return {item.at(0).number(-most, most), item.at(1).number(-most, most),
          item.at(2).number(-most, most)};
}

/// Inertia of a sphere of bone of that mass, the default.
Matrix3d ball_inertia(double mass_kg) {
  constexpr double radius_mm = 15;
  return 0.4 * mass_kg * radius_mm * radius_mm * Matrix3d::Identity();
}

BoneMechanics bone(const JsonItem& item) {
  BoneMechanics out;
  out.mass_kg = item.at("mass_kg").number(1e-4, heaviest_kg);
  out.center = vector(item.at("com_mm"), farthest_center_mm);
  out.inertia = ball_inertia(out.mass_kg);
  if (const auto rows = item.find("inertia_about_com_kg_mm2")) {
    list(*rows, 3);
    for (int k = 0; k < 3; ++k)
      out.inertia.row(k) = vector(rows->at(static_cast<std::size_t>(k)), max_inertia).transpose();
    const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(out.inertia);
    if (!out.inertia.isApprox(out.inertia.transpose(), 1e-6) || !(axes.eigenvalues()[0] > 0))
      rows->refuse("is not symmetric and positive definite, as an inertia must be");
    out.inertia = (0.5 * (out.inertia + out.inertia.transpose())).eval();
  }
  if (const auto drag = item.find("frame_damping")) out.drag_kg_s = drag->number(0, max_drag);
  if (const auto drag = item.find("rotary_damping"))
    out.turning_drag_kg_mm2_s = drag->number(0, max_drag);
  return out;
}

CondylarPath guide(const JsonItem& points) {
  CondylarPath path;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const JsonItem point = list(points.at(i), 2);
    path.forward_mm.push_back(-point.at(0).number(-100, 100));
    path.inferior_mm.push_back(-point.at(1).number(-100, 100));
    if (i > 0 && !(path.forward_mm[i] > path.forward_mm[i - 1]))
      point.refuse("is not farther forward than the previous point");
  }
  if (points.size() < 2) points.refuse("needs two points or more");
  if (path.forward_mm.front() > 0) points.at(0).refuse("the guide must start at or behind 0");
  return path;
}

Json values(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json to_json(const BoneMechanics& bone) {
  Json rows = Json::array();
  for (int k = 0; k < 3; ++k) rows.push_back(values(bone.inertia.row(k).transpose()));
  return {{"mass_kg", bone.mass_kg},
          {"com_mm", values(bone.center)},
          {"inertia_about_com_kg_mm2", rows},
          {"frame_damping", bone.drag_kg_s},
          {"rotary_damping", bone.turning_drag_kg_mm2_s}};
}

}  // namespace

JawMechanics read_mechanics(const std::filesystem::path& file) {
  const JsonFile text(file, read_file(file, max_case_json_bytes));
  JawMechanics out;
  out.mandible = bone(text.root().at("jaw"));
  if (const auto hyoid = text.root().find("hyoid")) out.hyoid = bone(*hyoid);
  if (const auto joint = text.root().find("tmj"))
    if (const auto points = joint->find(polyline_key)) out.guide = guide(*points);
  return out;
}

std::string mechanics_json(const JawMechanics& mechanics) {
  Json root = {{"jaw", to_json(mechanics.mandible)}};
  if (mechanics.hyoid) root["hyoid"] = to_json(*mechanics.hyoid);
  if (mechanics.guide)
    for (std::size_t i = 0; i < mechanics.guide->forward_mm.size(); ++i)
      root["tmj"][polyline_key].push_back(
          {-mechanics.guide->forward_mm[i], -mechanics.guide->inferior_mm[i]});
  return root.dump(1) + "\n";
}

}  // namespace condyle
