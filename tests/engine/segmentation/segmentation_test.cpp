// Bone and skin of scans of the built-in head, against the truth, and what is refused.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/mesh/self_crossings.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "engine/mesh/unfold.h"
#include "engine/segmentation/scan_surfaces.h"
#include "engine/segmentation/split_bones.h"
#include "sim/phantom/phantom.h"
#include "sim/scanner/scan_accuracy.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr int threads = 2;

/// Both jaws up to the joint and the orbits.
CtSettings jaw_scan_settings() {
  CtSettings settings;
  settings.spacing_mm = {1, 1, 1};
  settings.field_of_view = {{-62, -124, -98}, {62, 0, 4}};
  settings.noise_hu = 40;
  settings.threads = threads;
  return settings;
}

const CtScan& jaw_scan() {
  static const CtScan scan = scan_ct(ScannedHead(), jaw_scan_settings());
  return scan;
}

/// All steps up to labels.
struct Segmented {
  TissueLevels levels;
  HeadRegion head;
  BoneVoxels bone;
  std::vector<VoxelLabel> seeds;

  explicit Segmented(const Volume& volume, int on = threads, const Progress& progress = {}) {
    levels = tissue_levels(volume, "scan");
    head = find_head(volume, levels, "scan", on, progress);
    bone = find_bone(volume, levels, head, "scan", {.threads = on}, progress);
    constexpr double error_mm = 2.5;
    seeds = seed_labels(volume, bone, warped_template(builtin_patient(), error_mm, 3), {},
                        {.template_error_mm = error_mm, .threads = on}, progress);
    split_bones(volume, seeds, bone, on, progress);
  }
};

const Segmented& jaw_segments() {
  static const Segmented segments(jaw_scan().volume);
  return segments;
}

double voxel_of(const Volume& volume) { return std::cbrt(volume.spacing_mm.prod()); }

/// The goals of a scan with usual noise.
void expect_bones_right(const CtScan& scan, const Segmented& segments) {
  const ScannedHead head;
  const Volume& volume = scan.volume;
  const SplitErrors split = split_errors(scan, segments.bone, segments.seeds);
  EXPECT_GT(split.voxels, 10000u);
  EXPECT_LE(split.wrong_percent(), 0.1);
  EXPECT_LT(static_cast<double>(split.unlabelled), 0.001 * static_cast<double>(split.voxels));
  TriMesh both;  // vertices alone
  std::size_t uppers = 0;
  for (const VoxelLabel label : {skull_label, mandible_label}) {
    const ScanSurface surface =
        bone_surface(volume, segments.bone, label, {.target_triangles = 0, .threads = threads});
    const Topology topology = inspect(surface.mesh);
    EXPECT_TRUE(topology.closed());
    EXPECT_GT(topology.volume_mm3, 10000);
    EXPECT_GT(surface.moved_fraction, 0.85);
    both.vertices.insert(both.vertices.end(), surface.mesh.vertices.begin(),
                         surface.mesh.vertices.end());
    if (label == skull_label) uppers = both.vertices.size();
  }
  const SurfaceErrors errors = surface_errors(
      both, volume,
      [&](std::size_t v, const Vector3d& p) {
        return v < uppers ? head.upper_bone(p) : head.lower_bone(p);
      },
      threads);
  EXPECT_GT(errors.samples, 5000u);
  EXPECT_LE(errors.median_mm / voxel_of(volume), 0.15);
  EXPECT_LE(errors.p95_mm / voxel_of(volume), 0.5);
}

