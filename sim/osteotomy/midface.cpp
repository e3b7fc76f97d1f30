#include "sim/osteotomy/midface.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace condyle {
namespace {

using Eigen::Vector3d;

/// The highest point of the roots of a tooth on both sides, by mesh, else by landmark.
std::optional<Vector3d> highest_root(const SurgicalAnatomy& jaw, std::initializer_list<int> teeth,
                                     const std::string& apex) {
  std::optional<Vector3d> best;
  const auto add = [&](const Vector3d& p) {
    if (!best || p.z() > best->z()) best = p;
  };
  for (const int fdi : teeth)
    for (const auto& p : jaw.tooth_points(fdi)) add(p);
  for (const Side side : both_sides)
    if (const auto p = jaw.find("upper_" + name_of(side) + apex)) add(*p);
  return best;
}

void estimate(SurgicalAnatomy& jaw, const std::string& what, const std::string& how) {
  jaw.notes.push_back(what + " estimated: " + how);
}

}  // namespace

Midface find_midface(SurgicalAnatomy& jaw) {
  Midface face;
  const Vector3d incisal = jaw.need("upper_incisal_point");
  face.incisal_z = incisal.z();
  if (const auto canine = highest_root(jaw, {13, 23}, "_canine_apex")) {
    face.canine_y = canine->y(), face.canine_z = canine->z();
  } else {
    face.canine_y = incisal.y() + 14, face.canine_z = incisal.z() + 23;
    estimate(jaw, "canine apices are", "23 mm above and 14 mm behind the upper incisal edges");
  }
  if (const auto molar = highest_root(jaw, {16, 17, 26, 27}, "_first_molar_mesiobuccal_apex")) {
    face.molar_y = molar->y(), face.molar_z = molar->z();
    face.widest_root = std::abs(molar->x()) + 5;
    for (const int fdi : {16, 17, 26, 27})
      for (const auto& p : jaw.tooth_points(fdi))
        if (p.z() > molar->z() - 10) face.widest_root = std::max(face.widest_root, std::abs(p.x()));
  } else {
    face.molar_y = incisal.y() + 32, face.molar_z = incisal.z() + 21;
    face.widest_root = 30;
    estimate(jaw, "molar apices are", "21 mm above and 32 mm behind the upper incisal edges");
  }
  if (const auto ans = jaw.find("ans")) {
    face.front_y = ans->y(), face.floor_z = ans->z();
  } else {
    face.front_y = incisal.y(), face.floor_z = face.canine_z;
    estimate(jaw, "the anterior nasal spine is", "above the upper incisal edges");
  }
  if (const auto pns = jaw.find("pns")) {
    face.back_y = pns->y();
  } else {
    face.back_y = incisal.y() + 51;
    estimate(jaw, "the posterior nasal spine is", "51 mm behind the upper incisal edges");
  }
  if (const auto left = jaw.find("left_zygomaxillare"))
    if (const auto right = jaw.find("right_zygomaxillare"))
      face.crest = Vector3d(std::min(left->x(), -right->x()), 0.5 * (left->y() + right->y()),
                            std::min(left->z(), right->z()));
  return face;
}

Vector3d paired_point(const SurgicalAnatomy& skull, const std::string& name) {
  const Vector3d left = skull.need("left_" + name), right = skull.need("right_" + name);
  return 0.5 * (left + Vector3d(-right.x(), right.y(), right.z()));
}

}  // namespace condyle
