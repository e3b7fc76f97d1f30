// Skin folds along lines across which it is compressed, in pictures alone; at rest and where it is
// stretched the drawn face is that without folds, bit for bit.
#include "render/face/skin_folds.h"

#include <algorithm>
#include <array>
#include <utility>

#include "render/face/mouth_lining.h"
#include "render/mesh/vertex_normals.h"
#include "tests/render/face/opened_patient.h"
#include "tests/render/face/slit_head.h"

namespace condyle {
namespace {

using Eigen::Vector3f;

/// A round head with a nose and with a slit of 50 mm for a mouth, and a ball for each jaw's teeth.
std::vector<Part> head_with_nose() {
  TriMesh face = ball({0, 0, 0}, 60, 120);
  for (auto& p : face.vertices) {
    const double across = p.x() / 9, up = (p.z() - 26) / 9;
    if (p.y() < 0) p.y() -= 18 * std::exp(-across * across - up * up);
  }
  return head_with_slit(std::move(face));
}

/// The face of that head and its folds.
struct FoldedHead {
  std::vector<Part> parts = head_with_nose();
  std::vector<Vector3f> rest = {}, normals = {};
  std::optional<SkinFolds> folds = {};

  FoldedHead() {
    const TriMesh& face = parts[0].mesh;
    for (const auto& p : face.vertices) rest.push_back(p.cast<float>());
    vertex_normals(rest, face.triangles, normals);
    const auto lining = line_mouth(parts);
    if (lining) folds.emplace(rest, normals, face.triangles, lining->rim);
  }

