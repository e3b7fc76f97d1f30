#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "sim/phantom/soft_shapes.h"
#include "sim/phantom/surfaces.h"

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double root_radius = 0.085, tip_radius = 0.015;  // mm
constexpr int sides = 4, pieces = 5;

/// Differences between the lashes of the two lids.
struct LashRow {
  int count;
  double first, last;  // position along the lid, 0 at the inner corner to 1 at the outer
  double length_mm;    // of the longest
  double sink, curl;   // at the tip, fractions of the length: first with the lid, then away
  double side;         // 1 above, -1 below
};

/// Pseudo-random number from 0 to 1 for each lash and property.
double chance(int lash, int question) {
  const double x = std::sin(12.9898 * (lash + 1) + 78.233 * question) * 43758.5453;
  return x - std::floor(x);
}

/// The lid's front edge: from the line of the opening outward to the skin.
class LidEdge {
 public:
  LidEdge() : skin_(skin_recipe(Lips::none)), opening_(lid_opening()) {}

  Vector3d at(double along, double side) const {
    const double x = 17.8 + along * (44.7 - 17.8);
    // The opening's border in this column, then half a millimetre on the lid.
    double inside = 13.7 + 0.1 * (x - 31), outside = inside + 9 * side;
    for (int i = 0; i < 30; ++i) {
      const double z = (inside + outside) / 2;
      (opening_.distance({x, -100, z}) < 0 ? inside : outside) = z;
    }
    const double z = inside + 0.5 * side;
    double front = -98, back = -70;
    for (int i = 0; i < 30; ++i) {
      const double y = (front + back) / 2;
      (skin_({x, y, z}) > 0 ? front : back) = y;
    }
    return {x, front, z};
  }

 private:
  FieldRecipe skin_;
  Primitive opening_;
};

void add_lash(TriMesh& mesh, const std::vector<Vector3d>& line, const Vector3d& across) {
  const int base = static_cast<int>(mesh.vertices.size());
  const int last = static_cast<int>(line.size()) - 1;
  for (int i = 0; i <= last; ++i) {
    const double s = static_cast<double>(i) / last;
    const double radius = root_radius + (tip_radius - root_radius) * s * s;
    const Vector3d along = (line[std::min(i + 1, last)] - line[std::max(i - 1, 0)]).normalized();
    const Vector3d u = (across - along * along.dot(across)).normalized(), v = along.cross(u);
    for (int k = 0; k < sides; ++k) {
      const double turn = 2 * std::numbers::pi * k / sides;
      mesh.vertices.push_back(line[i] + radius * (std::cos(turn) * u + std::sin(turn) * v));
      mesh.colors.emplace_back(.15f, .105f, .085f);
    }
  }
  const auto at = [&](int ring, int k) { return base + ring * sides + k % sides; };
  for (int i = 0; i < last; ++i)
    for (int k = 0; k < sides; ++k) {
      mesh.triangles.emplace_back(at(i, k), at(i, k + 1), at(i + 1, k + 1));
      mesh.triangles.emplace_back(at(i, k), at(i + 1, k + 1), at(i + 1, k));
    }
  for (int k = 1; k + 1 < sides; ++k) {
    mesh.triangles.emplace_back(at(0, 0), at(0, k + 1), at(0, k));
    mesh.triangles.emplace_back(at(last, 0), at(last, k), at(last, k + 1));
  }
}

void add_row(TriMesh& mesh, const LidEdge& edge, const LashRow& row) {
  for (int i = 0; i < row.count; ++i) {
    const auto random = [&](int question) {
      return chance(i + (row.side > 0 ? 0 : 1000), question) - 0.5;
    };
    const double spacing = (row.last - row.first) / (row.count - 1);
    const double along = row.first + spacing * (i + 0.7 * random(0));
    const Vector3d root = edge.at(along, row.side);
    Vector3d out = root - eye_center;
    out.z() *= 0.4;
    out.normalize();
    // Shorter at both ends, longest past the middle; spread like a fan; some cross.
    const double hump = std::sin(std::numbers::pi * (0.12 + 0.80 * along));
    const double length = row.length_mm * (0.45 + 0.55 * hump) * (1 + 0.35 * random(1));
    const Vector3d aside(0.6 * (along - 0.42) + 0.28 * random(2), 0.2 * (along - 0.42), 0);
    const double curl = row.curl * (1 + 0.5 * random(3));
    std::vector<Vector3d> line;
    for (int k = 0; k <= pieces; ++k) {
      const double s = static_cast<double>(k) / pieces;
      const double up = row.side * (curl * s * s - row.sink * s);
      line.push_back(root - 0.35 * out + length * (s * (1 - 0.25 * s) * out + s * aside) +
                     Vector3d(0, 0, length * up));
    }
    add_lash(mesh, line, Vector3d::UnitX());
  }
}

}  // namespace

void add_lashes(TriMesh& eye) {
  const LidEdge edge;
  add_row(eye, edge, {56, .14, .975, 6.0, .20, .46, 1});
  add_row(eye, edge, {28, .26, .95, 2.4, -.10, .22, -1});
}

}  // namespace condyle
