// Cheeks of the built-in patient sink in as the mouth really opens and bulge in a real smile, in
// pictures alone; at rest nothing changes, bit for bit.
#include "render/face/cheek_thickness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/render/face/opened_patient.h"

namespace condyle {
namespace {

using Eigen::Vector3f;

const CheekThickness& cheeks() {
  static const OpenedPatient& p = opened_patient();
  static const CheekThickness made(p.rest, p.normals, p.prepared.lining()->rim, p.parts);
  return made;
}

/// Largest displacement on a side of the face, mm.
float deepest(const std::vector<Vector3f>& smooth, const std::vector<Vector3f>& sunken,
              float side) {
  float most = 0;
  for (std::size_t v = 0; v < smooth.size(); ++v)
    if (side * opened_patient().rest[v].x() > 0)
      most = std::max(most, (sunken[v] - smooth[v]).norm());
  return most;
}

TEST(CheekThicknessTest, RestStaysBitForBit) {
  auto places = opened_patient().rest;
  EXPECT_TRUE(cheeks().apply(places).empty());
  EXPECT_EQ(places, opened_patient().rest);
}

TEST(CheekThicknessTest, AFaceWithoutAMouthOrJawsHasNone) {
  const OpenedPatient& p = opened_patient();
  auto stretched = p.rest;
  for (auto& at : stretched) at.z() *= 1.4f;
  const auto before = stretched;
  const CheekThickness no_rim(p.rest, p.normals, {}, p.parts);
  const CheekThickness no_jaws(p.rest, p.normals, p.prepared.lining()->rim, {});
  EXPECT_TRUE(no_rim.apply(stretched).empty());
  EXPECT_TRUE(no_jaws.apply(stretched).empty());
  EXPECT_EQ(stretched, before);
  EXPECT_FALSE(cheeks().apply(stretched).empty());
}

TEST(CheekThicknessTest, OpenedCheeksSinkInBesideTheCornersAndDeeperWithTheOpening) {
  float first = 0, before = 0;
  for (const char* words : {"open 15", "open 30", "open 40"}) {
    const auto smooth = opened_patient().drawn(opened_patient().frame(words));
    auto sunken = smooth;
    cheeks().apply(sunken);
    const float left = deepest(smooth, sunken, 1), right = deepest(smooth, sunken, -1);
    EXPECT_NEAR(left, right, 0.3f) << words;
    RecordProperty(words, std::to_string(left));
    EXPECT_GE(left, before) << words;
    before = left;
    if (first == 0) first = left;
    for (std::size_t v = 0; v < smooth.size(); ++v) {
      if (sunken[v] == smooth[v]) continue;
      const Vector3f& p = opened_patient().rest[v];
      EXPECT_GT((p - opened_patient().corner(p.x() > 0 ? 1.f : -1.f)).norm(), 4) << p.transpose();
    }
  }
  EXPECT_LT(2 * first, before);
  EXPECT_GT(before, 1.5f);
  EXPECT_LT(before, 5);
}

/// Largest step from an undisplaced vertex to its neighbour, over their distance.
float step_at_end(const std::string& words) {
  const auto smooth = opened_patient().drawn(opened_patient().frame(words));
  auto sunken = smooth;
  cheeks().apply(sunken);
  float step = 0;
  for (const auto& t : opened_patient().face->mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(t[k]), b = static_cast<std::size_t>(t[(k + 1) % 3]);
      const float apart = (smooth[a] - smooth[b]).norm();
      if (sunken[a] == smooth[a] && apart > 0.1f)
        step = std::max(step, (sunken[b] - smooth[b]).norm() / apart);
    }
  return step;
}

TEST(CheekThicknessTest, HollowsAndBulgesEndWithoutAStep) {
  for (const char* words : {"open 40", "smile 1"}) {
    const float step = step_at_end(words);
    RecordProperty(words, std::to_string(step));
    EXPECT_GT(step, 0) << words;
    EXPECT_LT(step, 0.1f) << words;
  }
}

TEST(CheekThicknessTest, SmilingCheeksBulgeBelowTheEyesAndMoreWithTheSmile) {
  const OpenedPatient& p = opened_patient();
  float before = 0;
  for (const char* words : {"smile 0.5", "smile 1"}) {
    const auto smooth = opened_patient().drawn(opened_patient().frame(words));
    auto bulged = smooth;
    EXPECT_TRUE(cheeks().apply(bulged).empty()) << words;  // nothing gets darker
    const float left = deepest(smooth, bulged, 1), right = deepest(smooth, bulged, -1);
    RecordProperty(words, std::to_string(left));
    EXPECT_NEAR(left, right, 0.4f) << words;
    EXPECT_GT(left, 1.5f * before) << words;
    before = left;
    for (std::size_t v = 0; v < smooth.size(); ++v) {
      const Vector3f moved = bulged[v] - smooth[v];
      if (moved.norm() < 0.5f * left) continue;
      EXPECT_GT(moved.dot(p.normals[v]), 0) << p.rest[v].transpose();
      EXPECT_GT(p.rest[v].z(), p.corner(1).z() + 8) << p.rest[v].transpose();
    }
  }
  EXPECT_GT(before, 1.5f);
  EXPECT_LT(before, 4);
}

TEST(CheekThicknessTest, ASmileOfOneSideBulgesThatCheekAlone) {
  const auto smooth = opened_patient().drawn(opened_patient().frame("smile 1 left"));
  auto bulged = smooth;
  cheeks().apply(bulged);
  EXPECT_GT(deepest(smooth, bulged, 1), 1);
  EXPECT_EQ(deepest(smooth, bulged, -1), 0);
}

TEST(CheekThicknessTest, SunkenCheeksStayClearOfJawsAndTeeth) {
  const FrameState frame = opened_patient().frame("open 40");
  const auto smooth = opened_patient().drawn(frame);
  auto sunken = smooth;
  cheeks().apply(sunken);
  const auto [tested, nearest] = opened_patient().clearance(frame, smooth, sunken);
  EXPECT_GT(tested, 400u);
  EXPECT_GT(nearest, 2);
  RecordProperty("nearest", std::to_string(nearest));
}

}  // namespace
}  // namespace condyle