  /// The left corner of the mouth drawn up and outward by so much, mm, and the skin around it.
  std::vector<Vector3f> smiling(float mm) const {
    const Vector3f corner(25, -54.5f, 0);
    std::vector<Vector3f> places = rest;
    for (auto& p : places) {
      const float near = std::exp(-(p - corner).squaredNorm() / (12 * 12));
      p += mm * near * Vector3f(0.6f, 0.15f, 0.8f);
    }
    return places;
  }
};

TEST(SkinFoldsTest, RestAndStretchedSkinStayBitForBit) {
  const FoldedHead head;
  ASSERT_TRUE(head.folds);
  std::vector<Vector3f> places = head.rest;
  EXPECT_TRUE(head.folds->apply(places).empty());
  EXPECT_EQ(places, head.rest);
  for (auto& p : places) p *= 1.1f;
  const std::vector<Vector3f> stretched = places;
  EXPECT_TRUE(head.folds->apply(places).empty());
  EXPECT_EQ(places, stretched);
}

TEST(SkinFoldsTest, ASideThatSmilesFoldsBesideItsCornerAndDeeperWithTheSmile) {
  const FoldedHead head;
  ASSERT_TRUE(head.folds);
  double before = 0;
  for (const float mm : {5.f, 10.f}) {
    const std::vector<Vector3f> smooth = head.smiling(mm);
    std::vector<Vector3f> places = smooth;
    EXPECT_FALSE(head.folds->apply(places).empty());
    double deepest = 0;
    for (std::size_t v = 0; v < places.size(); ++v) {
      if (places[v] == smooth[v]) continue;
      const Vector3f& p = head.rest[v];
      EXPECT_GT(p.x(), 0) << p.transpose();
      EXPECT_LT(p.y(), 0) << p.transpose();
      deepest = std::max(deepest, static_cast<double>((places[v] - smooth[v]).norm()));
      EXPECT_LT((places[v] - smooth[v]).norm(), 4);
    }
    EXPECT_GT(deepest, before + 0.1);
    before = deepest;
    std::vector<Vector3f> again = smooth;
    head.folds->apply(again);
    EXPECT_EQ(again, places);
  }
  EXPECT_GT(before, 0.8);
}

TEST(SkinFoldsTest, NasolabialFoldsBeginAtTheAlaAndEndInEvenSkin) {
  const FoldedHead head;
  const auto lining = line_mouth(head.parts);
  ASSERT_TRUE(lining);
  float top = -1e9f;
  for (const FoldLine& line : find_fold_lines(head.rest, head.normals, lining->rim)) {
    EXPECT_EQ(line.samples.back().fraction, 0);
    if (line.far_mm == 0) continue;  // not nasolabial
    EXPECT_GT(line.samples.front().fraction, 0.5f);
    top = std::max(top, line.samples.front().point.z());
  }
  EXPECT_GT(top, 20);  // beside the nose
}

TEST(SkinFoldsTest, TheNasolabialFoldOfASmileReachesTheAla) {
  const FoldedHead head;
  const auto lining = line_mouth(head.parts);
  ASSERT_TRUE(lining);
  ASSERT_TRUE(head.folds);
  const std::vector<Vector3f> smooth = head.smiling(10);
  std::vector<Vector3f> places = smooth;
  head.folds->apply(places);
  const auto deepest_at = [&](const Vector3f& at) {
    float deepest = 0;
    for (std::size_t v = 0; v < places.size(); ++v)
      if ((head.rest[v] - at).norm() < 4)
        deepest = std::max(deepest, (places[v] - smooth[v]).norm());
    return deepest;
  };
  int folds = 0;
  for (const FoldLine& line : find_fold_lines(head.rest, head.normals, lining->rim)) {
    if (line.far_mm == 0 || line.samples.front().point.x() < 0) continue;  // the left fold alone
    ++folds;
    float deepest = 0;
    for (const auto& sample : line.samples) deepest = std::max(deepest, deepest_at(sample.point));
    // continued * fraction at the first sample is a third; coarse vertices miss some of it.
    EXPECT_GT(deepest_at(line.samples.front().point), 0.25f * deepest);
  }
  EXPECT_EQ(folds, 1);
}

TEST(SkinFoldsTest, PursedLipsHaveLinesAroundThem) {
  const FoldedHead head;
  ASSERT_TRUE(head.folds);
  std::vector<Vector3f> pursed = head.rest;
  for (auto& p : pursed)
    if (p.y() < 0) p.x() *= 0.8f;
  std::vector<Vector3f> places = pursed;
  EXPECT_FALSE(head.folds->apply(places).empty());
  // A symmetric face folds symmetrically.
  float left = 0, right = 0;
  for (std::size_t v = 0; v < places.size(); ++v)
    (head.rest[v].x() > 0 ? left : right) += (places[v] - pursed[v]).norm();
  EXPECT_NEAR(left, right, 0.05f * left);
  int above = 0, below = 0;
  for (std::size_t v = 0; v < places.size(); ++v) {
    const Vector3f& p = head.rest[v];
    if ((places[v] - pursed[v]).norm() < 0.1f || std::abs(p.x()) > 20) continue;
    above += p.z() > 4 && p.z() < 20;
    below += p.z() < -4 && p.z() > -20;
  }
  EXPECT_GT(above, 15);
  EXPECT_GT(below, 15);
}

TEST(SkinFoldsTest, NasolabialLinesOfThePatientRunOnTheCheekWithoutSteps) {
  const OpenedPatient& p = opened_patient();
  int lines = 0;
  for (const FoldLine& line : find_fold_lines(p.rest, p.normals, p.prepared.lining()->rim)) {
    if (line.far_mm == 0) continue;
    ++lines;
    for (std::size_t i = 0; i + 1 < line.samples.size(); ++i)  // 2.5 mm apart in front view
      EXPECT_LT((line.samples[i + 1].point - line.samples[i].point).norm(), 4) << i;
  }
  EXPECT_EQ(lines, 2);
}

TEST(SkinFoldsTest, TheForeheadHasThreeLinesAboveTheGlabellaWhereThereIsOne) {
  const OpenedPatient& p = opened_patient();
  const float glabella = static_cast<float>(p.scene.patient.landmarks.find("glabella").value().z());
  for (const bool whole : {true, false}) {
    std::vector<Vector3f> rest = p.rest;
    for (auto& at : rest)
      if (!whole && at.z() > 30) at.y() += 200;  // far behind the face
    int lines = 0;
    for (const FoldLine& line : find_fold_lines(rest, p.normals, p.prepared.lining()->rim)) {
      const auto by_height = [](const auto& a, const auto& b) { return a.point.z() < b.point.z(); };
      const auto [low, high] =
          std::minmax_element(line.samples.begin(), line.samples.end(), by_height);
      if (low->point.z() < glabella) continue;
      EXPECT_LT(high->point.z(), glabella + 35);
      ++lines;
    }
    EXPECT_EQ(lines, whole ? 3 : 0);
  }
}

TEST(SkinFoldsTest, BrowsDrawnTogetherHaveFrownLinesBetweenThem) {
  OpenedPatient p(builtin_patient({}, {}), true);
  const SkinFolds folds(p.rest, p.normals, p.face->mesh.triangles, p.prepared.lining()->rim);
  const Vector3f glabella = p.scene.patient.landmarks.find("soft_glabella").value().cast<float>();
  // Below the lines across the forehead, at the left and at the right.
  const auto deepest = [&](const char* words) {
    const auto smooth = p.drawn(p.frame(words));
    auto places = smooth;
    folds.apply(places);
    std::array<float, 2> most{};
    for (std::size_t v = 0; v < places.size(); ++v) {
      const Vector3f off = p.rest[v] - glabella;
      if (std::abs(off.x()) < 2 || std::abs(off.x()) > 10 || off.z() < -8 || off.z() > 4) continue;
      float& side = most[off.x() > 0 ? 0 : 1];
      side = std::max(side, (places[v] - smooth[v]).norm());
    }
    return most;
  };
  const auto little = deepest("AU4 0.15"), full = deepest("AU4 1"),
             other = deepest("AU6 1 and open 20");
  for (const std::size_t side : {0u, 1u}) {
    EXPECT_GT(little[side], 0.05f);
    EXPECT_GT(full[side], little[side] + 0.1f);
    EXPECT_EQ(other[side], 0);
  }
}

TEST(SkinFoldsTest, AFaceWithoutAMouthHasNone) {
  const FoldedHead head;
  const SkinFolds none(head.rest, head.normals, head.parts[0].mesh.triangles, {});
  std::vector<Vector3f> places = head.smiling(10);
  const std::vector<Vector3f> before = places;
  EXPECT_TRUE(none.apply(places).empty());
  EXPECT_EQ(places, before);
}

class SkinFoldPictures : public WithContext {};

TEST_F(SkinFoldPictures, ShowThemBesideTheCornerAloneAndNoneAtRest) {
  const FoldedHead head;
  SceneRenderer renderer(head.parts);
  PictureSettings folded = mask_settings(), smooth = folded;
  smooth.folds = false;
  FrameState frame;
  frame.face = head.rest;
  renderer.update(frame);
  const Camera camera = front_camera(140);
  const Image rest = renderer.picture(camera, folded);
  EXPECT_TRUE(test::same_bytes(rest, renderer.picture(camera, smooth)));
  frame.face = head.smiling(10);
  renderer.update(frame);
  const Image without = renderer.picture(camera, smooth), with = renderer.picture(camera, folded);
  EXPECT_TRUE(test::unlike(with, without, 0.002));
  EXPECT_TRUE(test::same_bytes(without, renderer.picture(camera, smooth))) << "switched back";
  for (int y = 0; y < with.height; ++y)
    for (int x = 0; x < with.width / 2; ++x) {
      const Pixel a = pixel(with, x, y), b = pixel(without, x, y);
      EXPECT_LE(std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)}), 12)
          << "the side that does not smile, " << x << " " << y;
    }
  renderer.update(FrameState{});
  EXPECT_TRUE(test::same_bytes(rest, renderer.picture(camera, folded))) << "at rest again";
}

}  // namespace
}  // namespace condyle
