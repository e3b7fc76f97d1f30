#include "sim/muscles/default_face_muscles.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "sim/case/eyes.h"

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
      {"mentalis", "infradentale", {6.5, 1.5, -5}, true, true, "soft_pogonion",
       {7.5, 1, 3}, 3, 3, 2, 9, 0.25, 0.8, 0.3},
      {"frontalis_medial", "endocanthion", {-5, 3, 55}, false, false, "endocanthion",
       {0, -10, 20}, 14, 14, 3, 16, 0.42, 0.5, 0.4},
      {"frontalis_lateral", "endocanthion", {16, 12, 55}, false, false, "endocanthion",
       {22, -3, 21}, 16, 16, 3, 16, 0.42, 0.5, 0.4},
      {"corrugator", "endocanthion", {-12.3, -9, 18}, false, true, "endocanthion",
       {9.7, -7, 23}, 5, 8, 2, 20, 0.5, 0.8, 0.3},
      {"procerus", "endocanthion", {-15.3, -12.5, 2}, false, true, "endocanthion",
       {-12, -18, 27}, 3, 8, 2, 14, 0.42, 0.7, 0.3},
  };
  // clang-format on
  return all;
}

struct Loop {
  const char* kind;
  double half_wide_mm, half_high_mm, width_mm;
  int lines;
  double limit_N, shortening, depth, spread_mm;
};

/// Only a deep loop, on the teeth's side, brings the lips forward.
const std::vector<Loop>& loops() {
  static const std::vector<Loop> all = {
      {"orbicularis_oris_marginal", 28, 7, 4, 2, 6, 0.3, 0.3, 0},
      {"orbicularis_oris_peripheral", 28, 14, 6, 3, 20, 0.42, 0.9, 3},
  };
  return all;
}

/// The outer part of orbicularis oculi from the inner to the outer rim of the orbit: `middle` is
/// the place between them, each a landmark and an offset.
struct EyeArc {
  struct Place {
    const char* mark;
    Vector3d offset;
  };
  const char* kind;
  Place inner, outer, middle;
  double limit_N, shortening, depth, width_mm;
  int lines;
};

const std::vector<EyeArc>& eye_arcs() {
  static const std::vector<EyeArc> all = {
      {"orbicularis_oculi",
       {"orbit_medial_rim", {0, 0, 0}},
       {"orbit_lateral_rim", {4, 1, 0}},
       {"orbitale", {2, -4, -10}},
       4,
       0.2,
       0.4,
       8,
       2},
      {"orbicularis_oculi_superior",
       {"endocanthion", {-7.3, -2, 4.4}},
       {"exocanthion", {5.8, 8, 2.5}},
       {"endocanthion", {13.7, -4.6, 21}},
       3,
       0.15,
       0.4,
       6,
       2},
  };
  return all;
}

struct Side {
  const char* name;
  double sign;
};

