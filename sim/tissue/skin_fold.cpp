#include "sim/tissue/skin_fold.h"

#include <algorithm>

#include "engine/tissue/layered_mesh.h"
#include "sim/tissue/tissue_contact.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

// Skin folds between columns that a wide opening brings together from afar.
constexpr double afar_mm = 15, close_mm = 20, nearer = 0.6;
constexpr double lips_mm = 25;            // from the mouth: lips are treated separately
constexpr double beside_mm = 12;          // at rest, of points from the other flap
constexpr double spacing_mm = 6;          // of points
constexpr std::size_t max_others = 1000;  // columns that each is compared with

/// For each column: number of columns that would fold onto it and follow the mandible less, minus
/// the number that follow it more.
struct Votes {
  std::vector<int> chin;
  std::vector<char> any;
};
Votes votes_of(const ContactSource& from) {
  const std::size_t columns = from.columns.size();
  std::vector<Vector3d> rest(columns), open(columns);
  std::vector<double> lower(columns);  // weight of the lower arch
  for (std::size_t c = 0; c < columns; ++c) {
    const int outer = node_of(static_cast<int>(c), 0, from.sheets);
    rest[c] = from.rest[outer];
    lower[c] = from.weights.of(static_cast<std::size_t>(outer), from.jaw.lower_arch);
    open[c] = rest[c] + lower[c] * (from.wide_open * rest[c] - rest[c]);
  }
  Votes votes{std::vector<int>(columns, 0), std::vector<char>(columns, 0)};
  const std::size_t every = 1 + columns / max_others;
  for (std::size_t a = 0; a < columns; ++a) {
    if (from.columns[a].to_mouth < lips_mm) continue;
    for (std::size_t b = 0; b < columns; b += every) {
      const double before = (rest[a] - rest[b]).norm(), after = (open[a] - open[b]).norm();
      if (before < afar_mm || after > close_mm || after > nearer * before) continue;
      if (from.columns[b].to_mouth < lips_mm) continue;
      votes.chin[a] += lower[a] > lower[b] ? 1 : -1;
      votes.any[a] = 1;
    }
  }
  return votes;
}

void add_points(const Nodes& rest, const Flap& other, Flap& flap) {
  if (flap.surface.empty() || other.surface.empty()) return;
  std::vector<MeshPoint> points;
  for (int node : flap.surface.nodes()) points.push_back(MeshPoint::of_node(node));
  std::vector<Eigen::Vector3i> triangles;
  for (const auto& [a, b, c] : flap.surface.triangles()) triangles.emplace_back(a, b, c);
  spread(triangles, rest, spacing_mm, points);
  const TriangleTree tree = other.surface.tree(other.surface.placed(rest));
  for (const auto& point : points)
    if (tree.nearest(point.at(rest)).distance > beside_mm) flap.points.push_back(point);
  flap.allowance.assign(flap.points.size(), 0.0);
}

}  // namespace

SkinFold find_fold(const ContactSource& from) {
  const Votes votes = votes_of(from);
  std::vector<std::array<int, 3>> chin, throat;
  for (const auto& t : from.skin.mesh.triangles) {
    bool folds = false;
    int sum = 0;
    std::array<int, 3> outer{};
    for (int k = 0; k < 3; ++k) {
      folds = folds || votes.any[t[k]];
      sum += votes.chin[t[k]];
      outer[k] = node_of(t[k], 0, from.sheets);
    }
    if (folds) (sum > 0 ? chin : throat).push_back(outer);
  }
  SkinFold fold;
  fold.chin.surface = MeshSurface(std::move(chin), from.rest);
  fold.throat.surface = MeshSurface(std::move(throat), from.rest);
  add_points(from.rest, fold.throat, fold.chin);
  add_points(from.rest, fold.chin, fold.throat);
  return fold;
}

}  // namespace condyle
