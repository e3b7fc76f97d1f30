// Scans made from crowns of known pose: registration, faults, bite, and the closed case.
#include "sim/dental_scan/dental_scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include "engine/core/error.h"
#include "engine/field/mesh_field.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/dental_scan/close_scan.h"
#include "sim/dental_scan/scanned_arches.h"
#include "tests/sim/dental_scan/made_scans.h"
#include "tests/support/builtin.h"
#include "tests/support/real_cases.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

DentalScan scan_of(const Case& patient, bool upper, const Pose& X_SC, unsigned seed = 1) {
  return dental_scan(made_scan(crowns(patient, upper), X_SC, seed),
                     upper ? "upper.stl" : "lower.stl");
}

ArchFit fitted(const DentalScan& scan, const Part& teeth, const ArchTarget* opposing = nullptr) {
  ArchFitRequest request;
  request.opposing = opposing;
  return fit_arch(scan, ArchTarget(teeth), request);
}

std::string message_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

void expect_words(const std::string& text, const std::vector<std::string>& words) {
  for (const auto& word : words) EXPECT_NE(text.find(word), std::string::npos) << text;
}

/// Without some teeth: an arch that is not its own mirror image.
Part without_teeth(Part teeth, std::initializer_list<int> fdi) {
  Part left = teeth;
  left.mesh.triangles.clear();
  left.teeth.clear();
  for (const Tooth& tooth : teeth.teeth) {
    if (std::find(fdi.begin(), fdi.end(), tooth.fdi) != fdi.end()) continue;
    left.teeth.push_back(
        {tooth.fdi, static_cast<int>(left.mesh.triangles.size()), tooth.triangle_count});
    const auto first = teeth.mesh.triangles.begin() + tooth.first_triangle;
    left.mesh.triangles.insert(left.mesh.triangles.end(), first, first + tooth.triangle_count);
  }
  drop_unreferenced(left.mesh);
  return left;
}

/// Both arches of crowns as in a CT, of any frame, in a target with its faults.
void expect_found_in_ct(const Case& patient, unsigned seed) {
  for (const bool upper : {true, false}) {
    Part target = crowns(patient, upper);
    make_ct_like(target, 10 + seed);
    const Pose X_SC = random_pose(100 + seed);
    const DentalScan scan = scan_of(patient, upper, X_SC, seed);
    const ArchFit fit = fitted(scan, target);
    const PoseError error = pose_error(scan.mesh, fit.X_CS, X_SC.inverse());
    EXPECT_LT(error.mean_mm, 0.25) << patient.name << " " << upper;
    EXPECT_LT(error.largest_mm, 0.35);
    EXPECT_LT(fit.mean_mm, good_fit_mm);
    EXPECT_GT(fit.p95_mm, 0.3);  // a fifth of the target is up to 3 mm off, and seen
    EXPECT_EQ(refusal(fit, scan, ArchTarget(target), false), "");
    ::testing::Test::RecordProperty(patient.name + (upper ? " upper um" : " lower um"),
                                    static_cast<int>(1000 * error.mean_mm));
  }
}

/// The built-in patient whose lower crowns a CT shows elsewhere, as a bite that is a little open.
Case with_open_bite(const Pose& X) {
  Case patient = builtin();
  for (Part& part : patient.parts)
    if (part.role == Role::lower_teeth) part.mesh = carried(part.mesh, X);
  return patient;
}

/// Fraction of the crowns' triangles where the other part has another tooth or none.
double wrongly_numbered(const Part& part, const Part& truth) {
  const TriangleTree tree(part.mesh);
  const auto number_at = [](const Part& teeth, int triangle) {
    for (const Tooth& tooth : teeth.teeth)
      if (triangle >= tooth.first_triangle &&
          triangle < tooth.first_triangle + tooth.triangle_count)
        return tooth.fdi;
    return 0;
  };
  int all = 0, wrong = 0;
  for (int t = 0; t < static_cast<int>(truth.mesh.triangles.size()); ++t) {
    const int near = tree.nearest(truth.mesh.vertices[truth.mesh.triangles[t][0]], 0.3).triangle;
    if (near < 0) continue;  // roots
    ++all;
    wrong += number_at(part, near) != number_at(truth, t);
  }
  EXPECT_GT(all, 10000);
  return static_cast<double>(wrong) / all;
}

Pose small_pose(double deg, const Vector3d& axis, const Vector3d& about, const Vector3d& shift) {
  Pose pose;
  pose.R = Eigen::AngleAxisd(deg * M_PI / 180, axis.normalized());
  pose.t = about + shift - pose.R * about;
  return pose;
}

}  // namespace

TEST(DentalScan, IsFoundOnCrownsOfACtFromAnyFrame) { expect_found_in_ct(builtin(), 1); }

TEST(DentalScan, IsFoundOnRealCrowns) {
  const auto patient = case_ubc();
  if (!patient) GTEST_SKIP() << "real data is absent";
  expect_found_in_ct(*patient, 2);
}

