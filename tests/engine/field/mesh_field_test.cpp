// Distance fields of closed surfaces, swept and without thin parts.
#include "engine/field/mesh_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/field/isosurface.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "tests/support/shapes.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

constexpr double band = 1.2, step = 0.25;

std::array<GridAxis, 3> axes_around(double half) {
  return even_grid({Vector3d::Constant(-half - 0.013), Vector3d::Constant(half)}, step);
}

/// A solid box as a field: the greatest of the distances from its faces.
SampledField box_field(const Vector3d& half, double around) {
  SampledField field{axes_around(around), {}};
  field.values.resize(field.axes[0].size() * field.axes[1].size() * field.axes[2].size());
  for (int i = 0; i < field.size().x(); ++i)
    for (int j = 0; j < field.size().y(); ++j)
      for (int k = 0; k < field.size().z(); ++k)
        field.values[field.index(i, j, k)] =
            static_cast<float>((field.position(i, j, k).cwiseAbs() - half).maxCoeff());
  return field;
}

double volume_of(const SampledField& field) { return inspect(isosurface(field)).volume_mm3; }

}  // namespace

TEST(MeshField, EqualsTheDistanceOfTheNearestTriangleWithinTheBand) {
  const TriMesh mesh = sphere(3, 5, {0.3, -0.2, 0.1}, 0.1);
  const TriangleTree tree(mesh);
  const SampledField field = mesh_field(mesh, axes_around(7), band);
  int near = 0, far = 0;
  for (int i = 0; i < field.size().x(); ++i)
    for (int j = 0; j < field.size().y(); ++j)
      for (int k = 0; k < field.size().z(); ++k) {
        const double value = field.values[field.index(i, j, k)];
        const double exact = tree.signed_distance(field.position(i, j, k));
        ASSERT_NEAR(value, std::clamp(exact, -band, band), 2e-4);  // squares are single precision
        (std::abs(exact) < band ? near : far) += 1;
      }
  EXPECT_GT(near, 10000);
  EXPECT_GT(far, 10000);
}

TEST(MeshField, ShellsThatOverlapAreTheirUnion) {
  const TriMesh two = joined(sphere(3, 3, {-1, 0, 0}), sphere(3, 3, {1, 0, 0}));
  const SampledField field = mesh_field(two, axes_around(5), band);
  EXPECT_LT(even_value(field, {0, 0, 0}), 0);
  EXPECT_LT(even_value(field, {2, 0, 0}), 0);  // on the buried surface's outer side
  EXPECT_GT(even_value(field, {0, 3, 0}), 0);
}

TEST(MeshField, IsBitIdenticalForAnyNumberOfThreads) {
  const TriMesh mesh = sphere(3, 4, {0, 0, 0}, 0.2);
  SampledField one = mesh_field(mesh, axes_around(6), band, 1),
               three = mesh_field(mesh, axes_around(6), band, 3);
  EXPECT_EQ(one.values, three.values);
  sweep(one, Sweep::up, 1);
  sweep(three, Sweep::up, 3);
  EXPECT_EQ(one.values, three.values);
  remove_thin(one, 0.5, 0.1, 1);
  remove_thin(three, 0.5, 0.1, 3);
  EXPECT_EQ(one.values, three.values);
}

TEST(MeshField, ASweptSolidFillsWhatLiesBeyondIt) {
  const TriMesh mesh = sphere(4, 3);
  SampledField up = mesh_field(mesh, axes_around(6), band), down = up;
  sweep(up, Sweep::up);
  sweep(down, Sweep::down);
  EXPECT_LT(even_value(up, {0, 0, 5}), -band + 0.01);
  EXPECT_GT(even_value(up, {0, 0, -5}), band - 0.01);
  EXPECT_LT(even_value(down, {0, 0, -5}), -band + 0.01);
  // Beside the cylinder that it sweeps: the distance from that, within the curvature of a cell.
  EXPECT_NEAR(even_value(up, {3.5, 0, 4}), 0.5, 0.02);
}

TEST(RemoveThin, DropsAPlateThatIsThinAndKeepsAThickOne) {
  SampledField thin = box_field({4, 4, 0.3}, 6), thick = box_field({4, 4, 0.9}, 6);
  const double before = volume_of(thick);
  remove_thin(thin, 0.5, 0.1);
  remove_thin(thick, 0.5, 0.1);
  EXPECT_TRUE(isosurface(thin).empty());
  // Sharp edges lose what no ball reaches: for a right angle (1 - pi/4) of the squared radius.
  const double edges = (4 * 8 + 4 * 8 + 4 * 1.8) * (1 - 0.785) * 0.25;
  EXPECT_LT(volume_of(thick), before + 1e-6);
  EXPECT_GT(volume_of(thick), before - edges);
}

TEST(RemoveThin, KeepsTheFacesOfAThickPlateWhereTheyAre) {
  SampledField thick = box_field({4, 4, 0.9}, 6);
  const SampledField before = thick;
  remove_thin(thick, 0.5, 0.1);
  for (const Vector3d& p : {Vector3d(0, 0, 0.9), Vector3d(1, -2, -0.9), Vector3d(4, 0.3, 0.1)})
    EXPECT_NEAR(even_value(thick, p), even_value(before, p), 1e-6);
}

TEST(RemoveThin, WithinABoxItChangesTheSamplesThereAlone) {
  SampledField whole = box_field({4, 4, 0.3}, 6), part = whole;
  const SampledField before = whole;
  remove_thin(whole, 0.5, 0.1);
  Box box;
  box.add(Vector3d(-1.05, -2.05, -1));
  box.add(Vector3d(1.05, 2.05, 1));
  remove_thin_within(part, box, 0.5, 0.1);
  int changed = 0;
  for (int i = 0; i < part.size().x(); ++i)
    for (int j = 0; j < part.size().y(); ++j)
      for (int k = 0; k < part.size().z(); ++k) {
        const std::size_t at = part.index(i, j, k);
        const SampledField& like = box.contains(part.position(i, j, k)) ? whole : before;
        ASSERT_EQ(part.values[at], like.values[at]) << i << " " << j << " " << k;
        changed += part.values[at] != before.values[at];
      }
  EXPECT_GT(changed, 50);
}

}  // namespace condyle::test
