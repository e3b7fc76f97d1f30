#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "sim/case/landmark_names.h"
#include "sim/phantom/phantom_solid.h"
#include "sim/phantom/surfaces.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

// The head is its own mirror image, so the left side is tested, and that the right one mirrors it.

struct Head {
  PhantomSolid solid = make_phantom_solid();
  Landmarks landmarks = phantom_landmarks(solid);
  std::vector<Canal> canals = phantom_canals(landmarks);
  std::map<int, ToothPoints> teeth;
  Head() {
    for (const auto& tooth : tooth_points(solid)) teeth[tooth.fdi] = tooth;
  }
  Vector3d at(const std::string& name) const { return landmarks.points.at(name); }
};

const Head& head() {
  static const Head made;
  return made;
}

/// Distance from a point in the mandible to its surface along a direction.
double bone_along(const Vector3d& from, const Vector3d& direction) {
  double t = 0;
  while (t < 60 && head().solid.mandible(from + t * direction) < 0) t += 0.02;
  return t;
}

/// Front and back of the left ramus at a height: y of its borders.
std::pair<double, double> ramus_borders(double z) {
  double front = 1e9, back = -1e9;
  for (double y = -60; y < 0; y += 0.1)
    for (double x = 30; x < 60; x += 0.25)
      if (head().solid.mandible({x, y, z}) < 0) {
        front = std::min(front, y);
        back = std::max(back, y);
      }
  return {front, back};
}

TEST(SurgicalLandmarks, LingulaLiesInTheMiddleOfTheInnerSideOfTheRamus) {
  const Vector3d lingula = head().at("left_lingula"), notch = head().at("left_sigmoid_notch"),
                 gonion = head().at("left_gonion");
  EXPECT_NEAR((notch.z() - lingula.z()) / (notch.z() - gonion.z()), 0.42, 0.03);
  const auto [front, back] = ramus_borders(lingula.z());
  EXPECT_GT((lingula.y() - front) / (back - front), 0.45);
  EXPECT_LT((lingula.y() - front) / (back - front), 0.55);
  EXPECT_NEAR(head().solid.mandible(lingula), 0, 0.05);
  // The inner side: bone to the left of it, none to the right.
  EXPECT_LT(head().solid.mandible(lingula + Vector3d(1, 0, 0)), 0);
  EXPECT_GT(head().solid.mandible(lingula - Vector3d(1, 0, 0)), 0);
}

TEST(SurgicalLandmarks, MentalForamenOpensBelowThePremolars) {
  const Vector3d foramen = head().at("left_mental_foramen");
  EXPECT_NEAR(head().solid.mandible(foramen), 0, 0.05);
  const Vector3d first = head().teeth.at(34).apex, second = head().teeth.at(35).apex,
                 molar = head().teeth.at(36).apex;
  EXPECT_GT(foramen.y(), first.y());
  EXPECT_LT(foramen.y(), (second.y() + molar.y()) / 2);
  EXPECT_LT(foramen.z(), std::min(first.z(), second.z()));
  EXPECT_GT(foramen.z(), std::min(first.z(), second.z()) - 4);
  // Half way between the margin of the alveolar bone and the lower border.
  const double border =
      foramen.z() - 4 - bone_along(foramen - Vector3d(6, 0, 4), -Vector3d::UnitZ());
  const double margin = -58;
  EXPECT_NEAR((margin - foramen.z()) / (margin - border), 0.5, 0.12);
  // It opens to the side and back, and can be seen: the bone has a hole there.
  const Vector3d mouth(28, -75.6, -73.4);
  EXPECT_GT(head().solid.mandible(mouth), 0.5);
  EXPECT_LT((mouth - foramen).norm(), 3);
}

TEST(SurgicalLandmarks, InfraorbitalForamenLiesBelowTheOrbit) {
  const Vector3d foramen = head().at("left_infraorbital_foramen"),
                 orbitale = head().at("left_orbitale");
  EXPECT_NEAR(head().solid.skull(foramen), 0, 0.05);
  EXPECT_GT(orbitale.z() - foramen.z(), 6);
  EXPECT_LT(orbitale.z() - foramen.z(), 10);
  EXPECT_GT(foramen.x(), 24);  // 25 to 30 mm beside the midline
  EXPECT_LT(foramen.x(), 31);
  EXPECT_GT(head().solid.skull(foramen - Vector3d(0, 1, 0)), 0);  // on the front
  // It can be seen, is not a window into the sinus or the orbit, and opens down and inwards.
  const Vector3d mouth(26.8, -82, -8);
  EXPECT_GT(head().solid.skull(mouth), 0.5);
  EXPECT_LT((mouth - foramen).norm(), 3);
  EXPECT_LT(head().solid.skull({27.4, -76.3, -6.4}), -0.8);
}

