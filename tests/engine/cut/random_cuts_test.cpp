// Finite cuts at random and at places where rounding decides: through vertices, along edges, in the
// plane of a face, bent sheets, axis planes, planes that graze the surface.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <atomic>
#include <filesystem>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "engine/core/parallel.h"
#include "engine/cut/cell_complex.h"
#include "engine/field/wrap.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/mesh_io/mesh_files.h"
#include "tests/engine/cut/cut_checks.h"
#include "tests/support/builtin.h"
#include "tests/support/places.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

constexpr std::array kinds{
    "random patch", "through three vertices", "along an edge", "in a face's plane",
    "bent sheet",   "axis plane at a vertex", "grazing"};

class RandomCuts {
 public:
  explicit RandomCuts(const TriMesh& bone) : bone_(bone) {}

  /// none: the three points that would span the plane lie on a line.
  std::optional<Cut> next(std::size_t kind, int number) {
    Eigen::Vector3d normal(normal_(random_), normal_(random_), normal_(random_)), center = vertex();
    const auto& triangle = bone_.triangles[random_() % bone_.triangles.size()];
    double kerf = number % 4 == 0 ? 0 : uniform(0.2, 2);
    if (kind == 1) {
      const Eigen::Vector3d a = vertex(), b = vertex();
      normal = (a - center).cross(b - center);
    } else if (kind == 2) {
      center = bone_.vertices[triangle[0]];
      normal = (bone_.vertices[triangle[1]] - center).cross(vertex() - center);
    } else if (kind == 3) {
      center = bone_.vertices[triangle[0]];
      normal = (bone_.vertices[triangle[1]] - center).cross(bone_.vertices[triangle[2]] - center);
    } else if (kind == 5) {
      normal = Eigen::Vector3d::Unit(number % 3);
    } else if (kind == 6) {  // at the bone's extreme vertex, or at one as its normal says
      const int v = number % 2 ? triangle[0] : extreme(normal);
      center = bone_.vertices[v];
      if (number % 2) normal = normals_[v];
    }
    if (normal.norm() < 1e-6) return std::nullopt;
    normal.normalize();
    const Eigen::Vector3d u = normal.unitOrthogonal(), w = normal.cross(u);
    const double size = kind == 0 && number % 5 == 0 ? uniform(5, 25) : uniform(15, 80);
    Cut cut{kinds[kind], Region::above({}), {}, kerf};
    for (const Eigen::Vector3d& side : {u, Eigen::Vector3d(-u), w, Eigen::Vector3d(-w)})
      cut.reach.push_back(plane_through(center + size * side, side));
    if (kind == 4) {
      std::vector<Eigen::Vector3d> polyline;
      for (int i = 0; i <= 5; ++i)
        polyline.push_back(center + (2 * i / 5. - 1) * size * u + uniform(-4, 4) * normal);
      cut.above = beyond_sheet(polyline, w, normal);
      return cut;
    }
    for (const Eigen::Vector3d& side : {normal, Eigen::Vector3d(-normal)})
      cut.reach.push_back(plane_through(center + 6 * side, side));
    // One wall exactly on the vertex, edge or face; of a grazing cut, in turn the inner and outer.
    const double shift = kind == 0 ? 0 : kind == 6 && number % 4 > 1 ? -0.5 * kerf : 0.5 * kerf;
    cut.above = Region::above(plane_through(center + shift * normal, normal));
    return cut;
  }

 private:
  double uniform(double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random_);
  }
  const Eigen::Vector3d& vertex() { return bone_.vertices[random_() % bone_.vertices.size()]; }

  int extreme(const Eigen::Vector3d& direction) const {
    int found = bone_.triangles[0][0];
    for (const auto& t : bone_.triangles)
      for (const int v : t)
        if (direction.dot(bone_.vertices[v]) > direction.dot(bone_.vertices[found])) found = v;
    return found;
  }

  const TriMesh& bone_;
  std::vector<Eigen::Vector3d> normals_ = vertex_normals(bone_);
  std::mt19937_64 random_{7};
  std::normal_distribution<double> normal_;
};

