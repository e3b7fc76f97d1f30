#include "tools/demo/skull_landmarks.h"

#include <cmath>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

// Of the greatest length of the brain case: adult skulls of 180 mm have nasion 100 mm below the
// vertex and 26 mm above the Frankfort plane, porions 95 mm behind nasion and 110 mm apart, and
// orbitales 60 mm apart.
constexpr double vertex_to_nasion = 0.555, nasion_to_frankfort = 0.145, nasion_to_porion = 0.53;
constexpr double half_porions = 0.31, half_orbitales = 0.167, orbitale_behind_nasion = 0.03;
constexpr double basion_below_porion = 0.06;

}  // namespace

Landmarks estimate_skull_landmarks(const TriMesh& skull) {
  const Box whole = bounding_box(skull);
  Box vault;  // its upper part, without face and jaw
  for (const Vector3d& p : skull.vertices)
    if (p.z() > whole.high.z() - 70) vault.add(p);
  const double length = vault.high.y() - vault.low.y(), middle = vault.center().x();
  if (!(length > 100 && length < 260))
    throw InputError("the skull's brain case is " + std::to_string(static_cast<int>(length)) +
                     " mm long; expected 100 to 260 mm: is it in mm, with z up and y back?");
  Vector3d nasion(middle, whole.high.y(), vault.high.z() - vertex_to_nasion * length);
  for (const Vector3d& p : skull.vertices)  // the foremost point of the midline at that height
    if (std::abs(p.x() - middle) < 5 && std::abs(p.z() - nasion.z()) < 4)
      nasion.y() = std::min(nasion.y(), p.y());
  const double frankfort = nasion.z() - nasion_to_frankfort * length;
  const double ear = nasion.y() + nasion_to_porion * length;
  const double eye = nasion.y() + orbitale_behind_nasion * length;
  Landmarks landmarks;
  landmarks.points = {{"nasion", nasion},
                      {"basion", {middle, ear, frankfort - basion_below_porion * length}},
                      {"left_porion", {middle + half_porions * length, ear, frankfort}},
                      {"right_porion", {middle - half_porions * length, ear, frankfort}},
                      {"left_orbitale", {middle + half_orbitales * length, eye, frankfort}},
                      {"right_orbitale", {middle - half_orbitales * length, eye, frankfort}}};
  return landmarks;
}

}  // namespace condyle
