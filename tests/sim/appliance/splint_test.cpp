// Occlusal splints between planned arches, measured by distances of their own.
#include "sim/appliance/splint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/appliance/outline.h"
#include "tests/sim/appliance/planned.h"
#include "tests/support/real_cases.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

constexpr double coarse = 0.4;  // most of what a splint is does not depend on its voxels

SplintSettings with_voxel(double voxel_mm) {
  SplintSettings settings;
  settings.voxel_mm = voxel_mm;
  settings.threads = 2;
  return settings;
}

TriMesh moved_arch(TriMesh mesh, const Pose& X) {
  for (Vector3d& p : mesh.vertices) p = X * p;
  return mesh;
}

/// Text of the error that a call throws.
std::string refusal(const auto& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

const SplintArches& final_arches() {
  static const SplintArches arches = splint_arches(two_jaws(), SplintKind::final_bite);
  return arches;
}

/// The splint that users get by default.
const Splint& final_splint() {
  static const Splint splint = make_splint(final_arches(), with_voxel(0.2));
  return splint;
}

}  // namespace

TEST(Splint, IsOneClosedPieceOutsideOfAllTeeth) {
  const Splint& splint = final_splint();
  const Topology topology = inspect(splint.mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.components, 1);
  EXPECT_GT(topology.volume_mm3, 5000);
  EXPECT_TRUE(splint.measure.closed);
  EXPECT_EQ(splint.measure.pieces, 1);
  const TriangleTree upper(final_arches().upper.mesh),
      lower(moved_arch(final_arches().lower.mesh, splint.X_lower));
  double nearest = 1e9;
  for (const Vector3d& p : splint.mesh.vertices)
    nearest = std::min({nearest, upper.signed_distance(p), lower.signed_distance(p)});
  // The gap, less what cells of 0.2 mm round off at an edge of a crown: a fifth of a cell.
  EXPECT_GT(nearest, 0.1 - 0.2 / 5);
  EXPECT_LT(nearest, 0.1 + 0.01);
}

TEST(Splint, ItsPrintLiesWithin015MillimetresOfTheTeeth) {
  const Splint& splint = final_splint();
  ASSERT_EQ(splint.measure.prints.size(), 2u);
  for (const PrintMeasure& print : splint.measure.prints) {
    EXPECT_GT(print.area_mm2, 500) << print.on;
    EXPECT_LE(print.fit_max_mm, 0.15) << print.on;
    EXPECT_GT(print.fit_mean_mm, 0.08) << print.on;
    EXPECT_EQ(print.overlap_mm, 0) << print.on;
    // A tenth of the crowns is narrower than a wall, between teeth.
    EXPECT_LT(print.relieved_mm2, 0.25 * print.area_mm2) << print.on;
    EXPECT_LT(print.rim_mm2, 0.2 * print.area_mm2) << print.on;
  }
  // The tips of the teeth, which no crevice hides, seen from the tooth.
  const TriangleTree tree(splint.mesh);
  int tips = 0;
  for (const char* name : {"upper_left_canine_tip", "upper_right_first_molar_mesiobuccal_cusp",
                           "upper_left_central_incisor_tip"}) {
    const auto at =
        patient_at_stage(two_jaws(), SplintKind::final_bite, FirstJaw::upper).landmarks.find(name);
    ASSERT_TRUE(at) << name;
    const SurfacePoint tooth = TriangleTree(final_arches().upper.mesh).nearest(*at);
    EXPECT_LE(tree.nearest(tooth.point).distance, 0.15) << name;
    ++tips;
  }
  EXPECT_EQ(tips, 3);
}

