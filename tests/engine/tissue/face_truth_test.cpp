// A real face's tissue, by springs and prisms and by finite elements: the same nodes, the same ones
// grown on the jaw and on the skull, the jaw moved by 5 mm.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>

#include "engine/math/pose.h"
#include "engine/tissue/layered_mesh.h"
#include "engine/tissue/refactorization.h"
#include "tests/engine/tissue/finite_elements.h"
#include "tests/support/places.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// The needed content of a VTK file in text: points, cells, and a named value for each point.
struct VtkGrid {
  Nodes points;
  std::vector<std::vector<int>> cells;
  std::map<std::string, std::vector<double>> values;
};

VtkGrid read_vtk(const std::filesystem::path& path) {
  std::ifstream in(path);
  VtkGrid grid;
  std::string word;
  std::size_t count = 0, unused = 0;
  while (in >> word) {
    if (word == "POINTS") {
      in >> count >> word;
      grid.points.resize(count);
      for (auto& p : grid.points) in >> p.x() >> p.y() >> p.z();
    } else if (word == "CELLS") {
      in >> count >> unused;
      grid.cells.resize(count);
      for (auto& cell : grid.cells) {
        in >> count;
        cell.resize(count);
        for (int& node : cell) in >> node;
      }
    } else if (word == "SCALARS") {
      in >> word;
      auto& values = grid.values[word];
      std::getline(in, word);
      std::getline(in, word);
      values.resize(grid.points.size());
      for (double& value : values) in >> value;
    }
  }
  return grid;
}

/// The face as a layered mesh: its bricks form columns of three from the skin to the bone.
struct FaceNet {
  static constexpr int sheets = 4;
  std::vector<int> of_column;  // node_of order -> node of the file
  std::vector<Eigen::Vector3i> triangles;
};

FaceNet columns_of(const VtkGrid& bricks, const VtkGrid& tets) {
  const auto& layer = tets.values.at("layer");
  const auto on_skin = [&](int node) { return layer[node] == 2; };
  std::set<int> front;
  for (std::size_t i = 0; i < layer.size(); ++i)
    if (on_skin(static_cast<int>(i))) front.insert(static_cast<int>(i));
  const std::set<int> skin = front;

  // Pairs of opposite faces, each corner with its partner across; a wedge has one.
  const std::vector<std::vector<int>> of_hex = {
      {0, 1, 2, 3, 4, 5, 6, 7}, {0, 1, 5, 4, 3, 2, 6, 7}, {0, 3, 7, 4, 1, 2, 6, 5}};
  const std::vector<std::vector<int>> of_wedge = {{0, 1, 2, 3, 4, 5}};
  std::vector<int> below(layer.size(), -1);
  std::vector<char> used(bricks.cells.size(), 0);
  for (int level = 0; level + 1 < FaceNet::sheets; ++level) {
    std::set<int> next;
    for (std::size_t b = 0; b < bricks.cells.size(); ++b) {
      const auto& cell = bricks.cells[b];
      const std::size_t half = cell.size() / 2;
      for (const auto& pairs : half == 4 ? of_hex : of_wedge)
        for (std::size_t top : {std::size_t{0}, half}) {
          const auto corner = [&](std::size_t k) { return cell[pairs[k]]; };
          bool all = !used[b];
          for (std::size_t k = 0; k < half; ++k) all = all && front.count(corner(top + k)) > 0;
          if (!all) continue;
          used[b] = 1;
          for (std::size_t k = 0; k < half; ++k) {
            below[corner(top + k)] = corner(half - top + k);
            next.insert(corner(half - top + k));
          }
        }
    }
    front = next;
  }

  FaceNet mesh;
  std::map<int, int> column;
  for (int node : skin) {
    const int c = static_cast<int>(column.size());
    column[node] = c;
    for (int s = 0, v = node; s < FaceNet::sheets; ++s, v = below[v]) mesh.of_column.push_back(v);
  }
  for (const auto& tet : tets.cells)
    for (int k = 0; k < 4; ++k) {
      if (std::count_if(tet.begin(), tet.end(), on_skin) != 3 || on_skin(tet[k])) continue;
      const int a = tet[(k + 1) % 4], b = tet[(k + 2) % 4], c = tet[(k + 3) % 4];
      const auto& p = tets.points;
      const bool outward = (p[b] - p[a]).cross(p[c] - p[a]).dot(p[tet[k]] - p[a]) < 0;
      mesh.triangles.emplace_back(column[a], column[outward ? b : c], column[outward ? c : b]);
    }
  return mesh;
}