std::string refusal(const Volume& volume) {
  try {
    const TissueLevels levels = tissue_levels(volume, "series 3");
    const HeadRegion head = find_head(volume, levels, "series 3", threads);
    find_bone(volume, levels, head, "series 3");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

Volume uniform_volume(std::int16_t hu) {
  Volume volume;
  volume.size = {60, 60, 60};
  volume.spacing_mm = {2, 2, 2};
  volume.values.assign(60 * 60 * 60, hu);
  return volume;
}

TEST(Segmentation, FindsBothBonesWithinTheGoals) { expect_bones_right(jaw_scan(), jaw_segments()); }

TEST(Segmentation, WorksOnTurnedAxesAndFlatVoxels) {
  CtSettings settings = jaw_scan_settings();
  settings.spacing_mm = {0.8, 0.8, 1};
  // Another order and sign of the axes, and a turned head.
  settings.axes = Eigen::AngleAxisd(0.25, Vector3d(1, 2, 0.5).normalized()).toRotationMatrix();
  settings.axes.col(0) = -settings.axes.col(0);
  const CtScan scan = scan_ct(ScannedHead(), settings);
  EXPECT_LT(scan.volume.axes.determinant(), 0);
  expect_bones_right(scan, Segmented(scan.volume));
}

TEST(Segmentation, BonesThatTouchDoNotPassThroughEachOther) {
  constexpr double touching_mm = 0.1, least_depth = 0.25;  // voxels
  const CtScan scan = scan_ct(ScannedHead({}, touching_mm), jaw_scan_settings());
  const Segmented segments(scan.volume);
  std::vector<TriMesh> bones;
  for (const VoxelLabel label : {skull_label, mandible_label}) {
    bones.push_back(
        bone_surface(scan.volume, segments.bone, label, {.target_triangles = 0, .threads = threads})
            .mesh);
    TriMesh& mesh = bones.back();
    EXPECT_TRUE(inspect(mesh).closed());
    const int folds = unfold(mesh, {.rounds = 0});
    EXPECT_LT(folds, 20) << "of " << mesh.triangles.size() << " triangles";
  }
  std::size_t deep = 0, near = 0;
  for (const auto& [one, other] : {std::pair(0, 1), std::pair(1, 0)}) {
    const TriangleTree tree(bones[static_cast<std::size_t>(other)]);
    for (const auto& p : bones[static_cast<std::size_t>(one)].vertices) {
      const SurfacePoint at = tree.signed_nearest(p, 1);
      if (at.triangle < 0) continue;
      ++near;
      deep += at.distance < -least_depth;
    }
  }
  EXPECT_GT(near, 100u);
  EXPECT_EQ(deep, 0u) << "of " << near;
}

TEST(Segmentation, AJointOpensWhereThickVoxelsShowNoGap) {
  // The discs of the built-in joints are 2.5 mm thick.
  for (const double voxel_mm : {1.5, 2.0}) {
    CtSettings settings = jaw_scan_settings();
    settings.spacing_mm = Vector3d::Constant(voxel_mm);
    const CtScan scan = scan_ct(ScannedHead(), settings);
    const Segmented segments(scan.volume);
    const auto surface = [&](VoxelLabel label) {
      return bone_surface(scan.volume, segments.bone, label,
                          {.target_triangles = 20000, .threads = threads})
          .mesh;
    };
    const TriMesh skull = surface(skull_label), mandible = surface(mandible_label);
    EXPECT_TRUE(self_crossings(skull, threads).empty());
    EXPECT_TRUE(self_crossings(mandible, threads).empty());
    const TriangleTree tree(skull);
    double least = 10;
    std::size_t near = 0;
    for (const auto& p : mandible.vertices) {
      if (p.y() < -25 || p.z() < -12) continue;  // the condyles are left
      ++near;
      least = std::min(least, tree.signed_distance(p));
    }
    EXPECT_GT(near, 100u);
    EXPECT_GT(least, 0.4) << voxel_mm;
  }
}

TEST(Segmentation, FindsTheSkin) {
  const Volume& volume = jaw_scan().volume;
  const Segmented& segments = jaw_segments();
  const ScanSurface skin = skin_surface(volume, segments.levels, segments.head, segments.bone.metal,
                                        "scan", {.target_triangles = 20000, .threads = threads});
  EXPECT_TRUE(inspect(skin.mesh).closed());
  EXPECT_EQ(inspect(skin.mesh).components, 1);  // no cavity
  const ScannedHead head;
  const SurfaceErrors errors = surface_errors(
      skin.mesh, volume, [&](std::size_t, const Vector3d& p) { return head.skin(p); }, threads);
  EXPECT_GT(errors.samples, 1000u);
  EXPECT_LE(errors.median_mm, 0.3);
  EXPECT_LE(errors.p95_mm, 1);
}

TEST(Segmentation, DecimationKeepsSurfacesClosedAndReportsItsError) {
  const ScanSurface surface = bone_surface(jaw_scan().volume, jaw_segments().bone, mandible_label,
                                           {.target_triangles = 20000, .threads = threads});
  EXPECT_GT(surface.found_triangles, 40000u);
  EXPECT_LE(surface.mesh.triangles.size(), 20500u);
  EXPECT_TRUE(inspect(surface.mesh).closed());
  EXPECT_GT(surface.decimation_max_mm, 0);
  EXPECT_LE(surface.decimation_median_mm, surface.decimation_p95_mm);
  EXPECT_LT(surface.decimation_p95_mm, 0.2);
}

TEST(Segmentation, TableAndStreaksAreNoBone) {
  CtSettings settings = jaw_scan_settings();
  settings.spacing_mm = {1.2, 1.2, 1.2};
  settings.field_of_view = {{-90, -124, -70}, {90, 150, -30}};
  settings.table = settings.fillings = true;
  const CtScan scan = scan_ct(ScannedHead(), settings);
  const Volume& volume = scan.volume;
  int rails = 0;  // bright voxels outside the skin
  for (std::size_t q = 0; q < scan.truth.size(); ++q)
    rails += scan.truth[q] == ScanTissue::outside && volume.values[q] > 1000;
  EXPECT_GT(rails, 1000);

  const Segmented segments(volume);
  ASSERT_TRUE(segments.bone.metal.has_value());
  const ScannedHead head;
  int bone = 0, outside = 0, far = 0, dropped = 0;
  const VoxelBox& box = segments.bone.box;
  for (int k = 1; k + 1 < box.size[2]; ++k)
    for (int j = 1; j + 1 < box.size[1]; ++j)
      for (int i = 1; i + 1 < box.size[0]; ++i) {
        const VoxelLabel label = segments.bone.label[box.index(i, j, k)];
        if (label == no_bone) continue;
        const std::size_t q = volume.index(box.low[0] + i, box.low[1] + j, box.low[2] + k);
        if (label == other_bone) {
          ++dropped;
          continue;
        }
        ++bone;
        outside += scan.truth[q] == ScanTissue::outside;
        if (scan.truth[q] != ScanTissue::soft) continue;
        const Vector3d p = box.position(volume, i, j, k);
        far += std::min(head.upper_bone(p), head.lower_bone(p)) > 7;
      }
  EXPECT_GT(bone, 10000);
  EXPECT_GT(dropped, 20);
  EXPECT_EQ(outside, 0);
  EXPECT_LT(far, 10);  // streaks end beside the teeth

  const ScanSurface skin = skin_surface(volume, segments.levels, segments.head, segments.bone.metal,
                                        "scan", {.target_triangles = 0, .threads = threads});
  double back = 0;
  for (const Vector3d& p : skin.mesh.vertices) back = std::max(back, head.skin(p));
  EXPECT_LT(back, 8);  // the foam below the head may count, the table not

  // Beside the metal, the streaks do not show in the skin.
  const MetalSlab& metal = *segments.bone.metal;
  std::vector<double> errors;
  for (const Vector3d& p : skin.mesh.vertices) {
    const double slice =
        (volume.axes.transpose() * (p - volume.origin))[metal.axis] / volume.spacing_mm[metal.axis];
    if (slice < metal.first || slice > metal.last || p.y() > -60) continue;
    errors.push_back(std::abs(head.skin(p)));
  }
  ASSERT_GT(errors.size(), 200u);
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() * 95 / 100], 0.35);  // mm
  EXPECT_LT(errors.back(), 2);
}

