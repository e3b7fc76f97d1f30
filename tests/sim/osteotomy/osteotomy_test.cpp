#include "sim/osteotomy/osteotomy.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/core/error.h"
#include "engine/mesh/triangle_tree.h"
#include "tests/sim/osteotomy/osteotomies.h"

using namespace condyle;
using namespace condyle::test;
using Eigen::Vector3d;

namespace {

struct Expected {
  CutStep step;
  std::vector<std::string> segments;  // "": what stays with the bone's body
};
const std::vector<Expected>& all_osteotomies() {
  const std::vector<std::string> three = {"proximal_left", "proximal_right", "distal"};
  static const std::vector<Expected> all = {
      {named("genioplasty"), {"", "chin"}},
      {named("genioplasty", {}, 0), {"", "chin"}},
      {named("sagittal_split"), three},
      {named("sagittal_split", {{"buccal_back_mm", -6}}), three},
      {named("le_fort_1"), {"", "maxilla"}},
      {named("le_fort_1", {{"step_mm", 3}}), {"", "maxilla"}},
      {named("le_fort_1", {{"pieces", 2}}), {"", "maxilla_left", "maxilla_right"}},
      {named("le_fort_1", {{"pieces", 3}}), {"", "maxilla_front", "maxilla_left", "maxilla_right"}},
      {named("vertical_ramus"), three},
      {named("inverted_l"), three},
      {named("body_osteotomy"), three}};
  return all;
}

double volume_of(const Operated& done, const std::string& segment) {
  return done.piece(segment).volume_mm3;
}

/// Least distance of cut faces from the teeth of this part.
double nearest_tooth(const Operated& done, const Part& teeth) {
  const TriangleTree walls(done.walls());
  double least = 1e9;
  for (const auto& p : teeth.mesh.vertices) least = std::min(least, walls.nearest(p).distance);
  return least;
}

double nearest_landmark(const Operated& done, const Case& patient, const std::string& name) {
  return TriangleTree(done.walls()).nearest(*patient.landmarks.find(name)).distance;
}

/// Least distance of cut faces from the wall of a canal.
double nearest_canal(const Operated& done, const Case& patient) {
  const TriangleTree walls(done.walls());
  double least = 1e9;
  for (const auto& canal : patient.canals)
    for (const auto& p : canal.points)
      least = std::min(least, walls.nearest(p).distance - 0.5 * canal.diameter_mm);
  return least;
}

bool is_inside(const Piece& piece, const Vector3d& p) {
  return TriangleTree(piece.mesh).signed_distance(p) < 0;
}

std::string refusal(const Case& patient, const CutStep& step) {
  try {
    place_osteotomy(patient, step);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "the step was accepted";
  return "";
}

void expect_mentions(const std::string& text, const std::string& words) {
  EXPECT_NE(text.find(words), std::string::npos) << text;
}

}  // namespace

TEST(Osteotomy, PartsTheBuiltInPatient) {
  for (const auto& [step, segments] : all_osteotomies()) {
    SCOPED_TRACE(step_title(step));
    const Operated done = operate(builtin(), step);
    expect_parted(done, segments);
    EXPECT_TRUE(done.placed.notes.empty() || step.osteotomy == "genioplasty");
  }
}

TEST(Osteotomy, PartsAPatientWithFewLandmarks) {
  const auto patient = case_badin();
  if (!patient) GTEST_SKIP() << "no case-badin";
  for (const auto& [step, segments] : all_osteotomies()) {
    SCOPED_TRACE(step_title(step));
    const Operated done = operate(*patient, step);
    expect_parted(done, segments);
    EXPECT_FALSE(done.placed.notes.empty());
  }
  EXPECT_NEAR(volume_of(operate(*patient, named("genioplasty")), "chin"), 4200, 1000);
}

TEST(Osteotomy, SidesAreAlikeOnASymmetricBone) {
  for (const char* name : {"sagittal_split", "vertical_ramus", "inverted_l", "body_osteotomy"}) {
    const Operated done = operate(builtin(), named(name));
    EXPECT_NEAR(volume_of(done, "proximal_left"), volume_of(done, "proximal_right"), 0.1) << name;
  }
  const Operated two = operate(builtin(), named("le_fort_1", {{"pieces", 2}}));
  EXPECT_NEAR(volume_of(two, "maxilla_left"), volume_of(two, "maxilla_right"), 0.1);
}

TEST(Osteotomy, CutsAvoidRootsCanalsAndForamina) {
  const Case& patient = builtin();
  const Part &upper = *patient.find(Role::upper_teeth), &lower = *patient.find(Role::lower_teeth);
  const Operated chin = operate(patient, named("genioplasty"));
  EXPECT_GT(nearest_tooth(chin, lower), 4.99);
  EXPECT_GT(nearest_landmark(chin, patient, "left_mental_foramen"), 4.99);
  EXPECT_GT(nearest_canal(chin, patient), 1.99);
  const Operated maxilla = operate(patient, named("le_fort_1"));
  EXPECT_GT(nearest_tooth(maxilla, upper), 3);
  EXPECT_GT(nearest_landmark(maxilla, patient, "right_infraorbital_foramen"), 3);
  const Operated split = operate(patient, named("sagittal_split"));
  EXPECT_GT(nearest_tooth(split, lower), 3);
  EXPECT_GT(nearest_canal(split, patient), 0.5);
  EXPECT_GT(nearest_canal(operate(patient, named("vertical_ramus")), patient), 1);
}

TEST(Osteotomy, SegmentsHaveTheirShare) {
  const Case& patient = builtin();
  const auto& marks = patient.landmarks;
  const Operated chin = operate(patient, named("genioplasty"));
  EXPECT_NEAR(volume_of(chin, "chin"), 7000, 500);  // canine roots reach deep
  const double higher =
      volume_of(operate(patient, named("genioplasty", {{"height_mm", 10}})), "chin");
  EXPECT_LT(higher, volume_of(chin, "chin") - 1000);
  const Operated split = operate(patient, named("sagittal_split"));
  EXPECT_TRUE(is_inside(split.piece("proximal_left"), *marks.find("left_condyle")));
  EXPECT_TRUE(is_inside(split.piece("proximal_right"), *marks.find("right_condyle")));
  for (const char* apex : {"lower_left_first_molar_mesiobuccal_apex", "lower_right_canine_apex"})
    EXPECT_GT(TriangleTree(split.piece("proximal_left").mesh).signed_distance(*marks.find(apex)),
              3);
  EXPECT_NEAR(volume_of(split, "proximal_left"), 12600, 1500);
  const double whole =
      volume_of(operate(patient, named("sagittal_split", {{"full", 1}})), "proximal_left");
  EXPECT_LT(whole, volume_of(split, "proximal_left"));  // the back of the ramus is split, too
  // The whole upper arch moves with the maxilla.
  const Box maxilla = bounding_box(operate(patient, named("le_fort_1")).piece("maxilla").mesh);
  const Box teeth = bounding_box(patient.find(Role::upper_teeth)->mesh);
  EXPECT_LT(teeth.high.z(), maxilla.high.z() - 3);
  EXPECT_LT(teeth.high.y(), maxilla.high.y() - 3);
  EXPECT_NEAR(maxilla.high.y(), marks.find("pns")->y() + 0.2, 0.5);
}

TEST(Osteotomy, FollowsATurnedHead) {
  const Pose X{Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vector3d(1, -2, 0.5).normalized())),
               {40, -300, 120}};
  const Case& patient = builtin();
  const Case other = turned(patient, X);
  for (const char* name : {"genioplasty", "sagittal_split", "le_fort_1", "inverted_l"}) {
    const auto straight = operate(patient, named(name)), tilted = operate(other, named(name));
    ASSERT_EQ(straight.result.pieces.size(), tilted.result.pieces.size()) << name;
    for (const auto& segment : straight.placed.segments) {
      const Piece &a = straight.piece(segment.name), &b = tilted.piece(segment.name);
      EXPECT_NEAR(a.volume_mm3, b.volume_mm3, 0.01) << segment.name;
      TriMesh moved = a.mesh;
      for (auto& p : moved.vertices) p = X * p;
      EXPECT_LT((bounding_box(moved).low - bounding_box(b.mesh).low).norm(), 1e-3) << segment.name;
    }
  }
}