/// Another head with both jaws moved.
TEST(Splint, FitsTheTeethOfAnotherHead) {
  const Case patient = builtin_patient(HeadChoice{.seed = 3});
  Plan plan = two_jaw_plan();
  plan.geometry = geometry_of(patient);
  plan = with_move(plan, {"distal", ExplicitMove{{Eigen::Quaterniond::Identity(), {0, -3, 1}}}});
  const SplintArches arches = splint_arches(apply_plan(patient, plan), SplintKind::final_bite);
  const Splint splint = make_splint(arches, with_voxel(0.2));
  for (const PrintMeasure& print : splint.measure.prints) {
    EXPECT_LE(print.fit_max_mm, 0.15) << print.on;
    EXPECT_GT(print.area_mm2, 500) << print.on;
  }
  // Seen from the splint: what lies beside a tooth, between the gap and a wide relief, is little.
  const TriangleTree upper(arches.upper.mesh), lower(moved_arch(arches.lower.mesh, splint.X_lower));
  int near = 0, off = 0;
  for (const Vector3d& p : splint.mesh.vertices) {
    const double distance = std::min(upper.nearest(p).distance, lower.nearest(p).distance);
    near += distance <= 0.15;
    off += distance > 0.15 && distance < 0.6;
  }
  EXPECT_GT(near, 10000);
  EXPECT_LT(off, 0.35 * near);
}

/// A cup that opens downward: a rim of 3 mm about a floor 3 mm above it.
TriMesh cup(bool closed_rim) {
  TriMesh mesh;
  const auto plate = [&](double x, double y, double width, double length, double z) {
    const int first = static_cast<int>(mesh.vertices.size());
    for (const auto& [i, j] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}})
      mesh.vertices.emplace_back(x + i * width, y + j * length, z);
    mesh.triangles.emplace_back(first, first + 2, first + 1);
    mesh.triangles.emplace_back(first, first + 3, first + 2);
  };
  plate(-5, -5, 10, 3, 0);
  plate(-5, 2, 10, 3, 0);
  plate(-5, -2, 3, 4, 0);
  if (closed_rim) plate(2, -2, 3, 4, 0);
  plate(-2, -2, 4, 4, 3);
  return mesh;
}

TEST(SplintPlate, FillsAFossaDeeperThanThePrintAndNoOpening) {
  for (const bool closed_rim : {true, false}) {
    FlatGrid face;
    face.low = {-8, -8};
    face.columns = face.rows = 81;
    face.values.assign(81 * 81, 2.0f);
    fill_fossae(face, cup(closed_rim), true, 5);
    EXPECT_NEAR(face(0, 0), closed_rim ? 3.5 : 2, 1e-6);
    EXPECT_EQ(face(-4, 0), 2);
    EXPECT_EQ(face(-7, 0), 2);
    std::fill(face.values.begin(), face.values.end(), 2.0f);
    fill_fossae(face, cup(closed_rim), true, 1);
    EXPECT_NEAR(face(1, 1), closed_rim ? 3 : 2, 1e-6);
  }
}

TEST(Splint, IsAsThickAsRequestedBetweenTheArches) {
  const Splint& splint = final_splint();
  EXPECT_GE(splint.thickness_mm, 1.5);
  EXPECT_LT(splint.thickness_mm, 1.8);
  EXPECT_GE(splint.measure.wall_min_mm, 0.5);
  // The plan has no bite: the hinge opens it, and carries the condyles' axis in place.
  EXPECT_LT(splint.clearance_before_mm, 1.7);
  EXPECT_GT(splint.opening_mm, 0.2);
  const auto& condyles = *final_arches().condyles;
  for (const Vector3d& condyle : condyles)
    EXPECT_NEAR((splint.X_lower * condyle - condyle).norm(), 0, 1e-9);
  // Distances of the arches themselves, by their corners.
  const TriMesh lower = moved_arch(final_arches().lower.mesh, splint.X_lower);
  const TriangleTree upper(final_arches().upper.mesh);
  double nearest = 1e9;
  for (const Vector3d& p : lower.vertices) nearest = std::min(nearest, upper.nearest(p).distance);
  EXPECT_GE(nearest, 1.7);
}