TEST(Segmentation, ThinBoneKeepsItsWalls) {
  // A shell of bone, 1 mm thick, in a ball of soft tissue, with noise.
  Volume volume;
  volume.size = {120, 120, 120};
  volume.values.assign(120 * 120 * 120, -1000);
  const Vector3d middle = Vector3d::Constant(59.5);
  std::size_t q = 0;
  for (int k = 0; k < 120; ++k)
    for (int j = 0; j < 120; ++j)
      for (int i = 0; i < 120; ++i, ++q) {
        const double r = (Vector3d(i, j, k) - middle).norm();
        const double covered = std::clamp(1 - std::abs(r - 35), 0.0, 1.0);
        if (r < 50) volume.values[q] = static_cast<std::int16_t>(50 + 1150 * covered);
      }
  add_noise(60, 1, threads, volume);
  const TissueLevels levels = tissue_levels(volume, "scan");
  const HeadRegion head = find_head(volume, levels, "scan", threads);
  const BoneVoxels bone = find_bone(volume, levels, head, "scan", {.threads = threads});
  const ScanSurface shell =
      bone_surface(volume, bone, 1, {.target_triangles = 0, .threads = threads});
  const Topology topology = inspect(shell.mesh);
  EXPECT_TRUE(topology.closed());
  // Holes through the shell would make it a handlebody: outer and inner wall have no handle.
  EXPECT_EQ(static_cast<int>(shell.mesh.vertices.size()) -
                static_cast<int>(shell.mesh.triangles.size()) / 2,
            2 * topology.components);
}

