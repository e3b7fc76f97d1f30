#include "sim/plan/movement_table.h"

#include <fmt/format.h>

#include "sim/plan/columns.h"
#include "sim/plan/move.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

enum class Carrier { upper_arch, lower_arch, condyle };

/// A row of the planner's table; paired ones have a landmark with "left" or "right" in place of {}.
struct TablePoint {
  const char* label;
  const char* landmark;
  Carrier carrier;
  bool paired;
};

const std::vector<TablePoint>& table_points() {
  static const std::vector<TablePoint> points = {
      {"U1", "upper_incisal_point", Carrier::upper_arch, false},
      {"U3", "upper_{}_canine_tip", Carrier::upper_arch, true},
      {"U6", "upper_{}_first_molar_mesiobuccal_cusp", Carrier::upper_arch, true},
      {"ANS", "ans", Carrier::upper_arch, false},
      {"PNS", "pns", Carrier::upper_arch, false},
      {"A", "a_point", Carrier::upper_arch, false},
      {"L1", "lower_incisal_point", Carrier::lower_arch, false},
      {"L3", "lower_{}_canine_tip", Carrier::lower_arch, true},
      {"L6", "lower_{}_first_molar_mesiobuccal_cusp", Carrier::lower_arch, true},
      {"B", "b_point", Carrier::lower_arch, false},
      {"Pog", "pogonion", Carrier::lower_arch, false},
      {"Me", "menton", Carrier::lower_arch, false},
      {"Go", "{}_gonion", Carrier::condyle, true},
      {"Co", "{}_condyle", Carrier::condyle, true},
  };
  return points;
}

std::string sided(const char* pattern, const char* side) {
  return fmt::format(fmt::runtime(pattern), side);
}

/// Calls visit(label, landmark, side, point) for each landmark of the table; side is "" for the
/// midline.
template <class Visit>
void for_each_point(const Visit& visit) {
  for (const auto& point : table_points()) {
    if (!point.paired) {
      visit(std::string(point.label), std::string(point.landmark), std::string(), point);
      continue;
    }
    for (const char* side : {"right", "left"})
      visit(fmt::format("{} {}", point.label, side), sided(point.landmark, side), std::string(side),
            point);
  }
}

void add_midline(MovementTable& table, const char* label, const char* name,
                 const ClinicalFrame& frame, const Landmarks& rest, const Landmarks& now) {
  const auto before = rest.find(name), after = now.find(name);
  if (before && after)
    table.midlines.push_back({label, false, frame.left.dot(*before - frame.origin),
                              frame.left.dot(*after - frame.origin)});
}

void add_cant(MovementTable& table, const char* label, const char* pattern,
              const ClinicalFrame& frame, const Landmarks& rest, const Landmarks& now) {
  const auto lower_on_left = [&](const Landmarks& marks) -> std::optional<double> {
    const auto left = marks.find(sided(pattern, "left")),
               right = marks.find(sided(pattern, "right"));
    if (!left || !right) return std::nullopt;
    return -frame.up.dot(*left - *right);
  };
  const auto before = lower_on_left(rest), after = lower_on_left(now);
  if (before && after) table.midlines.push_back({label, true, *before, *after});
}

std::string midline_words(const MidlineRow& row, double value) {
  return row.is_cant ? in_words(value, "lower on the left", "lower on the right")
                     : in_words(value, "left", "right");
}

}  // namespace

LandmarkOwners default_landmark_owners(const JawBodies& jaw) {
  LandmarkOwners owners;
  for_each_point([&](const auto&, const std::string& landmark, const std::string& side,
                     const TablePoint& point) {
    if (point.carrier == Carrier::upper_arch)
      owners[landmark] = jaw.upper_arch;
    else if (point.carrier == Carrier::lower_arch)
      owners[landmark] = jaw.lower_arch;
    else
      owners[landmark] = side == "left" ? jaw.left_condyle : jaw.right_condyle;
  });
  for (const char* arch : {"upper", "lower"})
    for (const char* side : {"left", "right"})
      owners[fmt::format("{}_{}_central_incisor_apex", arch, side)] =
          std::string(arch) == "upper" ? jaw.upper_arch : jaw.lower_arch;
  owners["gnathion"] = jaw.lower_arch;
  return owners;
}

