#include "sim/phantom/phantom.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/phantom/soft_shapes.h"
#include "sim/phantom/surfaces.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

const Case& patient() {
  static const Case made = build_phantom_on(2);
  return made;
}

const TriMesh& mesh_of(Role role) { return patient().find(role)->mesh; }

double area_of(const TriMesh& mesh, const Eigen::Vector3i& t) {
  const auto at = [&](int i) -> const Vector3d& {
    return mesh.vertices[static_cast<std::size_t>(t[i])];
  };
  return (at(1) - at(0)).cross(at(2) - at(0)).norm() / 2;
}

void expect_bones_closed() {
  for (const Role role :
       {Role::skull, Role::mandible, Role::upper_gums, Role::lower_gums, Role::tongue}) {
    const auto topology = inspect(mesh_of(role));
    EXPECT_TRUE(topology.closed()) << static_cast<int>(role);
    EXPECT_EQ(topology.components, 1) << static_cast<int>(role);
    EXPECT_GT(topology.volume_mm3, 1000);
  }
  for (const Role role : {Role::skull, Role::mandible})
    EXPECT_NEAR(static_cast<double>(mesh_of(role).triangles.size()), 50000, 2500);
  for (const auto& part : patient().parts)
    for (const auto& t : part.mesh.triangles) ASSERT_GT(area_of(part.mesh, t), 1e-7) << part.name;
}

void expect_separate_teeth() {
  std::set<int> numbers;
  for (const Role role : {Role::upper_teeth, Role::lower_teeth}) {
    const Part& arch = *patient().find(role);
    ASSERT_EQ(arch.teeth.size(), 14u);
    const auto topology = inspect(arch.mesh);
    EXPECT_TRUE(topology.closed());
    EXPECT_EQ(topology.components, 14);
    const auto components = find_components(arch.mesh);
    int next = 0;
    for (const auto& tooth : arch.teeth) {
      EXPECT_TRUE(numbers.insert(tooth.fdi).second);
      EXPECT_EQ(tooth.first_triangle, next);
      next += tooth.triangle_count;
      Vector3d middle = Vector3d::Zero();
      const int piece = components.of_triangle[static_cast<std::size_t>(tooth.first_triangle)];
      for (int t = tooth.first_triangle; t < next; ++t) {
        ASSERT_EQ(components.of_triangle[static_cast<std::size_t>(t)], piece);
        const auto corner = arch.mesh.triangles[static_cast<std::size_t>(t)][0];
        middle += arch.mesh.vertices[static_cast<std::size_t>(corner)];
      }
      const int quadrant = tooth.fdi / 10;  // 1 and 4 on the right, which is -x
      EXPECT_EQ(middle.x() > 0, quadrant == 2 || quadrant == 3) << tooth.fdi;
      EXPECT_EQ(role == Role::upper_teeth, quadrant <= 2) << tooth.fdi;
    }
    EXPECT_EQ(next, static_cast<int>(arch.mesh.triangles.size()));
  }
  EXPECT_TRUE(numbers.count(11) && numbers.count(27) && numbers.count(31) && numbers.count(47));

  const TriangleTree upper(mesh_of(Role::upper_teeth)), lower(mesh_of(Role::lower_teeth));
  double gap = 1e9;
  for (const auto& p : mesh_of(Role::lower_teeth).vertices)
    gap = std::min(gap, upper.signed_distance(p));
  for (const auto& p : mesh_of(Role::upper_teeth).vertices)
    gap = std::min(gap, lower.signed_distance(p));
  EXPECT_GT(gap, 0.04);
  EXPECT_LT(gap, 0.15);
}

/// Vertices as a set of exact coordinates must be the same after x -> -x; but a face is never
/// quite even.
void expect_mirror_symmetry() {
  for (const auto& part : patient().parts) {
    if (part.role == Role::face) continue;
    std::vector<std::array<double, 3>> here, there;
    for (const auto& p : part.mesh.vertices) {
      here.push_back({p.x() == 0 ? 0 : p.x(), p.y(), p.z()});
      there.push_back({p.x() == 0 ? 0 : -p.x(), p.y(), p.z()});
    }
    std::sort(here.begin(), here.end());
    std::sort(there.begin(), there.end());
    EXPECT_TRUE(here == there) << part.name;
  }
}

