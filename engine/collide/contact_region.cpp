#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "engine/collide/overlap_measure.h"

namespace condyle {
namespace {

using Corners = std::array<Eigen::Vector3d, 3>;
using RegionCell = std::array<int, 3>;

/// A small piece of the surface of B that is in contact.
struct Piece {
  RegionCell cell;
  double area = 0;
  Eigen::Vector3d centroid, normal;
  double least = 0;  // distance at its deepest corner
  Eigen::Vector3d deepest;
  int triangle = 0;
};

/// Collects the pieces of one contact, in the coordinates of A.
class Gatherer {
 public:
  Gatherer(const SignedSurface& a, const RegionSettings& settings) : a_(a), settings_(settings) {}

  void add(const Corners& t, int triangle) {
    triangle_ = triangle;
    divide(t, false);
  }
  const std::vector<Piece>& pieces() const { return pieces_; }

 private:
  void divide(const Corners& t, bool known_inside) {
    const Eigen::Vector3d middle = (t[0] + t[1] + t[2]) / 3;
    double radius = 0, edge = 0;
    for (int k = 0; k < 3; ++k) {
      radius = std::max(radius, (t[k] - middle).norm());
      edge = std::max(edge, (t[k] - t[(k + 1) % 3]).norm());
    }
    if (!known_inside) {
      if (!a_.box().contains(middle, radius + settings_.within_mm)) return;
      const double distance = a_.distance(middle);
      if (distance - radius > settings_.within_mm) return;
      known_inside = distance + radius < settings_.within_mm;
    }
    // Without a boundary to locate, pieces need only be small enough to be connected.
    if (edge <= (known_inside ? 2 : 1) * settings_.resolution_mm) {
      cut(t);
      return;
    }
    const Eigen::Vector3d m[3] = {(t[0] + t[1]) / 2, (t[1] + t[2]) / 2, (t[2] + t[0]) / 2};
    divide({t[0], m[0], m[2]}, known_inside);
    divide({m[0], t[1], m[1]}, known_inside);
    divide({m[2], m[1], t[2]}, known_inside);
    divide({m[0], m[1], m[2]}, known_inside);
  }

  /// Keeps the part of the triangle in which the linearly interpolated distance is small enough.
  void cut(const Corners& t) {
    double d[3];
    for (int k = 0; k < 3; ++k) d[k] = a_.distance(t[k]) - settings_.within_mm;
    std::array<Eigen::Vector3d, 4> polygon;
    std::size_t count = 0;
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      if (d[k] <= 0) polygon[count++] = t[k];
      if ((d[k] <= 0) != (d[next] <= 0))
        polygon[count++] = t[k] + d[k] / (d[k] - d[next]) * (t[next] - t[k]);
    }
    if (count < 3) return;
    Piece piece;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero(), area_normal = Eigen::Vector3d::Zero();
    for (std::size_t k = 1; k + 1 < count; ++k) {
      const Eigen::Vector3d n = (polygon[k] - polygon[0]).cross(polygon[k + 1] - polygon[0]) / 2;
      piece.area += n.norm();
      area_normal += n;
      sum += n.norm() * (polygon[0] + polygon[k] + polygon[k + 1]) / 3;
    }
    if (!(piece.area > 0)) return;
    piece.centroid = sum / piece.area;
    piece.normal = area_normal;
    const int deepest = static_cast<int>(std::min_element(d, d + 3) - d);
    piece.least = d[deepest] + settings_.within_mm;
    piece.deepest = t[deepest];
    piece.triangle = triangle_;
    for (int k = 0; k < 3; ++k)
      piece.cell[k] =
          static_cast<int>(std::floor(piece.centroid[k] / (2 * settings_.resolution_mm)));
    pieces_.push_back(piece);
  }

  const SignedSurface& a_;
  const RegionSettings& settings_;
  int triangle_ = 0;
  std::vector<Piece> pieces_;
};

/// Number of the connected group of cells (sharing a corner at least) for each piece.
std::vector<int> group(const std::vector<Piece>& pieces, int& groups) {
  std::map<RegionCell, int> cells;
  for (const auto& piece : pieces) cells.try_emplace(piece.cell, 0);
  int count = 0;
  for (auto& entry : cells) entry.second = count++;
  std::vector<int> parent(cells.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const auto& [cell, index] : cells)
    for (int n = 0; n < 27; ++n) {
      const auto other =
          cells.find({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
      if (other == cells.end()) continue;
      const int a = root(index), b = root(other->second);
      parent[std::max(a, b)] = std::min(a, b);
    }
  std::vector<int> number(cells.size(), -1), of_piece;
  groups = 0;
  for (const auto& piece : pieces) {
    int& n = number[root(cells.at(piece.cell))];
    if (n < 0) n = groups++;
    of_piece.push_back(n);
  }
  return of_piece;
}

}  // namespace

ContactRegion contact_region(const SignedSurface& a, const Pose& X_WA, const TriMesh& b,
                             const Pose& X_WB, const RegionSettings& settings) {
  const Pose X_AB = X_WA.inverse() * X_WB;
  Gatherer gatherer(a, settings);
  for (std::size_t i = 0; i < b.triangles.size(); ++i) {
    const auto& t = b.triangles[i];
    gatherer.add({X_AB * b.vertices[t[0]], X_AB * b.vertices[t[1]], X_AB * b.vertices[t[2]]},
                 static_cast<int>(i));
  }
  const auto& pieces = gatherer.pieces();
  int groups = 0;
  const auto of_piece = group(pieces, groups);
  ContactRegion region;
  region.patches.resize(static_cast<std::size_t>(groups));
  std::vector<double> least(region.patches.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const auto& piece = pieces[i];
    const auto g = static_cast<std::size_t>(of_piece[i]);
    auto& patch = region.patches[g];
    patch.area_mm2 += piece.area;
    patch.centroid += piece.area * piece.centroid;
    region.area_mm2 += piece.area;
    region.centroid += piece.area * piece.centroid;
    region.normal -= piece.normal;
    patch.normal -= piece.normal;
    patch.box.add(X_WA * piece.centroid);
    if (piece.least < least[g]) {
      least[g] = piece.least;
      patch.depth_mm = std::max(0.0, -piece.least);
      patch.deepest = piece.deepest;
      patch.triangle = piece.triangle;
    }
  }
  const auto unit = [&](const Eigen::Vector3d& n, double area) {
    return Eigen::Vector3d(n.norm() > 1e-9 * area ? X_WA.R * n.normalized()
                                                  : Eigen::Vector3d::Zero());
  };
  for (auto& patch : region.patches) {
    patch.normal = unit(patch.normal, patch.area_mm2);
    patch.centroid = X_WA * (patch.centroid / patch.area_mm2);
    patch.deepest = X_WA * patch.deepest;
  }
  if (region.area_mm2 > 0) region.centroid = X_WA * (region.centroid / region.area_mm2);
  region.normal = unit(region.normal, region.area_mm2);
  std::stable_sort(
      region.patches.begin(), region.patches.end(),
      [](const ContactPatch& p, const ContactPatch& q) { return p.area_mm2 > q.area_mm2; });
  return region;
}

}  // namespace condyle