Landmarks moved_landmarks(const Landmarks& rest, const LandmarkOwners& owners,
                          const BodyPoses& poses) {
  Landmarks moved = rest;
  for (auto& [name, point] : moved.points)
    if (const auto owner = owners.find(name); owner != owners.end())
      point = poses[owner->second] * point;
  return moved;
}

MovementTable movement_table(const Landmarks& rest, const ClinicalFrame& frame,
                             const BodyTree& bodies, const LandmarkOwners& owners,
                             const BodyPoses& poses) {
  const BodyPoses at = completed(bodies, poses);
  const Landmarks now = moved_landmarks(rest, owners, at);
  MovementTable table;
  for_each_point(
      [&](const std::string& label, const std::string& landmark, const auto&, const TablePoint&) {
        const auto before = rest.find(landmark);
        if (!before || !owners.contains(landmark)) return;
        const Vector3d moved = frame.components(*now.find(landmark) - *before);
        table.rows.push_back({label, landmark, moved.x(), moved.y(), moved.z()});
      });
  for (int b = 1; b < bodies.size(); ++b) {
    const ClinicalMove move = clinical_move(at[BodyId{b}], frame, Vector3d::Zero());
    table.rotations.push_back(
        {bodies[BodyId{b}].name, move.yaw_deg, move.pitch_deg, move.roll_deg});
  }
  add_midline(table, "upper midline", "upper_incisal_point", frame, rest, now);
  add_midline(table, "lower midline", "lower_incisal_point", frame, rest, now);
  add_midline(table, "chin", "pogonion", frame, rest, now);
  add_cant(table, "cant U3", "upper_{}_canine_tip", frame, rest, now);
  add_cant(table, "cant U6", "upper_{}_first_molar_mesiobuccal_cusp", frame, rest, now);
  return table;
}

std::string movement_text(const MovementTable& table) {
  std::vector<std::vector<std::string>> rows = {
      {"point", "right-left", "back-forward", "down-up", "distance"}};
  for (const auto& row : table.rows)
    rows.push_back({row.label, in_words(row.left_mm, "left", "right"),
                    in_words(row.back_mm, "back", "forward"), in_words(row.up_mm, "up", "down"),
                    fmt::format("{:.1f}", row.distance_mm())});
  std::string text = "Displacements, mm\n" + aligned_columns(rows, "llllr");
  if (!table.rotations.empty()) {
    rows = {{"segment", "yaw", "pitch", "roll"}};
    for (const auto& row : table.rotations)
      rows.push_back({row.body, in_words(row.yaw_deg, "front to the left", "front to the right"),
                      in_words(row.pitch_deg, "front down", "front up"),
                      in_words(row.roll_deg, "left side down", "right side down")});
    text += "\nRotations, degrees\n" + aligned_columns(rows, "llll");
  }
  if (!table.midlines.empty()) {
    rows = {{"", "before", "after"}};
    for (const auto& row : table.midlines)
      rows.push_back(
          {row.label, midline_words(row, row.before_mm), midline_words(row, row.after_mm)});
    text += "\nMidlines and cant, mm\n" + aligned_columns(rows, "lll");
  }
  return text;
}

nlohmann::ordered_json movement_json(const MovementTable& table) {
  nlohmann::ordered_json json = {{"landmarks", nlohmann::ordered_json::array()},
                                 {"segments", nlohmann::ordered_json::array()},
                                 {"midlines", nlohmann::ordered_json::array()}};
  for (const auto& row : table.rows)
    json["landmarks"].push_back({{"label", row.label},
                                 {"landmark", row.landmark},
                                 {"left_mm", row.left_mm},
                                 {"forward_mm", 0.0 - row.back_mm},
                                 {"up_mm", row.up_mm},
                                 {"distance_mm", row.distance_mm()}});
  for (const auto& row : table.rotations)
    json["segments"].push_back({{"name", row.body},
                                {"yaw_deg", row.yaw_deg},
                                {"pitch_deg", row.pitch_deg},
                                {"roll_deg", row.roll_deg}});
  for (const auto& row : table.midlines)
    json["midlines"].push_back(
        {{"label", row.label},
         {row.is_cant ? "left_lower_before_mm" : "left_before_mm", row.before_mm},
         {row.is_cant ? "left_lower_after_mm" : "left_after_mm", row.after_mm}});
  return json;
}

}  // namespace condyle
