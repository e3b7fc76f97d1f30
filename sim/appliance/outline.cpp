#include "sim/appliance/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "engine/mesh/measure.h"

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double tip_cell_mm = 3, tip_smoothing_mm = 6, crown_slack_mm = 5;
constexpr double above_others_mm = 1;  // a cell whose lowest point is no tip but a gap or a fossa
constexpr double closing_mm = 9, opening_mm = 2.5;  // radii of the outline, inward and outward
constexpr double spine_half_mm = 4;                 // of the plate where teeth are missing
constexpr float far_away = 1e12f, no_surface = 1e6f;
constexpr double fossa_slack_mm = 0.5;  // of a plate beyond the floor of a fossa

/// Squared distances along one line to the nearest of its parabolas.
/// source: Felzenszwalb and Huttenlocher, Distance Transforms of Sampled Functions, 2012
void transform_line(std::vector<float>& f, std::vector<float>& out, std::vector<int>& v,
                    std::vector<float>& z, int n) {
  int k = 0;
  v[0] = 0;
  z[0] = -far_away;
  z[1] = far_away;
  const auto crossing = [&](int q, int p) {
    return ((f[q] + float(q) * float(q)) - (f[p] + float(p) * float(p))) / float(2 * (q - p));
  };
  for (int q = 1; q < n; ++q) {
    float s = crossing(q, v[k]);
    while (k > 0 && s <= z[k]) s = crossing(q, v[--k]);
    v[++k] = q;
    z[k] = s;
    z[k + 1] = far_away;
  }
  k = 0;
  for (int q = 0; q < n; ++q) {
    while (z[k + 1] < float(q)) ++k;
    out[q] = float(q - v[k]) * float(q - v[k]) + f[v[k]];
  }
}

/// Distance of each sample from the nearest one for which `inside` holds, mm.
template <class Inside>
FlatGrid distance_to(const FlatGrid& grid, const Inside& inside) {
  FlatGrid result = grid;
  for (std::size_t i = 0; i < grid.values.size(); ++i)
    result.values[i] = inside(grid.values[i]) ? 0.0f : 1e8f;
  const auto longest = static_cast<std::size_t>(std::max(grid.columns, grid.rows));
  std::vector<float> f(longest), out(longest), z(longest + 1);
  std::vector<int> v(longest);
  for (int i = 0; i < grid.columns; ++i) {
    for (int j = 0; j < grid.rows; ++j) f[j] = result.at(i, j);
    transform_line(f, out, v, z, grid.rows);
    for (int j = 0; j < grid.rows; ++j) result.at(i, j) = out[j];
  }
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) f[i] = result.at(i, j);
    transform_line(f, out, v, z, grid.columns);
    for (int i = 0; i < grid.columns; ++i)
      result.at(i, j) = static_cast<float>(grid.step_mm) * std::sqrt(out[i]);
  }
  return result;
}

/// Marks what a triangle covers.
void cover(FlatGrid& grid, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const double longest =
      std::sqrt(std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (c - b).squaredNorm()}));
  const int n = std::max(1, static_cast<int>(std::ceil(2 * longest / grid.step_mm)));
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      const Vector3d p = a + (b - a) * (double(i) / n) + (c - a) * (double(j) / n);
      const int x = static_cast<int>(std::lround((p.x() - grid.low.x()) / grid.step_mm));
      const int y = static_cast<int>(std::lround((p.y() - grid.low.y()) / grid.step_mm));
      if (x >= 0 && y >= 0 && x < grid.columns && y < grid.rows) grid.at(x, y) = 1;
    }
}

