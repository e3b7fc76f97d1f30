#include <vector>

#include "engine/field/primitives.h"
#include "sim/phantom/surfaces.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double mandibular_canal_mm = 3;

/// Inside the left half of the mandible, from below the lingula to the bend before the foramen.
const std::vector<Vector3d> canal_course = {
    {40.4, -30.3, -43.0}, {39.4, -31.5, -48}, {38.0, -33.5, -53}, {36.4, -36.5, -58},
    {35.0, -40, -62},     {33.6, -44, -65},   {32.2, -48, -67.3}, {30.6, -52, -69.2},
    {29.0, -56, -71},     {27.2, -60, -72.8}, {25.3, -64, -74.4}, {23.6, -68, -75.9},
    {22.2, -72, -77.2},   {22.3, -75, -77.4}, {23.8, -76.8, -76}};

}  // namespace

std::vector<Canal> phantom_canals(const Landmarks& landmarks) {
  std::vector<Eigen::VectorXd> knots{landmarks.points.at("left_lingula")};
  knots.insert(knots.end(), canal_course.begin(), canal_course.end());
  knots.push_back(landmarks.points.at("left_mental_foramen"));
  Canal left{"left_mandibular_canal", mandible_body, mandibular_canal_mm, {}},
      right{"right_mandibular_canal", mandible_body, mandibular_canal_mm, {}};
  for (const auto& p : catmull_rom(knots, 3)) {
    left.points.emplace_back(p);
    right.points.emplace_back(-p.x(), p.y(), p.z());
  }
  return {left, right};
}

}  // namespace condyle