/// A natural face is not its own mirror image, but the difference is barely visible.
void expect_a_slightly_uneven_face() {
  const TriMesh& face = mesh_of(Role::face);
  const TriangleTree tree(face);
  std::vector<double> off;
  for (std::size_t i = 0; i < face.vertices.size(); i += 7) {
    const Vector3d& p = face.vertices[i];
    off.push_back(tree.nearest({-p.x(), p.y(), p.z()}).distance);
  }
  std::sort(off.begin(), off.end());
  EXPECT_GT(off[off.size() * 95 / 100], 0.2);
  EXPECT_GT(off.back(), 1);
  EXPECT_LT(off.back(), 3);
  // Displacement of the centre of a region on the left: both halves had the same vertices.
  const auto leans = [&](double half_width, double behind, double low, double high) {
    double sum = 0;
    int count = 0;
    for (const auto& p : face.vertices)
      if (std::abs(p.x()) < half_width && p.y() < behind && p.z() > low && p.z() < high) {
        sum += p.x();
        ++count;
      }
    EXPECT_GT(count, 100);
    return sum / count;
  };
  const double nose = leans(22, -108, -30, 0), chin = leans(30, -85, -100, -80),
               lips = leans(30, -85, -60, -44);
  EXPECT_GT(nose, 0.3);
  EXPECT_LT(chin, -0.3);
  EXPECT_LT(std::abs(lips), 0.15);
}

void expect_lips_that_part() {
  const TriMesh& face = mesh_of(Role::face);
  const auto topology = inspect(face);
  EXPECT_EQ(topology.components, 1);
  EXPECT_EQ(topology.nonmanifold_edges, 0);
  EXPECT_EQ(topology.misoriented_edges, 0);
  ASSERT_EQ(topology.boundary.size(), 3u);  // behind the lips, and in both eye sockets
  EXPECT_GT(face.triangles.size(), 60000u);
  EXPECT_LT(face.triangles.size(), 120000u);
  EXPECT_EQ(face.colors.size(), face.vertices.size());
  const auto mouth = *std::max_element(
      topology.boundary.begin(), topology.boundary.end(),
      [](const auto& a, const auto& b) { return a.box.center().z() > b.box.center().z(); });
  EXPECT_GT(mouth.box.low.y(), -99);  // deep behind the lips
  EXPECT_GT(mouth.box.size().x(), 2 * mouth_corner_x);

  // Without what lies beyond the corners the lips are two: nothing joins them across the line.
  std::map<bool, int> sides;
  int crossing = 0;
  for (const auto& t : face.triangles) {
    int above = 0, near = 0;
    for (int i = 0; i < 3; ++i) {
      const auto& p = face.vertices[static_cast<std::size_t>(t[i])];
      near += std::abs(p.x()) < mouth_corner_x - 1.5 && p.y() < -80 && std::abs(p.z() + 50) < 12;
      above += p.z() > lip_line(p.x(), p.y());
    }
    if (near < 3) continue;
    crossing += above == 1 || above == 2;
    ++sides[above == 3];
  }
  EXPECT_EQ(crossing, 0);
  EXPECT_GT(sides[true], 1000);
  EXPECT_GT(sides[false], 1000);
  // Closed at rest: from the midline's upper lip the lower one is near.
  const TriangleTree tree(face);
  const Vector3d lip(0.37, -100, lip_line(0.37, -100));
  const auto up = tree.ray_cast(lip, Vector3d::UnitZ()),
             down = tree.ray_cast(lip, -Vector3d::UnitZ());
  ASSERT_TRUE(up && down);
  EXPECT_LT(up->distance + down->distance, 0.3);
}

void expect_landmarks_on_surfaces() {
  const auto& points = patient().landmarks.points;
  EXPECT_GT(points.size(), 90u);
  const std::set<std::string> in_space = {"sella",         "hyoid",        "left_condyle",
                                          "right_condyle", "left_eyeball", "right_eyeball"};
  std::vector<TriangleTree> trees;
  for (const auto& part : patient().parts) trees.emplace_back(part.mesh);
  int checked = 0;
  for (const auto& [name, p] : points) {
    if (in_space.count(name)) continue;
    double d = 1e9;
    for (const auto& tree : trees) d = std::min(d, tree.nearest(p).distance);
    EXPECT_LT(d, 0.7) << name;
    ++checked;
    const auto side = name.find("left_");
    if (side == 0 || (side != name.npos && name[side - 1] == '_')) {
      const auto& twin = points.at(std::string(name).replace(side, 5, "right_"));
      EXPECT_EQ(twin, Vector3d(-p.x(), p.y(), p.z())) << name;
      EXPECT_GT(p.x(), 0) << name;
    }
  }
  EXPECT_GT(checked, 80);
  for (const char* name : {"stomion", "left_cheilion", "soft_pogonion", "pronasale", "left_porion",
                           "upper_incisal_point", "lower_incisal_point", "right_orbitale"})
    EXPECT_TRUE(points.count(name)) << name;
}