/// Tissue grown on bone, and its displacement by the bone.
fe::Given attached(const VtkGrid& tets, const Pose& jaw) {
  const auto marked = [&](const char* name, std::size_t i) { return tets.values.at(name)[i] != 0; };
  fe::Given given;
  for (std::size_t i = 0; i < tets.points.size(); ++i) {
    const bool on_jaw = marked("jaw_attached", i);
    const bool free = marked("lip_free", i) || marked("cheek_free", i);
    const bool on_skull = marked("edge_fixed", i) || marked("nose_fixed", i) ||
                          marked("zygomatic_ligament_fixed", i) ||
                          (marked("maxilla_within_1mm", i) && !free);
    if (!on_jaw && !on_skull) continue;
    given.node.push_back(static_cast<int>(i));
    given.at.push_back(on_jaw ? Vector3d(jaw * tets.points[i]) : tets.points[i]);
  }
  return given;
}

TEST(FaceTruth, SkinAgreesWithFiniteElementsWhenTheJawMovesFiveMillimetres) {
  const auto folder = test::source_folder() / "../shared/data/case-badin";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "real anatomy absent";
  const VtkGrid tets = read_vtk(folder / "softtissue_tet.vtk");
  const FaceNet face = columns_of(read_vtk(folder / "softtissue_hex.vtk"), tets);
  ASSERT_EQ(face.of_column.size(), tets.points.size());
  ASSERT_EQ(face.triangles.size(), 4122u);
  std::vector<int> in_column(face.of_column.size());
  Nodes rest;
  for (std::size_t i = 0; i < face.of_column.size(); ++i) {
    in_column[face.of_column[i]] = static_cast<int>(i);
    rest.push_back(tets.points[face.of_column[i]]);
  }

  // One material, Poisson's ratio 0.45; ours with the springs that buckle, as tissue has them.
  constexpr double young_MPa = 0.02, poisson = 0.45;
  fe::Body body{tets.points, {}, {young_MPa, poisson}};
  for (const auto& cell : tets.cells) body.tets.push_back({cell[0], cell[1], cell[2], cell[3]});
  const SpringPrismMesh plain =
      layered_mesh(face.triangles, FaceNet::sheets, rest, {3, {young_MPa, poisson, 0}},
                   ShearSprings::over_layers);

  Pose forward, opened;
  forward.t = {0, -5, 0};
  const Vector3d hinge(0, 135, 135);  // between the condyles; the chin is 95 mm away
  opened.R = Eigen::AngleAxisd(5.0 / 95, Vector3d::UnitX());
  opened.t = hinge - opened.R * hinge;
  for (const Pose& jaw : {forward, opened}) {
    const fe::Given given = attached(tets, jaw);
    EXPECT_EQ(given.node.size(), 900u);
    const fe::Solution reference = fe::solve(body, given, 2);

    SpringPrismMesh mesh = plain;
    MeshLoads loads, rest_loads;
    for (std::size_t i = 0; i < given.node.size(); ++i) {
      mesh.anchor_node.push_back(in_column[given.node[i]]);
      mesh.anchor_stiffness.push_back(2);
      loads.anchor_target.push_back(given.at[i]);
      rest_loads.anchor_target.push_back(tets.points[given.node[i]]);
    }
    const HessianFactor factor(mesh, rest_loads, FaceNet::sheets, rest);
    SpringPrismEnergy energy(mesh, loads, 1);
    MinimizeSettings settings;
    Nodes x = rest;
    EXPECT_TRUE(
        minimize_with_refactorization(mesh, loads, energy, factor, settings, x).converged());

    std::vector<double> apart, moved;
    for (std::size_t i = 0; i < x.size(); i += FaceNet::sheets) {
      const int node = face.of_column[i];
      apart.push_back((x[i] - reference.nodes[node]).norm());
      moved.push_back((reference.nodes[node] - tets.points[node]).norm());
    }
    std::sort(apart.begin(), apart.end());
    std::sort(moved.begin(), moved.end());
    const double median = apart[apart.size() / 2], p95 = apart[apart.size() * 95 / 100];
    std::printf(
        "skin apart: median %.3f, p95 %.3f, most %.3f mm; moved: median %.2f, most %.2f mm\n",
        median, p95, apart.back(), moved[moved.size() / 2], moved.back());
    EXPECT_GT(moved[moved.size() / 2], 0.7);
    EXPECT_GT(moved.back(), 4.5);
    EXPECT_LT(median, 0.5);
    EXPECT_LT(p95, 1.5);
  }
}

}  // namespace
}  // namespace condyle
