#include "sim/muscles/default_face_muscles.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/core/error.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double point_spacing_mm = 5, end_spread_mm = 5;

/// Straight muscle: an origin, an insertion, both as a landmark and an offset for the left side.
struct Straight {
  const char* kind;
  const char* origin;
  Vector3d from;
  bool on_mandible, on_bone;
  const char* insertion;
  Vector3d to;
  double width_mm, end_width_mm;
  int lines;
  double limit_N, shortening;
  double from_depth, to_depth;
};

const std::vector<Straight>& straight_muscles() {
  // clang-format off
  static const std::vector<Straight> all = {
      {"zygomaticus_major", "malar", {4, 6, 4}, false, true, "cheilion",
       {0, 1.5, 0.5}, 8.5, 4, 3, 36, 0.2, 0.7, 0.5},
      {"zygomaticus_minor", "malar", {-3, 1, 5}, false, true, "cheilion",
       {-13.5, -10.4, 7.5}, 5, 5, 2, 20, 0.2, 0.7, 0.5},
      {"levator_labii_superioris", "orbitale", {-4, -1, -8}, false, true, "cheilion",
       {-12.5, -10.4, 8.5}, 10, 8, 3, 24, 0.2, 0.8, 0.5},
      {"levator_labii_alaeque_nasi", "orbitale", {-23, -13, 14.5}, false, true, "cheilion",
       {-16, -11, 12}, 6, 5, 2, 15, 0.15, 0.7, 0.5},
      {"levator_anguli_oris", "orbitale", {-7, 2, -16}, false, true, "cheilion",
       {1.5, 5, 0.5}, 8, 5, 2, 6, 0.2, 0.8, 0.6},
      {"risorius", "soft_gonion", {-6, -26, 12}, false, false, "cheilion",
       {1.5, 3, 0.5}, 8, 4, 2, 9, 0.15, 0.5, 0.5},
      {"buccinator", "cheilion", {6, 40, 8}, false, true, "cheilion",
       {3, 5, 0.5}, 20, 6, 4, 9, 0.2, 0.9, 0.9},
      {"depressor_anguli_oris", "mental_foramen", {-10, -14, -10}, true, true, "cheilion",
       {1.5, 5, 0.5}, 12, 5, 3, 9, 0.2, 0.7, 0.5},
      {"depressor_labii_inferioris", "mental_foramen", {-14, -18, -6}, true, true, "cheilion",
       {-15.5, -10.4, -7.5}, 12, 8, 3, 6, 0.2, 0.8, 0.5},
  };
  // clang-format on
  return all;
}

struct Side {
  const char* name;
  double sign;
};

Vector3d landmark(const Case& patient, const std::string& name) {
  const auto found = patient.landmarks.find(name);
  if (!found) throw InputError("muscles of the face: landmark " + name + " is missing");
  return *found;
}

std::vector<FaceMusclePoint> line_between(const Vector3d& a, const Vector3d& b,
                                          std::optional<BodyId> bone, double from_depth,
                                          double to_depth) {
  const int segments =
      std::max(3, static_cast<int>(std::lround((b - a).norm() / point_spacing_mm)));
  std::vector<FaceMusclePoint> line;
  for (int i = 0; i <= segments; ++i) {
    const double s = static_cast<double>(i) / segments;
    FaceMusclePoint p{.at = a + s * (b - a), .depth = from_depth + s * (to_depth - from_depth)};
    if (i == 0) p.bone = bone;
    if (i == segments) p.spread_mm = end_spread_mm;
    line.push_back(p);
  }
  return line;
}