/// Joins the covered ground by a band along the arch, seen from the middle between its ends.
void cover_spine(FlatGrid& grid) {
  Vector2d low = Vector2d::Constant(1e9), high = -low;
  for (int j = 0; j < grid.rows; ++j)
    for (int i = 0; i < grid.columns; ++i)
      if (grid.at(i, j) > 0) {
        const Vector2d p = grid.low + grid.step_mm * Vector2d(i, j);
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
      }
  const Vector2d center(0.5 * (low.x() + high.x()), high.y());
  constexpr int bins = 45;  // of 4 degrees, from the left end over the front to the right one
  struct Bin {
    double sum = 0;
    int count = 0;
  };
  std::vector<Bin> radius(bins);
  const auto angle_of = [&](const Vector2d& d) { return std::atan2(-d.y(), d.x()); };
  for (int j = 0; j < grid.rows; ++j)
    for (int i = 0; i < grid.columns; ++i)
      if (grid.at(i, j) > 0) {
        const Vector2d d = grid.low + grid.step_mm * Vector2d(i, j) - center;
        const double angle = std::clamp(angle_of(d), 0.0, 3.14159);
        Bin& bin = radius[static_cast<std::size_t>(angle / 3.1416 * bins)];
        bin.sum += d.norm();
        ++bin.count;
      }
  std::vector<Vector2d> spine;
  for (int b = 0; b < bins; ++b)
    if (radius[b].count > 0) {
      const double angle = 3.1416 * (b + 0.5) / bins;
      spine.push_back(center + radius[b].sum / radius[b].count *
                                   Vector2d(std::cos(angle), -std::sin(angle)));
    }
  FlatGrid line = grid;
  std::fill(line.values.begin(), line.values.end(), 0.0f);
  for (std::size_t i = 0; i + 1 < spine.size(); ++i) {
    const Vector3d a(spine[i].x(), spine[i].y(), 0), b(spine[i + 1].x(), spine[i + 1].y(), 0);
    cover(line, a, b, b);
  }
  const FlatGrid band = distance_to(line, [](float v) { return v > 0; });
  for (std::size_t i = 0; i < grid.values.size(); ++i)
    if (band.values[i] < spine_half_mm) grid.values[i] = 1;
}

/// Height of the first surface of an arch over each sample, times `sense`; no_surface: none.
FlatGrid first_surface(const FlatGrid& grid, const TriMesh& arch, float sense) {
  FlatGrid first = grid;
  std::fill(first.values.begin(), first.values.end(), no_surface);
  for (const auto& v : arch.triangles) {
    const Vector3d &a = arch.vertices[v[0]], &b = arch.vertices[v[1]], &c = arch.vertices[v[2]];
    const Vector3d n = (b - a).cross(c - a);
    if (n.z() == 0) continue;
    const auto cell = [&](double value, int axis) {
      return (value - grid.low[axis]) / grid.step_mm;
    };
    const Vector3d low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    const int last_i = std::min(grid.columns - 1, static_cast<int>(std::floor(cell(high.x(), 0)))),
              last_j = std::min(grid.rows - 1, static_cast<int>(std::floor(cell(high.y(), 1))));
    for (int j = std::max(0, static_cast<int>(std::ceil(cell(low.y(), 1)))); j <= last_j; ++j)
      for (int i = std::max(0, static_cast<int>(std::ceil(cell(low.x(), 0)))); i <= last_i; ++i) {
        const Vector2d p = grid.low + grid.step_mm * Vector2d(i, j);
        const auto side = [&](const Vector3d& from, const Vector3d& to) {
          return (to.x() - from.x()) * (p.y() - from.y()) -
                 (to.y() - from.y()) * (p.x() - from.x());
        };
        const double s = side(a, b), t = side(b, c), u = side(c, a);
        if (!((s >= 0 && t >= 0 && u >= 0) || (s <= 0 && t <= 0 && u <= 0))) continue;
        const double z = a.z() - (n.x() * (p.x() - a.x()) + n.y() * (p.y() - a.y())) / n.z();
        first.at(i, j) = std::min(first.at(i, j), sense * static_cast<float>(z));
      }
  }
  return first;
}

