// Cutting guides on the bone of planned osteotomies.
#include "sim/appliance/guide.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "tests/sim/appliance/planned.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

GuideSettings with_saw(const std::string& saw, double voxel_mm) {
  GuideSettings settings;
  settings.saw = find_saw(saw);
  settings.voxel_mm = voxel_mm;
  settings.threads = 2;
  return settings;
}

/// The chin of the built-in head is cut, and moved by no one.
const Plan& chin_plan() {
  static const Plan plan = [] {
    Plan made;
    made.name = "chin";
    made.geometry = geometry_of(class_iii_head());
    return with_step(made, CutStep{.osteotomy = "genioplasty", .pieces = {"chin"}});
  }();
  return plan;
}
const CutLine& chin_line() {
  static const CutLine line =
      find_cut_line(apply_cuts(class_iii_head(), chin_plan()), chin_plan(), "genioplasty");
  return line;
}
const GuideSupport& chin_support() {
  static const GuideSupport support = [] {
    std::vector<std::string> notes;
    return guide_support(class_iii_head(), chin_plan(), chin_line(), notes);
  }();
  return support;
}
const Guide& chin_guide() {
  static const Guide guide = make_guide(chin_support(), chin_line(), with_saw("sagittal", 0.2));
  return guide;
}

std::string why_no_guide(const auto& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace

TEST(Guide, IsOneClosedPieceThatLiesOnTheBone) {
  const Guide& guide = chin_guide();
  const Topology topology = inspect(guide.mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.components, 1);
  ASSERT_EQ(guide.measure.prints.size(), 1u);
  const PrintMeasure& print = guide.measure.prints[0];
  EXPECT_GT(print.area_mm2, 1000);
  EXPECT_LE(print.fit_p95_mm, 0.15);
  EXPECT_EQ(print.overlap_mm, 0);
  EXPECT_LE(print.undercut_mm, 0.42);  // the grip, and the step of 0.1 mm in which it is measured
  EXPECT_GE(guide.measure.wall_min_mm, 1);
  EXPECT_GE(guide.measure.wall_p5_mm, 1.5);
  const TriangleTree bone(chin_support().bone);
  double nearest = 1e9;
  for (const Vector3d& p : guide.mesh.vertices)
    nearest = std::min(nearest, bone.signed_distance(p));
  // The gap, less what cells of 0.2 mm round off at an edge of the bone: a fifth of a cell.
  EXPECT_GT(nearest, 0.1 - 0.2 / 5);
}

TEST(Guide, ItsSlotsLeadTheSawInThePlaneOfTheCut) {
  const Guide& guide = chin_guide();
  EXPECT_NEAR(guide.slot_mm, 0.4 + 2 * 0.25, 1e-12);
  ASSERT_GE(guide.slots.size(), 3u);
  const TriangleTree tree(guide.mesh);
  double length = 0;
  for (const GuideSlot& slot : guide.slots) {
    EXPECT_NEAR(slot.width_min_mm, 0.9, 0.05);
    EXPECT_NEAR(slot.width_max_mm, 0.9, 0.05);
    EXPECT_GE(slot.wall_min_mm, 1);
    length += slot.length_mm;
    // Both ends lie on a wall of the planned cut and on the bone.
    for (const Vector3d& end : {slot.from, slot.to}) {
      double off = 1e9;
      for (const Plane& wall : chin_line().walls) off = std::min(off, std::abs(wall.distance(end)));
      EXPECT_LT(off, 1e-6);
      EXPECT_LT(TriangleTree(chin_support().bone).nearest(end).distance, 0.3);
    }
    // A blade that stands in the slot touches nothing.
    const Plane& wall = *std::min_element(
        chin_line().walls.begin(), chin_line().walls.end(), [&](const Plane& a, const Plane& b) {
          return std::abs(a.distance(slot.from)) + std::abs(a.distance(slot.to)) <
                 std::abs(b.distance(slot.from)) + std::abs(b.distance(slot.to));
        });
    const Vector3d out = -guide.measure.prints[0].seat;
    const Vector3d in_plane = (out - out.dot(wall.normal) * wall.normal).normalized();
    const Vector3d along = (slot.to - slot.from).normalized();
    for (double height = 3; height < 6; height += 0.5)
      for (const double side : {-0.2, 0., 0.2})
        EXPECT_LT(tree.winding_number(slot.from + along + height * in_plane + side * wall.normal),
                  0.5);
  }
  EXPECT_NEAR(length, guide.led_mm, 1e-9);
  EXPECT_GT(guide.led_mm, 0.7 * guide.line_mm);
}

TEST(Guide, StatesHowMuchOfTheCutLiesBetweenTwoWalls) {
  const Guide& guide = chin_guide();
  double guided = 0;
  for (const GuideSlot& slot : guide.slots) {
    double missing = 0;
    for (const SlotGap& gap : slot.gaps) missing += gap.length_mm;
    EXPECT_NEAR(slot.guided_mm + missing, slot.length_mm, 1e-9);
    guided += slot.guided_mm;
  }
  EXPECT_NEAR(guide.guided_mm, guided, 1e-9);
  EXPECT_GT(guide.guided_mm, 0.9 * guide.led_mm);
  // A plane that a tooth crosses has no walls there: the guide keeps away from it.
  GuideSupport beside_tooth = chin_support();
  const Vector3d middle = 0.5 * (guide.slots[1].from + guide.slots[1].to);
  beside_tooth.teeth = {};
  for (const double z : {-1., 1.})
    for (const double y : {-6., 6.})
      for (const double x : {-1., 1.})
        beside_tooth.teeth.vertices.push_back(middle + Vector3d(x, y, 8 * z));
  beside_tooth.teeth.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                  {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  GuideSettings settings = with_saw("sagittal", 0.4);
  const Guide whole = make_guide(chin_support(), chin_line(), settings);
  const Guide parted = make_guide(beside_tooth, chin_line(), settings);
  EXPECT_LT(parted.guided_mm, whole.guided_mm - 1.5);
  int gaps = 0;
  for (const GuideSlot& slot : parted.slots)
    for (const SlotGap& gap : slot.gaps) gaps += gap.length_mm > 1;
  EXPECT_GT(gaps, 0);
}

TEST(Guide, HasFourScrewHolesInTheShell) {
  const Guide& guide = chin_guide();
  ASSERT_EQ(guide.holes.size(), 4u);
  for (const ScrewHole& hole : guide.holes) {
    EXPECT_NEAR(hole.diameter_mm, 2, 0.1);
    EXPECT_NEAR(hole.axis.norm(), 1, 1e-9);
    for (const DangerZone& zone : chin_support().dangers)
      for (const Vector3d& p : zone.points)
        EXPECT_GT((p - hole.point).norm(), zone.radius_mm + 1.4) << zone.name;
  }
}

TEST(Guide, BothSidesOfTheUpperJawAreJoined) {
  const Operated cuts = apply_cuts(class_iii_head(), two_jaw_plan());
  const CutLine line = find_cut_line(cuts, two_jaw_plan(), "maxilla");
  EXPECT_EQ(line.bone, "skull");
  std::vector<std::string> notes;
  const Guide guide = make_guide(guide_support(class_iii_head(), two_jaw_plan(), line, notes), line,
                                 with_saw("0.6", 0.4));
  EXPECT_TRUE(guide.measure.closed);
  EXPECT_EQ(guide.measure.pieces, 1);
  const Box box = bounding_box(guide.mesh);
  EXPECT_LT(box.low.x(), -30);
  EXPECT_GT(box.high.x(), 30);
  // It comes from the front, in the midsagittal plane.
  EXPECT_NEAR(guide.measure.prints[0].seat.x(), 0, 1e-9);
  EXPECT_GT(guide.measure.prints[0].seat.y(), 0.8);
}

TEST(Guide, TheStandardHeadGetsOneForBothSidesByDefault) {
  const Case patient = builtin_patient();
  Plan plan;
  plan.name = "upper jaw";
  plan.geometry = geometry_of(patient);
  plan = with_step(plan, CutStep{.osteotomy = "le_fort_1", .pieces = {"maxilla"}});
  const CutLine line = find_cut_line(apply_cuts(patient, plan), plan, "maxilla");
  std::vector<std::string> notes;
  const Guide guide =
      make_guide(guide_support(patient, plan, line, notes), line, with_saw("sagittal", 0.4));
  EXPECT_TRUE(guide.measure.closed);
  EXPECT_EQ(guide.measure.pieces, 1);
  EXPECT_GE(guide.measure.wall_min_mm, 1);  // no hooks at the piriform rim
  EXPECT_GT(guide.guided_mm, 0.8 * guide.led_mm);
  EXPECT_LT(bounding_box(guide.mesh).low.x(), -30);
  EXPECT_GT(bounding_box(guide.mesh).high.x(), 30);
}

TEST(Guide, LeftAndRightAreThePatientsWhereTheCaseLiesBesideItsAxes) {
  Case patient = class_iii_head();
  const Vector3d aside(70, 0, 0);
  for (Part& part : patient.parts)
    for (Vector3d& p : part.mesh.vertices) p += aside;
  for (auto& [name, p] : patient.landmarks.points) p += aside;
  patient.canals.clear();
  Plan plan;
  plan.name = "aside";
  plan.geometry = geometry_of(patient);
  plan = with_step(plan, CutStep{.osteotomy = "le_fort_1", .pieces = {"maxilla"}});
  const CutLine line = find_cut_line(apply_cuts(patient, plan), plan, "maxilla");
  std::vector<std::string> notes;
  const GuideSupport support = guide_support(patient, plan, line, notes);
  EXPECT_NEAR(support.frame.left.dot(support.frame.origin), 70, 1);
  GuideSettings settings = with_saw("sagittal", 0.4);
  settings.side = GuideSide::right;  // all of it at x > 0
  const Guide guide = make_guide(support, line, settings);
  EXPECT_LT(bounding_box(guide.mesh).high.x(), 75);
  EXPECT_GT(bounding_box(guide.mesh).low.x(), 5);
}

TEST(Guide, TheBoneIsChosenWhereACutPassesThroughSeveral) {
  // The maxilla as if it had been another bone before the cut.
  Operated cuts = apply_cuts(class_iii_head(), two_jaw_plan());
  for (auto& [part, origin] : cuts.origin)
    for (const Part& piece : cuts.patient.parts)
      if (piece.name == part && cuts.patient.bodies[piece.body].name == "maxilla")
        origin.part = "upper jaw";
  const CutLine line = find_cut_line(cuts, two_jaw_plan(), "le_fort_1");
  ASSERT_EQ(line.bones.size(), 2u);
  EXPECT_EQ(line.bone, line.bones[0].name);
  EXPECT_GE(line.bones[0].length_mm, line.bones[1].length_mm);
  const std::string other = line.bones[1].name;
  const CutLine chosen = find_cut_line(cuts, two_jaw_plan(), "le_fort_1", other);
  EXPECT_EQ(chosen.bone, other);
  EXPECT_FALSE(chosen.edges.empty());
  const std::string text =
      why_no_guide([&] { find_cut_line(cuts, two_jaw_plan(), "le_fort_1", "mandible"); });
  EXPECT_NE(text.find("does not pass through a bone \"mandible\"; it passes through"),
            std::string::npos)
      << text;
}

TEST(Guide, OneSideOfASplitHasItsOwn) {
  const Operated cuts = apply_cuts(class_iii_head(), two_jaw_plan());
  const CutLine line = find_cut_line(cuts, two_jaw_plan(), "2");
  std::vector<std::string> notes;
  const GuideSupport support = guide_support(class_iii_head(), two_jaw_plan(), line, notes);
  for (const GuideSide side : {GuideSide::left, GuideSide::right}) {
    GuideSettings settings = with_saw("reciprocating", 0.4);
    settings.side = side;
    const Guide guide = make_guide(support, line, settings);
    EXPECT_TRUE(guide.measure.closed);
    EXPECT_EQ(guide.measure.pieces, 1);
    EXPECT_GT(bounding_box(guide.mesh).center().x() * (side == GuideSide::left ? 1 : -1), 20);
  }
}

TEST(Guide, IsBitIdenticalForAnyNumberOfThreads) {
  GuideSettings settings = with_saw("sagittal", 0.4);
  settings.threads = 1;
  const Guide one = make_guide(chin_support(), chin_line(), settings);
  settings.threads = 3;
  EXPECT_EQ(mesh_hash(one.mesh), mesh_hash(make_guide(chin_support(), chin_line(), settings).mesh));
}

TEST(Guide, RefusesWhatCannotBeMade) {
  const auto made = [](const GuideSettings& settings) {
    return why_no_guide([&] { make_guide(chin_support(), chin_line(), settings); });
  };
  EXPECT_NE(made(with_saw("sagittal", 0)).find("voxel 0 mm"), std::string::npos);
  EXPECT_NE(made(with_saw("sagittal", 0.5)).find("too coarse for a slot of 0.90 mm"),
            std::string::npos);
  // The bone as a shell of 0.9 mm, which a blade of 1 mm would saw to dust.
  GuideSettings thick = with_saw("1", 0.4);
  GuideSupport thin = chin_support();
  const std::vector<Vector3d> normals = vertex_normals(thin.bone);
  const int count = static_cast<int>(thin.bone.vertices.size());
  for (int v = 0; v < count; ++v)
    thin.bone.vertices.push_back(thin.bone.vertices[v] - 0.7 * normals[v]);
  for (std::size_t t = 0, triangles = thin.bone.triangles.size(); t < triangles; ++t) {
    const Eigen::Vector3i v = thin.bone.triangles[t];
    thin.bone.triangles.emplace_back(v[2] + count, v[1] + count, v[0] + count);
  }
  const std::string text = why_no_guide([&] { make_guide(thin, chin_line(), thick); });
  EXPECT_NE(text.find("is thicker than the bone"), std::string::npos) << text;
}

TEST(Guide, NamesTheCutsOfThePlanWhereOneIsUnknown) {
  const std::string text = why_no_guide([&] {
    find_cut_line(apply_cuts(class_iii_head(), two_jaw_plan()), two_jaw_plan(), "le_fort_3");
  });
  EXPECT_NE(
      text.find("the plan has no cut \"le_fort_3\"; it has 1 (le_fort_1), 2 (sagittal_split)"),
      std::string::npos)
      << text;
}

TEST(Saws, AreFoundByNameAndThickness) {
  EXPECT_EQ(find_saw("piezo").blade_mm, 0.55);
  EXPECT_EQ(find_saw("0.7").blade_mm, 0.7);
  for (const Saw& saw : known_saws()) EXPECT_FALSE(saw.source.empty()) << saw.name;
  EXPECT_NE(why_no_guide([] { find_saw("sagital"); }).find("did you mean \"sagittal\""),
            std::string::npos);
  for (const char* wrong : {"0", "-1", "5", "nan", "1mm", ""})
    EXPECT_NE(why_no_guide([&] { find_saw(wrong); }), "no error") << wrong;
}

}  // namespace condyle::test
