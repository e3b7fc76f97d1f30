#include "sim/phantom/phantom_solid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/field/isosurface.h"
#include "engine/math/pchip.h"
#include "engine/math/pose.h"
#include "sim/phantom/bone_shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

const PhantomSolid& solid() {
  static const PhantomSolid made = make_phantom_solid();
  return made;
}

/// Rotation about the condyles, then translation along their path.
Pose opened(double rotation_deg, double slide_mm) {
  const auto table = phantom_condylar_path();
  const Pchip drop(table.forward_mm, table.inferior_mm);
  const Vector3d hinge(0, condyle_center.y(), condyle_center.z());
  Pose X_CM;
  X_CM.R = Eigen::AngleAxisd(rotation_deg * std::numbers::pi / 180, Vector3d::UnitX());
  X_CM.t = hinge - X_CM.R * hinge + Vector3d(0, -slide_mm, -drop(slide_mm));
  return X_CM;
}

std::vector<Vector3d> surface_points(const FieldRecipe& field, const Eigen::AlignedBox3d& box,
                                     double spacing) {
  return isosurface(sample_field(field, even_grid(box, spacing))).vertices;
}

const std::vector<Vector3d>& mandible_points() {
  static const auto points =
      surface_points(solid().mandible, {Vector3d(0, -98, -100), Vector3d(66, 2, 2)}, 0.9);
  return points;
}

const std::vector<Vector3d>& lower_tooth_points() {
  static const auto points = [] {
    std::vector<Vector3d> all;
    for (const auto& tooth : solid().teeth)
      if (tooth.fdi > 30)
        for (const auto& p : surface_points(tooth.solid, tooth.box, 0.5)) all.push_back(p);
    return all;
  }();
  return points;
}

template <class Field>
double least(const Field& field, const std::vector<Vector3d>& points, const Pose& X) {
  double d = 1e9;
  for (const auto& p : points) d = std::min(d, field(X * p));
  return d;
}

TEST(PhantomSolid, CondyleSitsInItsFossa) {
  double top = -20, roof = 20;
  for (double z = -7.5; z < 6; z += 0.01) {
    const Vector3d p(condyle_center.x(), condyle_center.y(), z);
    if (solid().mandible(p) < 0) top = z;
    if (z > top && roof > 6 && solid().skull(p) < 0) roof = z;
  }
  EXPECT_GT(roof - top, 2);
  EXPECT_LT(roof - top, 3);
  const double anywhere = least(solid().skull, mandible_points(), Pose());
  EXPECT_GT(anywhere, 1);
  EXPECT_LT(anywhere, 2);
}

TEST(PhantomSolid, BonesStayApartAlongBuiltInMotions) {
  struct Step {
    double rotation_deg, slide_mm;
  };
  double drop = 0;
  for (const auto& s : {Step{0, 0},
                        {6, 0},
                        {12, 0},
                        {15, 2},
                        {20, 5},
                        {25, 8.5},
                        {30, 12},
                        {34, 14.6},
                        {38, 17},
                        {44, 17},
                        {46, 19},
                        {4, 4},
                        {4, 8}}) {
    const Pose X_CM = opened(s.rotation_deg, s.slide_mm);
    EXPECT_GT(least(solid().skull, mandible_points(), X_CM), 0.9)
        << s.rotation_deg << " " << s.slide_mm;
    EXPECT_GT(least(solid().skull, lower_tooth_points(), X_CM), 0.5) << s.rotation_deg;
    drop = std::max(drop, -50.9 - (X_CM * Vector3d(0, -92.5, -50.9)).z());
  }
  EXPECT_GT(drop, 50);
}

TEST(PhantomSolid, CondyleKeepsItsGapOnTheWholePath) {
  std::vector<Vector3d> head;
  for (const auto& p : mandible_points())
    if (p.z() > -14 && p.y() > -22) head.push_back(p);
  ASSERT_GT(head.size(), 100u);
  for (double s = 0; s <= 19; s += 1) {
    const double gap = least(solid().skull, head, opened(2.3 * s, s));
    EXPECT_GT(gap, 1) << s;
    EXPECT_LT(gap, 3) << s;
  }
}

TEST(PhantomSolid, TeethMeetWithoutTouching) {
  const auto upper = [](const Vector3d& p) { return solid().upper_teeth(p); };
  const double rest = least(upper, lower_tooth_points(), Pose());
  EXPECT_GT(rest, 0.05);
  EXPECT_LT(rest, 0.15);
  double before = rest;
  for (const double angle : {1.0, 2.0, 3.0}) {
    const double gap = least(upper, lower_tooth_points(), opened(angle, 0));
    EXPECT_GT(gap, before + 0.2);
    before = gap;
  }
  // Many contacts, spread over the arch: the bite is no single point.
  std::vector<int> close(14, 0);
  std::size_t tooth = 0;
  for (const auto& t : solid().teeth) {
    if (t.fdi > 30)
      for (const auto& p : surface_points(t.solid, t.box, 0.5))
        close[tooth] += solid().upper_teeth(p) < 0.3;
    ++tooth;
  }
  EXPECT_GE(std::count_if(close.begin(), close.end(), [](int n) { return n > 0; }), 6);
}

