// Bones that carry crowns besides their teeth, and the distances of registered scans.
#include "sim/dental_scan/carried_crowns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>
#include <vector>

#include "engine/field/mesh_field.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/dental_scan/dental_scan.h"
#include "sim/dental_scan/scanned_arches.h"
#include "tests/sim/dental_scan/made_scans.h"
#include "tests/support/boxes.h"
#include "tests/support/builtin.h"
#include "tests/support/exact_distance.h"
#include "tests/support/real_cases.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

/// The built-in patient whose lower jaw carries its crowns, as after a
/// segmentation that did not part them.
Case with_carried_crowns() {
  Case patient = builtin();
  for (Part& part : patient.parts) {
    if (part.role != Role::mandible) continue;
    TriMesh mesh = part.mesh;
    const auto add = [&](const TriMesh& other) {
      const int offset = static_cast<int>(mesh.vertices.size());
      mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
      for (const auto& t : other.triangles)
        mesh.triangles.push_back(t + Eigen::Vector3i::Constant(offset));
    };
    add(crowns(patient, false).mesh);
    const Box box = bounding_box(mesh);
    const Vector3d margin = Vector3d::Constant(2);
    part.mesh =
        isosurface(mesh_field(mesh, even_grid({box.low - margin, box.high + margin}, 0.9), 2, 2));
  }
  return patient;
}

ScannedArches imported(const Case& patient, bool upper, unsigned seed) {
  ScannedArchesRequest request;
  const TriMesh scan = made_scan(crowns(patient, upper), random_pose(seed), seed);
  (upper ? request.upper : request.lower) = dental_scan(scan, "scan.stl");
  return with_scanned_arches(patient, request);
}

const Part& bone_of(const Case& patient, bool upper) {
  for (const Part& part : patient.parts)
    if (part.body == crowns(patient, upper).body && !is_teeth(part.role) && collides(part.role))
      return part;
  throw std::runtime_error("the arch has no bone");
}

/// Vertices and middles of triangles in the crowns or within 0.8 mm of them, in the occlusal 4.5 mm
/// of a tooth.
int points_at_crowns(const TriMesh& bone, const TriMesh& teeth, bool upper) {
  const TriMesh tips = cut_at_gum(teeth, upper, 4.5);
  const TriangleTree tree(tips), whole(teeth);
  const Box box = bounding_box(tips);
  const Components pieces = find_components(tips);
  std::vector<Box> boxes(static_cast<std::size_t>(pieces.count));
  for (std::size_t t = 0; t < tips.triangles.size(); ++t)
    for (const int v : tips.triangles[t])
      boxes[static_cast<std::size_t>(pieces.of_triangle[t])].add(tips.vertices[v]);
  int count = 0;
  const auto look = [&](const Vector3d& p) {
    if (!box.contains(p, 1)) return;
    if (std::none_of(boxes.begin(), boxes.end(), [&](const Box& b) { return b.contains(p); }))
      return;
    count += tree.nearest(p).distance < 0.8 || whole.winding_number(p) > 0.5;
  };
  for (const auto& v : bone.vertices) look(v);
  for (const auto& t : bone.triangles)
    look((bone.vertices[t[0]] + bone.vertices[t[1]] + bone.vertices[t[2]]) / 3);
  return count;
}

/// Vertices of the bone that are no more there, though they lie farther than `far_mm` from teeth or
/// deeper than all crowns.
int lost_vertices(const TriMesh& before, const TriMesh& after, const TriMesh& teeth, bool upper) {
  constexpr double far_mm = 8, deep_mm = 11;
  std::set<std::array<double, 3>> kept;
  for (const auto& v : after.vertices) kept.insert({v.x(), v.y(), v.z()});
  const TriMesh tips = cut_at_gum(teeth, upper);
  const TriangleTree tree(tips);
  double lowest_tip = 1e9;  // along the bite
  const Components pieces = find_components(tips);
  std::vector<double> top(static_cast<std::size_t>(pieces.count), -1e9);
  for (std::size_t t = 0; t < tips.triangles.size(); ++t)
    for (const int v : tips.triangles[t]) {
      double& height = top[static_cast<std::size_t>(pieces.of_triangle[t])];
      height = std::max(height, (upper ? -1 : 1) * tips.vertices[v].z());
    }
  for (const double height : top) lowest_tip = std::min(lowest_tip, height);
  int lost = 0;
  for (const auto& v : before.vertices)
    if (tree.nearest(v).distance > far_mm || (upper ? -1 : 1) * v.z() < lowest_tip - deep_mm)
      lost += !kept.count({v.x(), v.y(), v.z()});
  return lost;
}

