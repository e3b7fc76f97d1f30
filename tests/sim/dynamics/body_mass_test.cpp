#include "sim/dynamics/body_mass.h"

#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "tests/support/boxes.h"

namespace condyle {
namespace {

constexpr double bone_kg_mm3 = 1.9e-6;

Part block(Role role, double low_x, double size, BodyId body) {
  return {.name = "block",
          .role = role,
          .mesh = test::box({low_x, 0, 0}, {low_x + size, size, size}),
          .teeth = {},
          .body = body};
}

}  // namespace

TEST(BodyMass, JoinsThePartsOfABody) {
  Case patient;
  patient.parts = {block(Role::mandible, 0, 10, mandible_body),
                   block(Role::mandible, 20, 10, mandible_body),
                   block(Role::skull, 0, 40, cranium_body)};
  const MassProperties mass = body_mass(patient, mandible_body);
  EXPECT_NEAR(mass.mass_kg, 2000 * bone_kg_mm3, 1e-12);
  EXPECT_NEAR(mass.center.x(), 15, 1e-9);
  // Two cubes: m s^2 / 6 each, and 10 mm from the common centre.
  EXPECT_NEAR(mass.inertia(1, 1), 2000 * bone_kg_mm3 * (100.0 / 6 + 100), 1e-9);
  EXPECT_NEAR(body_mass(patient, cranium_body).mass_kg, 64000 * bone_kg_mm3, 1e-12);
}

TEST(BodyMass, CrownsCountOnlyWithoutOtherBone) {
  Case patient;
  patient.parts = {block(Role::lower_teeth, 0, 5, mandible_body)};
  EXPECT_NEAR(body_mass(patient, mandible_body).mass_kg, 125 * bone_kg_mm3, 1e-12);
  patient.parts.push_back(block(Role::mandible, 0, 10, mandible_body));
  EXPECT_NEAR(body_mass(patient, mandible_body).mass_kg, 1000 * bone_kg_mm3, 1e-12);
}

TEST(BodyMass, MeasuredValuesBelongToTheLowerArch) {
  Case patient;
  patient.parts = {block(Role::mandible, 0, 10, mandible_body)};
  const BodyId segment =
      patient.add_piece(block(Role::segment, 0, 10, mandible_body), mandible_body);
  patient.mechanics.emplace().mandible.mass_kg = 0.2;
  EXPECT_EQ(body_mass(patient, mandible_body).mass_kg, 0.2);
  EXPECT_NEAR(body_mass(patient, segment).mass_kg, 1000 * bone_kg_mm3, 1e-12);
}

TEST(BodyMass, OpenSurfacesCountAsABox) {
  Case patient;
  patient.parts = {block(Role::mandible, 0, 100, mandible_body)};
  patient.parts[0].mesh.triangles.pop_back();
  const MassProperties mass = body_mass(patient, mandible_body);
  EXPECT_GT(mass.mass_kg, 0.1);
  EXPECT_LT(mass.mass_kg, 0.4);
  EXPECT_NEAR(mass.center.x(), 50, 1e-9);
}

TEST(BodyMass, ABodyWithoutBoneHasNone) {
  Case patient;
  patient.name = "nobody";
  EXPECT_THROW(body_mass(patient, mandible_body), InputError);
}

}  // namespace condyle