/// The mean over a square, twice.
void smooth(FlatGrid& grid, double half_mm) {
  const int half = static_cast<int>(std::lround(half_mm / grid.step_mm));
  for (int pass = 0; pass < 2; ++pass)
    for (const bool along_x : {true, false}) {
      const FlatGrid before = grid;
      for (int j = 0; j < grid.rows; ++j)
        for (int i = 0; i < grid.columns; ++i) {
          double sum = 0;
          for (int n = -half; n <= half; ++n)
            sum += along_x ? before.at(std::clamp(i + n, 0, grid.columns - 1), j)
                           : before.at(i, std::clamp(j + n, 0, grid.rows - 1));
          grid.at(i, j) = static_cast<float>(sum / (2 * half + 1));
        }
    }
}

}  // namespace

double FlatGrid::operator()(double x, double y) const {
  const double u = std::clamp((x - low.x()) / step_mm, 0.0, columns - 1.001),
               v = std::clamp((y - low.y()) / step_mm, 0.0, rows - 1.001);
  const int i = static_cast<int>(u), j = static_cast<int>(v);
  const double a = u - i, b = v - j;
  return (1 - b) * ((1 - a) * at(i, j) + a * at(i + 1, j)) +
         b * ((1 - a) * at(i, j + 1) + a * at(i + 1, j + 1));
}

double TipHeights::operator()(double x, double y) const {
  double sum = 0, weights = 0;
  for (const Tip& tip : tips) {
    const double d2 = (tip.x - x) * (tip.x - x) + (tip.y - y) * (tip.y - y);
    const double w = std::exp(-0.5 * d2 / (tip_smoothing_mm * tip_smoothing_mm)) + 1e-12;
    sum += w * tip.z;
    weights += w;
  }
  return weights > 0 ? sum / weights : 0;
}

TipHeights find_tips(const TriMesh& arch, double level_mm, bool down) {
  const double sense = down ? 1 : -1;  // tips are where sense * z is least
  std::map<std::pair<int, int>, Vector3d> lowest;
  for (const Vector3d& p : arch.vertices) {
    if (std::abs(p.z() - level_mm) > crown_slack_mm) continue;
    const std::pair cell(static_cast<int>(std::floor(p.x() / tip_cell_mm)),
                         static_cast<int>(std::floor(p.y() / tip_cell_mm)));
    const auto [at, is_new] = lowest.emplace(cell, p);
    if (!is_new && sense * p.z() < sense * at->second.z()) at->second = p;
  }
  TipHeights heights;
  for (const auto& [cell, p] : lowest) heights.tips.push_back({p.x(), p.y(), p.z()});
  for (int pass = 0; pass < 6; ++pass) {
    const TipHeights all = heights;
    std::erase_if(heights.tips, [&](const TipHeights::Tip& tip) {
      return sense * (tip.z - all(tip.x, tip.y)) > above_others_mm;
    });
  }
  return heights;
}

