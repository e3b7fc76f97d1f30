// Heads other than the built-in patient, measured as a planner measures them.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"
#include "sim/plan/case_geometry.h"
#include "sim/plan/cephalometry.h"
#include "tests/support/builtin.h"

namespace condyle {
namespace {

Case head(const HeadChoice& choice) { return reshaped_head(test::builtin(), choice); }

double measured(const Case& patient, const std::string& name) {
  for (const auto& measure :
       cephalometry(clinical_frame(patient.landmarks), patient.landmarks, patient.landmarks))
    if (measure.name == name) return measure.before.value();
  throw std::runtime_error("no measure " + name);
}

/// Width of the brain case by its length, in percent.
double cephalic_index(const Case& patient) {
  Box box;
  for (const Part& part : patient.parts)
    if (part.role == Role::skull)
      for (const auto& p : part.mesh.vertices)
        if (p.z() > 40) box.add(p);
  return 100 * box.size().x() / box.size().y();
}

void expect_whole(const Case& patient) {
  const Case& standard = test::builtin();
  ASSERT_EQ(patient.parts.size(), standard.parts.size());
  for (std::size_t i = 0; i < patient.parts.size(); ++i) {
    const Part &part = patient.parts[i], &as = standard.parts[i];
    EXPECT_EQ(part.mesh.triangles.size(), as.mesh.triangles.size()) << part.name;
    EXPECT_EQ(inspect(part.mesh).closed(), inspect(as.mesh).closed()) << part.name;
    const double volume = signed_volume(part.mesh), before = signed_volume(as.mesh);
    EXPECT_GT(volume / before, 0.7) << part.name;
    EXPECT_LT(volume / before, 1.4) << part.name;
  }
}

}  // namespace

TEST(HeadVariants, TheStandardHeadWithoutASeedKeepsItsBits) {
  EXPECT_TRUE(HeadChoice{}.is_default());
  EXPECT_EQ(geometry_of(head({})), geometry_of(test::builtin()));
}

TEST(HeadVariants, ClassIIIHasAReverseOverjetAndTheSameJoints) {
  const Case patient = head({.variant = HeadChoice::Variant::class_iii, .seed = 0});
  expect_whole(patient);
  EXPECT_NEAR(measured(patient, "overjet"), -6.5, 0.5);
  EXPECT_NEAR(measured(patient, "ANB"), -3, 1.5);
  EXPECT_GT(measured(patient, "overbite"), 0);
  EXPECT_GT(measured(patient, "lower lip to E line"),
            measured(test::builtin(), "lower lip to E line") + 1)
      << "the face follows the bones";
  const auto& standard = test::builtin().landmarks;
  for (const char* name : {"left_condyle", "right_condyle"})
    EXPECT_LT((*patient.landmarks.find(name) - *standard.find(name)).norm(), 1e-9) << name;
}

TEST(HeadVariants, ScaphocephalyIsLongAndNarrowWithTheSameFace) {
  const Case patient = head({.variant = HeadChoice::Variant::scaphocephaly, .seed = 0});
  expect_whole(patient);
  EXPECT_GT(cephalic_index(test::builtin()), 72);
  EXPECT_LT(cephalic_index(patient), 70);
  for (const char* name : {"overjet", "ANB", "FMA (Frankfort to Go-Me)"})
    EXPECT_NEAR(measured(patient, name), measured(test::builtin(), name), 0.1) << name;
}

TEST(HeadVariants, SeedsGiveHeadsWithinHumanBounds) {
  double least_anb = 90, most_anb = -90;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    const Case patient = head({.variant = HeadChoice::Variant::standard, .seed = seed});
    expect_whole(patient);
    const double anb = measured(patient, "ANB");
    least_anb = std::min(least_anb, anb), most_anb = std::max(most_anb, anb);
    // Norms and three standard deviations.
    EXPECT_NEAR(measured(patient, "SNA"), 82, 10.5);
    EXPECT_NEAR(measured(patient, "SNB"), 80, 9);
    EXPECT_NEAR(anb, 2, 6);
    EXPECT_NEAR(measured(patient, "FMA (Frankfort to Go-Me)"), 25, 15);
    EXPECT_NEAR(measured(patient, "overjet"), 2.5, 3);
    EXPECT_NEAR(measured(patient, "overbite"), 2.5, 3);
    EXPECT_NEAR(cephalic_index(patient), 80, 12);
  }
  EXPECT_GT(most_anb - least_anb, 1) << "heads differ";
}

TEST(HeadVariants, ASeedIsTheSameHeadEachTime) {
  const HeadChoice choice{.variant = HeadChoice::Variant::standard, .seed = 3};
  EXPECT_EQ(geometry_of(head(choice)), geometry_of(head(choice)));
  EXPECT_NE(geometry_of(head(choice)).parts[0].hash, geometry_of(test::builtin()).parts[0].hash);
}

TEST(HeadVariants, NamesAreReadAsTheyAreWritten) {
  for (const char* name :
       {"built-in:class-iii", "built-in:scaphocephaly:seed=7", "built-in:seed=2"})
    EXPECT_EQ(head_name(parse_head_name(name)), name);
  EXPECT_THROW(parse_head_name("built-in:class-iv"), InputError);
  EXPECT_THROW(parse_head_name("built-in:seed=x"), InputError);
  EXPECT_THROW(head_variant("classic"), InputError);
}

}  // namespace condyle
