// A template is carried onto a deformed copy of itself whose triangles are others.
#include "engine/registration/elastic_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <functional>

#include "engine/mesh/measure.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// A closed body without symmetry, about 80 mm long.
TriMesh potato(int around, const std::function<Vector3d(const Vector3d&)>& place = {}) {
  const int down = around / 2;
  TriMesh mesh;
  const auto add = [&](double a, double b) {
    const Vector3d d(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
    const double r = 1 + 0.2 * std::sin(3 * d.x() + 1) + 0.15 * std::cos(4 * d.y()) +
                     0.1 * std::sin(5 * d.z() + 2 * d.x());
    const Vector3d p = r * Vector3d(25, 30, 40).cwiseProduct(d);
    mesh.vertices.push_back(place ? place(p) : p);
  };
  add(0, 0);
  for (int i = 1; i < down; ++i)
    for (int j = 0; j < around; ++j) add(M_PI * i / down, 2 * M_PI * j / around);
  add(M_PI, 0);
  const int last = static_cast<int>(mesh.vertices.size()) - 1;
  const auto at = [&](int i, int j) { return 1 + (i - 1) * around + j % around; };
  for (int j = 0; j < around; ++j) {
    mesh.triangles.emplace_back(0, at(1, j), at(1, j + 1));
    mesh.triangles.emplace_back(last, at(down - 1, j + 1), at(down - 1, j));
    for (int i = 1; i + 1 < down; ++i) {
      mesh.triangles.emplace_back(at(i, j), at(i + 1, j), at(i, j + 1));
      mesh.triangles.emplace_back(at(i, j + 1), at(i + 1, j), at(i + 1, j + 1));
    }
  }
  return mesh;
}

}  // namespace

TEST(SurfaceSamples, LieOnTheSurfaceAndSeeOutside) {
  const TriMesh outer = potato(40);
  TriMesh both = outer;
  const int first = static_cast<int>(both.vertices.size());
  for (const auto& v : outer.vertices) both.vertices.push_back(0.8 * v);  // the wall of a cavity
  for (const auto& t : outer.triangles)
    both.triangles.emplace_back(first + t[0], first + t[2], first + t[1]);
  const TriangleTree tree(both), outer_tree(outer);
  const auto samples = sample_surface(both, 1000);
  ASSERT_EQ(samples.size(), 1000u);
  for (const auto& sample : samples) EXPECT_LT(tree.nearest(sample.point).distance, 1e-9);
  const auto seen = outer_samples(samples, tree, 2);
  EXPECT_GT(seen.size(), 500u);
  for (const auto& sample : seen) EXPECT_LT(outer_tree.nearest(sample.point).distance, 1e-9);
}

TEST(SimilarityFit, FindsTurnScaleAndOffset) {
  AffineMap truth;
  truth.matrix = 1.1 * Eigen::AngleAxisd(2, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  truth.offset = {10, -40, 7};
  std::vector<PointPair> pairs;
  for (const Vector3d& p : {Vector3d(0, 0, 0), Vector3d(10, 0, 0), Vector3d(0, 20, 0),
                            Vector3d(3, 4, 30), Vector3d(-7, 5, 9)})
    pairs.push_back({p, truth * p, 1, {0, 0, 1}});
  pairs.push_back({{5, 5, 5}, {900, 0, 0}, 0, {0, 0, 1}});  // without weight
  const auto fit = similarity_fit(pairs, {0.8, 1.25}), fixed = similarity_fit(pairs, {1, 1});
  ASSERT_TRUE(fit && fixed);
  EXPECT_LT((fit->matrix - truth.matrix).norm(), 1e-12);
  EXPECT_LT((fit->offset - truth.offset).norm(), 1e-10);
  EXPECT_NEAR(fixed->matrix.determinant(), 1, 1e-12);
  EXPECT_LT((truth.inverse() * (truth * Vector3d(1, 2, 3)) - Vector3d(1, 2, 3)).norm(), 1e-12);
  EXPECT_FALSE(similarity_fit(std::span(pairs).first(2), {1, 1}));
}

TEST(DisplacementLayer, FollowsASmoothField) {
  const auto field = [](const Vector3d& p) {
    return Vector3d(2 * std::sin(p.z() / 20), std::cos(p.x() / 15), 0.05 * p.y());
  };
  std::vector<Pull> pulls;
  for (const auto& sample : sample_surface(potato(40), 800))
    pulls.push_back({sample.point, sample.point + field(sample.point), sample.normal, 1});
  const DisplacementLayer layer(
      pulls, {.reach_mm = 60, .spacing_mm = 12, .stiffness = 1e-3, .tangential = 1});
  EXPECT_GT(layer.controls(), 50);
  for (const auto& pull : pulls)
    EXPECT_LT((layer(pull.point) - pull.target).norm(), 0.3);  // a tenth
  const Vector3d far(500, 0, 0);
  EXPECT_EQ(layer(far), far);
}

TEST(ElasticFit, CarriesATemplateOntoADeformedCopy) {
  const auto deform = [](const Vector3d& p) {
    const Vector3d bent(1.05 * p.x() + 2 * std::sin(p.z() / 20), 0.95 * p.y(),
                        p.z() + 1.5 * std::cos(p.y() / 25));
    return Vector3d(Eigen::AngleAxisd(0.15, Vector3d::UnitX()) * bent + Vector3d(4, -3, 6));
  };
  const FitSurface moving(potato(50), 1500, 2), target(potato(71, deform), 2000, 2);
  ElasticFitSettings settings;
  settings.levels = {{60, 4, 3, 1}, {30, 4, 2, 1}};
  const auto carry = [&](int threads) {
    settings.match.threads = threads;
    ElasticFit fit = fit_stiffly(moving, target, {}, settings);
    add_displacements(fit, moving, target, settings);
    return fit;
  };
  const ElasticFit fit = carry(2);
  EXPECT_LT(fit.rms_mm, 0.1);
  int stiff = 0, soft = 0;  // vertices near the surface
  for (std::size_t i = 0; i < moving.mesh.vertices.size(); ++i) {
    const auto is_near = [&](const Vector3d& p) {
      return target.pairs.tree().nearest(p).distance < 0.3;  // a tenth of an edge
    };
    stiff += is_near(fit.deformation.affine * moving.mesh.vertices[i]) ? 1 : 0;
    soft += is_near(fit.vertices[i]) ? 1 : 0;
    EXPECT_LT((fit.vertices[i] - fit.deformation(moving.mesh.vertices[i])).norm(), 1e-9);
  }
  const auto count = static_cast<int>(moving.mesh.vertices.size());
  EXPECT_LT(stiff, count * 6 / 10);  // the displacements have something to do
  EXPECT_GT(soft, count * 9 / 10);
  EXPECT_EQ(fit.vertices, carry(1).vertices);
}

}  // namespace condyle
