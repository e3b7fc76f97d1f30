#include "sim/osteotomy/ramus.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "engine/core/error.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

void add_note(SurgicalAnatomy& jaw, const std::string& note) {
  if (std::find(jaw.notes.begin(), jaw.notes.end(), note) == jaw.notes.end())
    jaw.notes.push_back(note);
}

}  // namespace

Vector3d find_notch(SurgicalAnatomy& jaw, Side side) {
  if (const auto notch = jaw.find(name_of(side) + "_sigmoid_notch")) return *notch;
  const Vector3d condyle = jaw.need(name_of(side) + "_condyle");
  // The upper outline from the condyle forward: it falls, then rises to the coronoid process.
  const double inner = 0.5 * std::abs(condyle.x());
  std::vector<Vector3d> outline;
  for (double y = condyle.y(); y > condyle.y() - 50; y -= 1)
    if (const auto range = jaw.section(side, 1, y, 2, inner)) outline.push_back(range->high_at);
  std::size_t coronoid = 0;
  for (std::size_t i = 15; i < outline.size(); ++i)
    if (!coronoid || outline[i].z() > outline[coronoid].z()) coronoid = i;
  const auto lower = [](const Vector3d& a, const Vector3d& b) { return a.z() < b.z(); };
  if (coronoid == 0)
    throw InputError("the case lacks the landmark " + name_of(side) + "_sigmoid_notch");
  add_note(jaw, "the sigmoid notches are estimated from the outline of the rami");
  return *std::min_element(outline.begin(), outline.begin() + static_cast<std::ptrdiff_t>(coronoid),
                           lower);
}

Vector3d find_gonion(SurgicalAnatomy& jaw, Side side) {
  if (const auto gonion = jaw.find(name_of(side) + "_gonion")) return *gonion;
  const double inner = 0.5 * std::abs(jaw.need(name_of(side) + "_condyle").x());
  std::optional<Vector3d> best;
  for (const auto& p : jaw.bone().vertices)
    if (sign_of(side) * p.x() > inner && (!best || p.y() - p.z() > best->y() - best->z())) best = p;
  if (!best) throw InputError("the case lacks the landmark " + name_of(side) + "_gonion");
  add_note(jaw, "the gonia are estimated from the outline of the rami");
  return *best;
}

Ramus find_ramus(SurgicalAnatomy& jaw, Side side) {
  const auto known = jaw.find(name_of(side) + "_lingula");
  double height = 0;
  if (known) {
    height = known->z();
  } else {
    const Vector3d notch = find_notch(jaw, side), gonion = find_gonion(jaw, side);
    height = notch.z() + 0.42 * (gonion.z() - notch.z());
  }
  const double condyle = std::abs(jaw.need(name_of(side) + "_condyle").x());
  const auto section = jaw.section(side, 2, height, 1, 0.4 * condyle);
  if (!section) throw InputError("the case lacks the landmark " + name_of(side) + "_lingula");
  Ramus ramus{Vector3d::Zero(), section->low, section->high};
  if (known) {
    ramus.lingula = *known;
    return ramus;
  }
  const double y = ramus.front + 0.45 * (ramus.back - ramus.front);
  const auto walls = jaw.crossings(side, y, height);
  if (walls.size() < 2)
    throw InputError("the case lacks the landmark " + name_of(side) + "_lingula");
  add_note(jaw, "the lingulae are estimated from the outline of the rami");
  ramus.lingula = {sign_of(side) * walls[1], y, height};
  return ramus;
}

Vector3d occlusal_up(const SurgicalAnatomy& jaw) {
  const auto incisal = jaw.find("lower_incisal_point"),
             left = jaw.find("lower_left_first_molar_mesiobuccal_cusp"),
             right = jaw.find("lower_right_first_molar_mesiobuccal_cusp");
  if (!incisal || !left || !right) return Vector3d::UnitZ();
  return (*left - *incisal).cross(*right - *incisal).normalized() *
         ((*left - *incisal).cross(*right - *incisal).z() < 0 ? -1 : 1);
}

std::vector<SegmentRule> proximal_and_distal() {
  return {{"proximal_left", {CutSide::above, CutSide::neither}},
          {"proximal_right", {CutSide::neither, CutSide::above}},
          {"distal", {CutSide::below, CutSide::below}}};
}

}  // namespace condyle
