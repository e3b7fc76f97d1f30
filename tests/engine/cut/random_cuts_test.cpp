// Finite cuts at random and at places where rounding decides: through vertices, along edges, in the
// plane of a face, bent sheets, axis planes.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <optional>
#include <random>
#include <string>

#include "engine/cut/cell_complex.h"
#include "engine/mesh/repair.h"
#include "engine/mesh_io/mesh_files.h"
#include "tests/engine/cut/cut_checks.h"
#include "tests/support/places.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

constexpr std::array kinds{"random patch",  "through three vertices",
                           "along an edge", "in a face's plane",
                           "bent sheet",    "axis plane at a vertex"};

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
    // One wall exactly on the vertex, edge or face.
    const double shift = kind == 0 ? 0 : 0.5 * kerf;
    cut.above = Region::above(plane_through(center + shift * normal, normal));
    return cut;
  }

 private:
  double uniform(double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random_);
  }
  const Eigen::Vector3d& vertex() { return bone_.vertices[random_() % bone_.vertices.size()]; }

  const TriMesh& bone_;
  std::mt19937_64 random_{7};
  std::normal_distribution<double> normal_;
};

/// Cuts of each kind; returns how many parted the bone.
int cut_at_random(const TriMesh& bone, int each) {
  RandomCuts cuts(bone);
  int parted = 0;
  for (std::size_t kind = 0; kind < kinds.size(); ++kind)
    for (int i = 0; i < each; ++i) {
      const auto cut = cuts.next(kind, i);
      if (!cut) continue;
      SCOPED_TRACE(std::string(kinds[kind]) + " " + std::to_string(i));
      const CutResult result = cut_bone(bone, {&*cut, 1});
      test::expect_whole(bone, result);
      parted += result.outcomes[0].through;
      if (testing::Test::HasFailure()) return parted;
    }
  return parted;
}

TEST(RandomCuts, OfABumpyBallGiveWholePieces) {
  EXPECT_GT(cut_at_random(test::sphere(4, 20, {0, 0, 0}, 0.15), 90), 50);
}

TEST(RandomCuts, OfAFinerMeshGiveWholePieces) {
  EXPECT_GT(cut_at_random(test::sphere(5, 40, {3, -2, 1}, 0.1), 10), 5);
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
    EXPECT_GT(cut_at_random(bone, 84), 100);
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace condyle