TEST(Splint, LeavesTheTeethWithItsGripAlone) {
  SplintSettings deep = with_voxel(coarse);
  deep.depth_mm = 4.5;  // beyond the equators
  double undercut = 0;
  for (const double grip : {0.4, 0.15}) {
    deep.grip_mm = grip;
    const Splint splint = make_splint(final_arches(), deep);
    for (const PrintMeasure& print : splint.measure.prints) {
      EXPECT_LE(print.undercut_mm, grip + 0.02) << print.on;
      undercut = std::max(undercut, print.undercut_mm);
      EXPECT_LT(print.tilt_deg, 13);
    }
  }
  EXPECT_GT(undercut, 0.1);  // there are undercuts to hold
}

TEST(Splint, ThatCannotBeWithdrawnIsRefused) {
  ApplianceMeasure measure;
  measure.prints.emplace_back().on = "mandible";
  measure.prints[0].undercut_mm = 0.45;
  EXPECT_NO_THROW(check_withdrawal(measure, 0.4, "splint"));
  measure.prints[0].undercut_mm = 4.98;
  try {
    check_withdrawal(measure, 0.4, "splint");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    const std::string words = error.what();
    EXPECT_NE(words.find("the splint cannot be withdrawn from mandible"), std::string::npos);
    EXPECT_NE(words.find("4.98 mm"), std::string::npos);
  }
}

TEST(Splint, TheIntermediateOneHoldsTheOtherJawAtRest) {
  const SplintArches upper_first = splint_arches(two_jaws(), SplintKind::intermediate),
                     lower_first =
                         splint_arches(two_jaws(), SplintKind::intermediate, FirstJaw::lower),
                     both = final_arches();
  const auto center = [](const SplintArch& arch) { return bounding_box(arch.mesh).center(); };
  EXPECT_NEAR((center(upper_first.upper) - center(both.upper)).norm(), 0, 1e-9);
  EXPECT_NEAR((center(both.lower) - center(upper_first.lower) - Vector3d(0, 5, 1)).norm(), 0, 1e-6);
  EXPECT_NEAR((center(both.upper) - center(lower_first.upper) - Vector3d(0, -4, 2)).norm(), 0,
              1e-6);
  const Splint splint = make_splint(upper_first, with_voxel(coarse));
  EXPECT_TRUE(splint.measure.closed);
  EXPECT_EQ(splint.measure.pieces, 1);
}

TEST(Splint, IsBitIdenticalForAnyNumberOfThreads) {
  SplintSettings settings = with_voxel(coarse);
  settings.threads = 1;
  const Splint one = make_splint(final_arches(), settings);
  settings.threads = 3;
  const Splint three = make_splint(final_arches(), settings);
  EXPECT_EQ(mesh_hash(one.mesh), mesh_hash(three.mesh));
  EXPECT_EQ(one.measure.wall_min_mm, three.measure.wall_min_mm);
  EXPECT_EQ(one.measure.prints[0].fit_mean_mm, three.measure.prints[0].fit_mean_mm);
}

TEST(Splint, StatesTheOpeningThatIsNeededWhereItIsGiven) {
  SplintSettings settings = with_voxel(coarse);
  settings.opening_mm = 0;
  const std::string text = refusal([&] { make_splint(final_arches(), settings); });
  EXPECT_NE(text.find("mm at the incisors gives it"), std::string::npos) << text;
  settings.opening_mm = final_splint().opening_mm + 2;
  const Splint wide = make_splint(final_arches(), settings);
  EXPECT_NEAR(wide.opening_mm, *settings.opening_mm, 1e-9);
  EXPECT_GT(wide.thickness_mm, final_splint().thickness_mm + 0.5);
}

TEST(Splint, NeedsCondylesWhereTheBiteMustOpen) {
  SplintArches arches = final_arches();
  arches.condyles.reset();
  EXPECT_NE(refusal([&] { make_splint(arches, with_voxel(coarse)); }).find("left_condyle"),
            std::string::npos);
}

