// The path of a block into a gap between two walls, and of a plate that must tilt under an
// overhang.
#include "sim/contact/insertion_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "sim/frame/body_poses.h"
#include "tests/support/boxes.h"
#include "tests/support/overlap_oracle.h"

using namespace condyle;
using condyle::test::box;
using Eigen::Vector3d;

namespace {

/// A block of 20 mm between walls that are `gap_mm` away from it.
Case walled_block(double gap_mm) {
  Case patient;
  patient.name = "walls";
  const auto add = [&](const char* name, Role role, const TriMesh& mesh) {
    patient.parts.push_back({name, role, mesh, {}});
  };
  add("skull", Role::skull, box({-60, -20, 30}, {60, 20, 60}));
  add("mandible", Role::mandible, box({-60, -10, -10}, {-10 - gap_mm, 10, 10}));
  patient.add_piece({"wall", Role::segment, box({10 + gap_mm, -10, -10}, {60, 10, 10}), {}},
                    mandible_body);
  patient.add_piece({"block", Role::transplant, box({-10, -8, -8}, {10, 8, 8}), {}}, mandible_body);
  return patient;
}

Seat seat() {
  return {.name = "block",
          .bodies = {"block"},
          .face_normals = {Vector3d::UnitX(), -Vector3d::UnitX()},
          .approach = {0.3, 0, -1}};
}

/// A plate of 40 x 20 x 6 mm in a recess that is open below, with 1 mm around it. A lip below its
/// rear end is `lip_mm` wide; behind and above that end there is room to tilt.
Case overhang(double lip_mm, int pieces = 1) {
  Case patient;
  patient.name = "overhang";
  const auto add = [&](const char* name, Role role, const TriMesh& mesh) {
    patient.parts.push_back({name, role, mesh, {}});
  };
  const auto add_wall = [&](const char* name, const TriMesh& mesh) {
    patient.add_piece({name, Role::segment, mesh, {}}, mandible_body);
  };
  add("skull", Role::skull, box({-60, -60, 8}, {60, 60, 40}));
  add("mandible", Role::mandible, box({-60, 21, -12}, {60, 60, 4}));
  add_wall("lip", box({-60, -60, -8}, {60, -20 + lip_mm, -4}));
  add_wall("left", box({11, -20, -12}, {60, 20, 4}));
  add_wall("right", box({-60, -20, -12}, {-11, 20, 4}));
  add_wall("rear", box({-60, -60, -3}, {60, -28, 7}));
  const double end = pieces == 1 ? 20 : 2;
  const BodyId first = patient.add_piece(
      {"plate", Role::transplant, box({-10, -20, -3}, {10, end, 3}), {}}, mandible_body);
  if (pieces == 2)
    patient.add_piece({"plate_2", Role::transplant, box({-10, end, -3}, {10, 20, 3}), {}}, first);
  return patient;
}

Seat plate(int pieces = 1) {
  Seat seat{.name = "plate", .bodies = {"plate"}, .face_normals = {}, .approach = {0, 0, -1}};
  if (pieces == 2) seat.bodies.emplace_back("plate_2");
  return seat;
}

/// The deepest overlap of the graft with all else along a path, by dense samples.
double deepest_along(const Case& patient, const std::vector<std::string>& graft,
                     const std::vector<Pose>& poses) {
  double deepest_mm = 0;
  for (const Part& a : patient.parts) {
    if (std::find(graft.begin(), graft.end(), a.name) == graft.end()) continue;
    const test::OverlapOracle moving(a.mesh);
    for (const Part& b : patient.parts) {
      if (std::find(graft.begin(), graft.end(), b.name) != graft.end()) continue;
      const test::OverlapOracle fixed(b.mesh, Box{{-30, -60, -30}, {30, 60, 30}});
      for (const Pose& X : poses) deepest_mm = std::max(deepest_mm, deepest(fixed, moving, X));
    }
  }
  return deepest_mm;
}

TEST(InsertionPath, leads_along_parallel_walls_and_is_free_where_they_are_far) {
  const InsertionPath path = find_insertion_path(walled_block(0.8), seat());
  EXPECT_EQ(path.state, InsertionPath::State::free);
  EXPECT_NEAR(path.direction.x(), 0, 1e-9);  // the approach without its part into the wall
  EXPECT_LT(path.direction.z(), -0.99);
  EXPECT_NEAR(path.margin_mm, 0.8, 1e-3);
  EXPECT_NEAR(path.length_mm, path_length_mm, 1);
}

TEST(InsertionPath, is_tight_where_the_walls_are_near) {
  const InsertionPath path = find_insertion_path(walled_block(0.2), seat());
  EXPECT_EQ(path.state, InsertionPath::State::tight);
  EXPECT_NEAR(path.margin_mm, 0.2, 1e-3);
  EXPECT_TRUE(path.margin_part == "mandible" || path.margin_part == "wall");
  EXPECT_NE(insertion_path_text(path, seat()).find("tight"), std::string::npos);
}

TEST(InsertionPath, is_blocked_by_what_closes_the_gap_after_the_distance_to_it) {
  Case patient = walled_block(0.5);
  // A sleeve around the block, open nowhere.
  patient.add_piece({"floor", Role::segment, box({-60, -60, -30}, {60, 60, -13}), {}},
                    mandible_body);
  patient.add_piece({"front", Role::segment, box({-60, -60, -12}, {60, -12, 29}), {}},
                    mandible_body);
  patient.add_piece({"roof", Role::segment, box({-60, -11.5, 11}, {60, 11.5, 29}), {}},
                    mandible_body);
  patient.add_piece({"back", Role::segment, box({-60, 12, -12}, {60, 60, 29}), {}}, mandible_body);
  const InsertionPath path = find_insertion_path(patient, seat());
  EXPECT_EQ(path.state, InsertionPath::State::blocked);
  EXPECT_FALSE(path.blocked_by.empty());
  EXPECT_GT(path.blocked_after_mm, 3.9);
  EXPECT_LT(path.blocked_after_mm, 9);
  EXPECT_EQ(path.margin_part, "");
  // Nor does any turn lead out of the sleeve: the search ends, and states how far it came.
  EXPECT_FALSE(path.turns());
  EXPECT_GE(path.poses_examined, 40000);
  EXPECT_LT(path.poses_examined, 42000);
  EXPECT_GT(path.searched_mm, 1);
  EXPECT_LT(path.searched_mm, 20);
  EXPECT_NE(insertion_path_text(path, seat()).find("paths with turns"), std::string::npos);
}

TEST(InsertionPath, of_a_graft_that_overlaps_at_its_seat_ends_where_it_meets_other_bone_first) {
  // The block lies 0.4 mm deep in both walls, which end 1 mm below it; 6 mm farther is a thin
  // plate, and behind that thick bone, in which the block would lie deeper.
  Case patient;
  patient.name = "walls";
  const auto add = [&](const char* name, Role role, const TriMesh& mesh) {
    patient.parts.push_back({name, role, mesh, {}});
  };
  add("skull", Role::skull, box({-60, -60, 10}, {60, 60, 60}));
  add("mandible", Role::mandible, box({-60, -10, 6.5}, {-9.6, 10, 9}));
  const auto add_wall = [&](const char* name, const TriMesh& mesh) {
    patient.add_piece({name, Role::segment, mesh, {}}, mandible_body);
  };
  add_wall("wall", box({9.6, -10, 6.5}, {60, 10, 9}));
  add_wall("plate", box({-60, -60, -15}, {60, 60, -14.8}));
  add_wall("bone", box({-60, -60, -60}, {60, 60, -22}));
  patient.add_piece({"block", Role::transplant, box({-10, -8, -8}, {10, 8, 8}), {}}, mandible_body);
  const InsertionPath path = find_insertion_path(patient, seat());
  EXPECT_EQ(path.state, InsertionPath::State::blocked);
  EXPECT_EQ(path.blocked_by, "plate");
  EXPECT_GT(path.blocked_after_mm, 6);
  EXPECT_LT(path.blocked_after_mm, 9);
}

TEST(InsertionPath, tilts_under_an_overhang_that_blocks_every_straight_direction) {
  const Case patient = overhang(6);
  const InsertionPath path = find_insertion_path(patient, plate(), 2);
  ASSERT_TRUE(path.turns());  // is searched only where straight paths are blocked
  EXPECT_EQ(path.state, InsertionPath::State::free);
  EXPECT_GE(path.margin_mm, tight_margin_mm);
  EXPECT_GT(path.turn_deg, 5);
  EXPECT_LT(path.turn_deg, 60);
  EXPECT_LT(path.poses_examined, 40000);
  EXPECT_TRUE(path.poses.front().t.isZero());
  EXPECT_NEAR(path.poses.back().t.norm(), path_length_mm, 0.2);
  EXPECT_LT(rotation_angle(path.poses.back()), 0.01);
  EXPECT_GE(path.length_mm, path_length_mm - 0.2);
  EXPECT_LT(path.length_mm, 1.5 * path_length_mm);  // shortened
  std::vector<Pose> poses = path.poses;
  for (std::size_t i = 1; i < path.poses.size(); ++i) {
    EXPECT_LT(
        (path.poses[i] * Vector3d(10, 20, 3) - path.poses[i - 1] * Vector3d(10, 20, 3)).norm(),
        1.1);
    poses.push_back(interpolate(path.poses[i - 1], path.poses[i], 0.5));
  }
  EXPECT_LT(deepest_along(patient, {"plate"}, poses), 0.03);
  EXPECT_NE(insertion_path_text(path, plate()).find("turned by up to"), std::string::npos);
}

TEST(InsertionPath, of_several_pieces_is_that_of_one_body_and_the_same_for_any_number_of_threads) {
  const Case patient = overhang(6, 2);
  const InsertionPath one = find_insertion_path(patient, plate(2), 1),
                      three = find_insertion_path(patient, plate(2), 3);
  ASSERT_TRUE(one.turns());
  EXPECT_LT(deepest_along(patient, {"plate", "plate_2"}, one.poses), 0.03);
  ASSERT_EQ(one.poses.size(), three.poses.size());
  for (std::size_t i = 0; i < one.poses.size(); ++i)
    EXPECT_TRUE(bit_identical(one.poses[i], three.poses[i])) << i;
  EXPECT_EQ(one.margin_mm, three.margin_mm);
  EXPECT_EQ(one.poses_examined, three.poses_examined);
}

TEST(InsertionPath, is_blocked_by_an_overhang_that_is_too_wide) {
  const InsertionPath path = find_insertion_path(overhang(38), plate(), 2);
  EXPECT_EQ(path.state, InsertionPath::State::blocked);
  EXPECT_FALSE(path.turns());
  EXPECT_EQ(path.blocked_by, "lip");
  EXPECT_NEAR(path.blocked_after_mm, 1.25, 0.3);  // the room above the lip, along a slope
}

TEST(InsertionPath, is_the_same_for_any_number_of_threads) {
  const Case patient = walled_block(0.4);
  const InsertionPath one = find_insertion_path(patient, seat(), 1),
                      four = find_insertion_path(patient, seat(), 4);
  EXPECT_EQ(one.direction, four.direction);
  EXPECT_EQ(one.margin_mm, four.margin_mm);
  EXPECT_EQ(one.margin_at, four.margin_at);
  Seat missing = seat();
  missing.bodies = {"graft"};
  EXPECT_THROW(find_insertion_path(patient, missing), InputError);
}

}  // namespace