TEST(DentalScan, ConnectedScansWithGumAreFound) {
  // Crowns and gum as one surface, as scanners give them, 13 mm high.
  TriMesh solid = crowns(builtin(), true).mesh;
  const TriMesh& gum = builtin().find(Role::upper_gums)->mesh;
  const int offset = static_cast<int>(solid.vertices.size());
  solid.vertices.insert(solid.vertices.end(), gum.vertices.begin(), gum.vertices.end());
  for (const auto& t : gum.triangles)
    solid.triangles.push_back(t + Eigen::Vector3i::Constant(offset));
  const Box box = bounding_box(solid);
  const auto grid =
      even_grid({box.low - Vector3d::Constant(2), box.high + Vector3d::Constant(2)}, 0.4);
  TriMesh mesh = isosurface(mesh_field(solid, grid, 2, 2));
  std::vector<double> values;
  for (const auto& v : mesh.vertices) values.push_back(v.z() - box.low.z() - 13);
  mesh = largest_piece(clipped(mesh, values));
  const Pose X_SC = random_pose(12);
  const DentalScan scan = dental_scan(carried(mesh, X_SC), "gum.ply");
  const ArchFit fit = fitted(scan, crowns(builtin(), true));
  EXPECT_LT(pose_error(scan.mesh, fit.X_CS, X_SC.inverse()).largest_mm, 0.1);
  EXPECT_LT(fit.mean_mm, 0.05);
  const ClosedScan closed = close_scan(carried(scan.mesh, fit.X_CS), Vector3d::UnitZ());
  EXPECT_TRUE(closed.closed);
  EXPECT_EQ(closed.skirts, 1);
}

TEST(DentalScan, PickedPointsStartTheFitAndWrongOnesAreRefused) {
  const Pose X_SC = random_pose(5);
  const DentalScan scan = scan_of(builtin(), true, X_SC);
  const ArchTarget target(crowns(builtin(), true));
  ArchFitRequest request;
  request.landmarks = builtin().landmarks;
  unsigned k = 0;
  for (const char* name : {"upper_incisal_point", "upper_left_first_molar_mesiobuccal_cusp",
                           "upper_right_first_molar_mesiobuccal_cusp"}) {
    const auto point = builtin().landmarks.find(name);
    ASSERT_TRUE(point) << name;
    const Vector3d pick_error(k % 2 ? 1 : -1, 0.5, k == 2 ? 1 : -0.5);  // as by hand
    request.picks.points[name] = X_SC * (*point + pick_error);
    ++k;
  }
  const ArchFit fit = fit_arch(scan, target, request);
  EXPECT_LT(pose_error(scan.mesh, fit.X_CS, X_SC.inverse()).largest_mm, 0.03);
  EXPECT_LT(fit.halves_mm, 0.1);
  EXPECT_GT(fit.picks_mm, 0.5);
  std::swap(request.picks.points["upper_incisal_point"],
            request.picks.points["upper_left_first_molar_mesiobuccal_cusp"]);
  expect_words(message_of([&] { fit_arch(scan, target, request); }), {"upper.stl", "mm off"});
  request.picks.points.erase("upper_incisal_point");
  request.picks.points["my_point"] = Vector3d::Zero();
  expect_words(message_of([&] { fit_arch(scan, target, request); }),
               {"2 of them", "three", "no landmark my_point"});
}

TEST(DentalScan, MirroredScansAreRefused) {
  // Teeth were lost on one side: else this patient is its own mirror image.
  const Part teeth = without_teeth(crowns(builtin(), true), {25, 26, 27});
  const ArchTarget target(teeth);
  TriMesh mesh = made_scan(teeth, {}, 3);
  for (auto& v : mesh.vertices) v.x() = -v.x();
  const Pose X = random_pose(9);
  const DentalScan mirror = dental_scan(carried(mesh, X), "mirror.ply");
  EXPECT_TRUE(mirror.inward);
  expect_words(refusal(fit_arch(mirror, target, {}), mirror, target, true),
               {"mirror.ply is mirrored"});
  const DentalScan scan = dental_scan(made_scan(teeth, X, 3), "scan.ply");
  EXPECT_EQ(refusal(fit_arch(scan, target, {}), scan, target, false), "");
}

TEST(DentalScan, ExchangedArchesAreRefused) {
  ScannedArchesRequest request;
  request.upper = scan_of(builtin(), false, random_pose(1));
  request.lower = scan_of(builtin(), true, random_pose(2));
  request.accept_residual = true;
  expect_words(message_of([&] { with_scanned_arches(builtin(), request); }),
               {"lower.stl is given as the upper arch", "the arches are exchanged"});
}