TEST(SurgicalLandmarks, ZygomaxillareLiesOnTheCrestAboveTheMolarApices) {
  const Vector3d point = head().at("left_zygomaxillare"), orbitale = head().at("left_orbitale"),
                 a = head().at("a_point");
  const FieldRecipe& skull = head().solid.skull;
  EXPECT_NEAR(skull(point), 0, 0.05);
  EXPECT_GT(skull(point - Vector3d(0, 0, 1)), 0.5);  // on the lower border
  EXPECT_LT(skull(point + Vector3d(0, 0, 3)), -1);
  EXPECT_GT(point.z(), head().teeth.at(26).apex.z() + 3);
  // Adult Europeans after Howells: breadth between both points 82 to 104 mm, height of the cheek
  // 18 to 28 mm, the point behind subspinale by 19 to 31 mm.
  EXPECT_NEAR(2 * point.x(), 93, 11);
  EXPECT_NEAR(orbitale.z() - point.z(), 23, 5);
  EXPECT_NEAR(point.y() - a.y(), 25, 6);
  // From there the crest rises outwards to the cheek bone and is concave down to the teeth.
  const auto lowest = [&](double x) {
    double z = -48;
    while (skull({x, point.y(), z}) > 0) z += 0.02;
    return z;
  };
  EXPECT_GT(lowest(48), point.z() + 0.5);
  EXPECT_LT(lowest(36), point.z() - 3);
  EXPECT_GT(lowest(40), (lowest(34) + lowest(46)) / 2 + 1);
}

TEST(SurgicalLandmarks, CanalKeepsItsDistances) {
  const Canal& canal = head().canals.at(0);
  const double radius = canal.diameter_mm / 2;
  EXPECT_NEAR(canal.diameter_mm, 3, 0.5);
  ASSERT_GT(canal.points.size(), 20u);
  double lowest = 0, length = 0;
  for (std::size_t i = 0; i < canal.points.size(); ++i) {
    const Vector3d& p = canal.points[i];
    if (i > 0) {
      const double step = (p - canal.points[i - 1]).norm();
      EXPECT_LT(step, 2.5) << i;
      length += step;
    }
    lowest = std::min(lowest, p.z());
    const double from_lingula = (p - canal.points.front()).norm(),
                 from_foramen = (p - canal.points.back()).norm();
    if (from_lingula > 1 && from_foramen > 5.5) {
      EXPECT_LT(head().solid.mandible(p), -0.4) << i;
    }
    if (from_lingula < 5 || from_foramen < 6) continue;
    // Outer cortex and lower border; on the inner side of the ramus the wall is thin.
    EXPECT_GT(bone_along(p, Vector3d::UnitX()), radius + 2) << i;
    EXPECT_GT(bone_along(p, -Vector3d::UnitZ()), radius + 2) << i;
    EXPECT_LT(head().solid.mandible(p), -radius - 0.5) << i;
    for (const auto& tooth : head().solid.teeth)
      if (tooth.fdi > 30 && tooth.box.contains(p)) {
        EXPECT_GT(tooth.solid(p), radius + 1.5) << i << " " << tooth.fdi;
      }
  }
  EXPECT_GT(length, 55);
  EXPECT_LT(length, 80);
  const double dip = canal.points.back().z() - lowest;
  EXPECT_GT(dip, 3.9);
  EXPECT_LT(dip, 5.1);
}

TEST(SurgicalLandmarks, CanalRunsBelowTheMolars) {
  const Canal& canal = head().canals.at(0);
  for (const int fdi : {36, 37}) {
    const Vector3d apex = head().teeth.at(fdi).apex;
    const auto below = std::min_element(
        canal.points.begin(), canal.points.end(), [&](const Vector3d& a, const Vector3d& b) {
          return std::abs(a.y() - apex.y()) < std::abs(b.y() - apex.y());
        });
    EXPECT_GT(apex.z() - below->z(), 2 + canal.diameter_mm / 2) << fdi;
    EXPECT_LT(apex.z() - below->z(), 8) << fdi;
  }
}

