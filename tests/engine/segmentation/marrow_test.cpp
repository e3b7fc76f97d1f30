// Marrow behind pinholes is filled; gaps between bones, wide holes and thick cavities are not.
#include "engine/segmentation/marrow.h"

#include <gtest/gtest.h>

#include <functional>

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr int size = 76;
constexpr std::int16_t air = -1000, soft = 50, dark = 120, cortex = 1300;

struct Made {
  Volume volume;
  BoneVoxels bone;

  /// `tissue`: HU at a place, from the middle of the volume.
  explicit Made(const std::function<std::int16_t(const Vector3d&)>& tissue) {
    volume.size = {size, size, size};
    bone.box = whole_box(volume);
    bone.threshold_hu = 300;
    for (int k = 0; k < size; ++k)
      for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i)
          bone.smooth.push_back(tissue(Vector3d(i, j, k) - Vector3d::Constant(size / 2)));
    for (const std::int16_t hu : bone.smooth)
      bone.label.push_back(hu > bone.threshold_hu ? VoxelLabel{1} : no_bone);
    volume.values = bone.smooth;
  }
  std::size_t fill(int threads = 2) {
    const std::vector<VoxelLabel> before = bone.label;
    fill_marrow(volume, threads, bone);
    std::size_t filled = 0;
    for (std::size_t q = 0; q < before.size(); ++q) {
      filled += bone.label[q] != before[q];
      EXPECT_TRUE(bone.label[q] == no_bone || bone.smooth[q] > bone.threshold_hu);
    }
    return filled;
  }
  VoxelLabel at(int x, int y, int z) const {
    return bone.label[bone.box.index(x + size / 2, y + size / 2, z + size / 2)];
  }
};

/// A cranium: bone from 26 to 28 and from 32 to 34 mm, marrow between.
std::int16_t cranium(const Vector3d& p) {
  const double r = p.norm();
  return r < 26 || r >= 34 ? soft : r >= 28 && r < 32 ? dark : cortex;
}
/// Whether a place lies in a square channel to the right, from so far on.
bool in_channel(const Vector3d& p, double from, int width) {
  return p.x() >= from && p.y() >= 0 && p.y() < width && p.z() >= 0 && p.z() < width;
}

TEST(Marrow, PinholesDoNotKeepACavityOpen) {
  const auto made = [] {
    return Made([](const Vector3d& p) {
      if (in_channel(p, 31, 2)) return soft;                  // 2 x 2 voxels, outward
      if (in_channel(-p, 25, 1) && p.x() > -30) return soft;  // one voxel, to the brain
      return cranium(p);
    });
  };
  Made head = made();
  EXPECT_GT(head.fill(), 40000u);
  EXPECT_EQ(head.at(0, 30, 0), 1);
  EXPECT_EQ(head.at(0, 0, -30), 1);
  EXPECT_EQ(head.at(0, 0, 0), no_bone);  // the brain
  EXPECT_EQ(head.at(36, 0, 0), no_bone);
  Made again = made();
  again.fill(1);
  EXPECT_EQ(again.bone.label, head.bone.label);
  EXPECT_EQ(again.bone.smooth, head.bone.smooth);
}

TEST(Marrow, AirBesideMarrowEndsIt) {
  // Cortex between marrow and a sinus may be too thin for the scan.
  Made head([](const Vector3d& p) {
    return (p - Vector3d(37, 0, 0)).norm() < 7 ? air : in_channel(p, 31, 2) ? soft : cranium(p);
  });
  EXPECT_GT(head.fill(), 40000u);
  EXPECT_EQ(head.at(33, 0, 0), no_bone);
}

TEST(Marrow, WideHolesAndThickCavitiesStay) {
  Made wide([](const Vector3d& p) { return in_channel(p, 31, 9) ? soft : cranium(p); });
  EXPECT_EQ(wide.fill(), 0u);
  Made slit([](const Vector3d& p) {
    return p.x() > 31 && p.z() >= 0 && p.z() < 2 && std::abs(p.y()) < 12 ? soft : cranium(p);
  });
  EXPECT_EQ(slit.fill(), 0u);
  Made brain([](const Vector3d& p) {
    return p.norm() >= 34 || p.norm() < 31 || in_channel(p, 30, 2) ? soft : cortex;
  });
  EXPECT_EQ(brain.fill(), 0u);
}

TEST(Marrow, GapsOfJointsStay) {
  // A ball in a socket; a lip may narrow the gap along its rim, and bone bridge a half of that.
  for (const double gap : {2, 3, 4, 6})
    for (const double rim : {gap, 1.3})
      for (const bool bridges : {false, true}) {
        Made joint([&](const Vector3d& p) {
          const double r = p.norm();
          const bool at_rim = p.z() < 4;
          if (r < 14) return cortex;
          if (p.z() < 0 || r >= 24) return soft;
          if (bridges && at_rim && p.x() * p.y() > 0) return cortex;
          return r >= 14 + (at_rim ? rim : gap) ? cortex : soft;
        });
        EXPECT_EQ(joint.fill(), 0u) << gap << ' ' << rim << ' ' << bridges;
      }
}

}  // namespace
}  // namespace condyle
