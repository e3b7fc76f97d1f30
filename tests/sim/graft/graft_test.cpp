// Grafts between two cut faces: donors, mitred pieces, saw cuts on the donor, and contact of faces.
#include "sim/graft/graft.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"
#include "engine/mesh_io/mesh_files.h"
#include "sim/graft/corners.h"
#include "sim/graft/face_contact.h"
#include "tests/support/boxes.h"
#include "tests/support/program.h"

using namespace condyle;
using condyle::test::box;
using Eigen::Vector3d;

namespace {

/// A bar along x, whose ends were cut by step 1.
struct Bar {
  TriMesh mesh;
  std::vector<int> made_by;
};
Bar bar(double length_mm) {
  Bar made{box({0, -6, -15}, {length_mm, 6, 15}), {}};
  for (const auto& t : made.mesh.triangles) {
    const Vector3d a = made.mesh.vertices[t[0]], b = made.mesh.vertices[t[1]],
                   c = made.mesh.vertices[t[2]];
    made.made_by.push_back(std::abs((b - a).cross(c - a).normalized().x()) > 0.9 ? 1 : 0);
  }
  return made;
}

/// Its defect; the jaw's middle lies behind (+y), so that outward is -y.
Defect defect_of(const Bar& made, double kerf_mm = 0) {
  return find_defect(made.mesh, made.made_by, [=](int) { return kerf_mm; }, Vector3d::UnitZ(),
                     {30, 100, 0});
}

GraftStep graft_step(int pieces, std::vector<Vector3d> curve = {}) {
  GraftStep step;
  step.replaces = "bar";
  step.pieces = pieces;
  step.curve = std::move(curve);
  return step;
}

std::vector<Vector3d> face_points(const GraftPiece& piece, int face) {
  std::vector<Vector3d> points;
  for (std::size_t t = 0; t < piece.mesh.triangles.size(); ++t)
    if (piece.wall[t] == face)
      for (const int v : piece.mesh.triangles[t]) points.push_back(piece.mesh.vertices[v]);
  return points;
}

double farthest(const std::vector<Vector3d>& from, const std::vector<Vector3d>& to) {
  double most = 0;
  for (const Vector3d& p : from) {
    double least = 1e9;
    for (const Vector3d& q : to) least = std::min(least, (p - q).norm());
    most = std::max(most, least);
  }
  return most;
}

TEST(Donors, are_closed_and_have_the_published_sizes) {
  const struct {
    const char* name;
    Vector3d size;
    double least_mm3, most_mm3;
  } expected[] = {{"fibula", {360, 13, 15}, 30000, 60000},
                  {"iliac_block", {45, 14.1, 25}, 12500, 13500},
                  {"rib", {200, 0, 12}, 14000, 15100}};
  for (const auto& [name, size, least, most] : expected) {
    GraftStep step;
    step.donor = name;
    const Donor donor = make_donor(step);
    const Topology found = inspect(donor.mesh);
    EXPECT_TRUE(found.closed()) << name;
    EXPECT_EQ(found.components, 1) << name;
    EXPECT_GT(found.volume_mm3, least) << name;
    EXPECT_LT(found.volume_mm3, most) << name;
    const Vector3d box_size = bounding_box(donor.mesh).size();
    EXPECT_NEAR(box_size.z(), size.z(), 1e-9) << name;
    if (donor.bend_radius_mm == 0) {
      EXPECT_NEAR(box_size.x(), size.x(), 1e-9) << name;
      EXPECT_NEAR(box_size.y(), size.y(), 1e-9) << name;
    }
    EXPECT_NEAR(donor.place(donor.axis(30)), 30, 1e-9) << name;
  }
}

TEST(Donors, a_file_is_laid_along_x_and_must_be_closed_and_the_same) {
  const condyle::test::Folder folder;
  const auto file = folder.path() / "bone.ply";
  write_ply(box({5, 0, 0}, {15, 80, 20}), file);
  GraftStep step;
  step.donor = file.string();
  step.donor_shape = donor_shape(step.donor);
  const Donor donor = make_donor(step);
  EXPECT_NEAR(donor.length_mm, 80, 1e-9);
  EXPECT_NEAR(donor.height_mm, 20, 1e-9);
  EXPECT_NEAR(donor.width_mm, 10, 1e-9);
  EXPECT_NEAR(signed_volume(donor.mesh), 16000, 1e-6);
  write_ply(box({5, 0, 0}, {15, 80, 21}), file);
  EXPECT_THROW(make_donor(step), InputError);
  TriMesh open = box({0, 0, 0}, {10, 80, 20});
  open.triangles.pop_back();
  write_ply(open, file);
  EXPECT_THROW(donor_shape(step.donor), InputError);
}

TEST(Defects, have_the_faces_of_the_resected_bone_moved_by_the_kerf) {
  const Defect defect = defect_of(bar(60), 0.7);
  // From left to right: towards -x.
  EXPECT_TRUE(defect.faces[0].point.isApprox(Vector3d(60.7, 0, 0), 1e-9));
  EXPECT_TRUE(defect.faces[0].normal.isApprox(Vector3d(-1, 0, 0), 1e-9));
  EXPECT_TRUE(defect.faces[1].point.isApprox(Vector3d(-0.7, 0, 0), 1e-9));
  EXPECT_NEAR(defect.faces[1].area_mm2, 360, 1e-6);
  Bar one_face = bar(60);
  for (std::size_t t = 0; t < one_face.made_by.size(); ++t)
    if (one_face.mesh.vertices[one_face.mesh.triangles[t][0]].x() > 1) one_face.made_by[t] = 0;
  EXPECT_THROW(defect_of(one_face), InputError);
}

TEST(Grafts, of_one_piece_follow_the_lower_border_at_the_clearance) {
  const Bar made = bar(60);
  const GraftLayout graft = lay_graft(graft_step(1), made.mesh, defect_of(made));
  ASSERT_EQ(graft.pieces.size(), 1u);
  const GraftPiece& piece = graft.pieces[0];
  EXPECT_TRUE(inspect(piece.mesh).closed());
  const Box bounds = bounding_box(piece.mesh);
  EXPECT_NEAR(bounds.low.x(), 0.2, 1e-6);
  EXPECT_NEAR(bounds.high.x(), 59.8, 1e-6);
  EXPECT_NEAR(bounds.low.z(), -15, 1e-6);  // flush with the border
  EXPECT_NEAR(bounds.high.z(), 0, 1e-6);
  // The flat side of the fibula faces outward, -y.
  Box outer, inner;
  for (const Vector3d& v : piece.mesh.vertices) {
    if (v.y() < bounds.low.y() + 0.01) outer.add(v);
    if (v.y() > bounds.high.y() - 0.01) inner.add(v);
  }
  EXPECT_GT(outer.size().z(), 6);
  EXPECT_LT(inner.size().z(), 3);
  EXPECT_NEAR(piece.cuts[0].angle_deg, 0, 1e-6);
  EXPECT_NEAR(graft.donor_from_mm, 70, 1e-3);
  EXPECT_TRUE(graft.warnings.empty());
}

TEST(Grafts, have_equal_mitred_faces_and_saw_cuts_that_keep_their_distance) {
  const Bar made = bar(80);
  GraftStep step = graft_step(3, {{80, 0, 0}, {55, -15, 3}, {25, -15, -3}, {0, 0, 0}});
  const GraftLayout graft = lay_graft(step, made.mesh, defect_of(made));
  ASSERT_EQ(graft.pieces.size(), 3u);
  // An oblique prism has the volume of its section times its length along the middle of area.
  const Donor donor = make_donor(step);
  const double section_mm2 = signed_volume(donor.mesh) / donor.length_mm;
  Vector3d middle = Vector3d::Zero();
  for (const auto& t : donor.mesh.triangles) {
    const Vector3d a = donor.mesh.vertices[t[0]], b = donor.mesh.vertices[t[1]],
                   c = donor.mesh.vertices[t[2]];
    middle += a.dot(b.cross(c)) / 6 * (a + b + c) / 4 / signed_volume(donor.mesh);
  }
  for (const GraftPiece& piece : graft.pieces) {
    EXPECT_TRUE(inspect(piece.mesh).closed()) << piece.body;
    const Vector3d from = piece.X_CD * middle, along = piece.X_CD.R * Vector3d::UnitX();
    const auto reach = [&](int face) {
      return -piece.faces[face].distance(from) / piece.faces[face].normal.dot(along);
    };
    const double expected = section_mm2 * (reach(1) - reach(0));
    EXPECT_NEAR(piece.volume_mm3, expected, 1e-6 * expected) << piece.body;
    EXPECT_NEAR(signed_volume(piece.mesh), expected, 1e-6 * expected) << piece.body;
  }
  for (std::size_t i = 0; i + 1 < graft.pieces.size(); ++i) {
    const auto a = face_points(graft.pieces[i], 1), b = face_points(graft.pieces[i + 1], 0);
    ASSERT_FALSE(a.empty());
    const Plane &end = graft.pieces[i].faces[1], &begin = graft.pieces[i + 1].faces[0];
    EXPECT_NEAR(end.normal.dot(begin.normal), -1, 1e-9);
    for (const Vector3d& p : a) EXPECT_NEAR(end.distance(p), 0, 1e-6);
    // Corners of the prism lie on both faces; each may have points on straight edges besides.
    EXPECT_LT(farthest(a, b), 1.1);
    EXPECT_NEAR(graft.spacing_mm[i], 0.5, 1e-4);
  }
  // Each cut lies farther along the donor than the one before it.
  double last = 0;
  for (const GraftPiece& piece : graft.pieces)
    for (const DonorCut& cut : piece.cuts) {
      EXPECT_GT(cut.place_mm, last);
      last = cut.place_mm;
    }
  EXPECT_NEAR(graft.pieces[0].cuts[1].angle_deg, graft.pieces[1].cuts[0].angle_deg, 1e-6);
}

TEST(Grafts, refuse_saw_cuts_that_run_into_each_other) {
  const Bar made = bar(80);
  GraftStep step = graft_step(2, {{80, 0, 0}, {40, -20, 0}, {0, 0, 0}});
  const GraftLayout apart = lay_graft(step, made.mesh, defect_of(made));
  const double first = apart.pieces[0].start_mm, second = apart.pieces[1].start_mm;
  step.starts_mm = {first, second};
  EXPECT_NEAR(lay_graft(step, made.mesh, defect_of(made)).spacing_mm[0], 0.5, 1e-3);
  step.starts_mm = {first, second - 0.7};  // nearer than the saw is thick
  EXPECT_THROW(lay_graft(step, made.mesh, defect_of(made)), InputError);
  step.starts_mm = {first, second - 5};  // crossing
  EXPECT_THROW(lay_graft(step, made.mesh, defect_of(made)), InputError);
  step.starts_mm = {first, second + 5};
  EXPECT_EQ(lay_graft(step, made.mesh, defect_of(made)).warnings.size(), 1u);
}

TEST(Grafts, refuse_a_donor_that_is_too_short_and_warn_of_short_pieces) {
  const Bar made = bar(60);
  GraftStep step = graft_step(1);
  step.donor = "iliac_block";
  EXPECT_THROW(lay_graft(step, made.mesh, defect_of(made)), InputError);
  const Bar small = bar(30);
  const GraftLayout block = lay_graft(step, small.mesh, defect_of(small));
  EXPECT_TRUE(inspect(block.pieces[0].mesh).closed());
  step = graft_step(2);
  const GraftLayout graft = lay_graft(step, small.mesh, defect_of(small));
  EXPECT_EQ(graft.warnings.size(), 2u);  // two pieces below 20 mm
}

/// The reason for which a graft is refused.
std::string refusal(const GraftStep& step, const Bar& made) {
  try {
    lay_graft(step, made.mesh, defect_of(made));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Grafts, refuse_a_gap_without_room_and_bone_thinner_than_the_saw) {
  GraftStep step = graft_step(1);
  step.clearance_mm = 5;
  EXPECT_NE(refusal(step, bar(8)).find("leave no room for a graft"), std::string::npos)
      << refusal(step, bar(8));
  step.clearance_mm = 0.2;
  step.kerf_mm = 2;
  EXPECT_NE(refusal(step, bar(2)).find("1.60 mm long, no longer than the saw of 2 mm"),
            std::string::npos)
      << refusal(step, bar(2));
  const condyle::test::Folder folder;
  step.donor = folder / "plate.ply";
  write_ply(box({0, 0, 0}, {80, 1.5, 20}), step.donor);
  EXPECT_NE(refusal(step, bar(60)).find("1.50 mm thick, no thicker than the saw of 2 mm"),
            std::string::npos)
      << refusal(step, bar(60));
  step.kerf_mm = 0.5;
  EXPECT_EQ(refusal(step, bar(60)), "");
}

TEST(Grafts, name_no_file_in_reports) {
  GraftStep step = graft_step(2);
  EXPECT_NE(graft_step_details(step).find("fibula in 2 pieces"), std::string::npos);
  step.donor = "/patients/Mustermann/donor.ply";
  EXPECT_EQ(graft_step_details(step).find("Mustermann"), std::string::npos);
  EXPECT_NE(graft_step_details(step).find("own surface in 2 pieces"), std::string::npos);
}

TEST(Grafts, of_a_users_bone_are_cut_into_one_to_four_pieces) {
  const condyle::test::Folder folder;
  const Bar made = bar(100);
  for (int pieces = 1; pieces <= max_graft_pieces; ++pieces) {
    GraftStep step =
        graft_step(pieces, {{100, 0, 0}, {75, -9, 0}, {50, -12, 2}, {25, -9, 0}, {0, 0, 0}});
    step.donor = folder / "bone.ply";
    write_ply(box({0, 0, 0}, {14, 12, 200}), step.donor);
    step.donor_shape = donor_shape(step.donor);
    const GraftLayout graft = lay_graft(step, made.mesh, defect_of(made));
    ASSERT_EQ(graft.pieces.size(), static_cast<std::size_t>(pieces));
    ASSERT_EQ(graft.spacing_mm.size(), static_cast<std::size_t>(pieces - 1));
    for (const double spacing : graft.spacing_mm) EXPECT_NEAR(spacing, 0.5, 1e-3);
    double volume = 0;
    for (const GraftPiece& piece : graft.pieces) {
      EXPECT_TRUE(inspect(piece.mesh).closed()) << piece.body;
      volume += piece.volume_mm3;
    }
    double axis = 0;
    for (std::size_t i = 1; i < graft.corners.size(); ++i)
      axis += (graft.corners[i] - graft.corners[i - 1]).norm();
    EXPECT_NEAR(volume, 14 * 12 * axis, 0.02 * volume) << pieces;  // end faces are oblique
  }
}

TEST(Grafts, refuse_a_curve_that_runs_beside_a_face) {
  const Bar made = bar(60);
  EXPECT_THROW(
      lay_graft(graft_step(2, {{60, 0, 0}, {58, -40, 0}, {0, 0, 0}}), made.mesh, defect_of(made)),
      InputError);
}

TEST(Corners, lie_on_the_curve_and_keep_the_least_length) {
  std::vector<Vector3d> arc;
  for (int i = 0; i <= 90; ++i)
    arc.emplace_back(40 * std::cos(i * 3.14159265 / 90), 40 * std::sin(i * 3.14159265 / 90), 0);
  const auto corners = corners_on_curve(arc, 3, 20);
  ASSERT_EQ(corners.size(), 4u);
  EXPECT_EQ(corners.front(), arc.front());
  for (std::size_t i = 1; i < corners.size(); ++i)
    EXPECT_NEAR((corners[i] - corners[i - 1]).norm(), 40, 2);  // thirds of a semicircle
  EXPECT_NEAR(deviation_of(corners, arc), 40 * (1 - std::cos(3.14159265 / 6)), 0.5);
}

TEST(FaceContact, is_the_share_of_the_face_with_a_small_gap) {
  const TriMesh cube = box({0, 0, 0}, {20, 10, 5});
  std::vector<int> wall;
  for (const auto& t : cube.triangles)
    wall.push_back(cube.vertices[t[0]].z() > 1 && cube.vertices[t[1]].z() > 1 &&
                           cube.vertices[t[2]].z() > 1
                       ? 0
                       : -1);
  const Plane top{Vector3d::UnitZ(), 5};
  // A ramp: no gap at x = 0, 2 mm at x = 20; nothing before the second half of y.
  const FaceContact found =
      face_contact(cube, wall, 0, top, [](const Vector3d& p) -> std::optional<double> {
        if (p.y() > 5) return std::nullopt;
        return 0.1 * p.x();
      });
  EXPECT_NEAR(found.area_mm2, 200, 1e-9);
  EXPECT_NEAR(found.facing_share, 0.5, 1e-9);
  EXPECT_NEAR(found.contact_mm2, 25, 2.5);  // x up to 5 mm, by columns of half a millimetre
  EXPECT_NEAR(found.mean_gap_mm, 1, 1e-9);
  EXPECT_NEAR(found.largest_gap_mm, 2, 0.05);
}

}  // namespace