void expect_crowns_removed(const Case& patient, bool upper, double least_mm3, double most_mm3) {
  const ScannedArches made = imported(patient, upper, 3);
  const Part& before = bone_of(patient, upper);
  const Part& after = bone_of(made.patient, upper);
  const TriMesh& teeth = crowns(patient, upper).mesh;
  EXPECT_GT(points_at_crowns(before.mesh, teeth, upper), 1000) << patient.name;
  EXPECT_EQ(points_at_crowns(after.mesh, teeth, upper), 0) << patient.name;
  EXPECT_TRUE(inspect(after.mesh).closed());
  EXPECT_EQ(lost_vertices(before.mesh, after.mesh, teeth, upper), 0);
  const auto& bones = upper ? made.upper_bones : made.lower_bones;
  ASSERT_EQ(bones.size(), 1u);
  EXPECT_EQ(bones[0].part, before.name);
  EXPECT_NEAR(bones[0].removed_mm3, signed_volume(before.mesh) - signed_volume(after.mesh), 1e-3);
  EXPECT_GT(bones[0].removed_mm3, least_mm3);
  EXPECT_LT(bones[0].removed_mm3, most_mm3);
}

}  // namespace

TEST(CarriedCrowns, GiveWayToTheScan) {
  const Case patient = with_carried_crowns();
  expect_crowns_removed(patient, false, 1500, 6000);
}

TEST(CarriedCrowns, OfRealBonesGiveWay) {
  const auto patient = case_ubc();
  if (!patient) GTEST_SKIP() << "real data is absent";
  for (const bool upper : {true, false}) expect_crowns_removed(*patient, upper, 1500, 6000);
}

TEST(CarriedCrowns, BonesThatCarryNoneStayAsTheyAre) {
  for (const bool upper : {true, false}) {
    const ScannedArches made = imported(builtin(), upper, 4);
    EXPECT_TRUE(made.upper_bones.empty() && made.lower_bones.empty());
    for (std::size_t i = 0; i < made.patient.parts.size(); ++i)
      if (const Part& before = builtin().parts[i]; !is_teeth(before.role)) {
        EXPECT_EQ(mesh_hash(made.patient.parts[i].mesh), mesh_hash(before.mesh)) << before.name;
      }
  }
}

TEST(CarriedCrowns, OfAnOpenBoneStayAndAreReported) {
  Case patient = with_carried_crowns();
  for (Part& part : patient.parts)
    if (part.role == Role::mandible)
      punch_hole(part.mesh, *patient.landmarks.find("left_gonion"), 3);
  const ScannedArches made = imported(patient, false, 5);
  ASSERT_EQ(made.lower_bones.size(), 1u);
  EXPECT_GT(made.lower_bones[0].open_edges, 0);
  EXPECT_EQ(made.lower_bones[0].removed_mm3, 0);
  EXPECT_EQ(mesh_hash(bone_of(made.patient, false).mesh), mesh_hash(bone_of(patient, false).mesh));
}

/// A slab through the lower incisors, down to so far below their tips.
Part slab(const char* name, double depth_mm, double height_mm) {
  const Vector3d tip = *builtin().landmarks.find("lower_incisal_point");
  return {name,
          Role::mandible,
          box(tip + Vector3d(-6, -1, -depth_mm), tip + Vector3d(6, 3, height_mm - depth_mm)),
          {},
          crowns(builtin(), false).body};
}

const Part* find_part(const Case& patient, const std::string& name) {
  for (const Part& part : patient.parts)
    if (part.name == name) return &part;
  return nullptr;
}

