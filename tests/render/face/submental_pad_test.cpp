// The skin under the chin of a real opening of the built-in patient bulges instead of folding into
// a deep cleft, in pictures alone; at rest it is as without a pad, bit for bit.
#include "render/face/submental_pad.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <string>
#include <vector>

#include "tests/render/face/opened_patient.h"

namespace condyle {
namespace {

using Eigen::Vector3f;

const SubmentalPad& pad() {
  static const OpenedPatient& p = opened_patient();
  static const SubmentalPad made(p.rest, p.face->mesh.triangles, p.prepared.lining()->rim);
  return made;
}

NeckProfile profile() {
  const OpenedPatient& p = opened_patient();
  return find_neck_profile(p.rest, p.face->mesh.triangles, p.prepared.lining()->rim).value();
}

/// Depth of the deepest cleft of the midline under the chin, mm: of those at most 15 mm wide.
float cleft_mm(const std::vector<Vector3f>& places) {
  const OpenedPatient& p = opened_patient();
  const NeckProfile neck = profile();
  std::vector<std::size_t> line;
  for (std::size_t v = 0; v < p.rest.size(); ++v)
    if (std::abs(p.rest[v].x() - neck.cervical_point.x()) < 2 &&
        (p.rest[v] - neck.cervical_point).norm() < 40)
      line.push_back(v);
  const Vector3f down = neck.throat - neck.chin;
  std::sort(line.begin(), line.end(), [&](std::size_t a, std::size_t b) {
    return p.rest[a].dot(down) < p.rest[b].dot(down);
  });
  float deepest = 0;
  for (std::size_t a = 0; a < line.size(); ++a)
    for (std::size_t b = a + 2; b < line.size(); ++b) {
      const Vector3f from = places[line[a]], chord = places[line[b]] - from;
      if (chord.norm() > 15) continue;
      const Vector3f behind = Vector3f(0, -chord.z(), chord.y()).normalized();
      for (std::size_t i = a + 1; i < b; ++i)
        deepest = std::max(deepest, (places[line[i]] - from).dot(behind));
    }
  return deepest;
}

TEST(SubmentalPadTest, FindsTheProfileWhereTheLandmarksAre) {
  const Landmarks& landmarks = opened_patient().scene.patient.landmarks;
  const NeckProfile neck = profile();
  EXPECT_LT((neck.cervical_point - landmarks.find("cervical_point").value().cast<float>()).norm(),
            6);
  EXPECT_LT((neck.pogonion - landmarks.find("soft_pogonion").value().cast<float>()).norm(), 6);
  EXPECT_GT(neck.chin.z(), neck.cervical_point.z());
  EXPECT_LT(neck.throat.z(), neck.cervical_point.z());
}

TEST(SubmentalPadTest, AFaceWithoutAMouthOrANeckHasNone) {
  const OpenedPatient& p = opened_patient();
  const auto& rim = p.prepared.lining()->rim;
  EXPECT_FALSE(find_neck_profile(p.rest, p.face->mesh.triangles, {}));
  const float bottom = profile().cervical_point.z() + 5;
  std::vector<Eigen::Vector3i> cut;
  for (const Eigen::Vector3i& t : p.face->mesh.triangles)
    if (std::all_of(t.begin(), t.end(),
                    [&](int v) { return p.rest[static_cast<std::size_t>(v)].z() > bottom; }))
      cut.push_back(t);
  ASSERT_FALSE(cut.empty());
  EXPECT_FALSE(find_neck_profile(p.rest, cut, rim));
  auto places = opened_patient().drawn(opened_patient().frame("open 40"));
  const auto before = places;
  SubmentalPad(p.rest, cut, rim).apply(places);
  EXPECT_EQ(places, before);
}

TEST(SubmentalPadTest, RestAndASmallOpeningStayBitForBit) {
  for (const char* words : {"open 1", "open 5"}) {
    auto places = opened_patient().drawn(opened_patient().frame(words));
    const auto before = places;
    pad().apply(places);
    EXPECT_EQ(places, before) << words;
  }
}

TEST(SubmentalPadTest, AWideOpeningKeepsThreeFifthsOfTheCleftAtMost) {
  for (const char* words : {"open 30", "open 40", "open 45"}) {
    const auto folded = opened_patient().drawn(opened_patient().frame(words));
    auto drawn = folded;
    pad().apply(drawn);
    const float before = cleft_mm(folded), after = cleft_mm(drawn);
    RecordProperty(words, std::to_string(before) + " to " + std::to_string(after));
    EXPECT_LE(after, before) << words;
    if (before > 6) {
      EXPECT_LT(after, 0.6f * before) << words;
    }
  }
}

TEST(SubmentalPadTest, TheJawStaysCovered) {
  const FrameState frame = opened_patient().frame("open 45");
  const auto folded = opened_patient().drawn(frame);
  auto drawn = folded;
  pad().apply(drawn);
  const auto [tested, nearest] = opened_patient().clearance(frame, folded, drawn);
  EXPECT_GT(tested, 400u);
  EXPECT_GT(nearest, 3);
  RecordProperty("nearest", std::to_string(nearest));
}

}  // namespace
}  // namespace condyle
