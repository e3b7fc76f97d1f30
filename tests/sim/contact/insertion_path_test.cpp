// The straight path of a block into a gap between two walls.
#include "sim/contact/insertion_path.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/error.h"
#include "tests/support/boxes.h"

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
  patient.add_piece({"back", Role::segment, box({-60, 12, -12}, {60, 60, 29}), {}}, mandible_body);
  const InsertionPath path = find_insertion_path(patient, seat());
  EXPECT_EQ(path.state, InsertionPath::State::blocked);
  EXPECT_FALSE(path.blocked_by.empty());
  EXPECT_GT(path.blocked_after_mm, 3.9);
  EXPECT_LT(path.blocked_after_mm, 9);
  EXPECT_EQ(path.margin_part, "");
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
