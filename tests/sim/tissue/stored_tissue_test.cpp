#include "sim/tissue/stored_tissue.h"

#include <gtest/gtest.h>

#include "engine/core/files.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/model.h"
#include "sim/tissue/path_factors.h"
#include "sim/tissue/tissue_memory.h"
#include "tests/sim/tissue/plain_patient.h"
#include "tests/support/allocated.h"
#include "tests/support/jaw_pose.h"
#include "tests/support/program.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

Case parted_patient() {
  Case patient = test::plain_patient();
  part_lips(patient);
  return patient;
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder)) found.push_back(entry.path());
  return found;
}

/// Frames of an opening, and the displayed face at its end.
struct Opened {
  std::vector<TissueState> frames;
  std::vector<Eigen::Vector3f> face;
};
Opened opened(const Case& patient, const TissueModel& model) {
  Opened made;
  TissueState state = rest_tissue(model);
  TissueWarmStart warm;
  for (const double degrees : {2.0, 5.0, 9.0}) {
    state = solve_tissue(model, state, test::jaw_at(test::opening(patient, degrees)), {}, warm);
    made.frames.push_back(state);
  }
  deform_face(model, state, made.face);
  return made;
}

void expect_same(const Opened& a, const Opened& b) {
  ASSERT_EQ(a.frames.size(), b.frames.size());
  for (std::size_t i = 0; i < a.frames.size(); ++i) {
    EXPECT_EQ(a.frames[i].nodes, b.frames[i].nodes) << "frame " << i;
    EXPECT_EQ(a.frames[i].iterations, b.frames[i].iterations) << "frame " << i;
    EXPECT_EQ(a.frames[i].penetration_mm, b.frames[i].penetration_mm) << "frame " << i;
  }
  EXPECT_EQ(a.face, b.face);
}

TEST(StoredTissue, HasTheSameBitsAsTheBuiltOneAndIsMadeAgainWhereDamaged) {
  const Case patient = parted_patient();
  TissueSettings settings{.surface_nodes = 260, .plan = {.turgor = 0.98}};
  const Opened expected = opened(patient, *build_tissue(patient, settings));
  EXPECT_GT(expected.frames.back().iterations, 0);
  const test::Folder cache;
  const auto stored = [&] { return stored_tissue(cache.path(), patient, settings); };
  const auto made = stored();
  expect_same(opened(patient, *made), expected);
  const auto files = files_in(cache.path());
  ASSERT_EQ(files.size(), 1u);

  const std::string whole = read_file(files.front());
  int builds = 0;
  const Progress count_builds = [&](std::string_view, double done) { builds += done == 1.0; };
  settings.threads = 1;  // of the reader: the same file
  const auto read = stored_tissue(cache.path(), patient, settings, count_builds);
  EXPECT_EQ(builds, 0);
  expect_same(opened(patient, *read), expected);
  EXPECT_EQ(summary(*read).notes, summary(*made).notes);
  EXPECT_EQ(summary(*read).rest_move_mm, summary(*made).rest_move_mm);
  EXPECT_EQ(summary(*read).nodes, summary(*made).nodes);

  for (const std::string& damaged : {whole.substr(0, whole.size() / 2), std::string(),
                                     whole.substr(0, 1000) + "x" + whole.substr(1001)}) {
    write_file(files.front(), damaged);
    builds = 0;
    const auto again = stored_tissue(cache.path(), patient, settings, count_builds);
    EXPECT_EQ(builds, 1);
    EXPECT_EQ(again->mesh->rest, made->mesh->rest);
    EXPECT_EQ(read_file(files.front()), whole);
  }
}

TEST(StoredTissue, AnotherPatientOrPlanHasAnotherFile) {
  const Case patient = parted_patient();
  const test::Folder cache;
  const TissueSettings settings{.surface_nodes = 150, .plan = {.layer_count = 1}};
  std::size_t files = 0;
  const auto expect_another = [&](const Case& of, const TissueSettings& as) {
    stored_tissue(cache.path(), of, as);
    EXPECT_EQ(files_in(cache.path()).size(), ++files);
  };
  expect_another(patient, settings);
  Case moved = patient;
  moved.parts[1].mesh.vertices[0].x() += 1e-9;  // of the mandible
  expect_another(moved, settings);
  moved = patient;
  moved.parts[2].mesh.vertices[0].x() += 1e-9;  // of the face
  expect_another(moved, settings);
  moved = patient;
  moved.landmarks.points["stomion"].z() += 1e-9;
  expect_another(moved, settings);
  TissueSettings other = settings;
  other.plan.turgor = 0.99;
  expect_another(patient, other);
  other.plan = {.layer_count = 1, .bond = TissueBond::glued};
  expect_another(patient, other);
  other = settings;
  other.surface_nodes = 160;
  expect_another(patient, other);
  other = settings;
  other.upper_face = true;
  expect_another(patient, other);
  Case planned = patient;
  planned.tissue.attachments.push_back({.landmark = "stomion"});
  expect_another(planned, settings);
  stored_tissue(cache.path(), patient, settings);
  EXPECT_EQ(files_in(cache.path()).size(), files);
}

TEST(PathFactors, AreMadeWhenUsedAndDoNotDependOnTheOrderOfUse) {
  const Case patient = parted_patient();
  const TissueSettings settings{.surface_nodes = 150};
  const auto forth = build_tissue(patient, settings), back = build_tissue(patient, settings);
  const double step = forth->opening.path->step_rad;
  ASSERT_GE(forth->opening.path->nodes.size(), 3u);
  EXPECT_EQ(forth->factors->made(), 1);  // at rest, by the build
  const Nodes g(forth->mesh->rest.size(), Eigen::Vector3d(1, -2, 3));
  const auto solved = [&](const TissueModel& model, double turned_rad) {
    Nodes z;
    model.factors->nearest(turned_rad)->solve(g, z);
    return z;
  };
  const Nodes first = solved(*forth, step), second = solved(*forth, 2 * step);
  EXPECT_EQ(forth->factors->made(), 3);
  EXPECT_NE(first, second);
  EXPECT_EQ(solved(*back, 2 * step), second);
  EXPECT_EQ(solved(*back, step), first);
  EXPECT_EQ(solved(*back, 1.49 * step), first);
  EXPECT_EQ(solved(*back, -step), solved(*back, 0));
}

TEST(TissueMemory, IsWhatTheModelHolds) {
  const Case patient = parted_patient();
  auto model = build_tissue(patient, {.surface_nodes = 260, .threads = 1});
  const double step = model->opening.path->step_rad;
  const TissueMemory at_rest = memory_of(*model);
  EXPECT_EQ(at_rest.factors_made, 1);
  EXPECT_EQ(at_rest.factors_most, static_cast<int>(model->opening.path->nodes.size()));
  model->factors->nearest(step);
  model->factors->nearest(2 * step);
  const TissueMemory memory = memory_of(*model);
  EXPECT_EQ(memory.factors_made, 3);
  EXPECT_EQ(memory.tissue, at_rest.tissue);
  EXPECT_GE(memory.factors, at_rest.factors + 2 * memory.bytes_of_a_factor);
  EXPECT_GE(at_rest.most_factors(),
            memory.bytes_of_a_factor * static_cast<std::size_t>(at_rest.factors_most));
  const std::size_t before = allocated_bytes();
  model.reset();
  const auto freed = static_cast<double>(before - allocated_bytes());
  const auto counted = static_cast<double>(memory.tissue + memory.displayed_face +
                                           memory.bone_surfaces + memory.factors);
  EXPECT_NEAR(counted, freed, 0.1 * freed);
}

}  // namespace
}  // namespace condyle
