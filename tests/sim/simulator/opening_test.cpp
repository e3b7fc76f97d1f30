// The main job: patients open the mouth, bones stay apart, the face follows.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "sim/case/case_io.h"
#include "sim/motion/measure_pose.h"
#include "sim/phantom/phantom.h"
#include "sim/simulator/simulator.h"
#include "tests/support/places.h"

namespace condyle::test {
namespace {

const std::filesystem::path real_anatomy = source_folder() / "../shared/data";

struct Opening {
  double widest_mm = 0;  // displacement of the lower incisal point
  double rotation_deg = 0, travel_mm = 0;
  double min_bone_gap_mm = 1e9, max_bone_gap_mm = 0;  // of the first pair: skull and mandible
  double penetration_mm = 0;
  int stopped = 0, inverted = 0, unconverged = 0;
  double fastest_end_mm_s = 0;  // incisal speed in the first and last step
  FrameState widest;
};

Opening open_mouth(const Scene& scene) {
  Opening seen;
  Playback playback(scene, make_motion("opening", scene.patient, scene.contacts), {});
  const int steps = static_cast<int>(playback.motion().duration_s * 120 + 0.5);
  const Eigen::Vector3d condyle = *scene.patient.landmarks.find("left_condyle");
  Eigen::Vector3d last = *scene.patient.landmarks.find("lower_incisal_point");
  for (int i = 0; i <= steps; ++i) {
    const FrameState frame = playback.at(i / 120.0);
    const auto& m = frame.measures;
    if (i == 1 || i == steps)
      seen.fastest_end_mm_s = std::max(seen.fastest_end_mm_s, (m.incisor - last).norm() * 120);
    last = m.incisor;
    if (m.incisal_displacement_mm > seen.widest_mm) {
      seen.widest_mm = m.incisal_displacement_mm;
      seen.widest = frame;
    }
    seen.rotation_deg = std::max(seen.rotation_deg, m.rotation_deg);
    seen.travel_mm = std::max(seen.travel_mm, (m.left_condyle - condyle).norm());
    const auto& pair = frame.contacts.pairs.front();
    seen.min_bone_gap_mm = std::min(seen.min_bone_gap_mm, pair.touching ? 0.0 : pair.distance_mm);
    seen.max_bone_gap_mm = std::max(seen.max_bone_gap_mm, pair.distance_mm);
    seen.penetration_mm = std::max(seen.penetration_mm, frame.contacts.max_penetration_mm());
    seen.stopped += frame.stopped;
    seen.inverted += frame.tissue.inverted_prisms;
    seen.unconverged += !frame.tissue.converged;
  }
  return seen;
}

/// Soft landmarks at full opening, as a surgeon would assess them.
void expect_the_face_follows(const Scene& scene, const Opening& opening) {
  const auto& marks = scene.patient.landmarks;
  const auto carried = [&](const char* name) {
    return carried_point(*scene.tissue, opening.widest.tissue, *marks.find(name));
  };
  const Eigen::Vector3d bone = *marks.find("pogonion"), soft = *marks.find("soft_pogonion");
  const Eigen::Vector3d bone_move = opening.widest.poses[mandible_body] * bone - bone;
  ASSERT_GT(bone_move.norm(), 30);
  EXPECT_GE((carried("soft_pogonion") - soft).dot(bone_move) / bone_move.squaredNorm(), 0.9);
  EXPECT_LT((carried("pronasale") - *marks.find("pronasale")).norm(), 0.5);
  const double gap = (carried("labrale_superius") - carried("labrale_inferius")).norm() -
                     (*marks.find("labrale_superius") - *marks.find("labrale_inferius")).norm();
  EXPECT_GE(gap / opening.widest_mm, 0.7);
  EXPECT_EQ(opening.inverted, 0);
  EXPECT_EQ(opening.unconverged, 0);
}

}  // namespace

TEST(BuiltInPatient, OpensAsFarAsAdultsWithinTheBandsOfAdults) {
  const Scene scene = make_scene(builtin_patient());
  ASSERT_NE(scene.tissue, nullptr);
  EXPECT_GE(summary(*scene.tissue).nodes, 1900);
  const Opening opening = open_mouth(scene);
  EXPECT_NEAR(opening.widest_mm, 51.2, 0.1);
  EXPECT_GE(opening.widest.measures.interincisal_mm, 42);
  EXPECT_LE(opening.widest.measures.interincisal_mm, 58);
  EXPECT_GE(opening.rotation_deg, 28);
  EXPECT_LE(opening.rotation_deg, 45);
  EXPECT_GE(opening.travel_mm, 10);
  EXPECT_LE(opening.travel_mm, 20);
  EXPECT_GE(opening.min_bone_gap_mm, 1);
  EXPECT_LE(opening.max_bone_gap_mm, 3);
  EXPECT_LE(opening.penetration_mm, 0);
  EXPECT_EQ(opening.stopped, 0);
  EXPECT_LT(opening.fastest_end_mm_s, 1);
  expect_the_face_follows(scene, opening);
}

TEST(BuiltInPatient, SameHashForOneAndTwoThreadsWithItsTissue) {
  const Scene scene = make_scene(builtin_patient());
  const Motion motion = make_motion("opening", scene.patient, scene.contacts);
  const auto hashes = [&](int threads) {
    SimulatorSettings settings;
    settings.threads = threads;
    Playback playback(scene, motion, settings);
    std::vector<std::uint64_t> all;
    for (int i = 0; i <= 60; i += 6) all.push_back(playback.at(i / 120.0).state_hash);
    return all;
  };
  EXPECT_EQ(hashes(1), hashes(2));
}

TEST(CaseBadin, OpensFortyMillimetresAndTheFaceFollows) {
  const auto folder = real_anatomy / "case-badin";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "real anatomy absent";
  const Scene scene =
      make_scene(import_meshes({.files = {{Role::maxilla, folder / "maxilla_capped.ply"},
                                          {Role::mandible, folder / "mandible.ply"},
                                          {Role::face, folder / "face_skin.ply"}},
                                .landmarks = folder / "markers.csv",
                                .name = "badin"}));
  ASSERT_NE(scene.tissue, nullptr);
  const Opening opening = open_mouth(scene);
  EXPECT_GE(opening.widest_mm, 40);
  EXPECT_LE(opening.penetration_mm, 0);
  expect_the_face_follows(scene, opening);
}

TEST(CaseUbc, OpensThirtyMillimetresNoDeeperThanAtRest) {
  const auto folder = real_anatomy / "case-ubc";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "real anatomy absent";
  const Scene scene = make_scene(
      import_meshes({.files = {{Role::maxilla, folder / "maxilla_with_teeth_wrap_30k.ply"},
                               {Role::mandible, folder / "mandible_8k.ply"},
                               {Role::upper_teeth, folder / "upper_teeth.ply"},
                               {Role::lower_teeth, folder / "lower_teeth.ply"}},
                     .landmarks = folder / "markers.csv",
                     .name = "ubc"}));
  const Opening opening = open_mouth(scene);
  EXPECT_GE(opening.widest_mm, 30);
  EXPECT_LE(opening.penetration_mm, 0.02);
  EXPECT_EQ(opening.stopped, 0);
}

}  // namespace condyle::test
