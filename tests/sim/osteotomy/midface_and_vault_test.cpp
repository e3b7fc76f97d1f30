// Osteotomies of the midface and the brain case, on the built-in skull and variants of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "tests/sim/osteotomy/osteotomies.h"

namespace condyle::test {
namespace {

struct ExpectedSegments {
  CutStep step;
  std::vector<std::string> segments;  // "": what stays with the cranium
};

const std::vector<ExpectedSegments>& skull_osteotomies() {
  static const std::vector<ExpectedSegments> all = {
      {named("le_fort_2", {}, 0), {"", "midface"}},
      {named("le_fort_3"), {"", "midface"}},
      {named("vault_strip", {}, 1.2), {"", "strip"}},
      {named("vault_panels", {}, 1.2), {"", "strip", "panel_left", "panel_right"}},
      {named("vault_panels", {{"strip_mm", 0}, {"columns", 2}}, 1.2),
       {"", "panel_left_1", "panel_left_2", "panel_right_1", "panel_right_2"}},
      {named("bandeau", {}, 1.2), {"", "bandeau", "frontal_bone"}},
      {named("bandeau", {{"frontal", 0}, {"tenon_mm", 0}}, 1.2), {"", "bandeau"}}};
  return all;
}

/// Deviation of the pieces and the kerf from the bone, relative to it.
double volume_error(const Case& patient, const Operated& done) {
  double sum = done.result.kerf_volume_mm3;
  for (const Piece& piece : done.result.pieces) sum += piece.volume_mm3;
  const double whole = signed_volume(part_named(patient, done.placed.part).mesh);
  return std::abs(sum - whole) / whole;
}

void expect_all_parted(const Case& patient) {
  for (const auto& [step, segments] : skull_osteotomies()) {
    SCOPED_TRACE(step_title(step));
    const Operated done = operate(patient, step);
    expect_parted(done, segments);
    EXPECT_LT(volume_error(patient, done), 1e-6);
  }
}

double volume(const Operated& done, const std::string& segment) {
  return done.piece(segment).volume_mm3;
}

}  // namespace

TEST(MidfaceAndVault, ArePartedOnTheBuiltInSkull) { expect_all_parted(builtin()); }

TEST(MidfaceAndVault, ArePartedOnALongNarrowSkull) {
  expect_all_parted(
      reshaped_head(builtin(), {.variant = HeadChoice::Variant::scaphocephaly, .seed = 0}));
}

TEST(MidfaceAndVault, ArePartedOnAnotherHead) {
  expect_all_parted(
      reshaped_head(builtin(), {.variant = HeadChoice::Variant::standard, .seed = 5}));
}

TEST(MidfaceAndVault, ALeFort3TakesMoreThanALeFort2AndThatMoreThanALeFort1) {
  const double third = volume(operate(builtin(), named("le_fort_3")), "midface"),
               second = volume(operate(builtin(), named("le_fort_2")), "midface"),
               first = volume(operate(builtin(), named("le_fort_1")), "maxilla");
  EXPECT_GT(third, second + 10000);
  EXPECT_GT(second, first + 10000);
}

TEST(MidfaceAndVault, PanelsOfBothSidesAreAlikeAndGrowWithTheirHeight) {
  const Operated done = operate(builtin(), named("vault_panels", {}, 1.2));
  EXPECT_NEAR(volume(done, "panel_left"), volume(done, "panel_right"), 1);
  const Operated lower = operate(builtin(), named("vault_panels", {{"height_mm", 40}}, 1.2));
  EXPECT_LT(volume(lower, "panel_left"), volume(done, "panel_left") - 5000);
}

TEST(MidfaceAndVault, StavesStayWithTheSkull) {
  const Operated done = operate(builtin(), named("barrel_staves", {{"slits", 4}}, 2));
  ASSERT_EQ(done.result.outcomes.size(), 8U);
  for (const CutOutcome& outcome : done.result.outcomes) {
    EXPECT_TRUE(outcome.meets_bone);
    EXPECT_TRUE(outcome.open_on_purpose);
  }
  ASSERT_EQ(done.result.pieces.size(), 1U);
  EXPECT_TRUE(inspect(done.result.pieces[0].mesh).closed());
  EXPECT_LT(volume_error(builtin(), done), 1e-6);
  // Eight slits of 40 x 2 mm through some 7 mm of bone.
  EXPECT_NEAR(done.result.kerf_volume_mm3, 8 * 40 * 2 * 7, 2000);
}

TEST(MidfaceAndVault, ASkullWithoutVaultIsRefused) {
  Case patient = builtin();
  for (Part& part : patient.parts)
    for (auto& p : part.mesh.vertices) p.z() = std::min(p.z(), 25.0);
  try {
    place_osteotomy(patient, named("vault_strip"));
    ADD_FAILURE() << "a strip was placed";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("vault"), std::string::npos) << error.what();
  }
}

}  // namespace condyle::test