TEST(SurgicalLandmarks, TipsAndApicesAreTheEndsOfTheirTeeth) {
  ASSERT_EQ(head().teeth.size(), 28u);
  for (const auto& tooth : head().solid.teeth) {
    const ToothPoints& points = head().teeth.at(tooth.fdi);
    EXPECT_NEAR(tooth.solid(points.tip), 0, 1e-6) << tooth.fdi;
    EXPECT_NEAR(tooth.solid(points.apex), 0, 1e-6) << tooth.fdi;
    // Nothing of the tooth lies beyond the apex, and just before it there is tooth.
    const bool upper = tooth.fdi < 30;
    EXPECT_LT(tooth.solid(points.apex + 0.3 * points.axis), -0.05) << tooth.fdi;
    EXPECT_GT(tooth.solid(points.apex - 0.3 * points.axis), 0.2) << tooth.fdi;
    const FieldRecipe& bone = upper ? head().solid.skull : head().solid.mandible;
    EXPECT_LT(bone(points.apex), -2) << tooth.fdi;
    EXPECT_GT(bone(points.tip), 3) << tooth.fdi;
    EXPECT_NEAR(points.axis.norm(), 1, 1e-12);
    const double turned = std::acos((points.tip - points.apex).normalized().dot(points.axis));
    EXPECT_LT(turned * 180 / std::numbers::pi, 16) << tooth.fdi;
    EXPECT_GT((points.tip - points.apex).norm(), 18) << tooth.fdi;
    EXPECT_LT((points.tip - points.apex).norm(), 27) << tooth.fdi;
    // A summit: the crown is lower 0.5 mm to each side, of an incisor in front and behind.
    const Vector3d back = (Vector3d::UnitY() - points.axis.y() * points.axis).normalized();
    const bool incisor = tooth.fdi % 10 <= 2;
    for (const Vector3d& side : {back, Vector3d(points.axis.cross(back))})
      for (const double step : {-0.5, 0.5})
        if (!incisor || side == back) {
          EXPECT_GT(tooth.solid(points.tip + step * side + 0.02 * points.axis), 0) << tooth.fdi;
        }
  }
  // Molars: the first cusp lies in front of and outside the middle of the crown.
  for (const int fdi : {26, 36}) {
    const auto& tooth = *std::find_if(head().solid.teeth.begin(), head().solid.teeth.end(),
                                      [&](const ToothSolid& t) { return t.fdi == fdi; });
    const Vector3d middle = tooth.box.center(), tip = head().teeth.at(fdi).tip;
    EXPECT_LT(tip.y(), middle.y() - 1) << fdi;
  }
}

TEST(SurgicalLandmarks, TeethHaveLandmarksAsSurgeonsNameThem) {
  for (const int place : {1, 3, 6})
    for (const int quadrant : {1, 2, 3, 4}) {
      const int fdi = 10 * quadrant + place;
      const auto names = tooth_landmark_names(fdi);
      EXPECT_EQ(head().at(names.tip), head().teeth.at(fdi).tip);
      EXPECT_EQ(head().at(names.apex), head().teeth.at(fdi).apex);
    }
  EXPECT_EQ(head().at(canonical_landmark("U6 L")), head().teeth.at(26).tip);
  EXPECT_EQ(head().at(canonical_landmark("L3 R")), head().teeth.at(43).tip);
  // Incisors within the norms: U1 to Frankfort 111 +- 6 degrees, interincisal 131 +- 6.
  const Vector3d upper = head().teeth.at(21).tip - head().teeth.at(21).apex,
                 lower = head().teeth.at(31).tip - head().teeth.at(31).apex;
  const auto degrees = [](double y, double z) { return std::atan2(y, z) * 180 / std::numbers::pi; };
  const double u1 = 90 + degrees(-upper.y(), -upper.z()), l1 = degrees(-lower.y(), lower.z());
  EXPECT_NEAR(u1, 111, 6);
  EXPECT_NEAR(180 - (u1 - 90) - l1, 131, 6);
}

TEST(SurgicalLandmarks, BothSidesMirrorEachOther) {
  const auto mirrored = [](const Vector3d& p) { return Vector3d(-p.x(), p.y(), p.z()); };
  ASSERT_EQ(head().canals.size(), 2u);
  ASSERT_EQ(head().canals[0].points.size(), head().canals[1].points.size());
  for (std::size_t i = 0; i < head().canals[0].points.size(); ++i)
    EXPECT_EQ(mirrored(head().canals[0].points[i]), head().canals[1].points[i]);
  EXPECT_EQ(head().canals[0].name, "left_mandibular_canal");
  EXPECT_EQ(head().canals[1].name, "right_mandibular_canal");
  for (const auto& [fdi, tooth] : head().teeth) {
    const int twin = fdi + (fdi / 10 % 2 == 1 ? 10 : -10);
    EXPECT_EQ(tooth.tip.x() > 0, fdi / 10 == 2 || fdi / 10 == 3) << fdi;
    EXPECT_EQ(mirrored(tooth.tip), head().teeth.at(twin).tip) << fdi;
    EXPECT_EQ(mirrored(tooth.apex), head().teeth.at(twin).apex) << fdi;
  }
}

}  // namespace
}  // namespace condyle