TEST(PhantomSolid, SkinCoversBoneAndTeeth) {
  const std::vector<Vector3d> skull =
      surface_points(solid().skull, {Vector3d(0, -112, -62), Vector3d(76, 102, 122)}, 1.3);
  std::vector<double> depths;
  for (const auto* points : std::initializer_list<const std::vector<Vector3d>*>{
           &skull, &mandible_points(), &lower_tooth_points()})
    for (const auto& p : *points) {
      if (p.y() > -12 && p.y() < 12 && p.x() > 55) continue;  // the ear canal
      depths.push_back(-solid().skin(p));
    }
  EXPECT_GT(depths.size(), 20000u);
  EXPECT_GT(*std::min_element(depths.begin(), depths.end()), 1.8);
}

/// Where the solid ends along a ray toward -y or +x.
double surface_along(const FieldRecipe& field, Vector3d from, const Vector3d& direction) {
  for (double t = 0; t < 110; t += 0.05)
    if (field(from + t * direction) < 0) return t;
  return 1e9;
}

TEST(PhantomSolid, ProfilesFollowTheTables) {
  struct Point {
    double z, y;
  };
  const auto check = [](const FieldRecipe& field, const std::vector<Point>& profile,
                        double tolerance) {
    for (const auto& point : profile) {
      const double y = -135 + surface_along(field, {0, -135, point.z}, Vector3d::UnitY());
      EXPECT_NEAR(y, point.y, tolerance) << point.z;
    }
  };
  // Nasal bones and spine are drawn blunter than the tables.
  check(solid().skull,
        {{80, -78.4},
         {70, -83.9},
         {60, -88.1},
         {50, -91.1},
         {40, -93.4},
         {34, -92},
         {28, -90.7},
         {22, -91.3},
         {16, -94.7},
         {-30, -91},
         {-36, -91.3},
         {-42, -90}},
        1.0);
  check(solid().mandible,
        {{-60, -90.7},
         {-64, -90},
         {-67, -88.5},
         {-70, -87.8},
         {-73, -88.3},
         {-76, -89.3},
         {-80, -90.7},
         {-84, -90.6},
         {-88, -89.2}},
        0.7);
  check(solid().skin, {{85, -81.6},   {75, -87.6},   {65, -92.5},   {55, -96.4},   {46, -98.9},
                       {40, -99.4},   {34, -98.5},   {28, -96.9},   {22, -96.8},   {16, -99.7},
                       {10, -103.6},  {4, -107.3},   {-2, -112},    {-8, -116.5},  {-14, -118.7},
                       {-20, -117.4}, {-46, -105.2}, {-54, -105},   {-62, -100.1}, {-66, -98.9},
                       {-70, -98.2},  {-75, -98.9},  {-80, -100.2}, {-85, -100.6}, {-90, -99.7}},
        1.2);
}

TEST(PhantomSolid, HalfWidthsFollowTheTables) {
  struct Width {
    double z, y, x;
  };
  const auto check = [](const FieldRecipe& field, const std::vector<Width>& table,
                        double tolerance) {
    for (const auto& w : table) {
      const double x = 110 - surface_along(field, {110, w.y, w.z}, -Vector3d::UnitX());
      EXPECT_NEAR(x, w.x, tolerance) << w.z << " " << w.y;
    }
  };
  check(solid().skull,
        {{100, 0, 46},
         {80, -40, 55},
         {80, 20, 63},
         {60, -60, 51},
         {60, 40, 66},
         {40, 0, 70},
         {40, 60, 60},
         {20, -20, 57},
         {20, 40, 64},
         {0, 20, 63},
         {0, 60, 52}},
        1.5);
  check(solid().skin,
        {{40, -80, 49},
         {20, -60, 63},
         {0, -70, 60},
         {0, -50, 69},
         {-20, -60, 62},
         {-40, -70, 53},
         {-40, -40, 63},
         {-60, -80, 40},
         {-60, -50, 56},
         {-80, -70, 41}},
        1.5);
  check(solid().mandible,
        {{-60, -75, 26}, {-60, -55, 37}, {-60, -35, 45}, {-40, -35, 44}, {-40, -25, 47}}, 1.5);
}

TEST(PhantomSolid, IsMirrorSymmetric) {
  for (double x = 1; x < 70; x += 7)
    for (double y = -110; y < 90; y += 13)
      for (double z = -95; z < 100; z += 11)
        for (const auto* field :
             {&solid().skull, &solid().mandible, &solid().skin, &solid().oral_cavity}) {
          ASSERT_EQ((*field)({x, y, z}), (*field)({-x, y, z}));
        }
}

TEST(PhantomSolid, HollowsAreHollow) {
  const auto outside_bone = [](const Vector3d& p) { return solid().skull(p) > 1; };
  EXPECT_TRUE(outside_bone({0, 10, 50}));      // brain
  EXPECT_TRUE(outside_bone({32, -73, 15}));    // orbit
  EXPECT_TRUE(outside_bone({6, -80, -8}));     // nose
  EXPECT_TRUE(outside_bone({24, -63, -13}));   // sinus
  EXPECT_TRUE(outside_bone({55, -40, -8}));    // behind the arch
  EXPECT_LT(solid().skull({64, -38, -7}), 0);  // the arch itself
  EXPECT_LT(solid().nasal_cavity({5, -75, -10}), 0);
  EXPECT_LT(solid().oral_cavity({0, -80, -50}), 0);
}

}  // namespace
}  // namespace condyle
