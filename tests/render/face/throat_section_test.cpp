// A section of the open mouth: tongue and jaw stay out of the airway, which stays open.
#include "render/face/throat_section.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <optional>

#include "render/face/tongue_bend.h"
#include "sim/phantom/phantom.h"

namespace condyle {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Tissue = SectionOutline::Tissue;

const Case& patient() {
  static const Case built_in = builtin_patient();
  return built_in;
}

/// The jaw turned about the condyles, which have come forward.
Pose opened(double deg, double forward_mm) {
  const Eigen::Quaterniond R(Eigen::AngleAxisd(deg * std::numbers::pi / 180, Vector3d::UnitX()));
  const Vector3d condyles(0, -12, -7);
  return {R, condyles - R * condyles + Vector3d(0, -forward_mm, -0.4 * forward_mm)};
}

/// From a little to more than people can.
std::vector<Pose> openings() {
  std::vector<Pose> poses;
  for (int step = 1; step <= 9; ++step) poses.push_back(opened(5 * step, 2 * step));
  return poses;
}

bool is_inside(const Vector2f& p, const std::vector<Vector2f>& outline) {
  bool inside = false;
  for (std::size_t i = 0, before = outline.size() - 1; i < outline.size(); before = i++) {
    const Vector2f &a = outline[i], &b = outline[before];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      inside = !inside;
  }
  return inside;
}

const SectionOutline& of(Tissue tissue, const std::vector<SectionOutline>& all) {
  return *std::find_if(all.begin(), all.end(),
                       [&](const SectionOutline& each) { return each.tissue == tissue; });
}

/// From the front wall to the back at one height; none outside.
std::optional<float> depth_at(float z, const std::vector<Vector2f>& outline) {
  std::vector<float> crossings;
  for (std::size_t i = 0, before = outline.size() - 1; i < outline.size(); before = i++) {
    const Vector2f &a = outline[i], &b = outline[before];
    if ((a.y() > z) != (b.y() > z))
      crossings.push_back(a.x() + (z - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
  }
  if (crossings.size() != 2) return std::nullopt;
  return std::abs(crossings[1] - crossings[0]);
}

/// Vertices beside the median plane of tongue and lower jaw.
struct Moving {
  std::vector<Vector3f> tongue, jaw;
  Eigen::AlignedBox3f box;  // of the tongue

  Moving() {
    for (const Part& part : patient().parts)
      for (const auto& v : part.mesh.vertices) {
        const Vector3f p = v.cast<float>();
        if (part.role == Role::tongue) box.extend(p);
        if (std::abs(p.x()) > 6) continue;
        if (part.role == Role::tongue) tongue.push_back(p);
        if (part.role == Role::mandible) jaw.push_back(p);
      }
  }
};

TEST(ThroatSectionTest, NeitherTongueNorJawEntersTheAirwayOfAnOpenMouth) {
  const ThroatSection throat(patient().parts);
  ASSERT_TRUE(throat.exists());
  const Moving moving;
  ASSERT_GT(moving.tongue.size(), 100u);
  ASSERT_GT(moving.jaw.size(), 100u);
  const auto rest = throat.at({});
  int unbent = 0, jaw_at_rest = 0;
  for (const Pose& X_CM : openings()) {
    const auto now = throat.at(X_CM);
    const auto& air = of(Tissue::air, now).points;
    const TongueBend bend(moving.box, X_CM);
    for (const Vector3f& v : moving.tongue) {
      EXPECT_FALSE(is_inside(bend(v).tail<2>(), air)) << bend(v).transpose();
      unbent += is_inside((X_CM * v.cast<double>()).tail<2>().cast<float>(),
                          of(Tissue::air, rest).points);
    }
    for (const Vector3f& v : moving.jaw) {
      const Vector2f p = (X_CM * v.cast<double>()).tail<2>().cast<float>();
      EXPECT_FALSE(is_inside(p, air)) << p.transpose();
      jaw_at_rest += is_inside(p, of(Tissue::air, rest).points);
    }
    for (const SectionOutline& outline : now) {
      if (!outline.with_tongue) continue;
      for (const Vector2f& p : outline.points) EXPECT_FALSE(is_inside(p, air)) << p.transpose();
    }
  }
  // A tongue that did not bend, and an airway that did not give way, would fail.
  EXPECT_GT(unbent, 100);
  EXPECT_GT(jaw_at_rest, 10);
}

TEST(ThroatSectionTest, TheAirwayKeepsMostOfItsDepthAndItsUpperEnd) {
  const ThroatSection throat(patient().parts);
  const auto rest = throat.at({});
  int narrowed = 0;
  for (const Pose& X_CM : openings()) {
    const auto now = throat.at(X_CM);
    const auto &before = of(Tissue::air, rest).points, &air = of(Tissue::air, now).points;
    ASSERT_EQ(air.size(), before.size());
    for (float z = -170; z < -56; z += 1) {
      const auto was = depth_at(z, before), is = depth_at(z, air);
      ASSERT_TRUE(was && is) << z;
      EXPECT_GT(*is, 0.6f * *was) << z;
      EXPECT_LT(*is, 1.1f * *was) << z;
      narrowed += *is < 0.8f * *was;
    }
    for (std::size_t i = 0; i < air.size(); ++i) {
      EXPECT_GE(air[i].x(), before[i].x()) << "backward";
      if (before[i].y() > -54) {
        EXPECT_EQ(air[i], before[i]) << "above the soft palate's tip";
      }
    }
  }
  EXPECT_GT(narrowed, 10);
}

TEST(ThroatSectionTest, TheHyoidStaysBehindTheChinAndTheTongueComesForwardInTheArch) {
  const ThroatSection throat(patient().parts);
  const Moving moving;
  const Vector3f back(0, moving.box.max().y() - 8, moving.box.max().z() - 8);
  float before = 0;
  for (const Pose& X_CM : openings()) {
    const auto now = throat.at(X_CM);
    const TongueBend bend(moving.box, X_CM);
    const Vector3d in_arch = X_CM.inverse() * bend(back).cast<double>();
    const float forward = back.y() - static_cast<float>(in_arch.y());
    EXPECT_GT(forward, before);
    before = forward;
    for (const Vector2f& p : of(Tissue::bone, now).points)
      for (const Vector3f& v : moving.jaw) {
        const Vector2f q = (X_CM * v.cast<double>()).tail<2>().cast<float>();
        EXPECT_GT((q - p).norm(), 3);
      }
  }
  EXPECT_GT(before, 2);
  EXPECT_LT(before, 15);
}

TEST(ThroatSectionTest, NothingMovesAtRestAndWithoutATongueThereIsNone) {
  const Moving moving;
  const TongueBend bend(moving.box, {});
  for (const Vector3f& v : moving.tongue) EXPECT_LT((bend(v) - v).norm(), 1e-4f);
  std::vector<Part> others;
  for (const Part& part : patient().parts)
    if (part.role == Role::mandible) others.push_back(part);
  const ThroatSection none(others);
  EXPECT_FALSE(none.exists());
  EXPECT_TRUE(none.at(opened(20, 8)).empty());
}

TEST(ThroatSectionTest, AMovedPatientsThroatMovesWithIt) {
  const Vector3d offset(30, -200, 500);
  std::vector<Part> moved = patient().parts;
  for (Part& part : moved)
    for (auto& v : part.mesh.vertices) v += offset;
  const Pose X_CM = opened(30, 12), there = {X_CM.R, X_CM.t + offset - X_CM.R * offset};
  const auto here = ThroatSection(patient().parts).at(X_CM), now = ThroatSection(moved).at(there);
  ASSERT_EQ(here.size(), now.size());
  for (std::size_t k = 0; k < here.size(); ++k) {
    EXPECT_NEAR(now[k].middle, here[k].middle + 30, 1e-3);
    for (std::size_t i = 0; i < here[k].points.size(); ++i)
      EXPECT_LT((now[k].points[i] - here[k].points[i] - offset.tail<2>().cast<float>()).norm(),
                0.02f);
  }
}

}  // namespace
}  // namespace condyle