TEST(Osteotomy, ValuesAreRefusedWithNameAndBounds) {
  const Case& patient = builtin();
  expect_mentions(refusal(patient, named("le_fort")), "did you mean \"le_fort_1\"");
  expect_mentions(refusal(patient, named("genioplasty", {{"hight_mm", 3}})),
                  "did you mean \"height_mm\"");
  expect_mentions(refusal(patient, named("genioplasty", {{"height_mm", 60}})),
                  "height_mm is 60; expected 6 to 25 mm");
  expect_mentions(refusal(patient, named("le_fort_1", {{"pieces", 2.5}})), "pieces is 2.5");
  expect_mentions(refusal(patient, named("le_fort_1", {{"pieces", 2}, {"step_mm", 3}})), "step");
  expect_mentions(refusal(patient, named("genioplasty", {}, 3)), "kerf_mm is 3");
  CutStep elsewhere = named("genioplasty");
  elsewhere.target = "chinn";
  expect_mentions(refusal(patient, elsewhere), "no bone \"chinn\"");
  CutStep many = named("genioplasty");
  many.pieces = {"a", "b"};
  expect_mentions(refusal(patient, many), "makes chin");
  Case blind = patient;
  for (const char* name : {"upper_incisal_point"}) blind.landmarks.points.erase(name);
  expect_mentions(refusal(blind, named("le_fort_1")), "upper_incisal_point");
  Case toothless;
  toothless.landmarks = patient.landmarks;
  expect_mentions(refusal(toothless, named("genioplasty")), "mandible");
  for (const auto& name : osteotomy_names())
    for (const auto& parameter : osteotomy_parameters(name)) {
      EXPECT_LE(parameter.low, parameter.standard) << name << ' ' << parameter.name;
      EXPECT_GE(parameter.high, parameter.standard) << name << ' ' << parameter.name;
      EXPECT_FALSE(parameter.meaning.empty());
    }
}