FlatGrid plate_outline(const std::vector<ArchCrowns>& arches, double depth_mm, double wall_mm,
                       double step_mm) {
  struct Covered {
    const TriMesh& mesh;
    std::vector<int> triangles;
  };
  std::vector<Covered> covered;
  Box box;
  for (const ArchCrowns& arch : arches) {
    covered.push_back({arch.mesh, {}});
    const double sense = arch.down ? 1 : -1;
    std::vector<char> is_in(arch.mesh.vertices.size());
    for (std::size_t v = 0; v < is_in.size(); ++v) {
      const Vector3d& p = arch.mesh.vertices[v];
      const double height = sense * (p.z() - arch.tips(p.x(), p.y()));
      is_in[v] = height < depth_mm && height > -crown_slack_mm;
    }
    for (std::size_t t = 0; t < arch.mesh.triangles.size(); ++t) {
      const auto& v = arch.mesh.triangles[t];
      if (!is_in[v[0]] || !is_in[v[1]] || !is_in[v[2]]) continue;
      covered.back().triangles.push_back(static_cast<int>(t));
      for (int k = 0; k < 3; ++k) box.add(arch.mesh.vertices[v[k]]);
    }
  }
  FlatGrid grid;
  if (box.empty()) return grid;
  const double margin = wall_mm + closing_mm + opening_mm + 3;
  grid.low = box.low.head<2>().array() - margin;
  grid.step_mm = step_mm;
  grid.columns = static_cast<int>((box.size().x() + 2 * margin) / step_mm) + 1;
  grid.rows = static_cast<int>((box.size().y() + 2 * margin) / step_mm) + 1;
  grid.values.assign(static_cast<std::size_t>(grid.columns) * grid.rows, 0);
  for (const Covered& part : covered)
    for (const int t : part.triangles) {
      const auto& v = part.mesh.triangles[t];
      cover(grid, part.mesh.vertices[v[0]], part.mesh.vertices[v[1]], part.mesh.vertices[v[2]]);
    }
  cover_spine(grid);
  // Grown, then shrunk: inward bends are rounded and gaps closed; then outward bends.
  const auto grown = static_cast<float>(wall_mm + closing_mm);
  FlatGrid distance = distance_to(grid, [](float v) { return v > 0; });
  distance = distance_to(distance, [&](float v) { return v > grown; });
  const auto shrunk = static_cast<float>(closing_mm + opening_mm);
  distance = distance_to(distance, [&](float v) { return v > shrunk; });
  const FlatGrid inside = distance_to(distance, [&](float v) { return v > opening_mm; });
  for (std::size_t i = 0; i < distance.values.size(); ++i)
    distance.values[i] = inside.values[i] > 0 ? -inside.values[i]
                                              : distance.values[i] - static_cast<float>(opening_mm);
  smooth(distance, 1);
  return distance;
}

void fill_fossae(FlatGrid& face, const TriMesh& arch, bool down, double most_mm) {
  const float sense = down ? 1 : -1;
  const FlatGrid first = first_surface(face, arch, sense);
  constexpr char tooth = 0, open = 1, outside = 2, fossa = 3;
  std::vector<char> kind(face.values.size());
  const auto beyond = [&](std::size_t at) { return first.values[at] - sense * face.values[at]; };
  for (std::size_t at = 0; at < kind.size(); ++at) kind[at] = beyond(at) > 0 ? open : tooth;
  const int columns = face.columns, rows = face.rows;
  // Cells that are reached from one without a tooth in front of it.
  const auto spread = [&](std::size_t from, char as, std::vector<std::size_t>& reached) {
    reached.assign(1, from);
    kind[from] = as;
    for (std::size_t next = 0; next < reached.size(); ++next) {
      const int i = static_cast<int>(reached[next]) % columns,
                j = static_cast<int>(reached[next]) / columns;
      for (const auto& [di, dj] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
        if (i + di < 0 || j + dj < 0 || i + di >= columns || j + dj >= rows) continue;
        const std::size_t to = static_cast<std::size_t>(j + dj) * columns + (i + di);
        if (kind[to] != open) continue;
        kind[to] = as;
        reached.push_back(to);
      }
    }
  };
  std::vector<std::size_t> cells;
  for (std::size_t at = 0; at < kind.size(); ++at)
    if (kind[at] == open && first.values[at] >= no_surface) spread(at, outside, cells);
  FlatGrid raised = face;
  for (std::size_t at = 0; at < kind.size(); ++at) {
    if (kind[at] != open) continue;
    spread(at, fossa, cells);
    double deepest = 0;
    for (const std::size_t cell : cells)
      deepest = std::max(deepest, static_cast<double>(beyond(cell)));
    const double by = std::min(deepest + fossa_slack_mm, most_mm);
    for (const std::size_t cell : cells)  // and the teeth around it
      for (const int i : {-1, 0, 1})
        for (const int j : {-columns, 0, columns}) {
          const std::size_t to = cell + i + j;
          if (to < raised.values.size())
            raised.values[to] = face.values[to] + sense * static_cast<float>(by);
        }
  }
  face = std::move(raised);
}

}  // namespace condyle