struct Made {
  int cuts = 0, parted = 0;
};
/// Makes cuts of each kind, some alone and some in pairs of unlike kinds, and expects whole pieces.
Made cut_at_random(const TriMesh& bone, int each) {
  RandomCuts random(bone);
  std::vector<Cut> cuts;
  for (int number = 0; static_cast<int>(cuts.size()) < each * static_cast<int>(kinds.size());
       ++number)
    for (std::size_t kind = 0; kind < kinds.size(); ++kind)
      if (auto cut = random.next(kind, number)) {
        cut->name += " " + std::to_string(number);
        cuts.push_back(*std::move(cut));
      }
  std::atomic<int> parted = 0;
  std::atomic<bool> failed = false;
  const std::size_t calls = 2 * (cuts.size() / 3);
  parallel_for(calls, static_cast<int>(std::thread::hardware_concurrency()), [&](std::size_t i) {
    if (failed) return;  // the first failures are enough
    const std::span<const Cut> these(&cuts[i / 2 * 3 + i % 2], 1 + i % 2);
    SCOPED_TRACE(these.front().name + ", " + these.back().name);
    const CutResult result = cut_bone(bone, these);
    test::expect_whole(bone, result);
    test::expect_kept(bone, these, result);
    for (const CutOutcome& outcome : result.outcomes) parted += outcome.through;
    if (testing::Test::HasFailure()) failed = true;
  });
  return {static_cast<int>(calls / 2 * 3), parted};
}

constexpr int enough = 500;  // cuts of a mesh

TEST(RandomCuts, OfABumpyBallGiveWholePieces) {
  const Made made = cut_at_random(test::sphere(4, 20, {0, 0, 0}, 0.15), 72);
  EXPECT_GE(made.cuts, enough);
  EXPECT_GT(made.parted, 50);
}

TEST(RandomCuts, OfAFinerMeshGiveWholePieces) {
  EXPECT_GT(cut_at_random(test::sphere(5, 40, {3, -2, 1}, 0.1), 10).parted, 5);
}

TEST(RandomCuts, OfTheBuiltInBonesGiveWholePieces) {
  for (const Role role : {Role::mandible, Role::skull}) {
    const Part& part = *test::builtin().find(role);
    SCOPED_TRACE(part.name);
    const Made made = cut_at_random(part.mesh, 72);
    EXPECT_GE(made.cuts, enough);
    EXPECT_GT(made.parted, 20);
    if (HasFailure()) return;
  }
}

TEST(RandomCuts, OfRealJawsGiveWholePieces) {
  const auto data = test::source_folder() / ".." / "shared" / "data";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "real jaws: " << data << " does not exist";
  for (const char* file :
       {"case-badin/mandible.ply", "case-badin/maxilla_capped.ply", "case-ubc/mandible_8k.ply"}) {
    SCOPED_TRACE(file);
    TriMesh bone = read_mesh(data / file);
    weld(bone);
    drop_degenerate(bone);
    drop_duplicates(bone);
    orient_outward(bone);
    ASSERT_EQ(unbalanced_edges(bone), 0);
    const Made made = cut_at_random(bone, 72);
    EXPECT_GE(made.cuts, enough);
    EXPECT_GT(made.parted, 100);
    if (HasFailure()) return;
  }
}

TEST(RandomCuts, OfAWrappedMaxillaGiveWholePieces) {
  const auto file = test::source_folder() / ".." / "shared" / "data" / "case-ubc" / "maxilla.ply";
  if (!std::filesystem::exists(file))
    GTEST_SKIP() << "a real maxilla: " << file << " does not exist";
  TriMesh bone = read_mesh(file);
  weld(bone);
  drop_degenerate(bone);
  orient_outward(bone);
  EXPECT_GT(unbalanced_edges(bone), 2000);
  const WrappedSurface wrapped =
      wrap(bone, {.threads = static_cast<int>(std::thread::hardware_concurrency())});
  EXPECT_EQ(wrapped.solids, 1);
  EXPECT_LT(wrapped.largest_mm, 1);
  EXPECT_LT(wrapped.mean_mm, 0.15);
  const Made made = cut_at_random(wrapped.mesh, 72);
  EXPECT_GE(made.cuts, enough);
  EXPECT_GT(made.parted, 100);
}

}  // namespace
}  // namespace condyle