TEST(Splint, RefusesAnArchOfOneToothAndSettingsOutOfRange) {
  SplintArches arches = final_arches();
  const Part& teeth = *class_iii_head().find(Role::upper_teeth);
  TriMesh tooth;
  tooth.vertices = teeth.mesh.vertices;
  const Tooth& first = teeth.teeth.front();
  tooth.triangles.assign(
      teeth.mesh.triangles.begin() + first.first_triangle,
      teeth.mesh.triangles.begin() + first.first_triangle + first.triangle_count);
  std::vector<Vector3d> used;
  for (auto& t : tooth.triangles)
    for (int& v : t) {
      used.push_back(tooth.vertices[v]);
      v = static_cast<int>(used.size()) - 1;
    }
  tooth.vertices = used;
  arches.upper.mesh = tooth;
  const std::string text = refusal([&] { make_splint(arches, with_voxel(coarse)); });
  EXPECT_NE(text.find("upper_teeth: the teeth extend"), std::string::npos) << text;
  for (const double voxel : {0., -1., 5., std::nan("")})
    EXPECT_NE(refusal([&] { make_splint(final_arches(), with_voxel(voxel)); }).find("voxel"),
              std::string::npos)
        << voxel;
  SplintSettings thin = with_voxel(coarse);
  thin.thickness_mm = 0;
  EXPECT_NE(refusal([&] { make_splint(final_arches(), thin); }).find("thickness"),
            std::string::npos);
}

TEST(Splint, NeedsMovedJaws) {
  Plan plan = two_jaw_plan();
  plan = with_move(plan, {"distal", ExplicitMove{}});
  const Operated one = apply_plan(class_iii_head(), plan);
  EXPECT_NE(refusal([&] {
              splint_arches(one, SplintKind::intermediate);
            }).find("the plan moves the upper jaw alone"),
            std::string::npos);
  plan = with_move(plan, {"maxilla", ExplicitMove{}});
  const Operated none = apply_plan(class_iii_head(), plan);
  EXPECT_NE(
      refusal([&] { splint_arches(none, SplintKind::final_bite); }).find("moves no dental arch"),
      std::string::npos);
}

TEST(Splint, ArchesThatAreOpenAreClosedAndACaseWithoutTeethIsRefused) {
  Case patient = class_iii_head();
  for (Part& part : patient.parts)
    if (part.role == Role::upper_teeth) {  // without the last tooth's last triangles
      part.mesh.triangles.resize(part.mesh.triangles.size() - 3);
      part.teeth.back().triangle_count -= 3;
    }
  Plan plan = two_jaw_plan();
  plan.geometry = geometry_of(patient);
  const SplintArches arches = splint_arches(apply_plan(patient, plan), SplintKind::final_bite);
  EXPECT_EQ(inspect(arches.upper.mesh).boundary_edges, 0);
  EXPECT_FALSE(arches.notes.empty());

  std::erase_if(patient.parts, [](const Part& part) { return part.role == Role::lower_teeth; });
  plan.geometry = geometry_of(patient);
  patient.landmarks.points.erase("lower_incisal_point");
  EXPECT_NE(refusal([&] {
              splint_arches(apply_plan(patient, plan), SplintKind::final_bite);
            }).find("no lower teeth"),
            std::string::npos);
}

TEST(Splint, FitsScannedTeeth) {
  const auto patient = case_ubc();
  if (!patient) GTEST_SKIP() << "../shared/data is absent";
  Plan plan;
  plan.name = "scanned";
  plan.geometry = geometry_of(*patient);
  plan = with_move(plan, {"mandible", ExplicitMove{{Eigen::Quaterniond::Identity(), {0, 1, -1}}}});
  const Splint splint = make_splint(
      splint_arches(apply_plan(*patient, plan), SplintKind::final_bite), with_voxel(0.2));
  EXPECT_TRUE(splint.measure.closed);
  EXPECT_EQ(splint.measure.pieces, 1);
  EXPECT_GE(splint.thickness_mm, 1.5);
  for (const PrintMeasure& print : splint.measure.prints) {
    EXPECT_GT(print.area_mm2, 200) << print.on;
    EXPECT_LE(print.fit_max_mm, 0.15) << print.on;
    EXPECT_LE(print.undercut_mm, 0.4) << print.on;
  }
}

}  // namespace condyle::test
