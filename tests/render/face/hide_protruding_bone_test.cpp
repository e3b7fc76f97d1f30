// Bone that protrudes slightly from the skin, by the error of a scan, is hidden under an opaque
// face.
#include "render/face/hide_protruding_bone.h"

#include <Eigen/Geometry>

#include "tests/render/scene_fixture.h"

namespace condyle {
namespace {

using HideProtrudingBonePicture = WithContext;

/// A ball whose top is `out_mm` above a skin of radius 50.
TriMesh bone_out_by(double out_mm) { return ball({0, 0, 30 + out_mm}, 20, 40); }

TEST(HideProtrudingBone, HidesSlightProtrusionsOnly) {
  const TriMesh skin = ball({0, 0, 0}, 50, 64);
  EXPECT_FALSE(hide_protruding_bone(bone_out_by(-1), skin, false));
  const TriMesh bone = bone_out_by(2);
  const auto kept = hide_protruding_bone(bone, skin, false);
  ASSERT_TRUE(kept);
  int left_out = 0;
  for (const auto& t : bone.triangles) {
    const bool is_kept = std::find(kept->begin(), kept->end(), t) != kept->end();
    double highest = 0;
    for (const int v : t)
      highest = std::max(highest, bone.vertices[static_cast<std::size_t>(v)].norm());
    if (highest < 49.8 || highest > 50) {
      EXPECT_EQ(is_kept, highest < 49.8) << highest;
    }
    left_out += !is_kept;
  }
  EXPECT_GT(left_out, 20);
}

TEST(HideProtrudingBone, ShowsLargeProtrusions) {
  const TriMesh skin = ball({0, 0, 0}, 50, 64), bone = bone_out_by(6);
  const auto kept = hide_protruding_bone(bone, skin, true);
  ASSERT_TRUE(kept);
  const auto top = std::count_if(kept->begin(), kept->end(), [&](const Eigen::Vector3i& t) {
    return bone.vertices[static_cast<std::size_t>(t[0])].norm() > 54;
  });
  EXPECT_GT(top, 20);
}

TEST(HideProtrudingBone, KeepsBoneNearARim) {
  TriMesh skin = ball({0, 0, 0}, 50, 64);
  std::erase_if(skin.triangles,
                [&](const Eigen::Vector3i& t) { return skin.vertices[t[0]].z() > 48.5; });
  const TriMesh tooth = ball({0, 0, 36}, 14.5, 40);  // fills the opening
  EXPECT_FALSE(hide_protruding_bone(tooth, skin, true));
}

TEST(HideProtrudingBone, HidesBoneInPlaceBelowThinSkinFarFromRims) {
  const TriMesh whole = ball({0, 0, 0}, 50, 64);
  TriMesh open = whole;
  std::erase_if(open.triangles,
                [&](const Eigen::Vector3i& t) { return open.vertices[t[0]].z() > 48.5; });
  const TriMesh bone = ball({0, 0, 0}, 46, 64), deep = ball({0, 0, 0}, 44, 64);
  const auto kept = hide_protruding_bone(bone, open, true);
  ASSERT_TRUE(kept);
  EXPECT_FALSE(kept->empty());
  for (const auto& t : *kept) {
    const auto z = [&](int v) { return bone.vertices[static_cast<std::size_t>(v)].z(); };
    EXPECT_GT(std::max({z(t[0]), z(t[1]), z(t[2])}), 30) << "as the opening is near";
  }
  EXPECT_FALSE(hide_protruding_bone(bone, open, false)) << "it may have moved";
  EXPECT_FALSE(hide_protruding_bone(deep, whole, true));
}

TEST_F(HideProtrudingBonePicture, HidesItOnlyUnderAWholeFace) {
  auto bone = bone_out_by(2);
  for (auto& v : bone.vertices) v = {v.x(), -v.z(), v.y()};  // toward the eye
  const std::vector<Part> parts = {make_part("face", Role::face, ball({0, 0, 0}, 50, 120)),
                                   make_part("skull", Role::skull, bone)};
  SceneRenderer renderer(parts);
  auto settings = mask_settings(200);
  const Image with = renderer.picture(front_camera(), settings);
  settings.part_opacity = {{"skull", 0}};
  EXPECT_EQ(with.rgba, renderer.picture(front_camera(), settings).rgba);
  settings.part_opacity = {{"face", 0}};
  const Pixel alone = pixel(renderer.picture(front_camera(), settings), 100, 100);
  EXPECT_EQ(alone.a, 255);
}

TEST_F(HideProtrudingBonePicture, SkinThatSlidesExposesNoBoneThatStaysInPlace) {
  const TriMesh skin = ball({0, 0, 0}, 50, 120), bone = ball({0, 0, 0}, 47, 60);
  const std::vector<Part> parts = {make_part("face", Role::face, skin),
                                   make_part("skull", Role::skull, bone)};
  SceneRenderer renderer(parts);
  auto settings = mask_settings(200);
  FrameState frame;
  for (const auto& v : skin.vertices) {
    frame.face.push_back(v.cast<float>());
    if (v.y() < -45) frame.face.back().y() += 4;
  }
  renderer.update(frame);
  const Image with = renderer.picture(front_camera(), settings);
  settings.part_opacity = {{"skull", 0}};
  EXPECT_EQ(with.rgba, renderer.picture(front_camera(), settings).rgba);
}

}  // namespace
}  // namespace condyle