FaceMuscle straight(const Case& patient, const Straight& of, const Side& side) {
  FaceMuscle muscle{.name = std::string(side.name) + "_" + of.kind,
                    .kind = of.kind,
                    .limit_N = of.limit_N,
                    .shortening = of.shortening,
                    .lines = {}};
  const Vector3d mirror(side.sign, 1, 1);
  const auto place = [&](const char* mark, const Vector3d& offset) -> Vector3d {
    return landmark(patient, std::string(side.name) + "_" + mark) + mirror.cwiseProduct(offset);
  };
  const Vector3d a = place(of.origin, of.from), b = place(of.insertion, of.to);
  const Vector3d out = mirror.cwiseProduct(Vector3d(0.6, -0.8, 0));
  const Vector3d across = (b - a).cross(out).normalized();
  std::optional<BodyId> bone;
  if (of.on_bone) bone = of.on_mandible ? patient.jaw.lower_arch : cranium_body;
  for (int i = 0; i < of.lines; ++i) {
    const double t = of.lines > 1 ? static_cast<double>(i) / (of.lines - 1) - 0.5 : 0;
    muscle.lines.push_back(line_between(a + t * of.width_mm * across,
                                        b + t * of.end_width_mm * across, bone, of.from_depth,
                                        of.to_depth));
  }
  return muscle;
}

/// A closed loop around the mouth.
FaceMuscle loop(const Case& patient, const char* kind, double half_wide, double half_high,
                double width, int lines, double limit_N, double depth) {
  FaceMuscle muscle{.name = kind, .kind = kind, .limit_N = limit_N, .shortening = 0.3, .lines = {}};
  const Vector3d left = landmark(patient, "left_cheilion"),
                 right = landmark(patient, "right_cheilion");
  const Vector3d upper = landmark(patient, "labrale_superius"),
                 lower = landmark(patient, "labrale_inferius");
  const Vector3d corners = 0.5 * (left + right), middle = 0.5 * (upper + lower);
  const double reach = 0.5 * (left - right).norm();
  for (int i = 0; i < lines; ++i) {
    const double t = lines > 1 ? (static_cast<double>(i) / (lines - 1) - 0.5) * width : 0;
    const double a = half_wide + t, b = half_high + t;
    const int count = 32;
    std::vector<FaceMusclePoint> line;
    for (int n = 0; n <= count; ++n) {
      const double angle = 2 * std::numbers::pi * n / count;
      const double x = a * std::cos(angle), z = b * std::sin(angle);
      const double back = std::min(1.0, std::abs(x) / reach);
      line.push_back(
          {.at = Vector3d(middle.x() + x, middle.y() + (corners.y() - middle.y()) * back * back,
                          middle.z() + z),
           .depth = depth});
    }
    muscle.lines.push_back(std::move(line));
  }
  return muscle;
}

}  // namespace

std::string missing_face_landmark(const Case& patient) {
  for (const char* mark : {"left_malar", "right_malar", "left_cheilion", "right_cheilion",
                           "left_orbitale", "right_orbitale", "left_soft_gonion",
                           "right_soft_gonion", "left_mental_foramen", "right_mental_foramen",
                           "infradentale", "soft_pogonion", "labrale_superius", "labrale_inferius"})
    if (!patient.landmarks.find(mark)) return mark;
  return {};
}

std::vector<FaceMuscle> default_face_muscles(const Case& patient) {
  if (!missing_face_landmark(patient).empty()) return {};
  std::vector<FaceMuscle> muscles;
  for (const Side& side : {Side{"left", 1}, Side{"right", -1}}) {
    for (const Straight& of : straight_muscles()) muscles.push_back(straight(patient, of, side));
    FaceMuscle mentalis{.name = std::string(side.name) + "_mentalis",
                        .kind = "mentalis",
                        .limit_N = 9,
                        .shortening = 0.25,
                        .lines = {}};
    for (const double t : {0.0, 3.0})
      mentalis.lines.push_back(
          line_between(landmark(patient, "infradentale") + Vector3d(side.sign * (5 + t), 1.5, -5),
                       landmark(patient, "soft_pogonion") + Vector3d(side.sign * (6 + t), 1, 3),
                       patient.jaw.lower_arch, 0.8, 0.3));
    muscles.push_back(mentalis);
  }
  muscles.push_back(loop(patient, "orbicularis_oris_marginal", 28, 7, 4, 2, 6, 0.3));
  muscles.push_back(loop(patient, "orbicularis_oris_peripheral", 32, 17, 8, 3, 9, 0.9));
  return muscles;
}

}  // namespace condyle