TEST(Osteotomy, PiecesHaveTheStepsNames) {
  CutStep step = named("genioplasty");
  step.pieces = {"button"};
  EXPECT_EQ(place_osteotomy(builtin(), step).segments.at(0).name, "button");
  // The distal segment is not named: it stays the mandible's body.
  step = named("sagittal_split");
  step.pieces = {"proximal_left", "proximal_right"};
  const Operated split = operate(builtin(), step);
  expect_parted(split, {"", "proximal_left", "proximal_right"});
}

TEST(Osteotomy, SurfacesOfAStepAreCut) {
  const Case& patient = builtin();
  CutStep step;
  step.target = "mandible";
  step.kerf_mm = 0.5;
  step.pieces = {"upper", "lower"};
  step.surfaces = {
      PlanePatch{{0, -75, -80}, Vector3d::UnitZ(), PatchRectangle{Vector3d::UnitX(), 45, 40}}};
  const Operated flat = operate(patient, step);
  expect_parted(flat, {"upper", "lower"});
  EXPECT_GT(volume_of(flat, "upper"), volume_of(flat, "lower"));
  // The left of a polyline towards the patient's left, seen from the front, is below.
  step.surfaces = {
      BentSheet{{{60, -95, -85}, {0, -95, -80}, {-60, -95, -85}}, Vector3d::UnitY(), 70, 10}};
  const Operated bent = operate(patient, step);
  expect_parted(bent, {"upper", "lower"});
  EXPECT_LT(bent.piece("upper").mesh.vertices.size(), bent.piece("lower").mesh.vertices.size());
  // Surfaces replace those of a named osteotomy; a short one does not go through.
  CutStep replaced = named("genioplasty");
  replaced.surfaces = {PlanePatch{{0, -85, -80}, Vector3d::UnitZ(), 10.0}};
  replaced.pieces = {"chin"};
  const Operated partial = operate(patient, replaced);
  ASSERT_EQ(partial.result.outcomes.size(), 1u);
  EXPECT_FALSE(partial.result.outcomes[0].through);
  EXPECT_GT(partial.result.outcomes[0].left_mm, 1);
}