TEST(CarriedCrowns, AnotherBoneIsTrimmedAndNotDropped) {
  Case patient = builtin();
  patient.parts.push_back(slab("slab", 22, 21));
  const ScannedArches made = imported(patient, false, 6);
  const Part* after = find_part(made.patient, "slab");
  ASSERT_TRUE(after);
  EXPECT_TRUE(inspect(after->mesh).closed());
  EXPECT_NEAR(bounding_box(after->mesh).size().z(), 22 - crown_floor_mm, 1.5);
  // Nor a shell of the same bone.
  const TriMesh shell = slab("slab", 22, 21).mesh;
  Case slabs = builtin();
  std::erase_if(slabs.parts, [](const Part& part) { return part.role == Role::mandible; });
  TriMesh far = box({-10, 20, -120}, {30, 90, -60});
  const int more = static_cast<int>(far.vertices.size());
  far.vertices.insert(far.vertices.end(), shell.vertices.begin(), shell.vertices.end());
  for (const auto& t : shell.triangles)
    far.triangles.push_back(t + Eigen::Vector3i::Constant(more));
  slabs.parts.push_back({"mandible", Role::mandible, far, {}, crowns(builtin(), false).body});
  const ScannedArches two = imported(slabs, false, 6);
  EXPECT_EQ(find_components(bone_of(two.patient, false).mesh).count, 2);
  EXPECT_LT(signed_volume(bone_of(two.patient, false).mesh), signed_volume(far) - 50);
}

TEST(CarriedCrowns, ALumpThatIsAPartOfItsOwnIsRemoved) {
  Case patient = builtin();
  patient.parts.push_back(slab("lump", 3, 3));
  const ScannedArches made = imported(patient, false, 7);
  EXPECT_FALSE(find_part(made.patient, "lump"));
  EXPECT_TRUE(std::any_of(made.notes.begin(), made.notes.end(), [](const std::string& note) {
    return note.find("lump: all of it") == 0;
  }));
  // The arch's only bone stays.
  std::erase_if(patient.parts, [](const Part& part) {
    return part.role == Role::mandible && part.name != "lump";
  });
  EXPECT_TRUE(find_part(imported(patient, false, 7).patient, "lump"));
}

TEST(CarriedCrowns, OfABoneThatFacesInwardStayAndAreReported) {
  Case patient = with_carried_crowns();
  for (Part& part : patient.parts)
    if (part.role == Role::mandible)
      for (auto& t : part.mesh.triangles) std::swap(t[1], t[2]);
  const ScannedArches made = imported(patient, false, 5);
  EXPECT_EQ(mesh_hash(bone_of(made.patient, false).mesh), mesh_hash(bone_of(patient, false).mesh));
  EXPECT_TRUE(std::any_of(made.notes.begin(), made.notes.end(), [](const std::string& note) {
    return note.find("face inward") != std::string::npos;
  }));
}

TEST(ScanResiduals, AreTheExactSignedDistancesFromTheCrowns) {
  const TriMesh& teeth = crowns(builtin(), true).mesh;
  TriMesh grown = cut_at_gum(teeth, true);
  const auto normals = vertex_normals(grown);
  for (std::size_t i = 0; i < normals.size(); ++i)
    grown.vertices[i] += (grown.vertices[i].x() > 0 ? 0.2 : -0.2) * normals[i];
  const DentalScan scan = dental_scan(grown, "scan.ply");
  const auto residual_mm = crown_distances(scan, ArchTarget(crowns(builtin(), true)), {}, 2);
  ASSERT_EQ(residual_mm.size(), scan.mesh.vertices.size());
  int checked = 0, wrong_side = 0;
  for (std::size_t i = 0; i < residual_mm.size(); i += 97) {
    if (std::isnan(residual_mm[i])) continue;
    ++checked;
    const Vector3d& p = scan.mesh.vertices[i];
    EXPECT_NEAR(std::abs(residual_mm[i]), exact_distance(p, teeth), 1e-6);
    wrong_side += (residual_mm[i] > 0) != (p.x() > 0);
  }
  EXPECT_GT(checked, 80);
  EXPECT_LE(wrong_side, checked / 20);  // where neighbouring crowns touch
}

}  // namespace condyle::test