/// Where landmarks are; none when one is missing.
std::optional<Vector3d> placed(const Case& patient, const Side& side, const char* mark,
                               const Vector3d& offset) {
  auto found = patient.landmarks.find(std::string(side.name) + "_" + mark);
  if (!found) found = patient.landmarks.find(mark);
  if (!found) return std::nullopt;
  return *found + Vector3d(side.sign, 1, 1).cwiseProduct(offset);
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

std::optional<FaceMuscle> straight(const Case& patient, const Straight& of, const Side& side) {
  const auto a = placed(patient, side, of.origin, of.from),
             b = placed(patient, side, of.insertion, of.to);
  if (!a || !b) return std::nullopt;
  FaceMuscle muscle{.name = std::string(side.name) + "_" + of.kind,
                    .kind = of.kind,
                    .limit_N = of.limit_N,
                    .shortening = of.shortening,
                    .lines = {}};
  const Vector3d out = Vector3d(side.sign * 0.6, -0.8, 0);
  const Vector3d across = (*b - *a).cross(out).normalized();
  std::optional<BodyId> bone;
  if (of.on_bone) bone = of.on_mandible ? patient.jaw.lower_arch : cranium_body;
  for (int i = 0; i < of.lines; ++i) {
    const double t = of.lines > 1 ? static_cast<double>(i) / (of.lines - 1) - 0.5 : 0;
    muscle.lines.push_back(line_between(*a + t * of.width_mm * across,
                                        *b + t * of.end_width_mm * across, bone, of.from_depth,
                                        of.to_depth));
  }
  return muscle;
}

/// A closed loop around the mouth.
std::optional<FaceMuscle> loop(const Case& patient, const Loop& of) {
  const auto left = patient.landmarks.find("left_cheilion"),
             right = patient.landmarks.find("right_cheilion"),
             upper = patient.landmarks.find("labrale_superius"),
             lower = patient.landmarks.find("labrale_inferius");
  if (!left || !right || !upper || !lower) return std::nullopt;
  FaceMuscle muscle{.name = of.kind,
                    .kind = of.kind,
                    .limit_N = of.limit_N,
                    .shortening = of.shortening,
                    .lines = {}};
  const Vector3d corners = 0.5 * (*left + *right), middle = 0.5 * (*upper + *lower);
  const double reach = 0.5 * (*left - *right).norm();
  for (int i = 0; i < of.lines; ++i) {
    const double t =
        of.lines > 1 ? (static_cast<double>(i) / (of.lines - 1) - 0.5) * of.width_mm : 0;
    const double a = of.half_wide_mm + t, b = of.half_high_mm + t;
    constexpr int count = 32;
    std::vector<FaceMusclePoint> line;
    for (int n = 0; n <= count; ++n) {
      const double angle = 2 * std::numbers::pi * n / count;
      const double x = a * std::cos(angle), z = b * std::sin(angle);
      const double back = std::min(1.0, std::abs(x) / reach);
      line.push_back(
          {.at = Vector3d(middle.x() + x, middle.y() + (corners.y() - middle.y()) * back * back,
                          middle.z() + z),
           .depth = of.depth,
           .spread_mm = of.spread_mm});
    }
    muscle.lines.push_back(std::move(line));
  }
  return muscle;
}

std::optional<FaceMuscle> eye_arc(const Case& patient, const EyeArc& of, const Side& side) {
  const auto inner = placed(patient, side, of.inner.mark, of.inner.offset),
             outer = placed(patient, side, of.outer.mark, of.outer.offset),
             middle = placed(patient, side, of.middle.mark, of.middle.offset);
  if (!inner || !outer || !middle) return std::nullopt;
  FaceMuscle muscle{.name = std::string(side.name) + "_" + of.kind,
                    .kind = of.kind,
                    .limit_N = of.limit_N,
                    .shortening = of.shortening,
                    .lines = {}};
  const Vector3d center = 0.5 * (*inner + *outer), across = *inner - center,
                 away = *middle - center;
  for (int i = 0; i < of.lines; ++i) {
    const double t = (static_cast<double>(i) / (of.lines - 1) - 0.5) * of.width_mm;
    constexpr int count = 16;
    std::vector<FaceMusclePoint> line;
    for (int n = 0; n <= count; ++n) {
      const double angle = std::numbers::pi * n / count;
      line.push_back({.at = center + std::cos(angle) * across +
                            std::sin(angle) * (away + t * away.normalized()),
                      .depth = of.depth});
    }
    line.front().bone = line.back().bone = cranium_body;
    muscle.lines.push_back(std::move(line));
  }
  return muscle;
}

/// Force and shortening of a kind as the default muscles have them.
void give_strength(FaceMuscle& muscle) {
  const auto give = [&](const char* kind, double limit_N, double shortening) {
    if (muscle.kind != kind) return;
    if (muscle.limit_N <= 0) muscle.limit_N = limit_N;
    if (muscle.shortening <= 0) muscle.shortening = shortening;
  };
  for (const Straight& of : straight_muscles()) give(of.kind, of.limit_N, of.shortening);
  for (const Loop& of : loops()) give(of.kind, of.limit_N, of.shortening);
  for (const EyeArc& of : eye_arcs()) give(of.kind, of.limit_N, of.shortening);
}

/// A landmark that is missing where one of the patient's own muscles begins, as the default one of
/// its kind begins at it.
void add_origins(const std::vector<FaceMuscle>& own, Case& patient) {
  for (const Side& side : {Side{"left", 1}, Side{"right", -1}})
    for (const Straight& of : straight_muscles()) {
      const std::string name = std::string(side.name) + "_" + of.origin;
      if (!of.on_bone || patient.landmarks.find(name) || patient.landmarks.find(of.origin))
        continue;
      const auto muscle = std::find_if(own.begin(), own.end(), [&](const FaceMuscle& one) {
        return one.name == std::string(side.name) + "_" + of.kind;
      });
      if (muscle == own.end()) continue;
      Vector3d origin = Vector3d::Zero();
      for (const auto& line : muscle->lines)
        origin += line.front().at / static_cast<double>(muscle->lines.size());
      patient.landmarks.points[name] = origin - Vector3d(side.sign, 1, 1).cwiseProduct(of.from);
    }
}

/// Canthi that are not marked, by the openings of the eyes.
void mark_canthi(const Case& patient, Landmarks& landmarks) {
  const Part* face = patient.find(Role::face);
  if (!face) return;
  const auto eyes = find_eyes(face->mesh, landmarks);
  if (!eyes) return;
  landmarks.points.emplace("left_endocanthion", eyes->left.inner);
  landmarks.points.emplace("left_exocanthion", eyes->left.outer);
  landmarks.points.emplace("right_endocanthion", eyes->right.inner);
  landmarks.points.emplace("right_exocanthion", eyes->right.outer);
}

}  // namespace