TEST(Segmentation, PointsDecideAndMustLieNearBone) {
  const Volume& volume = jaw_scan().volume;
  BoneVoxels bone = jaw_segments().bone;
  // Two points in each bone, without a template.
  const std::vector<SeedPoint> points = {
      {{0, -82, -84}, mandible_label},   {{46, -22, -50}, mandible_label},
      {{-46, -22, -50}, mandible_label}, {{0, -78, -34}, skull_label},
      {{27, -52, -36}, skull_label},     {{-27, -52, -36}, skull_label}};
  for (auto& label : bone.label)
    if (label != no_bone && label != other_bone) label = 1;
  const auto seeds = seed_labels(volume, bone, {}, points);
  split_bones(volume, seeds, bone, threads);
  const SplitErrors errors = split_errors(jaw_scan(), bone, seeds);
  EXPECT_EQ(errors.wrong_seeds, 0u);
  EXPECT_LT(errors.wrong_percent(), 3);
  try {
    seed_labels(volume, bone, {}, {points[0], {{0, -118, -30}, skull_label}});
    FAIL() << "a point in the air was accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("seed point 2"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("-118.0"), std::string::npos) << error.what();
  }
}

TEST(Segmentation, SameBitsForAnyNumberOfThreads) {
  const Segmented one(jaw_scan().volume, 1);
  EXPECT_EQ(one.seeds, jaw_segments().seeds);
  EXPECT_EQ(one.bone.label, jaw_segments().bone.label);
  EXPECT_EQ(one.bone.smooth, jaw_segments().bone.smooth);
  const auto hash = [&](int on) {
    return mesh_hash(bone_surface(jaw_scan().volume, one.bone, mandible_label,
                                  {.target_triangles = 0, .threads = on})
                         .mesh);
  };
  EXPECT_EQ(hash(1), hash(3));
}

TEST(Segmentation, ProgressReportsAndCancels) {
  struct Stop {};
  std::vector<std::string> stages;
  double last = 0;
  const auto listen = [&](std::string_view what, double fraction) {
    if (stages.empty() || stages.back() != what) stages.emplace_back(what), last = 0;
    EXPECT_GE(fraction, last) << what;
    EXPECT_LE(fraction, 1) << what;
    last = fraction;
  };
  CtSettings coarse = jaw_scan_settings();
  coarse.spacing_mm = {2, 2, 2};
  const Volume volume = scan_ct(ScannedHead(), coarse).volume;
  const Segmented segments(volume, threads, listen);
  EXPECT_EQ(stages.size(), 4u);
  for (const std::string& stage : stages)
    EXPECT_THROW(Segmented(volume, threads,
                           [&](std::string_view what, double) {
                             if (what == stage) throw Stop{};
                           }),
                 Stop)
        << stage;
}

TEST(Segmentation, RefusesWhatIsNoHead) {
  EXPECT_NE(refusal(uniform_volume(-1000)).find("series 3: 0.00 % of the volume lies between"),
            std::string::npos)
      << refusal(uniform_volume(-1000));
  EXPECT_NE(refusal(uniform_volume(40)).find("series 3: 0.000 % of the volume lies above 700 HU"),
            std::string::npos)
      << refusal(uniform_volume(40));
  // A small body: a bottle of water with a rod.
  Volume bottle = uniform_volume(-1000);
  for (int k = 0; k < 60; ++k)
    for (int j = 25; j < 40; ++j)
      for (int i = 25; i < 40; ++i)
        bottle.values[bottle.index(i, j, k)] = i / 2 == 15 && j / 2 == 15 ? 1200 : 20;
  EXPECT_NE(refusal(bottle).find("a head has at least 100 cm3"), std::string::npos)
      << refusal(bottle);
  // Tissue up to all sides has bone but no skin.
  const CtScan& scan = jaw_scan();
  Volume inner;
  inner.size = {40, 40, 40};
  inner.spacing_mm = scan.volume.spacing_mm;
  for (int k = 0; k < 40; ++k)
    for (int j = 0; j < 40; ++j)
      for (int i = 0; i < 40; ++i)
        inner.values.push_back(i > 15 && i < 22 && j > 15 && j < 22 ? 1300 : 45);
  inner.spacing_mm = {2, 2, 2};
  const TissueLevels levels = tissue_levels(inner, "series 3");
  const HeadRegion head = find_head(inner, levels, "series 3", threads);
  EXPECT_FALSE(head.has_outside);
  EXPECT_THROW(skin_surface(inner, levels, head, {}, "series 3"), InputError);
  const BoneVoxels bone = find_bone(inner, levels, head, "series 3");
  EXPECT_TRUE(inspect(bone_surface(inner, bone, 1).mesh).closed());  // ends at the border
}

}  // namespace
}  // namespace condyle