TEST(DentalScan, SurfacesThatAreNoArchAreRefused) {
  const Part& teeth = crowns(builtin(), true);
  Part one = without_teeth(teeth, {11, 12, 13, 14, 15, 16, 17, 21, 22, 23, 24, 25, 27});
  expect_words(message_of([&] { dental_scan(cut_at_gum(one.mesh, true), "tooth.stl"); }),
               {"tooth.stl", "mm", "picked points"});
  TriMesh metres = teeth.mesh;
  for (auto& v : metres.vertices) v *= 0.001;
  expect_words(message_of([&] { dental_scan(metres, "m.obj"); }), {"m.obj", "--units m"});
  expect_words(message_of([&] { dental_scan({}, "none.stl"); }), {"none.stl", "0 triangles"});
  Case bones = builtin();
  std::erase_if(bones.parts, [](const Part& part) { return is_teeth(part.role); });
  ScannedArchesRequest request;
  request.lower = scan_of(builtin(), false, {});
  expect_words(message_of([&] { with_scanned_arches(bones, request); }), {"no lower teeth"});
}

TEST(ScannedArches, ReplaceTheCrownsAndKeepTheScannedBite) {
  const Vector3d molars(0, -60, -50);
  const Pose X_open = small_pose(1.2, {1, 0.2, 0}, molars, {0.4, 0.3, -1.5});
  const Case ct = with_open_bite(X_open);
  const Pose X_SC = random_pose(4);  // of both scans
  TriMesh upper = made_scan(crowns(builtin(), true), X_SC, 5);
  const auto cusp = builtin().landmarks.find("upper_left_first_molar_mesiobuccal_cusp");
  ASSERT_TRUE(cusp);
  punch_hole(upper, X_SC * *cusp, 1.5);
  ScannedArchesRequest request;
  request.upper = dental_scan(upper, "upper.stl");
  request.lower = scan_of(builtin(), false, X_SC, 6);
  const ScannedArches made = with_scanned_arches(ct, request);
  ASSERT_TRUE(made.together && made.together->in_occlusion) << made.together->why;
  ASSERT_TRUE(made.bite && made.patient.X_CM_bite);
  // In the scanned bite the crowns lie as in the patient before the CT.
  const TriMesh& lower = crowns(ct, false).mesh;
  EXPECT_LT(pose_error(lower, *made.patient.X_CM_bite, X_open.inverse()).largest_mm, 0.03);
  EXPECT_NEAR(made.bite->rotation_deg, 1.2, 0.05);
  EXPECT_GT(made.bite->largest_mm, 1.5);
  for (const bool is_upper : {true, false}) {
    const Part& part = crowns(made.patient, is_upper);
    const Part& truth = crowns(ct, is_upper);
    EXPECT_TRUE(inspect(part.mesh).closed());
    EXPECT_EQ(part.name, truth.name);
    ASSERT_EQ(part.teeth.size(), truth.teeth.size());
    EXPECT_LT(wrongly_numbered(part, truth), 0.03);
  }
}

TEST(ScannedArches, AloneMakeACaseInTheirBite) {
  const Pose X_SC = random_pose(8);
  ScannedArchesRequest request;
  request.upper = scan_of(builtin(), true, X_SC);
  request.lower = scan_of(builtin(), false, X_SC);
  const ScannedArches made = case_of_scanned_arches(request, builtin());
  ASSERT_TRUE(made.together && made.together->in_occlusion) << made.together->why;
  ASSERT_EQ(made.patient.parts.size(), 2u);
  EXPECT_TRUE(made.patient.has_both_arches());
  // The crowns lie as the built-in patient's, which the attitude is taken from.
  const TriangleTree tree(crowns(builtin(), false).mesh);
  double farthest = 0;
  for (const auto& t : crowns(made.patient, false).mesh.triangles) {
    const Vector3d& p = crowns(made.patient, false).mesh.vertices[t[0]];
    if (p.z() > -53) farthest = std::max(farthest, tree.nearest(p).distance);
  }
  EXPECT_LT(farthest, 0.2);
  const auto left = made.patient.landmarks.find("left_condyle"),
             right = made.patient.landmarks.find("right_condyle"),
             edge = made.patient.landmarks.find("lower_incisal_point");
  ASSERT_TRUE(left && right && edge);
  EXPECT_NEAR((*left - *right).norm(), 110, 1e-6);
  EXPECT_NEAR((*left - *edge).norm(), 110, 1e-6);
  EXPECT_GT(left->x(), right->x());
  EXPECT_GT(left->y(), edge->y() + 70);
  EXPECT_GT(left->z(), edge->z() + 15);
}

TEST(ScannedArches, OfOtherPeopleAreTurnedAndKnownToHoldNoBite) {
  const auto patient = case_ubc();
  if (!patient) GTEST_SKIP() << "real data is absent";
  const Pose X_upper = random_pose(3), X_lower = random_pose(4);
  ScannedArchesRequest request;
  request.upper = scan_of(*patient, true, X_upper);
  request.lower = scan_of(*patient, false, X_lower);
  const ScannedArches made = case_of_scanned_arches(request, builtin());
  EXPECT_FALSE(made.together->in_occlusion);
  EXPECT_FALSE(made.patient.X_CM_bite);
  for (const auto& [fit, X_SC] : {std::pair(*made.upper, X_upper), std::pair(*made.lower, X_lower)})
    EXPECT_LT(rotation_angle(fit.X_CS * X_SC) * 180 / M_PI, 12);
}

}  // namespace condyle::test