std::string missing_face_landmark(const Case& patient) {
  if (!patient.face_muscles.empty()) return {};
  for (const char* mark : {"left_cheilion", "right_cheilion", "labrale_superius",
                           "labrale_inferius", "left_malar", "right_malar"})
    if (!patient.landmarks.find(mark)) return mark;
  return {};
}

std::vector<FaceMuscle> default_face_muscles(const Case& patient) {
  std::vector<FaceMuscle> muscles;
  for (const Side& side : {Side{"left", 1}, Side{"right", -1}}) {
    for (const Straight& of : straight_muscles())
      if (auto muscle = straight(patient, of, side)) muscles.push_back(std::move(*muscle));
    for (const EyeArc& of : eye_arcs())
      if (auto muscle = eye_arc(patient, of, side)) muscles.push_back(std::move(*muscle));
  }
  for (const Loop& of : loops())
    if (auto muscle = loop(patient, of)) muscles.push_back(std::move(*muscle));
  return muscles;
}

std::vector<FaceMuscle> muscles_of_face(const Case& patient) {
  std::vector<FaceMuscle> muscles = patient.face_muscles;
  for (FaceMuscle& muscle : muscles) {
    give_strength(muscle);
    for (auto& line : muscle.lines)
      for (FaceMusclePoint& point : line)
        if (point.bone == mandible_body) point.bone = patient.jaw.lower_arch;
  }
  const std::size_t own = muscles.size();
  Case marked;  // what the default muscles need
  marked.landmarks = patient.landmarks;
  marked.jaw = patient.jaw;
  mark_canthi(patient, marked.landmarks);
  add_origins(muscles, marked);
  for (FaceMuscle& other : default_face_muscles(marked))
    if (std::none_of(muscles.begin(), muscles.begin() + static_cast<std::ptrdiff_t>(own),
                     [&](const FaceMuscle& muscle) { return muscle.kind == other.kind; }))
      muscles.push_back(std::move(other));
  return muscles;
}

}  // namespace condyle
