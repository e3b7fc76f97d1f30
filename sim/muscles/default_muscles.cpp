#include "sim/muscles/default_muscles.h"

#include <array>

#include "engine/core/error.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using B = MuscleBody;

/// Attachments: to the left, forward and up from the midpoint of the condyles, mm, for a jaw with
/// condyles 101 mm apart and 90.6 mm from them to the incisors; those on hyoid and neck from the
/// centre of the hyoid.
struct DefaultMuscle {
  const char* kind;
  const char* full_name;
  const char* group;
  B from, to;
  std::array<double, 3> origin, insertion;
  double max_force_N, tendon_ratio, stretch;  // stretch: maximum over optimal length
};

const std::array<DefaultMuscle, 17> default_table = {{
    {"at",
     "Anterior Temporal",
     "closer",
     B::cranium,
     B::mandible,
     {58, 41, 60},
     {44, 28, -8},
     158,
     0.5,
     1.3},
    {"mt",
     "Middle Temporal",
     "closer",
     B::cranium,
     B::mandible,
     {70, 2, 66},
     {46, 29, -1},
     95.6,
     0.5,
     1.4},
    {"pt",
     "Posterior Temporal",
     "closer",
     B::cranium,
     B::mandible,
     {69, -20, 28},
     {46, 28, -1},
     75.6,
     0.5,
     1.3},
    {"sm",
     "Superficial Masseter",
     "closer",
     B::cranium,
     B::mandible,
     {56, 36, -5},
     {47, 13, -50},
     190.4,
     0.45,
     1.3},
    {"dm",
     "Deep Masseter",
     "closer",
     B::cranium,
     B::mandible,
     {61, 21, 1},
     {48, 14, -25},
     81.6,
     0.3,
     1.5},
    {"mp",
     "Medial Pterygoid",
     "closer",
     B::cranium,
     B::mandible,
     {22, 21, -5},
     {43, 10, -50},
     174.8,
     0.6,
     1.3},
    {"sp",
     "Superior Lateral Pterygoid",
     "protruder_opener",
     B::cranium,
     B::mandible,
     {38, 20, 9},
     {48, 1, 1},
     28.7,
     0,
     1.35},
    {"ip",
     "Inferior Lateral Pterygoid",
     "protruder_opener",
     B::cranium,
     B::mandible,
     {23, 21, -1},
     {48, 1, -3},
     66.9,
     0,
     1.35},
    {"ad",
     "Anterior Digastric",
     "opener",
     B::mandible,
     B::hyoid,
     {8, 66, -80},
     {13, -3, 1},
     40,
     0,
     1.3},
    {"am",
     "Anterior Mylohyoid",
     "opener",
     B::mandible,
     B::hyoid,
     {22, 52, -66},
     {1, 3, -1},
     35.4,
     0,
     1.3},
    {"pm",
     "Posterior Mylohyoid",
     "opener",
     B::mandible,
     B::hyoid,
     {30, 31, -50},
     {8, 1, -1},
     35.4,
     0,
     1.3},
    {"gh", "Geniohyoid", "opener", B::mandible, B::hyoid, {2, 64, -76}, {1, 1, 0}, 32, 0, 1.3},
    {"pd",
     "Posterior Digastric",
     "hyoid",
     B::cranium,
     B::hyoid,
     {51, -19, -8},
     {14, -3, 1},
     40,
     0,
     1.3},
    {"sh", "Stylohyoid", "hyoid", B::cranium, B::hyoid, {40, -12, -14}, {14, -3, 1}, 15.6, 0, 1.3},
    {"th", "Thyrohyoid", "hyoid", B::hyoid, B::neck, {17, -3, -4}, {16, -14, -19}, 20, 0.5, 1.3},
    {"steh", "Sternohyoid", "hyoid", B::hyoid, B::neck, {3, 4, -8}, {9, -3, -92}, 50, 0.5, 1.3},
    {"oh", "Omohyoid", "hyoid", B::hyoid, B::neck, {9, 3, -8}, {12, -9, -54}, 50, 0.5, 1.3},
}};

constexpr double default_width_mm = 101, default_depth_mm = 90.6;
const Vector3d default_hyoid(0, 30, -80);  // in the axes of the attachments
constexpr double passive_fraction = 0.015;

Vector3d landmark(const Case& patient, const char* name) {
  const auto point = patient.landmarks.find(name);
  if (!point)
    throw InputError(patient.name + ": the landmark " + name +
                     " is missing; muscles cannot be fitted to the jaw without it");
  return *point;
}

}  // namespace

std::vector<Muscle> default_muscles(const Case& patient) {
  const Vector3d left = landmark(patient, "left_condyle"),
                 right = landmark(patient, "right_condyle"),
                 incisor = landmark(patient, "lower_incisal_point");
  const Vector3d middle = 0.5 * (left + right);
  const double depth = (incisor - middle).norm(), width = (left - right).norm();
  if (!(depth > 20 && depth < 300 && width > 20 && width < 300))
    throw InputError(patient.name + ": the condyles are " + std::to_string(width) +
                     " mm apart and " + std::to_string(depth) +
                     " mm from the incisors; no jaw is like that");
  const double scale = depth / default_depth_mm;
  const auto scaled_point = [&](const Vector3d& from, const Vector3d& p) {
    return Vector3d(from +
                    Vector3d(p.x() * width / default_width_mm, -scale * p.y(), scale * p.z()));
  };
  const Vector3d hyoid =
      patient.landmarks.find("hyoid").value_or(scaled_point(middle, default_hyoid));

  std::vector<Muscle> muscles;
  for (const DefaultMuscle& entry : default_table)
    for (const double side : {1.0, -1.0}) {
      const auto at = [&](B body, const std::array<double, 3>& p) {
        return scaled_point(body == B::hyoid || body == B::neck ? hyoid : middle,
                            {side * p[0], p[1], p[2]});
      };
      Muscle m;
      m.kind = entry.kind;
      m.name = (side > 0 ? "l" : "r") + m.kind;
      m.full_name = entry.full_name;
      m.group = entry.group;
      m.origin_body = entry.from;
      m.insertion_body = entry.to;
      m.origin = at(entry.from, entry.origin);
      m.insertion = at(entry.to, entry.insertion);
      m.max_force_N = entry.max_force_N;
      m.optimal_length_mm = (m.origin - m.insertion).norm();
      m.max_length_mm = entry.stretch * m.optimal_length_mm;
      m.tendon_ratio = entry.tendon_ratio;
      m.passive_fraction = passive_fraction;
      muscles.push_back(m);
    }
  return muscles;
}

std::vector<Muscle> muscles_of(const Case& patient) {
  return patient.muscles.empty() ? default_muscles(patient) : patient.muscles;
}

std::optional<Vector3d> hyoid_center(const std::vector<Muscle>& muscles) {
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  for (const Muscle& m : muscles) {
    if (m.origin_body == B::hyoid) sum += m.origin, ++count;
    if (m.insertion_body == B::hyoid) sum += m.insertion, ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

}  // namespace condyle