void expect_foramina_and_canals_in_bone() {
  const TriangleTree mandible(mesh_of(Role::mandible)), skull(mesh_of(Role::skull));
  const auto& points = patient().landmarks.points;
  for (const std::string side : {"left_", "right_"}) {
    EXPECT_LT(mandible.nearest(points.at(side + "lingula")).distance, 0.3);
    EXPECT_LT(mandible.nearest(points.at(side + "mental_foramen")).distance, 0.3);
    EXPECT_LT(skull.nearest(points.at(side + "infraorbital_foramen")).distance, 0.3);
  }
  ASSERT_EQ(patient().canals.size(), 2u);
  for (const Canal& canal : patient().canals) {
    const std::string side = canal.name.substr(0, canal.name.find("mandibular_canal"));
    EXPECT_EQ(canal.points.front(), points.at(side + "lingula"));
    EXPECT_EQ(canal.points.back(), points.at(side + "mental_foramen"));
    EXPECT_EQ(canal.body, mandible_body);
    for (const Vector3d& p : canal.points)
      if ((p - canal.points.front()).norm() > 1 && (p - canal.points.back()).norm() > 5.5) {
        EXPECT_GT(mandible.winding_number(p), 0.9) << canal.name << " " << p.transpose();
      }
  }
}

TEST(Phantom, IsAWholePatient) {
  EXPECT_EQ(patient().name, "built-in patient");
  expect_bones_closed();
  expect_separate_teeth();
  expect_mirror_symmetry();
  expect_a_slightly_uneven_face();
  expect_lips_that_part();
  expect_landmarks_on_surfaces();
  expect_foramina_and_canals_in_bone();
  ASSERT_TRUE(patient().condylar_path);
  EXPECT_GE(patient().condylar_path->forward_mm.back(), 19);
}

TEST(Phantom, EachPartBelongsToTheBodyOfItsRole) {
  for (const Part& part : build_phantom().parts)
    EXPECT_EQ(part.body, default_body(part.role)) << part.name;
}

TEST(Phantom, IsBitIdenticalOnTheseThreadCounts) {
  const Case alone = build_phantom_on(1);
  ASSERT_EQ(alone.parts.size(), patient().parts.size());
  for (std::size_t i = 0; i < alone.parts.size(); ++i)
    EXPECT_EQ(mesh_hash(alone.parts[i].mesh), mesh_hash(patient().parts[i].mesh))
        << alone.parts[i].name;
  EXPECT_EQ(alone.landmarks.points, patient().landmarks.points);
  for (std::size_t i = 0; i < alone.canals.size(); ++i)
    EXPECT_EQ(alone.canals[i].points, patient().canals.at(i).points);
}

TEST(Phantom, BuildingCanBeCancelled) {
  struct Cancelled {};
  EXPECT_THROW(build_phantom([](std::string_view, double) { throw Cancelled(); }), Cancelled);
}

TEST(Phantom, HairIsCutToTheSkinAboveForeheadAndEarAndOnNeither) {
  const auto light = [](double x, double y, double z) { return skin_color({x, y, z}).x(); };
  for (const double side : {-1, 1}) {
    const double forehead = light(side * 20, -95, 55), ear = light(side * 84, 14, 10);
    const double above_ear = light(side * 74, 13, 60), behind_ear = light(side * 70, 60, 20),
                 crown = light(side * 30, 20, 110);
    EXPECT_GT(std::min(forehead, ear) - std::max({above_ear, behind_ear, crown}), 0.1) << side;
    EXPECT_NEAR(light(side * 76, 13, 36), ear, 0.06) << side;  // above its root
  }
}

TEST(Phantom, TheCreaseBesideTheAlaIsShadedAndTheEarHardlyRedderThanTheCheek) {
  const auto red = [](const Eigen::Vector3f& color) { return color.x() / color.y(); };
  for (const double side : {-1, 1}) {
    const Eigen::Vector3f crease = skin_color({side * 18, -97, -20.5}),
                          beside = skin_color({side * 26, -93, -22}),
                          cheek = skin_color({side * 44, -74, -16}),
                          ear = skin_color({side * 84, 14, 0});
    EXPECT_LT(crease.sum(), 0.85f * beside.sum()) << side;
    EXPECT_LT(red(ear), 1.1f * red(cheek)) << side;
  }
}

}  // namespace
}  // namespace condyle
